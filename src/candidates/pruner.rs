//! Prunes the candidates of one leaf, from the hierarchy down to blocks of 2^3 nodes.

use super::PlaneBound;
use super::closest_to_nodes::{ClosestToNodes, Survivor};
use super::triangle_f32::{EightPoints, ROUNDING, TriangleF32};
use crate::filter::Block;
use crate::geom::simd::{F32s, Vec3F32s, dispatch};
use crate::lattice::Lattice;
use crate::ssvh::{Hit, Ssvh, TriangleSlot};
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// Depths of lists: of the leaf, of its octants of 4^3 nodes, of their octants of 2^3 nodes.
const LEVELS: usize = 3;

/// Largest distance, in voxels, from the centre of an octant's nodes to a point of the cells at
/// them. The largest octant has 4^3 nodes.
const MAX_RADIUS: f32 = 2.5 * 1.732_051;

/// The lists of one leaf after the other, in memory that is used again.
#[derive(Debug, Default)]
pub struct CandidatePruner {
    /// Slots of the leaf's candidates in the hierarchy.
    slots: Vec<TriangleSlot>,
    /// The leaf's candidates, seen from the leaf's centre.
    triangles: Vec<TriangleF32>,
    /// Rounding error of a distance, in voxels.
    slack: f32,
    /// Model units to a voxel.
    voxel: f64,
    levels: [Level; LEVELS],
    /// The list that was asked for last, as slots.
    list_slots: Vec<TriangleSlot>,
    /// Working memory of [`ClosestToNodes`].
    survivors: Vec<Survivor>,
}

/// The candidates of a block, and their bounds around the centres of its eight octants.
///
/// Each vector holds `count` elements that count; the rest is left from longer lists.
#[derive(Debug, Default)]
struct Level {
    count: usize,
    /// Candidates, as numbers among the leaf's triangles.
    list: Vec<u32>,
    /// Bounds of the candidates around the block's own centre, on the last level only.
    planes: Vec<PlaneBound>,
    /// Bounds of the candidates around the octants' centres.
    bounds: Vec<Bounds8>,
    /// Octants that each candidate matters to, a bit each.
    octants: Vec<u8>,
    /// NearestCandidate candidate to each octant's centre.
    nearest: [NearestCandidate; 8],
    /// Indices into the parent block's list of the candidates that survive in this octant.
    kept: Vec<u32>,
}

impl Level {
    fn list(&self) -> &[u32] {
        &self.list[..self.count]
    }

    fn planes(&self) -> &[PlaneBound] {
        &self.planes[..self.count]
    }
}

/// Lower bounds of the distance from one triangle to the points around eight centres, in voxels: as
/// [`PlaneBound`] has it for one centre.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds8 {
    low: [f32; 8],
    direction: EightPoints,
}

/// The nearest candidate to the centre of an octant.
#[derive(Clone, Copy, Debug, Default)]
pub struct NearestCandidate {
    /// Distance of the candidate from the centre, in voxels, but for `error`.
    pub distance: f32,
    /// Rounding error of the distance, in voxels.
    pub error: f32,
    /// Vector from the candidate's closest point to the centre, in voxels.
    pub(super) from: [f32; 3],
}

impl CandidatePruner {
    /// Collects the candidates of a leaf from the hierarchy. Returns whether there are at most
    /// `most`; otherwise no list can be used. `q` is a point of the mesh near the leaf.
    pub fn collect(&mut self, ssvh: &Ssvh, lattice: Lattice, leaf: Block, q: DVec3, most: usize) -> bool {
        let centre = leaf.centre(lattice);
        let [x, y, z] = corners(leaf.width).map(|lane| lane.map(f64::from));
        let corners = std::array::from_fn(|n| centre + lattice.voxel * DVec3::new(x[n], y[n], z[n]));
        let limits = corners.map(|c: DVec3| (c - q).length());
        self.slots.clear();
        ssvh.collect(&corners, &limits, most, &mut self.slots);
        if self.slots.len() > most {
            return false;
        }
        self.voxel = lattice.voxel;
        let scale = 1.0 / lattice.voxel;
        let mut largest = leaf.width as f32;
        self.triangles.clear();
        self.triangles.extend(self.slots.iter().map(|&slot| {
            let (triangle, size) = TriangleF32::new(ssvh.triangle_at(slot), centre, scale);
            largest = largest.max(size);
            triangle
        }));
        self.slack = ROUNDING * largest;
        let Level { list, count, .. } = &mut self.levels[0];
        list.clear();
        list.extend(0..self.slots.len() as u32);
        *count = list.len();
        true
    }

    /// Measures the list of `depth` from the centres of the eight octants of its block, and decides
    /// which candidates matter to which octant.
    ///
    /// An octant reaches from its first node to one voxel beyond its last node along each axis.
    /// `centres` are relative to the leaf's centre, in voxels. The octants have `width` nodes along
    /// an axis.
    pub fn measure(&mut self, depth: usize, centres: &EightPoints, width: i32) {
        let Level { count, list, bounds, octants, nearest, .. } = &mut self.levels[depth];
        let list = &list[..*count];
        let bounds = at_least(bounds, *count);
        *nearest = dispatch(MeasureFromCentres {
            triangles: &self.triangles,
            list,
            centres,
            slack: self.slack,
            bounds,
        });
        let octants = at_least(octants, *count);
        dispatch(SelectOctants { bounds, nearest, ends: ends(width), slack: self.slack, octants });
    }

