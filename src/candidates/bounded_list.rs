//! The candidates of one block with bounds, by which most triangles are passed over for most
//! points.

use crate::geom::simd::{F32s, F64s, Vec3F32s, dispatch};
use crate::ssvh::{Closest8, Hit, Ssvh, TriangleSlot};
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// A lower bound of the distance from one triangle to the points around a block's centre c, in
/// voxels.
///
/// The distance at c + x is at least `low` + `direction` . x, since the triangle lies beyond the
/// plane through its closest point to c.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneBound {
    /// The bound at the centre.
    pub low: f32,
    /// The unit vector from the triangle.
    pub direction: [f32; 3],
}

/// Steps of a direction's coordinate between 0 and 1: as many as fit into 8 bits with a sign.
const DIRECTION_STEPS: f32 = 127.0;

/// Steps of a bound in a voxel: 8 voxels fit into 8 bits, three times what a list of this extent
/// has.
const STEPS_PER_VOXEL: f32 = 32.0;

/// The largest sum of the absolute coordinates, in voxels from the centre of the nodes, of a point
/// in the cells of a block of 2^3 nodes.
const MAX_SUM: f32 = 4.5;

/// The most that rounding of the direction takes from a bound, in voxels, with a little for the
/// sums.
const DIRECTION_ERROR: f32 = MAX_SUM * 0.5 / DIRECTION_STEPS + 1e-4;

/// Factor that keeps a distance in f32 from being below the exact one after a few roundings.
const ROUND_UP: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Number of candidates whose bounds are computed together. Most lists are shorter.
const CHUNK: usize = 64;

/// Length of a list beyond which the hierarchy is asked instead, starting from the nearest triangle
/// of the first chunk. Thickening a patch of 827,000 triangles at 128 voxels asks such lists; its
/// shape processing takes 0.12 s that way, 0.3 s by the lists alone.
const LONG_LIST: usize = 512;

/// The least bound that means anything, in voxels: distances are not negative, and the direction
/// adds at most the length of a diagonal.
const MIN_BOUND: f32 = -MAX_SUM;

/// Packs a bound into 32 bits.
///
/// From the lowest bits on: 8 bits for each coordinate of the direction, in units of 1 /
/// [`DIRECTION_STEPS`], then 8 bits for the bound at the centre above `base`, in units of 1 /
/// [`STEPS_PER_VOXEL`]. `base` is at most the bound at the centre; the function [`base`] returns
/// one.
#[inline(always)]
pub(super) fn packed(bound: PlaneBound, base: f32) -> u32 {
    let [x, y, z] = bound.direction.map(|d| byte(d * DIRECTION_STEPS + DIRECTION_STEPS));
    // Rounded to the nearest after half a step was taken off is rounded down.
    let above = byte((bound.low.max(MIN_BOUND) - base) * STEPS_PER_VOXEL - 0.5);
    u32::from_le_bytes([x, y, z, above])
}

/// Rounds to the nearest number in 0..=255.
///
/// Next to 2^23 the last place of an f32 is one, so adding 2^23 rounds. That is several times
/// faster than a cast.
#[inline(always)]
#[allow(clippy::manual_clamp, reason = "what is not a number becomes 0")]
fn byte(x: f32) -> u8 {
    (x.max(0.0).min(255.0) + 8_388_608.0).to_bits() as u8
}

/// Returns the base of a list with these bounds: the least of them.
pub(super) fn base(bounds: &[PlaneBound]) -> f32 {
    bounds.iter().fold(f32::INFINITY, |base, bound| base.min(bound.low.max(MIN_BOUND)))
}

/// The triangles that can be closest to a point of a block of 2^3 nodes, or of the cells at its
/// nodes.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// Slots of the triangles in the hierarchy.
    pub(super) slots: &'a [TriangleSlot],
    /// Packed bounds of the triangles.
    pub(super) packed: &'a [u32],
    /// Base of the bounds, in voxels.
    pub(super) base: f32,
    /// World position of the centre of the block's nodes.
    pub(super) centre: DVec3,
    /// Model units to a voxel.
    pub(super) voxel: f64,
}

