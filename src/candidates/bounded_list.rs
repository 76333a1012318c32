//! The list of a block, with bounds: most of its triangles are passed over for most of its points.

use crate::geom::simd::{F32s, F64s, Vec3F32s, dispatch};
use crate::ssvh::{Closest8, Hit, Ssvh};
use glam::DVec3;
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

/// Candidates whose bounds are computed together: most lists are shorter.
const TOGETHER: usize = 64;

/// In lists longer than this, what is nearest among the first is where the hierarchy starts from: thickening a patch of 827,000
/// triangles at 128 voxels asks such lists, and its shape processing takes 0.12 s that way, 0.3 s without.
const LONG: usize = 512;

/// No bound is below this: distances are not negative, and the direction adds at most the length of a diagonal.
const LOWEST: f32 = -FARTHEST;

/// A bound in 32 bits, from the lowest on: 8 for each coordinate of the direction in units of 1 / [`DIRECTIONS`], and 8 for
/// how far the bound at the centre is above `base` in units of 1 / [`STEPS`]. `base` is at most that, as [`base`] gives it.
#[inline(always)]
pub(super) fn packed(bound: PlaneBound, base: f32) -> u32 {
    let [x, y, z] = bound.direction.map(|d| byte(d * DIRECTIONS + DIRECTIONS));
    // Rounded to the nearest after half a step was taken off is rounded down.
    let above = byte((bound.low.max(LOWEST) - base) * STEPS - 0.5);
    u32::from_le_bytes([x, y, z, above])
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
    /// Their slots in the hierarchy.
    pub(super) slots: &'a [u32],
    /// Their bounds.
    pub(super) packed: &'a [u32],
    /// What the bounds are above.
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
        let x = self.local(p);
        // Whatever is as near as this comes before it.
        let mut best = Hit { triangle: ssvh.id_at(self.slots[0]), distance_squared: f64::INFINITY };
        let mut most = f32::INFINITY;
        for (slots, packed) in self.slots.chunks(TOGETHER).zip(self.packed.chunks(TOGETHER)) {
            let mut bounds = [0.0; TOGETHER];
            let least = dispatch(LeastBounds { packed, points: &[x], bounds: &mut bounds });
            // The one with the least bound is nearest most of the time; after it few others matter.
            let first = bounds.iter().position(|&bound| bound == least).unwrap_or(0);
            bounds.swap(0, first);
            for (n, &bound) in bounds[..slots.len()].iter().enumerate() {
                if bound > most {
                    continue;
                }
                // The first one and that one have changed places.
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
                    most = distance + LOSS - self.base;
                }
            }
            if self.slots.len() > LONG {
                return ssvh.closest_from(p, best.triangle);
            }
        }
        best
    }

    /// The same for the first `count` of eight points, whose distances are expected to be at most `expected`, in model
    /// units: only triangles that can be that near are looked at, and all where there is none. What is returned for
    /// other points means nothing.
    pub fn closest8(&self, ssvh: &Ssvh, points: &[DVec3; 8], count: usize, expected: f64) -> [Hit; 8] {
        let exact = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
        let near = points.map(|p| self.local(p));
        let most = ((expected / self.voxel) as f32).next_up() * ROUNDED + (LOSS - self.base);
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

    /// A point in voxels from the centre.
    #[inline(always)]
    fn local(&self, p: DVec3) -> [f32; 3] {
        ((p - self.centre) * (1.0 / self.voxel)).as_vec3().to_array()
    }
}

/// The least bound of each candidate at some points, above the base of their list, and the least of all.
struct LeastBounds<'a> {
    packed: &'a [u32],
    points: &'a [[f32; 3]],
    /// Without meaning beyond the last candidate.
    bounds: &'a mut [f32; TOGETHER],
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
    let (direction, step) = (F32s::splat(simd, 1.0 / DIRECTIONS), F32s::splat(simd, 1.0 / STEPS));
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

struct Closest8InBlock<'a> {
    candidates: &'a Candidates<'a>,
    ssvh: &'a Ssvh,
    exact: &'a [[f64; 8]; 3],
    /// Those that count.
    near: &'a [[f32; 3]],
    /// Candidates with bounds above this do not matter.
    most: f32,
}

impl WithSimd for Closest8InBlock<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let Closest8InBlock { candidates, ssvh, exact, near, most } = self;
        let mut nearest = Closest8::NONE;
        let mut bounds = [0.0; TOGETHER];
        for (slots, packed) in candidates.slots.chunks(TOGETHER).zip(candidates.packed.chunks(TOGETHER)) {
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
