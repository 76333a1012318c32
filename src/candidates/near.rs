//! The list of a block, with bounds: most of its triangles are passed over for most of its points.

use crate::geom::lanes::{F32s, F64s, P32s, in_lanes};
use crate::ssvh::{Hit, NearestOfEight, Ssvh};
use glam::DVec3;
use multiversion::multiversion;
use pulp::{Simd, WithSimd};

/// How near a triangle comes to the points around the centre of a block's nodes: at c + x at least `low` + `direction` . x,
/// since it lies beyond the plane through its closest point. In voxels.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneBound {
    /// At the centre.
    pub low: f32,
    /// The unit vector from the triangle.
    pub direction: [f32; 3],
}

/// A triangle of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    /// Its position in the hierarchy.
    pub position: u32,
    /// Its bound: 8 bits each for the direction in units of 1 / [`DIRECTIONS`], and for how far the bound at the centre
    /// is above the base of its list in units of 1 / [`STEPS`].
    packed: [u8; 4],
}

/// Steps of a direction's coordinates. As many as fit.
const DIRECTIONS: f32 = 127.0;

/// Steps of a voxel: 8 voxels fit, three times what a list of this extent has.
const STEPS: f32 = 32.0;

/// The largest sum of the coordinates, in size, of a point in the cells of a block of 2^3 nodes, from the centre of the
/// nodes, in voxels.
const FARTHEST: f32 = 4.5;

/// What rounding of the direction takes from a bound at most, with a little for the sums.
const LOSS: f32 = FARTHEST * 0.5 / DIRECTIONS + 1e-4;

/// What a distance is multiplied with, so that it is not below the exact one after a few roundings.
const ROUNDED: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Entries whose bounds are computed together: most lists are shorter.
const TOGETHER: usize = 128;

/// No bound is below this: distances are not negative, and the direction adds at most the length of a diagonal.
const LOWEST: f32 = -FARTHEST;

impl Entry {
    /// `base` is at most the bound at the centre, as [`base`] gives it.
    #[inline(always)]
    pub fn new(position: u32, bound: PlaneBound, base: f32) -> Entry {
        let [x, y, z] = bound.direction.map(|d| byte(d * DIRECTIONS + DIRECTIONS));
        // Rounded to the nearest after half a step was taken off is rounded down.
        let above = byte((bound.low.max(LOWEST) - base) * STEPS - 0.5);
        Entry { position, packed: [x, y, z, above] }
    }

    #[inline(always)]
    fn low(self, base: f32) -> f32 {
        base + f32::from(self.packed[3]) * (1.0 / STEPS)
    }

    #[inline(always)]
    fn direction(self) -> [f32; 3] {
        let [x, y, z, _] = self.packed;
        [x, y, z].map(|d| f32::from(d) * (1.0 / DIRECTIONS) - 1.0)
    }
}

/// The nearest number in 0..=255. Next to 2^23 the last place of an f32 is one, so that adding it rounds: several times
/// faster than a cast.
#[inline(always)]
#[allow(clippy::manual_clamp, reason = "what is not a number becomes 0")]
fn byte(x: f32) -> u8 {
    (x.max(0.0).min(255.0) + 8_388_608.0).to_bits() as u8
}

/// The base of a list with the given bounds.
pub(super) fn base(bounds: &[PlaneBound]) -> f32 {
    bounds.iter().fold(f32::INFINITY, |base, bound| base.min(bound.low.max(LOWEST)))
}

/// The triangles that can be closest to a point of a block or of the cells at its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    pub(super) entries: &'a [Entry],
    pub(super) base: f32,
    /// World position of the centre of the block's nodes.
    pub(super) centre: DVec3,
    pub(super) voxel: f64,
}