    /// Returns the nearest candidate to the centre of octant `n`, as [`measure`](Self::measure)
    /// found it.
    pub fn nearest(&self, depth: usize, n: usize) -> NearestCandidate {
        self.levels[depth].nearest[n]
    }

    /// Prunes the measured list of `depth` to octant `n`. The result is the list of `depth` + 1.
    pub fn prune(&mut self, depth: usize, n: usize) {
        let [.., parent, child] = &mut self.levels[..depth + 2] else { unreachable!("two levels") };
        // Every candidate is written, and the next one over it where it does not matter: no branch
        // for the processor to guess wrong.
        let kept = at_least(&mut child.kept, parent.count);
        let mut count = 0;
        for (row, octants) in (0..).zip(&parent.octants[..parent.count]) {
            kept[count] = row;
            count += usize::from(octants >> n & 1);
        }
        child.count = count;
        let kept = &kept[..count];
        for (number, &row) in at_least(&mut child.list, count).iter_mut().zip(kept) {
            *number = parent.list[row as usize];
        }
        if depth + 2 == LEVELS {
            for (plane, &row) in at_least(&mut child.planes, count).iter_mut().zip(kept) {
                let Bounds8 { low, direction: [x, y, z] } = &parent.bounds[row as usize];
                *plane = PlaneBound { low: low[n], direction: [x[n], y[n], z[n]] };
            }
        }
    }

    /// Whether all nodes of a block are more than `above` voxels over the planes of all triangles
    /// in the list of `depth`. The block has `width` nodes along an axis; its centre is relative to
    /// the leaf's, in voxels.
    pub fn is_above(&self, depth: usize, centre: [f32; 3], width: i32, above: f32) -> bool {
        let half = 0.5 * (width - 1) as f32;
        let least = above + self.slack;
        let list = self.levels[depth].list();
        list.iter().all(|&n| self.triangles[n as usize].heights(centre, half)[0] > least)
    }

    /// Whether all nodes of a block are under the planes of all triangles in the list of `depth`,
    /// and no slot of the list is excepted. The block is given as for [`is_above`](Self::is_above).
    pub fn is_below(
        &self,
        depth: usize,
        centre: [f32; 3],
        width: i32,
        is_excepted: impl Fn(TriangleSlot) -> bool,
    ) -> bool {
        let half = 0.5 * (width - 1) as f32;
        self.levels[depth].list().iter().all(|&n| {
            let n = n as usize;
            self.triangles[n].heights(centre, half)[1] < -self.slack && !is_excepted(self.slots[n])
        })
    }

    /// Returns the number of triangles in the list of `depth`.
    pub fn count(&self, depth: usize) -> usize {
        self.levels[depth].count
    }

    /// Returns the list of the block of 2^3 nodes that was pruned to last: slots in the hierarchy,
    /// and bounds around the block's centre.
    pub fn bounded(&self) -> (impl ExactSizeIterator<Item = TriangleSlot> + '_, &[PlaneBound]) {
        let level = &self.levels[LEVELS - 1];
        (level.list().iter().map(|&n| self.slots[n as usize]), level.planes())
    }

    /// Returns the closest triangles to the nodes of the block that was pruned to last, as
    /// [`Ssvh::closest`] finds them among all.
    ///
    /// The block of 2^3 nodes is octant `n`, with its centre among `centres` as it was measured.
    /// `points` are the nodes' world positions. A node whose distance is outside of `wanted`, the
    /// least and the largest distance in voxels, gets a distance on the same side of that range,
    /// and no triangle.
    pub fn closest_to_nodes(
        &mut self,
        n: usize,
        centres: &EightPoints,
        ssvh: &Ssvh,
        points: &[DVec3; 8],
        wanted: [f32; 2],
    ) -> [Hit; 8] {
        let [.., parent, block] = &self.levels;
        let mut nodes = NODES;
        for (nodes, centres) in nodes.iter_mut().zip(centres) {
            *nodes = nodes.map(|x| x + centres[n]);
        }
        dispatch(ClosestToNodes {
            triangles: &self.triangles,
            slots: &self.slots,
            list: block.list(),
            planes: block.planes(),
            from: parent.nearest[n].from,
            around: &NODES,
            nodes: &nodes,
            slack: self.slack,
            // Distances that differ by less than their rounding error are not told apart.
            wanted: [wanted[0] - self.slack, wanted[1] + self.slack],
            ssvh,
            voxel: self.voxel,
            exact: &[points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)],
            survivors: &mut self.survivors,
        })
    }

    /// Returns the list of `depth`, as slots in the hierarchy.
    pub fn list(&mut self, depth: usize) -> &[TriangleSlot] {
        let list = self.levels[depth].list().iter();
        self.list_slots.clear();
        self.list_slots.extend(list.map(|&n| self.slots[n as usize]));
        &self.list_slots
    }
}

