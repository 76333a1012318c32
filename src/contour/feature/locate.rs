//! Where a crease or a corner of the surface is, from the planes that a cell sees of it.
//!
//! The minimiser of the error function of a cell is only as good as the cell's crossings: a third plane that
//! crosses no edge of the cell is missing, and curved sides are taken as planes far from where they are needed.
//! With the surface at hand, the pieces of it that the crossings lie on are asked at the place where they meet, until it
//! stays, and then the surface itself, whether it has another piece there that is nearer:
//!
//! ```text
//!   planes at the crossings -> where they meet -> planes of the pieces there -> where these meet ... -> is it on the
//!        A \   / B                 \ /                  \ /                      surface? then that is the feature;
//!           \ /                     x                    x                       else go on with the piece that is nearer
//! ```

use super::tangent_planes::{Normals, ONE_SIDE, Plane, Planes, Samples, sides};
use crate::contour::implicit_surface::Surface;
use crate::geom::quadric::{along, distance2, dot};

type Point = [f64; 3];

/// How far outside of its cell a feature is looked for, in voxels. The tip of a wedge of 22 degrees is 2.5 voxels
/// from where it is a voxel thick.
pub const REACH: f64 = 2.5;

/// How far beside the crease its sides are asked, in voxels, to begin with; then twice the last step, but at
/// least the second value, so that rounding does not decide which side answers.
const BESIDE: [f64; 2] = [0.2, 1e-3];

/// Rounds of asking beside a crease. Flat sides need one, curved ones three.
const ROUNDS: usize = 5;

/// Pieces that are followed, with a question each: two of three features need one, one in thirty more than two. Where
/// more are needed the sides have many pieces, and it is better to ask for them.
const PIECES: usize = 3;

/// Steps to where pieces meet. Flat pieces need one, curved ones three.
const PIECE_STEPS: usize = 6;

/// Steps along gradients end at this distance, in voxels.
const EXACTLY: f64 = 1e-6;

/// Steps along gradients.
const STEPS: usize = 12;

/// A place that moved by less than this in a step, in voxels, stays: by asking, and by pieces, where a step costs little.
/// The steps shrink quadratically, so what is left is far less.
const STAYS: [f64; 2] = [5e-3, 1e-3];

/// A place is on the surface when its distance is below this, in voxels.
const ON_SURFACE: f64 = 1e-3;

/// Asks the surface in the coordinates of a cell, in voxels.
pub struct Asker<'a> {
    /// The surface.
    pub surface: &'a dyn Surface,
    /// The world position of the cell's lowest corner.
    pub origin: Point,
    /// Voxel size.
    pub voxel: f64,
    /// A piece near by; after a question the one that is closest. See [`Surface::at`].
    pub piece: u32,
}

impl Asker<'_> {
    /// Distance in voxels and gradient at `local`.
    pub fn at(&mut self, local: Point) -> (f64, Point) {
        let (distance, gradient) = self.surface.at(self.world(local), &mut self.piece);
        (distance / self.voxel, gradient)
    }

    /// The plane at `local`, moved there along the gradient.
    fn plane(&mut self, local: Point) -> Plane {
        let (distance, normal) = self.at(local);
        Plane { anchor: along(local, -distance, normal), normal, piece: self.piece }
    }

    /// The plane of a piece at `local`, moved there along the gradient.
    fn plane_of(&self, piece: u32, local: Point) -> Plane {
        let (distance, normal) = self.surface.piece_at(self.world(local), piece);
        Plane { anchor: along(local, -distance / self.voxel, normal), normal, piece }
    }

    fn world(&self, local: Point) -> Point {
        std::array::from_fn(|a| self.origin[a] + self.voxel * local[a])
    }
}

/// A crease point or a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// The point of the feature that is nearest to the cell's crossings.
    pub point: Point,
    /// The unit normals of the sides that meet there, zero beyond the last one.
    pub normals: Normals,
}

/// Sheets whose normals differ by less, as the second eigenvalue of their error function over the largest, are
/// not looked at: five crossings on one side and one on another at 18 degrees to it have 0.013.
pub const SPREAD: f64 = 0.002;

/// The feature that a sheet with the given samples sees, if it sees one and the surface has it within reach of the
/// cell. `minimiser` is the least point of the error function, `mean` the mean of the sample points.
pub fn feature(ask: &mut Asker<'_>, samples: &Samples, minimiser: Point, mean: Point) -> Option<Feature> {
    let seen = sides(samples, minimiser);
    if seen.slice().len() < 2 {
        return None;
    }
    let (point, planes) = settle(ask, seen, mean)?;
    Some(Feature { point, normals: planes.normals() })
}

