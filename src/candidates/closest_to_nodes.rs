//! The closest triangles to the nodes of a block: in f32 those that can be, in f64 those that are.

use super::bounded_list::PlaneBound;
use super::triangle_f32::{EightPoints, TriangleF32};
use crate::geom::simd::{F32s, F64s, Vec3F32s};
use crate::ssvh::{Closest8, Hit, Ssvh, TriangleSlot};
use pulp::{Simd, WithSimd};

/// A triangle whose bound is near enough to a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Survivor {
    /// Number of the triangle among the leaf's.
    number: u32,
    /// Distances of the triangle from the nodes, in voxels.
    distances: [f32; 8],
}

/// Kernel: the closest triangles to the nodes of a block of 2^3 nodes, from the block's list.
/// Lengths are in voxels, but for `exact`.
pub(super) struct ClosestToNodes<'a> {
    /// The leaf's triangles.
    pub(super) triangles: &'a [TriangleF32],
    /// Slots of the leaf's triangles in the hierarchy.
    pub(super) slots: &'a [TriangleSlot],
    /// Candidates of the block, as numbers among the leaf's triangles.
    pub(super) list: &'a [u32],
    /// Bounds of the candidates around the block's centre.
    pub(super) planes: &'a [PlaneBound],
    /// Vector to the block's centre from the point of the mesh that is nearest to it.
    pub(super) from: [f32; 3],
    /// The nodes relative to the block's centre.
    pub(super) around: &'a EightPoints,
    /// The nodes relative to the leaf's centre.
    pub(super) nodes: &'a EightPoints,
    /// Rounding error of a distance.
    pub(super) slack: f32,
    /// Distances between which a node needs its exact distance and triangle. Of other nodes only
    /// the side is needed.
    pub(super) wanted: [f32; 2],
    pub(super) ssvh: &'a Ssvh,
    /// Model units to a voxel.
    pub(super) voxel: f64,
    /// World positions of the nodes.
    pub(super) exact: &'a [[f64; 8]; 3],
    /// Working memory.
    pub(super) survivors: &'a mut Vec<Survivor>,
}

impl WithSimd for ClosestToNodes<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let ClosestToNodes { triangles, slots, list, planes, from, around, nodes, slack, .. } = self;
        let ClosestToNodes { wanted: [least, most], ssvh, voxel, exact, survivors, .. } = self;
        let slacks = F32s::splat(simd, slack);
        let nobody = F32s::splat(simd, f32::NEG_INFINITY);
        let mut limits = [0.0; 8];
        let mut found = [0.0; 8];
        for vector in 0..8 / F32s::<S>::COUNT {
            // No node is farther from the mesh than from this point.
            let from = Vec3F32s::load(simd, around, vector) + Vec3F32s::splat(simd, from);
            let limit = from.dot(from).sqrt() + slacks;
            limit.store(&mut found, vector);
            let is_nearer = limit.less(F32s::splat(simd, least));
            is_nearer.select(nobody, limit).store(&mut limits, vector);
        }
        if survivors.len() < list.len() {
            survivors.resize(list.len(), Survivor::default());
        }
        let mut count = 0;
        for (&number, plane) in list.iter().zip(planes) {
            survivors[count].number = number;
            let (low, direction) = (F32s::splat(simd, plane.low), Vec3F32s::splat(simd, plane.direction));
            let mut matters = false;
            for vector in 0..8 / F32s::<S>::COUNT {
                let bound = direction.dot_plus(Vec3F32s::load(simd, around, vector), low);
                matters |= bound.at_most(F32s::load(simd, &limits, vector)).any();
            }
            count += usize::from(matters);
        }
        let survivors = &mut survivors[..count];
        for Survivor { number, distances } in survivors.iter_mut() {
            let triangle = &triangles[*number as usize];
            for vector in 0..8 / F32s::<S>::COUNT {
                let (distance, _, _) = triangle.distances(simd, Vec3F32s::load(simd, nodes, vector));
                distance.store(distances, vector);
                F32s::load(simd, &limits, vector).min(distance + slacks).store(&mut limits, vector);
                F32s::load(simd, &found, vector).min(distance).store(&mut found, vector);
            }
        }
        for vector in 0..8 / F32s::<S>::COUNT {
            let is_farther = F32s::splat(simd, most).less(F32s::load(simd, &found, vector) - slacks);
            let limit = F32s::load(simd, &limits, vector) + slacks;
            is_farther.select(nobody, limit).store(&mut limits, vector);
        }
        let mut nearest = Closest8::NONE;
        for Survivor { number, distances } in survivors.iter() {
            let slot = slots[*number as usize];
            let triangle = ssvh.triangle_at(slot).splat(simd);
            for vector in 0..8 / F64s::<S>::COUNT {
                if any_within::<S>(distances, &limits, vector) {
                    nearest.offer(simd, &triangle, ssvh.id_at(slot), exact, vector);
                }
            }
        }
        let mut hits = nearest.hits();
        for (i, hit) in hits.iter_mut().enumerate() {
            if limits[i] == f32::NEG_INFINITY {
                let distance = voxel * f64::from(found[i]);
                *hit = Hit { triangle: u32::MAX, distance_squared: distance * distance };
            }
        }
        hits
    }
}

/// Whether any of the numbers that fill vector number `vector` of f64 is at most its limit.
#[inline(always)]
fn any_within<S: Simd>(numbers: &[f32; 8], limits: &[f32; 8], vector: usize) -> bool {
    let lanes = F64s::<S>::COUNT;
    let mut any = false;
    for lane in vector * lanes..(vector + 1) * lanes {
        any |= numbers[lane] <= limits[lane];
    }
    any
}