/// Returns the first `count` elements of a vector, which grows where it is shorter. The elements
/// may hold anything.
fn at_least<T: Clone + Default>(all: &mut Vec<T>, count: usize) -> &mut [T] {
    if all.len() < count {
        all.resize(count, T::default());
    }
    &mut all[..count]
}

/// Returns the first and the last coordinate of a box of `width` nodes along an axis and the cells
/// at them, in voxels from the centre of the nodes.
fn ends(width: i32) -> [f32; 2] {
    [0.5 * (1 - width) as f32, 0.5 * (1 + width) as f32]
}

/// Returns the corners of the box that [`ends`] describes, z fastest.
fn corners(width: i32) -> EightPoints {
    let ends = ends(width);
    std::array::from_fn(|axis| std::array::from_fn(|n| ends[n >> (2 - axis) & 1]))
}

/// The nodes of a block of 2^3 nodes, in voxels from their centre, z fastest.
const NODES: EightPoints = {
    let (a, b) = (-0.5, 0.5);
    [[a, a, a, a, b, b, b, b], [a, a, b, b, a, a, b, b], [a, b, a, b, a, b, a, b]]
};

/// Kernel: bounds of a list's triangles around eight centres, and the nearest triangle to each.
struct MeasureFromCentres<'a> {
    triangles: &'a [TriangleF32],
    list: &'a [u32],
    centres: &'a EightPoints,
    slack: f32,
    bounds: &'a mut [Bounds8],
}

impl WithSimd for MeasureFromCentres<'_> {
    type Output = [NearestCandidate; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [NearestCandidate; 8] {
        let MeasureFromCentres { triangles, list, centres, slack, bounds } = self;
        let (mut least, mut from) = ([0.0; 8], [[0.0; 8]; 3]);
        let slacks = F32s::splat(simd, slack);
        let unknown = F32s::splat(simd, slack * MAX_RADIUS);
        for vector in 0..8 / F32s::<S>::COUNT {
            let p = Vec3F32s::load(simd, centres, vector);
            let mut nearest = F32s::splat(simd, f32::INFINITY);
            let mut way = Vec3F32s::splat(simd, [0.0; 3]);
            for (bound, &n) in bounds.iter_mut().zip(list) {
                let (distance, inverse, direction) = triangles[n as usize].distances(simd, p);
                let nearer = distance.less(nearest);
                nearest = nearer.select(distance, nearest);
                way = nearer.select_points(direction, way);
                // The nearer the triangle, the larger the error of its direction.
                (distance - slacks - unknown * inverse).store(&mut bound.low, vector);
                direction.store(&mut bound.direction, vector);
            }
            nearest.store(&mut least, vector);
            way.times(nearest).store(&mut from, vector);
        }
        std::array::from_fn(|i| NearestCandidate {
            distance: least[i],
            error: slack,
            from: [from[0][i], from[1][i], from[2][i]],
        })
    }
}

/// Kernel: the octants that each measured triangle matters to.
///
/// A triangle matters where it is nearer to one of the octant's corners than the point of the mesh
/// that is nearest to the octant's centre. An octant is a box from `ends[0]` to `ends[1]` along
/// each axis, in voxels from its centre.
struct SelectOctants<'a> {
    bounds: &'a [Bounds8],
    nearest: &'a [NearestCandidate; 8],
    ends: [f32; 2],
    slack: f32,
    octants: &'a mut [u8],
}

impl WithSimd for SelectOctants<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let SelectOctants { bounds, nearest, ends, slack, octants } = self;
        // Distance of each corner from that point, octants side by side.
        let mut limits = [[[[0.0; 8]; 2]; 2]; 2];
        for (x, limits) in limits.iter_mut().enumerate() {
            for (y, limits) in limits.iter_mut().enumerate() {
                for (z, limits) in limits.iter_mut().enumerate() {
                    for (limit, nearest) in limits.iter_mut().zip(nearest) {
                        let [a, b, c] = nearest.from;
                        let [a, b, c] = [a + ends[x], b + ends[y], c + ends[z]];
                        *limit = (a * a + b * b + c * c).sqrt() + slack;
                    }
                }
            }
        }
        let ends = [F32s::splat(simd, ends[0]), F32s::splat(simd, ends[1])];
        for (bound, octants) in bounds.iter().zip(octants) {
            let mut bits = 0;
            for vector in 0..8 / F32s::<S>::COUNT {
                let Vec3F32s { x, y, z } = Vec3F32s::load(simd, &bound.direction, vector);
                let low = F32s::load(simd, &bound.low, vector);
                // Nothing is less than itself.
                let mut near = low.less(low);
                for (limits, x_end) in limits.iter().zip(ends) {
                    let at = x.times_plus(x_end, low);
                    for (limits, y_end) in limits.iter().zip(ends) {
                        let at = y.times_plus(y_end, at);
                        for (limits, z_end) in limits.iter().zip(ends) {
                            let at = z.times_plus(z_end, at);
                            near = near | at.less(F32s::load(simd, limits, vector));
                        }
                    }
                }
                bits |= near.bits(vector);
            }
            *octants = bits;
        }
    }
}
