//! Solves the intersected edges of one leaf, block by block. Edges that start in a block of 2^3
//! nodes share the block's list.

use super::hybrid::{Direction, GridEdge, NodeTriangle, Root, Solver};
use super::settings::RootMethod;
use super::statistics::EdgeStatistics;
use super::{Crossing, EdgeNumbers, bisection};
use crate::band::{LeafId, LeafTriangles, NearTriangles, SignField};
use crate::candidates::CandidateLists;
use crate::lattice::{Axis, Ijk, Lattice, LeafMask};
use glam::DVec3;

/// The most edges that start at the nodes of a block of 2^3 nodes.
const MAX_EDGES_IN_BLOCK: usize = 24;

/// Two bits in each of two rows of a mask's word: the nodes of a block in one of its two words.
const BLOCK_ROWS: u64 = 0x0303;

/// The solver of the edges of a leaf.
pub(super) struct LeafSolver<'a> {
    pub(super) solver: Solver<'a>,
    pub(super) method: RootMethod,
    pub(super) lattice: Lattice,
    pub(super) signs: &'a SignField,
    pub(super) numbers: &'a EdgeNumbers,
    pub(super) near: &'a NearTriangles,
}

/// A leaf, with the data that its edges need.
struct Leaf<'a> {
    id: LeafId,
    origin: Ijk,
    inside: &'a LeafMask,
    /// Closest triangles of the leaf's nodes.
    own: Option<LeafTriangles<'a>>,
    /// Closest triangles of the nodes of the next leaf along each axis.
    next: [Option<LeafTriangles<'a>>; 3],
}

impl LeafSolver<'_> {
    /// Intersects all edges that start in a leaf.
    pub(super) fn solve(&self, id: LeafId, samples: &mut [Crossing]) -> EdgeStatistics {
        let mut statistics = EdgeStatistics::default();
        let leaf = self.leaf(id);
        if let (RootMethod::TriangleIteration, Some(lists)) = (self.method, &self.near.lists) {
            self.solve_by_blocks(&leaf, lists, samples, &mut statistics);
            return statistics;
        }
        for ((axis, number), sample) in self.numbers.in_leaf(id).zip(samples) {
            let edge = self.edge(&leaf, axis, number);
            let root = match self.method {
                RootMethod::TriangleIteration => self.solver.iterate(&edge, &mut statistics),
                RootMethod::Hybrid => self.solver.solve(&edge, &mut statistics),
                RootMethod::Bisection { tolerance } => {
                    bisection::solve(&self.solver, &edge, tolerance, &mut statistics)
                }
            };
            *sample = edge.crossing(root);
        }
        statistics
    }

    /// Intersects all edges that start in a leaf, eight at a time. Edges of one block are taken
    /// together: they share the block's list, if it has one.
    fn solve_by_blocks(
        &self,
        leaf: &Leaf<'_>,
        lists: &CandidateLists,
        samples: &mut [Crossing],
        statistics: &mut EdgeStatistics,
    ) {
        let masks = Axis::ALL.map(|axis| self.numbers.mask(leaf.id, axis));
        let first = self.numbers.range(leaf.id).start;
        let unsolved = Root { t: 0.0, normal: DVec3::ZERO, triangle: 0 };
        let mut together: Vec<GridEdge<'_>> = Vec::with_capacity(8);
        for block in 0..64 {
            let mut edges = [(Axis::X, 0); MAX_EDGES_IN_BLOCK];
            let count = starting_in(block, &masks, &mut edges);
            if count == 0 {
                continue;
            }
            let near = lists.of_cell(Ijk::in_leaf(leaf.origin, edges[0].1));
            for edges in edges[..count].chunks(8) {
                together.clear();
                together.extend(
                    edges.iter().map(|&(axis, number)| GridEdge {
                        candidates: near,
                        ..self.edge(leaf, axis, number)
                    }),
                );
                let mut roots = [unsolved; 8];
                self.solver.iterate8(&together, near, statistics, &mut roots);
                for ((edge, root), &(axis, number)) in together.iter().zip(roots).zip(edges) {
                    let id = self.numbers.get(leaf.id, axis, number).expect("an intersected edge");
                    samples[(id.0 - first) as usize] = edge.crossing(root);
                }
            }
        }
    }

    fn leaf(&self, id: LeafId) -> Leaf<'_> {
        let triangles = |id| self.near.nodes.of_leaf(id);
        let next = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        Leaf {
            id,
            origin: self.signs.origin(id),
            inside: self.signs.inside(id),
            own: triangles(id),
            next: next.map(|delta| self.signs.neighbour(id, delta).and_then(triangles)),
        }
    }

    fn edge(&self, leaf: &Leaf<'_>, axis: Axis, number: usize) -> GridEdge<'_> {
        let along = axis as usize;
        let step = [64, 8, 1][along];
        let node = leaf.origin + Ijk::in_leaf(Ijk::default(), number);
        // The other end is in the leaf, or among the first nodes of the next one.
        let (ids, next) = match (number / step) & 7 {
            7 => (leaf.next[along], number - 7 * step),
            _ => (leaf.own, number + step),
        };
        let known = [(leaf.own, number), (ids, next)].map(|(ids, n)| ids?.get(n));
        // A triangle near one end is near the other.
        let guess = known[0].or(known[1]).unwrap_or(0);
        let [a, b] = known.map(|known| known.map_or(NodeTriangle::Guess(guess), NodeTriangle::Known));
        let p = DVec3::from(self.lattice.world_from_index(node));
        let mut q = p;
        q[along] = self.lattice.plane(node.0[along] + 1);
        let inside_first = leaf.inside[number >> 6] >> (number & 63) & 1 == 1;
        let (ends, triangles, direction) =
            if inside_first { ([p, q], [a, b], Direction::Out) } else { ([q, p], [b, a], Direction::In) };
        GridEdge { inside: ends[0], outside: ends[1], triangles, candidates: None, direction, hint: guess }
    }
}

/// Writes to `edges` the edges of `masks`, one mask for each axis, that start at nodes of a block,
/// as axis and node number in the leaf. Blocks are numbered x slowest. Returns the number of edges.
fn starting_in(
    block: usize,
    masks: &[&LeafMask; 3],
    edges: &mut [(Axis, usize); MAX_EDGES_IN_BLOCK],
) -> usize {
    let [x, y, z] = [block >> 4, block >> 2 & 3, block & 3].map(|n| 2 * n);
    let mut count = 0;
    for (axis, mask) in Axis::ALL.into_iter().zip(masks) {
        for word in [x, x + 1] {
            let mut bits = mask[word] & BLOCK_ROWS << (8 * y + z);
            while bits != 0 {
                edges[count] = (axis, 64 * word + bits.trailing_zeros() as usize);
                count += 1;
                bits &= bits - 1;
            }
        }
    }
    count
}