impl Candidates<'_> {
    /// Returns the closest triangle to `p`, a point of the block, as [`Ssvh::closest`] finds it
    /// among all.
    ///
    /// # Panics
    /// When `ssvh` is not the hierarchy that the list was taken from.
    pub fn closest(&self, ssvh: &Ssvh, p: DVec3) -> Hit {
        let scale = 1.0 / self.voxel;
        let x = self.local(p);
        // Every triangle with a finite distance comes before this one.
        let mut best = Hit { triangle: ssvh.id_at(self.slots[0]), distance_squared: f64::INFINITY };
        let mut most = f32::INFINITY;
        for (slots, packed) in self.slots.chunks(CHUNK).zip(self.packed.chunks(CHUNK)) {
            let mut bounds = [0.0; CHUNK];
            let least = dispatch(LeastBounds { packed, points: &[x], bounds: &mut bounds });
            // The triangle with the least bound is nearest most of the time; after it few others
            // matter.
            let first = bounds.iter().position(|&bound| bound == least).unwrap_or(0);
            bounds.swap(0, first);
            for (n, &bound) in bounds[..slots.len()].iter().enumerate() {
                if bound > most {
                    continue;
                }
                // The first triangle and that one have changed places.
                let n = match n {
                    0 => first,
                    n if n == first => 0,
                    n => n,
                };
                let slot = slots[n];
                let hit = ssvh.hit(slot, p);
                if hit.before(&best) {
                    best = hit;
                    let distance = ((best.distance_squared.sqrt() * scale) as f32).next_up();
                    most = distance + DIRECTION_ERROR - self.base;
                }
            }
            if self.slots.len() > LONG_LIST {
                return ssvh.closest_from(p, best.triangle);
            }
        }
        best
    }

    /// Returns the closest triangles to the first `count` of eight points, each as
    /// [`closest`](Self::closest) finds it.
    ///
    /// `expected`, in model units, is the distance that the points are expected to have at most.
    /// Only triangles that can be that near are looked at, and all of them for a point that has
    /// none. What is returned for the other points means nothing.
    pub fn closest8(&self, ssvh: &Ssvh, points: &[DVec3; 8], count: usize, expected: f64) -> [Hit; 8] {
        let exact = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
        let near = points.map(|p| self.local(p));
        let most = ((expected / self.voxel) as f32).next_up() * ROUND_UP + (DIRECTION_ERROR - self.base);
        let near = &near[..count];
        let kernel = Closest8InBlock { candidates: self, ssvh, exact: &exact, near, most };
        let mut hits = dispatch(kernel);
        for (hit, &p) in hits.iter_mut().zip(points).take(count) {
            if hit.distance_squared > expected * expected {
                *hit = self.closest(ssvh, p);
            }
        }
        hits
    }

    /// Returns a point in voxels from the centre.
    #[inline(always)]
    fn local(&self, p: DVec3) -> [f32; 3] {
        ((p - self.centre) * (1.0 / self.voxel)).as_vec3().to_array()
    }
}

/// Kernel: the least bound of each candidate over some points, above the base of the list. Returns
/// the least of all.
struct LeastBounds<'a> {
    packed: &'a [u32],
    points: &'a [[f32; 3]],
    /// Without meaning beyond the last candidate.
    bounds: &'a mut [f32; CHUNK],
}

impl WithSimd for LeastBounds<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let LeastBounds { packed, points, bounds } = self;
        let (by_eight, rest) = packed.as_chunks();
        let bounds = bounds.as_chunks_mut().0;
        let mut least = F32s::splat(simd, f32::INFINITY);
        for (packed, bounds) in by_eight.iter().zip(bounds.iter_mut()) {
            least = least.min(least_of_8(simd, packed, points, bounds));
        }
        if let Some(&last) = rest.last() {
            let mut filled = [last; 8];
            filled[..rest.len()].copy_from_slice(rest);
            least = least.min(least_of_8(simd, &filled, points, &mut bounds[by_eight.len()]));
        }
        least.least()
    }
}

#[inline(always)]
fn least_of_8<S: Simd>(simd: S, packed: &[u32; 8], points: &[[f32; 3]], bounds: &mut [f32; 8]) -> F32s<S> {
    let (direction, step) =
        (F32s::splat(simd, 1.0 / DIRECTION_STEPS), F32s::splat(simd, 1.0 / STEPS_PER_VOXEL));
    let minus_one = F32s::splat(simd, -1.0);
    let mut all = F32s::splat(simd, f32::INFINITY);
    for vector in 0..8 / F32s::<S>::COUNT {
        let directions = Vec3F32s {
            x: F32s::bytes(simd, packed, vector, 0).times_plus(direction, minus_one),
            y: F32s::bytes(simd, packed, vector, 1).times_plus(direction, minus_one),
            z: F32s::bytes(simd, packed, vector, 2).times_plus(direction, minus_one),
        };
        let low = F32s::bytes(simd, packed, vector, 3) * step;
        let mut least = F32s::splat(simd, f32::INFINITY);
        for &point in points {
            least = least.min(directions.dot_plus(Vec3F32s::splat(simd, point), low));
        }
        least.store(bounds, vector);
        all = all.min(least);
    }
    all
}

/// Kernel: the closest candidates to up to eight points.
struct Closest8InBlock<'a> {
    candidates: &'a Candidates<'a>,
    ssvh: &'a Ssvh,
    exact: &'a [[f64; 8]; 3],
    /// The points that count, in voxels from the centre.
    near: &'a [[f32; 3]],
    /// Bound, above the base, beyond which a candidate does not matter.
    most: f32,
}

impl WithSimd for Closest8InBlock<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let Closest8InBlock { candidates, ssvh, exact, near, most } = self;
        let mut nearest = Closest8::NONE;
        let mut bounds = [0.0; CHUNK];
        for (slots, packed) in candidates.slots.chunks(CHUNK).zip(candidates.packed.chunks(CHUNK)) {
            LeastBounds { packed, points: near, bounds: &mut bounds }.with_simd(simd);
            for (&slot, &bound) in slots.iter().zip(&bounds) {
                if bound > most {
                    continue;
                }
                let triangle = ssvh.triangle_at(slot).splat(simd);
                for vector in 0..near.len().div_ceil(F64s::<S>::COUNT) {
                    nearest.offer(simd, &triangle, ssvh.id_at(slot), exact, vector);
                }
            }
        }
        nearest.hits()
    }
}
