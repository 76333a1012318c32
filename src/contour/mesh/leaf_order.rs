//! The finished mesh in the order of its leaves: a part of the lattice is one range of it.
//!
//! During construction a mesh has its vertices by kind, with added ones at the end. That order
//! depends on the whole lattice. In the order of leaves, the vertices and triangles of consecutive
//! leaves stand together, wherever the rest is made.

use super::compact::{push_range, shift_ranges, split_slices};
use super::leaf_mesh::{LeafMesh, VertexRun};
use crate::band::LeafId;
use crate::mesh::TriMesh;
use crate::run::SHARE;
use rayon::prelude::*;
use std::ops::Range;

/// A mesh in the order of its leaves.
#[derive(Debug)]
pub struct OrderedMesh {
    /// The mesh, with vertices and triangles by leaf, within a leaf in the order of their making.
    pub mesh: TriMesh,
    /// The number of the first vertex of each leaf, and the number of all at the end.
    vertices: Vec<usize>,
    /// The number of the first triangle of each leaf, and the number of all at the end.
    pub triangles: Vec<usize>,
}

impl OrderedMesh {
    /// Returns the ranges of the vertices and of the triangles of consecutive leaves.
    pub fn of_leaves(&self, leaves: Range<usize>) -> (Range<usize>, Range<usize>) {
        let of = |firsts: &[usize]| firsts[leaves.start]..firsts[leaves.end];
        (of(&self.vertices), of(&self.triangles))
    }
}

impl LeafMesh {
    /// Orders the mesh by leaves, without removed vertices and triangles.
    pub fn into_ordered(mut self) -> OrderedMesh {
        self.removed.sort_unstable();
        let leaves = self.firsts.len() - 1;
        // Runs follow each other in the order in which their vertices were made.
        let removed_in = |run: &VertexRun| {
            let below = |v: u32| self.removed.partition_point(|&r| r < v);
            &self.removed[below(run.numbers.start)..below(run.numbers.end)]
        };
        let left = |run: &VertexRun| run.numbers.len() - removed_in(run).len();
        // The sort is stable: cell vertices, face vertices, edge vertices, then added vertices.
        let mut by_leaf: Vec<usize> = (0..self.runs.len()).collect();
        by_leaf.sort_by_key(|&n| self.runs[n].leaf);
        let mut starts = vec![0; self.runs.len()];
        let mut firsts = Vec::with_capacity(leaves + 1);
        let mut next = 0;
        for &n in &by_leaf {
            firsts.resize(firsts.len().max(self.runs[n].leaf.0 as usize + 1), next);
            starts[n] = next;
            next += left(&self.runs[n]);
        }
        firsts.resize(leaves + 1, next);
        let mut numbers = vec![0; self.mesh.vertices.len()];
        let parts = split_slices(&mut numbers, self.runs.iter().map(|run| run.numbers.len()));
        parts.into_par_iter().zip(&self.runs).zip(&starts).with_min_len(16).with_max_len(SHARE).for_each(
            |((part, run), &start)| {
                let mut removed = removed_in(run).iter().peekable();
                let mut next = start as u32;
                for (number, old) in part.iter_mut().zip(run.numbers.clone()) {
                    if removed.next_if_eq(&&old).is_none() {
                        *number = next;
                        next += 1;
                    }
                }
            },
        );
        let vertices = std::mem::take(&mut self.mesh.vertices);
        let vertices = in_order(vertices, next, &self.runs, &starts, removed_in);

        let of_leaf = |leaf: usize| self.triangles(LeafId(leaf as u32));
        let counts: Vec<usize> = (0..leaves as u32).map(|leaf| self.count(LeafId(leaf))).collect();
        let mut ends = vec![0; leaves + 1];
        for (leaf, count) in counts.iter().enumerate() {
            debug_assert_eq!(*count, of_leaf(leaf).count(), "a triangle was missed");
            ends[leaf + 1] = ends[leaf] + count;
        }
        let mut triangles = vec![[0; 3]; ends[leaves]];
        let parts = split_slices(&mut triangles, counts.into_iter());
        parts.into_par_iter().enumerate().with_min_len(16).with_max_len(SHARE).for_each(|(leaf, part)| {
            for (to, number) in part.iter_mut().zip(of_leaf(leaf)) {
                *to = self.mesh.triangles[number].map(|v| numbers[v as usize]);
            }
        });
        OrderedMesh { mesh: TriMesh { vertices, triangles }, vertices: firsts, triangles: ends }
    }
}

/// Returns the `count` vertices of `runs` that are left, by leaf.
///
/// `starts` has the new number of the first vertex of each run, `removed_in` the removed vertices
/// of a run.
fn in_order<'a>(
    mut vertices: Vec<[f64; 3]>,
    count: usize,
    runs: &[VertexRun],
    starts: &[usize],
    removed_in: impl Fn(&VertexRun) -> &'a [u32],
) -> Vec<[f64; 3]> {
    // The first runs, one for each leaf with cells, have nearly all vertices, and stay in order.
    // They are shifted where they are, in one range as far as the shift is the same, and the others
    // put between them.
    let ascending = runs.windows(2).take_while(|pair| pair[0].leaf < pair[1].leaf).count() + 1;
    let (first_runs, others) = runs.split_at(ascending.min(runs.len()));
    let ranges = |run: &VertexRun| {
        let ends = removed_in(run).iter().copied().chain([run.numbers.end]);
        let mut from = run.numbers.start;
        ends.map(move |end| std::mem::replace(&mut from, end + 1)..end)
    };
    let mut moves: Vec<(Range<usize>, usize)> = Vec::new();
    for (run, &start) in first_runs.iter().zip(starts) {
        let mut to = start;
        for range in ranges(run).map(|range| range.start as usize..range.end as usize) {
            push_range(&mut moves, range.clone(), to);
            to += range.len();
        }
    }
    let first_of_others = others.first().map_or(vertices.len(), |run| run.numbers.start as usize);
    let rest = vertices.split_off(first_of_others);
    vertices.resize(count.max(first_of_others), [0.0; 3]);
    shift_ranges(&mut vertices, &moves);
    for (run, &start) in others.iter().zip(&starts[first_runs.len()..]) {
        let there = ranges(run).flatten().map(|v| rest[v as usize - first_of_others]);
        for (to, vertex) in vertices[start..].iter_mut().zip(there) {
            *to = vertex;
        }
    }
    vertices.truncate(count);
    vertices
}
