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

use super::qef::{Qef, dot};
use super::surface::Surface;

type Point = [f64; 3];

/// Crossings whose normals differ by less than this belong to one side of a crease (cosine of 18 degrees). A
/// blunter crease that is cut off by a whole voxel is off by less than 0.08 voxels.
const ONE_SIDE: f64 = 0.95;

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

/// A place that moved by less than this in a step, in voxels, stays. The steps shrink quadratically, so what
/// is left is far less.
const STAYS: f64 = 1e-3;

/// Planes meet nowhere when the square of the sine between them is below this: 2 degrees.
const PARALLEL: f64 = 1e-3;

/// A place is on the surface when its distance is below this, in voxels.
const ON_SURFACE: f64 = 1e-3;

/// A plane near a feature.
#[derive(Clone, Copy, Debug, Default)]
struct Plane {
    /// Where it touches the surface or close to it.
    anchor: Point,
    normal: Point,
    /// The piece of the surface that it belongs to.
    piece: u32,
}

/// The most planes that meet in a point in general.
pub const MAX_PLANES: usize = 3;

/// The planes that meet in a feature.
#[derive(Clone, Copy, Debug)]
struct Planes {
    planes: [Plane; MAX_PLANES],
    len: usize,
}

impl Planes {
    fn slice(&self) -> &[Plane] {
        &self.planes[..self.len]
    }

    fn normals(&self) -> Normals {
        let mut normals = Normals::default();
        for (to, plane) in normals.iter_mut().zip(self.slice()) {
            *to = plane.normal.map(|x| x as f32);
        }
        normals
    }

    fn with(mut self, plane: Plane) -> Option<Planes> {
        *self.planes.get_mut(self.len)? = plane;
        self.len += 1;
        Some(self)
    }

    /// The point nearest to `base` in which the planes meet; `None` when they are parallel.
    fn meet(&self, base: Point) -> Option<Point> {
        if self.len == 3 {
            // Three planes may have a line in common, or nearly.
            let mut qef = Qef::default();
            for plane in self.slice() {
                qef.add(plane.anchor, plane.normal);
            }
            return Some(qef.minimiser_near(base).point);
        }
        let [a, b] = [self.planes[0], self.planes[1]];
        let height = |p: &Plane| dot(p.normal, along(p.anchor, -1.0, base));
        let (ha, hb, cosine) = (height(&a), height(&b), dot(a.normal, b.normal));
        let det = 1.0 - cosine * cosine;
        if det < PARALLEL {
            return None;
        }
        let point = along(base, (ha - cosine * hb) / det, a.normal);
        Some(along(point, (hb - cosine * ha) / det, b.normal))
    }
}

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

/// The unit normals of the sides of a feature, zero beyond the last one.
pub type Normals = [[f32; 3]; MAX_PLANES];

/// The samples of a sheet: points in the cell's coordinates, with unit normals and pieces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Samples {
    all: [Plane; 12],
    len: usize,
}

impl Samples {
    /// Adds a sample, at most twelve, if its normal is one.
    #[inline]
    pub fn push(&mut self, anchor: Point, normal: Point, piece: u32) {
        // What is not a number has no length of one.
        if (dot(normal, normal) - 1.0).abs() < 1e-3 {
            self.all[self.len] = Plane { anchor, normal, piece };
            self.len += 1;
        }
    }

    fn slice(&self) -> &[Plane] {
        &self.all[..self.len]
    }

    /// Whether they see more than one side of a crease.
    pub fn see_several_sides(&self) -> bool {
        sides(self.slice(), [0.0; 3]).len >= 2
    }

    /// How high `point` is above a smooth surface through the samples, and the surface's normal there. By the
    /// trapezoidal rule along the ways from the samples, with the mean normal at the end: exact for quadratic
    /// functions, where the tangent planes themselves are off by their curvature.
    pub fn height(&self, point: Point) -> (f64, Point) {
        let sum = self.slice().iter().fold([0.0; 3], |sum, plane| along(sum, 1.0, plane.normal));
        let length = dot(sum, sum).sqrt();
        if length < f64::MIN_POSITIVE {
            return (0.0, sum);
        }
        let mean = sum.map(|x| x / length);
        let rise = |p: &Plane| dot(along(p.normal, 1.0, mean), along(point, -1.0, p.anchor)) / 2.0;
        let rises = self.slice().iter().map(rise);
        (rises.sum::<f64>() / self.len as f64, mean)
    }