impl Candidates<'_> {
    /// The closest triangle to `p`, a point of the block, as [`Ssvh::closest`] finds it among all.
    ///
    /// # Panics
    /// When `ssvh` is not the hierarchy that the list was taken from.
    pub fn closest(&self, ssvh: &Ssvh, p: DVec3) -> Hit {
        let scale = 1.0 / self.voxel;
        let x = ((p - self.centre) * scale).as_vec3().to_array();
        // No triangle has this number, so a real one comes before it.
        let mut best = Hit { triangle: u32::MAX, distance_squared: f64::INFINITY };
        let mut most = f32::INFINITY;
        for entries in self.entries.chunks(TOGETHER) {
            let mut bounds = [0.0; TOGETHER];
            let bounds = &mut bounds[..entries.len()];
            let least = bounds_at(entries, x, bounds);
            // The one with the least bound is nearest most of the time; after it few others matter.
            let first = bounds.iter().position(|&bound| bound == least).unwrap_or(0);
            bounds.swap(0, first);
            for (n, &bound) in bounds.iter().enumerate() {
                if bound > most {
                    continue;
                }
                let entry = entries[if n == 0 {
                    first
                } else if n == first {
                    0
                } else {
                    n
                }];
                let hit = ssvh.hit(entry.position, p);
                if hit.before(&best) {
                    best = hit;
                    let distance = ((best.distance_squared.sqrt() * scale) as f32).next_up();
                    most = distance + LOSS - self.base;
                }
            }
        }
        best
    }

    /// The same for the first `count` of eight points, whose distances are expected to be at most `expected`, in model
    /// units: only triangles that can be that near are looked at, and all where there is none. What is returned for
    /// other points means nothing.
    pub fn closest_to_eight(
        &self,
        ssvh: &Ssvh,
        points: &[DVec3; 8],
        count: usize,
        expected: f64,
    ) -> [Hit; 8] {
        let exact = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
        let scale = 1.0 / self.voxel;
        let near = points.map(|p| ((p - self.centre) * scale).as_vec3());
        let near = [near.map(|p| p.x), near.map(|p| p.y), near.map(|p| p.z)];
        let mut limits = [((expected * scale) as f32).next_up(); 8];
        // Those that nobody asks for look at nothing.
        limits[count..].fill(f32::NEG_INFINITY);
        let kernel = ClosestToEight { candidates: self, ssvh, exact: &exact, near: &near, count, limits };
        let hits = in_lanes(kernel);
        if hits[..count].iter().all(|hit| hit.distance_squared <= expected * expected) {
            return hits;
        }
        limits[..count].fill(f32::INFINITY);
        in_lanes(ClosestToEight { candidates: self, ssvh, exact: &exact, near: &near, count, limits })
    }
}

/// The bounds of some entries at `x`, above the base of their list, and the least of them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn bounds_at(entries: &[Entry], x: [f32; 3], bounds: &mut [f32]) -> f32 {
    for (bound, &entry) in bounds.iter_mut().zip(entries) {
        let direction = entry.direction();
        *bound = entry.low(0.0) + (direction[0] * x[0] + direction[1] * x[1] + direction[2] * x[2]);
    }
    bounds.iter().fold(f32::INFINITY, |least, &bound| if bound < least { bound } else { least })
}

struct ClosestToEight<'a> {
    candidates: &'a Candidates<'a>,
    ssvh: &'a Ssvh,
    exact: &'a [[f64; 8]; 3],
    near: &'a [[f32; 8]; 3],
    count: usize,
    /// In voxels.
    limits: [f32; 8],
}

impl WithSimd for ClosestToEight<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let ClosestToEight { candidates, ssvh, exact, near, count, mut limits } = self;
        let &Candidates { entries, base, voxel, .. } = candidates;
        for limit in &mut limits {
            *limit = *limit * ROUNDED + (LOSS - base);
        }
        let mut nearest = NearestOfEight::NONE;
        let scale = 1.0 / (voxel * voxel);
        for &entry in entries {
            let (low, direction) = (F32s::splat(simd, entry.low(0.0)), P32s::splat(simd, entry.direction()));
            let mut matters = false;
            for vector in 0..count.div_ceil(F32s::<S>::COUNT) {
                let bound = direction.dot_plus(P32s::load(simd, near, vector), low);
                matters |= bound.at_most(F32s::load(simd, &limits, vector)).any();
            }
            if !matters {
                continue;
            }
            let triangle = ssvh.triangle_at(entry.position).in_lanes(simd);
            for vector in 0..count.div_ceil(F64s::<S>::COUNT) {
                nearest.offer(simd, &triangle, ssvh.id_at(entry.position), exact, vector);
            }
            let mut scaled = [0.0; 8];
            for (scaled, squared) in scaled.iter_mut().zip(&nearest.squared) {
                *scaled = (squared * scale) as f32;
            }
            for vector in 0..count.div_ceil(F32s::<S>::COUNT) {
                let distance = F32s::load(simd, &scaled, vector).sqrt();
                let limit = distance * F32s::splat(simd, ROUNDED) + F32s::splat(simd, LOSS - base);
                F32s::load(simd, &limits, vector).min(limit).store(&mut limits, vector);
            }
        }
        nearest.hits()
    }
}
