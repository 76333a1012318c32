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
    /// The signed distance of `p`, negative inside, in model units, and its unit gradient there. `hint` is
    /// carried from one question to the next near it, for speed only; [`Crossing::hint`](crate::edge::Crossing)
    /// to begin with.
    fn at(&self, p: [f64; 3], hint: &mut u32) -> (f64, [f64; 3]);
}
