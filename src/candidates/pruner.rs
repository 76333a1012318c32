//! The lists of one leaf, from the hierarchy down to blocks of 2^3 nodes.

use super::PlaneBound;
use super::closest_to_nodes::{ClosestToNodes, Survivor};
use super::triangle_f32::{EightPoints, ROUNDING, TriangleF32};
use crate::filter::Block;
use crate::geom::simd::{F32s, Vec3F32s, dispatch};
use crate::lattice::Lattice;
use crate::ssvh::{Hit, Ssvh};
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// Lists: of the leaf, of its halves, of their halves.
const LEVELS: usize = 3;

/// Half the diagonal of the largest block that is narrowed to, 4^3 nodes with the cells at them, seen from the centre of
/// its nodes, in voxels.
const REACH: f32 = 2.5 * 1.732_051;

/// The working memory for the lists of one leaf after the other.
#[derive(Debug, Default)]
pub struct CandidatePruner {
    /// Slots in the hierarchy of the leaf's candidates.
    slots: Vec<u32>,
    /// The same triangles, seen from the leaf's centre.
    triangles: Vec<TriangleF32>,
    /// Rounding of distances, in voxels.
    slack: f32,
    /// Model units to a voxel.
    voxel: f64,
    levels: [Level; LEVELS],
    /// The list that was asked for last.
    named: Vec<u32>,
    /// Those that come near a block's nodes.
    survivors: Vec<Survivor>,
}

/// A block's candidates and what its eight halves' centres say of them. Of the vectors as much counts as there are
/// candidates; what is behind is left from longer lists.
#[derive(Debug, Default)]
struct Level {
    count: usize,
    /// Numbers in `triangles`.
    list: Vec<u32>,
    /// Their bounds around the centre of the block itself, where it is of the last level.
    planes: Vec<PlaneBound>,
    bounds: Vec<Bound>,
    /// Per candidate the halves that it matters to, a bit each.
    matters: Vec<u8>,
    nearest: [Nearest; 8],
    /// Those of the block that this one is a half of which are candidates here.
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

/// How near a triangle comes to the points around eight centres: at c + x at least `low` + `direction` . x, since it lies
/// beyond the plane through its closest point. Distances in voxels.
#[derive(Clone, Copy, Debug, Default)]
struct Bound {
    low: [f32; 8],
    direction: EightPoints,
}

/// The nearest candidate to a centre.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nearest {
    /// The distance from it in voxels, but for `error`.
    pub distance: f32,
    /// Rounding of the distance.
    pub error: f32,
    /// From its closest point to the centre.
    pub(super) from: [f32; 3],
}

impl CandidatePruner {
    /// Collects the candidates of a leaf from the hierarchy, and returns whether there are no more than `most`; otherwise
    /// there are none to work with. `q` is a point of the mesh near the leaf.
    pub fn collect(&mut self, ssvh: &Ssvh, lattice: Lattice, leaf: Block, q: DVec3, most: usize) -> bool {
        let centre = leaf.centre(lattice);
        let [x, y, z] = corners(leaf.side).map(|lane| lane.map(f64::from));
        let corners = std::array::from_fn(|n| centre + lattice.voxel * DVec3::new(x[n], y[n], z[n]));
        let limits = corners.map(|c: DVec3| (c - q).length());
        self.slots.clear();
        ssvh.collect(&corners, &limits, most, &mut self.slots);
        if self.slots.len() > most {
            return false;
        }
        self.voxel = lattice.voxel;
        let scale = 1.0 / lattice.voxel;
        let mut largest = leaf.side as f32;
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

    /// Measures the list of `depth` from the centres of the eight halves of its block, given relative to the leaf's
    /// centre in voxels: which candidates matter to which half, for all points from the half's first node to one voxel
    /// beyond its last along each axis. The halves have `side` nodes along an axis.
    pub fn measure(&mut self, depth: usize, centres: &EightPoints, side: i32) {
        let Level { count, list, bounds, matters, nearest, .. } = &mut self.levels[depth];
        let list = &list[..*count];
        let bounds = at_least(bounds, *count);
        *nearest = dispatch(Measure { triangles: &self.triangles, list, centres, slack: self.slack, bounds });
        let matters = at_least(matters, *count);
        dispatch(Reach { bounds, nearest, ends: ends(side), slack: self.slack, matters });
    }

    /// What [`measure`](Self::measure) found nearest to the centre of half number `n`.
    pub fn nearest(&self, depth: usize, n: usize) -> Nearest {
        self.levels[depth].nearest[n]
    }

    /// Narrows the measured list of `depth` to half number `n`: the list of `depth` + 1.
    pub fn prune(&mut self, depth: usize, n: usize) {
        let [.., parent, child] = &mut self.levels[..depth + 2] else { unreachable!("two levels") };
        // Every candidate is written, and the next one over it where it does not matter: no branch to guess wrong.
        let kept = at_least(&mut child.kept, parent.count);
        let mut count = 0;
        for (row, matters) in (0..).zip(&parent.matters[..parent.count]) {
            kept[count] = row;
            count += usize::from(matters >> n & 1);
        }
        child.count = count;
        let kept = &kept[..count];
        for (number, &row) in at_least(&mut child.list, count).iter_mut().zip(kept) {
            *number = parent.list[row as usize];
        }
        if depth + 2 == LEVELS {
            for (plane, &row) in at_least(&mut child.planes, count).iter_mut().zip(kept) {
                let Bound { low, direction: [x, y, z] } = &parent.bounds[row as usize];
                *plane = PlaneBound { low: low[n], direction: [x[n], y[n], z[n]] };
            }
        }
    }

    /// Whether all nodes of a block of `side` nodes along an axis, whose centre is given relative to the leaf's in voxels, are
    /// more than `above` voxels over the planes of all triangles in the list of `depth`.
    pub fn is_above(&self, depth: usize, centre: [f32; 3], side: i32, above: f32) -> bool {
        let half = 0.5 * (side - 1) as f32;
        let least = above + self.slack;
        let list = self.levels[depth].list();
        list.iter().all(|&n| self.triangles[n as usize].heights(centre, half)[0] > least)
    }

    /// Whether all of them are under the planes of all triangles in that list, none of which is excepted, by its slot.
    pub fn is_below(
        &self,
        depth: usize,
        centre: [f32; 3],
        side: i32,
        is_excepted: impl Fn(u32) -> bool,
    ) -> bool {
        let half = 0.5 * (side - 1) as f32;
        self.levels[depth].list().iter().all(|&n| {
            let n = n as usize;
            self.triangles[n].heights(centre, half)[1] < -self.slack && !is_excepted(self.slots[n])
        })
    }

    /// The number of triangles in the list of `depth`.
    pub fn count(&self, depth: usize) -> usize {
        self.levels[depth].count
    }

    /// The list of the block of 2^3 nodes that was narrowed to last: slots in the hierarchy, and bounds around the
    /// block's centre.
    pub fn bounded(&self) -> (impl ExactSizeIterator<Item = u32> + '_, &[PlaneBound]) {
        let level = &self.levels[LEVELS - 1];
        (level.list().iter().map(|&n| self.slots[n as usize]), level.planes())
    }

    /// The closest triangles to the nodes of the block of 2^3 nodes that was narrowed to last, as [`Ssvh::closest`] finds
    /// them among all: half number `n`, with its centre among `centres` as it was measured. `points` are the nodes' world
    /// positions. Of nodes whose distance is not within `wanted`, two lengths in voxels, only that is known: they get a
    /// distance on the same side of it, and no triangle.
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
            // Below their rounding, numbers this near are not told apart.
            wanted: [wanted[0] - self.slack, wanted[1] + self.slack],
            ssvh,
            voxel: self.voxel,
            exact: &[points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)],
            survivors: &mut self.survivors,
        })
    }

    /// Slots in the hierarchy of the list of `depth`.
    pub fn list(&mut self, depth: usize) -> &[u32] {
        let list = self.levels[depth].list().iter();
        self.named.clear();
        self.named.extend(list.map(|&n| self.slots[n as usize]));
        &self.named
    }
}

