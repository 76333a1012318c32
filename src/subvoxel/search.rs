//! Searches for points of one sign between nodes of the other sign.

use super::directions::{DirectionTable, Directions};
use crate::band::{LeafId, NearTriangles, SignField};
use crate::candidates::CandidateLists;
use crate::distance::{Sample, SignedDistance};
use crate::lattice::{Axis, Ijk, LEAF_DIM, LEAF_SIZE, Lattice, Slab};
use crate::run::{Cancelled, RunSettings, SHARE};
use glam::DVec3;
use rayon::prelude::*;

/// The side of the surface on which a point is missed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Missed {
    /// The point is in the offset solid, among outside nodes.
    Solid,
    /// The point is outside the offset solid, among inside nodes.
    Void,
}

/// The part of a cell in which a point was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Found {
    /// An edge that the surface crosses twice.
    OnEdge,
    /// The interior of a cell with corners of one sign.
    InCell,
}

/// A point whose sign differs from that of the nodes around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MissedCandidate {
    pub(super) cell: Ijk,
    pub(super) at: DVec3,
    pub(super) missed: Missed,
    pub(super) found: Found,
    /// Distance from the surface, in voxels.
    pub(super) depth: f64,
}

/// Points that the contour may not know of.
#[derive(Clone, Debug, Default)]
pub struct MissedCandidates {
    pub(super) all: Vec<MissedCandidate>,
    pub(super) lattice: Option<Lattice>,
}

impl MissedCandidates {
    /// Adds the candidates of the next slab.
    pub fn append(&mut self, mut other: MissedCandidates) {
        self.all.append(&mut other.all);
        self.lattice = self.lattice.or(other.lattice);
    }
}

/// The most distance queries along one edge. A gap between plane walls takes one, one between round
/// walls two or three.
const MAX_QUERIES_ON_EDGE: usize = 6;

/// The most distance queries in one cell.
const MAX_QUERIES_IN_CELL: usize = 6;

/// The fewest corners with known distances of a cell that is searched. Fewer do not tell that there
/// is something between them.
const MIN_KNOWN: usize = 4;

/// Depth, in voxels, up to which a point does not count: rounding.
const NEGLIGIBLE_DEPTH: f64 = 1e-3;

/// Finds points between the nodes of `signs` that have the other sign.
///
/// `near` has the closest triangles of the nodes. Leaves that other slabs own are left to them.
///
/// # Errors
/// When the run is cancelled.
pub fn find_missed(
    distance: &SignedDistance,
    r: f64,
    lattice: Lattice,
    slab: Slab,
    signs: &SignField,
    near: &NearTriangles,
    run: &RunSettings,
) -> Result<MissedCandidates, Cancelled> {
    let directions = DirectionTable::new(distance.ssvh(), distance.mesh().triangles.len());
    let by_leaf = run.install(|| {
        let of_leaf = |leaf| near.nodes.of_leaf(leaf).map_or(0, |of| directions.of_all(of.known()));
        signs.leaves().collect::<Vec<_>>().into_par_iter().with_min_len(64).map(of_leaf).collect()
    });
    let search = Search { distance, r, lattice, signs, near, directions, by_leaf };
    let leaves: Vec<LeafId> = signs.leaves().filter(|&leaf| slab.owns(signs.origin(leaf))).collect();
    let all: Vec<Vec<MissedCandidate>> = run.install(|| {
        leaves
            .par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|&leaf| {
                run.check()?;
                Ok(search.leaf(leaf))
            })
            .collect::<Result<_, Cancelled>>()
    })?;
    Ok(MissedCandidates { all: all.into_iter().flatten().collect(), lattice: Some(lattice) })
}

/// Number of corners of a leaf's cells along one axis.
const CORNERS_PER_AXIS: usize = LEAF_DIM as usize + 1;

/// The number of corners of a leaf's cells.
const CORNER_COUNT: usize = CORNERS_PER_AXIS * CORNERS_PER_AXIS * CORNERS_PER_AXIS;

struct Search<'a> {
    distance: &'a SignedDistance<'a>,
    r: f64,
    lattice: Lattice,
    signs: &'a SignField,
    near: &'a NearTriangles,
    directions: DirectionTable,
    /// The directions of all closest triangles of each leaf's nodes.
    by_leaf: Vec<Directions>,
}

/// A corner of a cell whose distance is known.
#[derive(Clone, Copy)]
struct Corner {
    p: DVec3,
    /// Distance from the surface, in model units: positive on the side that the nodes are on.
    height: f64,
    gradient: DVec3,
    triangle: u32,
}