    /// How far the farthest of their planes is from `point`.
    pub fn disagreement(&self, point: Point) -> f64 {
        let planes = self.slice().iter();
        planes.map(|p| dot(p.normal, along(point, -1.0, p.anchor)).abs()).fold(0.0, f64::max)
    }
}

/// The sides of a crease or corner that the samples see: one sample for each, the one nearest to `near`. Fewer
/// than two when the samples see one side only.
fn sides(samples: &[Plane], near: Point) -> Planes {
    let mut sides = Planes { planes: [Plane::default(); MAX_PLANES], len: 0 };
    let Some(&Plane { normal: first, .. }) = samples.first() else { return sides };
    let farthest = |from: &[Point]| {
        let nearest_cosine = |n: Point| from.iter().map(|&f| dot(f, n)).fold(f64::NEG_INFINITY, f64::max);
        let all = samples.iter().map(|p| (nearest_cosine(p.normal), p.normal));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(cosine, _)| *cosine < ONE_SIDE).map(|(_, n)| n)
    };
    let Some(a) = farthest(&[first]) else { return sides };
    let Some(b) = farthest(&[a]) else { return sides };
    let directions = [a, b, farthest(&[a, b]).unwrap_or(a)];
    let count = if directions[2] == a { 2 } else { 3 };
    for (n, &direction) in directions[..count].iter().enumerate() {
        let belongs = |normal: Point| {
            directions[..count]
                .iter()
                .enumerate()
                .all(|(m, &other)| m == n || dot(other, normal) < dot(direction, normal))
        };
        let own = samples.iter().filter(|p| belongs(p.normal));
        let nearest = own.min_by(|p, q| distance2(p.anchor, near).total_cmp(&distance2(q.anchor, near)));
        if let Some(&plane) = nearest {
            sides = sides.with(plane).expect("at most three");
        }
    }
    sides
}

/// Sheets whose normals differ by less, as the second eigenvalue of their error function over the largest, are
/// not looked at: five crossings on one side and one on another at 18 degrees to it have 0.013.
pub const SPREAD: f64 = 0.002;

/// The feature that a sheet with the given samples sees, if it sees one and the surface has it within reach of the
/// cell. `minimiser` is the least point of the error function, `mean` the mean of the sample points.
pub fn feature(ask: &mut Asker<'_>, samples: &Samples, minimiser: Point, mean: Point) -> Option<Feature> {
    let seen = sides(samples.slice(), minimiser);
    if seen.len < 2 {
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
    let seen = sides(samples.slice(), [0.0; 3]);
    if seen.len < 2 {
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
        let side = planes.planes[..planes.len].iter_mut().max_by(|a, b| cosine(a).total_cmp(&cosine(b)))?;
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
        for n in 0..planes.len {
            let Plane { anchor, .. } = planes.planes[n];
            let back = along(anchor, -1.0, point);
            let length = dot(back, back).sqrt();
            let step = if length > beside { beside / length } else { 1.0 };
            planes.planes[n] = ask.plane(along(point, step, back));
        }
        let next = planes.meet(mean)?;
        let moved = distance2(next, point).sqrt();
        point = next;
        if moved < STAYS {
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

/// Where the pieces of some planes meet, as near to `mean` as they do. The planes become those of the pieces there.
fn meet_pieces(ask: &Asker<'_>, planes: &mut Planes, mean: Point) -> Option<Point> {
    let mut point = planes.meet(mean)?;
    for _ in 0..PIECE_STEPS {
        if !is_within_reach(point) {
            return None;
        }
        for plane in &mut planes.planes[..planes.len] {
            *plane = ask.plane_of(plane.piece, point);
        }
        let next = planes.meet(mean)?;
        let moved = distance2(next, point);
        point = next;
        if moved < STAYS * STAYS {
            break;
        }
    }
    is_within_reach(point).then_some(point)
}

fn is_within_reach(point: Point) -> bool {
    point.iter().all(|x| (-REACH..=1.0 + REACH).contains(x))
}

/// a + scale b.
pub fn along(a: Point, scale: f64, b: Point) -> Point {
    std::array::from_fn(|i| a[i] + scale * b[i])
}

/// The square of the distance of two points.
pub fn distance2(a: Point, b: Point) -> f64 {
    let d = along(a, -1.0, b);
    dot(d, d)
}