/// The first `count` elements, which the vector has afterwards. They may hold anything.
fn at_least<T: Clone + Default>(all: &mut Vec<T>, count: usize) -> &mut [T] {
    if all.len() < count {
        all.resize(count, T::default());
    }
    &mut all[..count]
}

/// Where the box of `side` nodes along an axis and the cells at them begins and ends, in voxels from the centre of the
/// nodes.
fn ends(side: i32) -> [f32; 2] {
    [0.5 * (1 - side) as f32, 0.5 * (1 + side) as f32]
}

/// The corners of that box, z fastest.
fn corners(side: i32) -> EightPoints {
    let ends = ends(side);
    std::array::from_fn(|axis| std::array::from_fn(|n| ends[n >> (2 - axis) & 1]))
}

/// The nodes of a block of 2^3 from their centre, in voxels, z fastest.
const NODES: EightPoints = {
    let (a, b) = (-0.5, 0.5);
    [[a, a, a, a, b, b, b, b], [a, a, b, b, a, a, b, b], [a, b, a, b, a, b, a, b]]
};

/// Bounds of a list's triangles from eight centres, and the nearest ones.
struct Measure<'a> {
    triangles: &'a [TriangleF32],
    list: &'a [u32],
    centres: &'a EightPoints,
    slack: f32,
    bounds: &'a mut [Bound],
}

impl WithSimd for Measure<'_> {
    type Output = [Nearest; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Nearest; 8] {
        let Measure { triangles, list, centres, slack, bounds } = self;
        let (mut least, mut from) = ([0.0; 8], [[0.0; 8]; 3]);
        let slacks = F32s::splat(simd, slack);
        let unknown = F32s::splat(simd, slack * REACH);
        for vector in 0..8 / F32s::<S>::COUNT {
            let p = Vec3F32s::load(simd, centres, vector);
            let mut nearest = F32s::splat(simd, f32::INFINITY);
            let mut way = Vec3F32s::splat(simd, [0.0; 3]);
            for (bound, &n) in bounds.iter_mut().zip(list) {
                let (distance, inverse, direction) = triangles[n as usize].distances(simd, p);
                let nearer = distance.less(nearest);
                nearest = nearer.select(distance, nearest);
                way = nearer.select_points(direction, way);
                // The nearer the triangle, the less its direction is known.
                (distance - slacks - unknown * inverse).store(&mut bound.low, vector);
                direction.store(&mut bound.direction, vector);
            }
            nearest.store(&mut least, vector);
            way.times(nearest).store(&mut from, vector);
        }
        std::array::from_fn(|i| Nearest {
            distance: least[i],
            error: slack,
            from: [from[0][i], from[1][i], from[2][i]],
        })
    }
}

/// Which of the measured triangles matter to which half: those that come nearer to one of its corners than the point that
/// is nearest to its centre. The halves reach from the first to the second of `ends` around their centres.
struct Reach<'a> {
    bounds: &'a [Bound],
    nearest: &'a [Nearest; 8],
    ends: [f32; 2],
    slack: f32,
    matters: &'a mut [u8],
}

impl WithSimd for Reach<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Reach { bounds, nearest, ends, slack, matters } = self;
        // How far each corner is from that point, halves side by side.
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
        for (bound, matters) in bounds.iter().zip(matters) {
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
            *matters = bits;
        }
    }
}