impl Search<'_> {
    fn leaf(&self, leaf: LeafId) -> Vec<MissedCandidate> {
        let mut found = Vec::new();
        let around: [Option<LeafId>; 8] = std::array::from_fn(|n| {
            self.signs.neighbour(leaf, [n >> 2 & 1, n >> 1 & 1, n & 1].map(|d| d as i32))
        });
        // Most leaves are done with by what all of them and of the next ones have.
        let all = around.iter().flatten().fold(0, |all, id| all | self.by_leaf[id.0 as usize]);
        if !self.directions.disagree(all) {
            return found;
        }
        let (triangles, sets) = self.corners(around);
        let sets = around_cells(sets);
        let (mut last, mut disagrees) = (0, false);
        for number in 0..LEAF_SIZE {
            let [x, y, z] = [number >> 6, number >> 3 & 7, number & 7];
            let first = (x * CORNERS_PER_AXIS + y) * CORNERS_PER_AXIS + z;
            if sets[first] != last {
                last = sets[first];
                disagrees = self.directions.disagree(last);
            }
            if disagrees {
                let corners = std::array::from_fn(|corner| triangles[first + CORNERS[corner]]);
                self.cell(leaf, number, corners, &mut found);
            }
        }
        found
    }

    /// Returns the closest triangles of the corners of a leaf's cells, -1 where none is known, and
    /// the directions of these triangles. `around` is the leaf and the next ones, z fastest.
    fn corners(&self, around: [Option<LeafId>; 8]) -> ([i32; CORNER_COUNT], [Directions; CORNER_COUNT]) {
        let ids = around.map(|leaf| self.near.nodes.of_leaf(leaf?));
        // All of the leaf itself, and of the next ones the first layers only.
        let all = ids[0].map(|ids| ids.by_node());
        let one = |leaf: usize, number| ids[leaf].and_then(|ids| ids.get(number)).map_or(-1, |id| id as i32);
        let (mut triangles, mut sets) = ([-1; CORNER_COUNT], [0; CORNER_COUNT]);
        for (row, triangles) in triangles.chunks_exact_mut(CORNERS_PER_AXIS).enumerate() {
            let [x, y] = [row / CORNERS_PER_AXIS, row % CORNERS_PER_AXIS];
            let number = (x & 7) << 6 | (y & 7) << 3;
            let leaf = x >> 3 << 2 | y >> 3 << 1;
            let (first, last) = triangles.split_at_mut(CORNERS_PER_AXIS - 1);
            match &all {
                Some(all) if leaf == 0 => first.copy_from_slice(&all[number..number + CORNERS_PER_AXIS - 1]),
                _ => (0..).zip(first).for_each(|(z, triangle)| *triangle = one(leaf, number + z)),
            }
            last[0] = one(leaf | 1, number);
        }
        for (set, &triangle) in sets.iter_mut().zip(&triangles) {
            if triangle >= 0 {
                *set = self.directions.of(triangle as u32);
            }
        }
        (triangles, sets)
    }

    /// Searches the three edges that start at a cell's lowest node. Searches the cell itself if its
    /// corners have one sign.
    fn cell(&self, leaf: LeafId, number: usize, triangles: [i32; 8], found: &mut Vec<MissedCandidate>) {
        let local = Ijk::in_leaf(Ijk::default(), number);
        let cell = self.signs.origin(leaf) + local;
        let is_inside = |corner: usize| {
            let offset = Ijk([corner >> 2, corner >> 1 & 1, corner & 1].map(|x| x as i32));
            let (leaf, number) = self.signs.locate(leaf, (local + offset).0)?;
            Some(self.signs.inside(leaf)[number >> 6] >> (number & 63) & 1 == 1)
        };
        let inside: [Option<bool>; 8] = std::array::from_fn(is_inside);
        let corners: [Option<Corner>; 8] = std::array::from_fn(|n| {
            let triangle = u32::try_from(triangles[n]).ok()?;
            let offset = Ijk([n >> 2, n >> 1 & 1, n & 1].map(|x| x as i32));
            let p = DVec3::from(self.lattice.world_from_index(cell + offset));
            let sample = self.distance.from_triangle(p, triangle);
            Some(self.corner(p, &sample, if inside[n]? { Missed::Void } else { Missed::Solid }))
        });
        for (axis, other) in [(Axis::X, 4), (Axis::Y, 2), (Axis::Z, 1)] {
            let (Some(a), Some(b)) = (corners[0], corners[other]) else { continue };
            if inside[0] != inside[other] {
                continue;
            }
            let missed = if inside[0] == Some(true) { Missed::Void } else { Missed::Solid };
            if let Some((at, depth)) = self.edge(a, b, axis, missed) {
                found.push(MissedCandidate { cell, at, missed, found: Found::OnEdge, depth });
            }
        }
        let known = corners.iter().flatten().count();
        let missed =
            match inside[0] {
                Some(side) if known >= MIN_KNOWN && inside.iter().all(|other| *other == Some(side)) => {
                    if side { Missed::Void } else { Missed::Solid }
                }
                _ => return,
            };
        if let Some((at, depth)) = self.inside_cell(cell, &corners, missed) {
            found.push(MissedCandidate { cell, at, missed, found: Found::InCell, depth });
        }
    }

    fn corner(&self, p: DVec3, sample: &Sample, missed: Missed) -> Corner {
        let phi = sample.distance - self.r;
        let gradient = self.distance.gradient(p, sample, 1e-4 * self.lattice.voxel);
        let sign = match missed {
            Missed::Solid => 1.0,
            Missed::Void => -1.0,
        };
        Corner { p, height: sign * phi, gradient: sign * gradient, triangle: sample.triangle }
    }

    fn sample(&self, p: DVec3, guess: u32, missed: Missed) -> Corner {
        let near = self.near.lists.as_ref().and_then(|lists: &CandidateLists| lists.at(p.to_array()));
        let sample = match near {
            Some(near) => self.distance.from_triangle(p, near.closest(self.distance.ssvh(), p).triangle),
            None => self.distance.at(p, guess),
        };
        self.corner(p, &sample, missed)
    }

    /// Finds a point of an edge with the other sign than its ends. Returns the point and its depth.
    fn edge(&self, mut a: Corner, mut b: Corner, axis: Axis, missed: Missed) -> Option<(DVec3, f64)> {
        let along = axis as usize;
        for _ in 0..MAX_QUERIES_ON_EDGE {
            let length = b.p[along] - a.p[along];
            // The distance changes by no more than the way.
            if a.height + b.height >= length {
                return None;
            }
            let (fall, rise) = (a.gradient[along], b.gradient[along]);
            // It must fall from both ends.
            if fall >= 0.0 || rise <= 0.0 {
                return None;
            }
            // Where the tangents meet.
            let x =
                ((b.height - a.height - rise * length) / (fall - rise)).clamp(0.02 * length, 0.98 * length);
            let mut p = a.p;
            p[along] += x;
            let middle = self.sample(p, a.triangle, missed);
            if middle.height < 0.0 {
                return self.deep(middle);
            }
            if middle.gradient[along] < 0.0 {
                a = middle;
            } else {
                b = middle;
            }
        }
        None
    }

    /// Finds a point in a cell with the other sign than its corners. Returns the point and its
    /// depth.
    fn inside_cell(&self, cell: Ijk, corners: &[Option<Corner>; 8], missed: Missed) -> Option<(DVec3, f64)> {
        let voxel = self.lattice.voxel;
        let lo = DVec3::from(self.lattice.world_from_index(cell));
        let hi = lo + voxel;
        // All known corners must look down towards the middle, or there is nothing between them.
        let centre = lo + 0.5 * voxel;
        let falls = |c: &Corner| c.gradient.dot(centre - c.p) < 0.0;
        if !corners.iter().flatten().all(falls) {
            return None;
        }
        let mut p = centre;
        let mut triangle = corners.iter().flatten().next()?.triangle;
        for _ in 0..MAX_QUERIES_IN_CELL {
            let here = self.sample(p, triangle, missed);
            if here.height < 0.0 {
                return self.deep(here);
            }
            // Nothing in the cell is farther away.
            if here.height >= 3f64.sqrt() * voxel {
                return None;
            }
            triangle = here.triangle;
            // Down, and a little further.
            let next = (p - here.gradient * (here.height + 0.02 * voxel)).clamp(lo, hi);
            if (next - p).length() < 1e-3 * voxel {
                return None;
            }
            p = next;
        }
        None
    }

    fn deep(&self, corner: Corner) -> Option<(DVec3, f64)> {
        let depth = -corner.height / self.lattice.voxel;
        (depth > NEGLIGIBLE_DEPTH).then_some((corner.p, depth))
    }
}

/// Unites the directions at all corners of each cell, by the cell's lowest node.
///
/// `sets` holds the directions at nodes. The axes follow one another. The last nodes along an axis
/// have no cell; what is returned for them means nothing.
fn around_cells(mut sets: [Directions; CORNER_COUNT]) -> [Directions; CORNER_COUNT] {
    for step in [1, CORNERS_PER_AXIS, CORNERS_PER_AXIS * CORNERS_PER_AXIS] {
        for n in 0..CORNER_COUNT - step {
            sets[n] |= sets[n + step];
        }
    }
    sets
}

/// The corners of a cell in the array of a leaf's nodes, z fastest.
const CORNERS: [usize; 8] = {
    let mut corners = [0; 8];
    let mut n = 0;
    while n < 8 {
        corners[n] = ((n >> 2) * CORNERS_PER_AXIS + (n >> 1 & 1)) * CORNERS_PER_AXIS + (n & 1);
        n += 1;
    }
    corners
};