/// The feature between the sides of the surface that are near the points `at`, around the origin.
pub fn feature_between(ask: &mut Asker<'_>, at: impl Iterator<Item = Point>) -> Option<Point> {
    let mut samples = Samples::default();
    for p in at.take(12) {
        let Plane { anchor, normal, piece } = ask.plane(p);
        samples.push(anchor, normal, piece);
    }
    let seen = sides(&samples, [0.0; 3]);
    if seen.slice().len() < 2 {
        return None;
    }
    settle(ask, seen, [0.0; 3]).map(|(point, _)| point)
}

/// The point of the surface that is reached from `from` along gradients, or the last one on the way. Between two
/// sides the way goes to and fro.
pub fn nearest(ask: &mut Asker<'_>, from: Point) -> Option<Point> {
    let mut point = from;
    let (mut distance, mut normal) = ask.at(point);
    let mut share = 1.0;
    for _ in 0..STEPS {
        if distance.abs() <= EXACTLY {
            break;
        }
        let next = along(point, -share * distance, normal);
        let (next_distance, next_normal) = ask.at(next);
        if next_distance.abs() < distance.abs() {
            (point, distance, normal) = (next, next_distance, next_normal);
        } else {
            share *= 0.5;
        }
    }
    is_within_reach(point).then_some(point)
}

/// Follows the planes to where they meet on the surface: by the pieces that they are of, or, where these lead away, by
/// what the surface has beside the place where they meet.
fn settle(ask: &mut Asker<'_>, planes: Planes, mean: Point) -> Option<(Point, Planes)> {
    by_pieces(ask, planes, mean).or_else(|| by_asking(ask, planes, mean))
}

/// Follows the pieces of the planes to where they meet, and takes others where the surface has nearer ones, until that is
/// on the surface.
fn by_pieces(ask: &mut Asker<'_>, mut planes: Planes, mean: Point) -> Option<(Point, Planes)> {
    for _ in 0..PIECES {
        let point = meet_pieces(ask, &mut planes, mean)?;
        let (distance, normal) = ask.at(point);
        if distance.abs() <= ON_SURFACE {
            return Some((point, planes));
        }
        let cosine = |p: &Plane| dot(p.normal, normal);
        let side = planes.iter_mut().max_by(|a, b| cosine(a).total_cmp(&cosine(b)))?;
        if cosine(side) <= ONE_SIDE || side.piece == ask.piece {
            return None;
        }
        *side = Plane { anchor: along(point, -distance, normal), normal, piece: ask.piece };
    }
    None
}

/// Asks the surface beside the place where the planes meet, until that is on the surface.
fn by_asking(ask: &mut Asker<'_>, mut planes: Planes, mean: Point) -> Option<(Point, Planes)> {
    let mut point = planes.meet(mean)?;
    let mut beside = BESIDE[0];
    for _ in 0..ROUNDS {
        if !is_within_reach(point) {
            return None;
        }
        for plane in planes.iter_mut() {
            let back = along(plane.anchor, -1.0, point);
            let length = dot(back, back).sqrt();
            let step = if length > beside { beside / length } else { 1.0 };
            *plane = ask.plane(along(point, step, back));
        }
        let next = planes.meet(mean)?;
        let moved = distance2(next, point).sqrt();
        point = next;
        if moved < STAYS[0] {
            break;
        }
        beside = (2.0 * moved).clamp(BESIDE[1], BESIDE[0]);
    }
    if !is_within_reach(point) {
        return None;
    }
    let (distance, normal) = ask.at(point);
    if distance.abs() <= ON_SURFACE {
        return Some((point, planes));
    }
    // A side that no crossing of the cell showed.
    let third = Plane { anchor: along(point, -distance, normal), normal, piece: ask.piece };
    corner(ask, &planes, third, mean)
}

/// Where a third plane ends the crease of two.
fn corner(ask: &mut Asker<'_>, planes: &Planes, third: Plane, mean: Point) -> Option<(Point, Planes)> {
    if planes.slice().iter().any(|p| dot(p.normal, third.normal) > ONE_SIDE) {
        return None;
    }
    let planes = planes.with(third)?;
    let point = planes.meet(mean)?;
    if !is_within_reach(point) {
        return None;
    }
    let (distance, _) = ask.at(point);
    (distance.abs() <= ON_SURFACE).then_some((point, planes))
}

/// Where the pieces of some planes meet, as near to `mean` as they do; `None` when no place stays. The planes become those of
/// the pieces there.
fn meet_pieces(ask: &Asker<'_>, planes: &mut Planes, mean: Point) -> Option<Point> {
    let mut point = planes.meet(mean)?;
    for _ in 0..PIECE_STEPS {
        if !is_within_reach(point) {
            return None;
        }
        for plane in planes.iter_mut() {
            *plane = ask.plane_of(plane.piece, point);
        }
        let next = planes.meet(mean)?;
        let moved = distance2(next, point);
        point = next;
        if moved < STAYS[1] * STAYS[1] {
            return is_within_reach(point).then_some(point);
        }
    }
    None
}

fn is_within_reach(point: Point) -> bool {
    point.iter().all(|x| (-REACH..=1.0 + REACH).contains(x))
}
