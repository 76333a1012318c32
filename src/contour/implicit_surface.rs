//! The surface itself, where the contour may ask it for more than its crossings with grid edges.

/// How the distance runs near a crease, where several sides of the surface meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Creases {
    /// It is the least of the distances from the sides: all creases are concave, as those of a grown offset.
    Concave,
    /// It is the largest of them: all creases are convex, as those of a shrunk offset.
    Convex,
    /// Either.
    Both,
}

/// A surface given by its signed distance.
pub trait Surface: Sync {
    /// Which creases it has.
    fn creases(&self) -> Creases;
    /// The largest curvature of its sides, one over model units: away from concave creases, towards convex ones.
    fn curvature(&self) -> f64;
    /// The signed distance of `p`, negative inside, in model units, and its unit gradient there. `piece` is one near `p`,
    /// for speed only: [`Crossing::triangle`](crate::edge::Crossing) to begin with, then the answer of the last question
    /// near it. It becomes the piece that is the closest to `p`.
    fn at(&self, p: [f64; 3], piece: &mut u32) -> (f64, [f64; 3]);
    /// The same for a surface that `piece` makes alone, continued beyond the creases in which it ends.
    fn piece_at(&self, p: [f64; 3], piece: u32) -> (f64, [f64; 3]);
}
