//! A tree of axis-aligned boxes over triangles, in the order of a space-filling curve.
//!
//! The tree finds pairs of triangles that are near each other and triangles near a point. Its order
//! puts neighbours in space next to each other.
//!
//! The swept sphere volumes of `ssvh` fit tighter but take ten times as long to build. Touching
//! triangles need closed boxes without slack.

use super::aabb::boxes_meet;
use crate::geom::aabb::Aabb;
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;

/// Number of triangles in a leaf. Fewer: more nodes to visit; more: more pairs that are compared in
/// vain.
const TRIANGLES_PER_LEAF: usize = 8;

/// Number of children of a node.
const WIDTH: usize = 8;

/// Number of leaves in a task. Each task looks at the cancel token once.
const LEAVES_PER_TASK: usize = 256;

/// A closed box in f32, rounded outward.
#[derive(Clone, Copy, Debug)]
struct Box32 {
    lo: [f32; 3],
    hi: [f32; 3],
}

impl Box32 {
    const EMPTY: Box32 = Box32 { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    fn around(points: impl IntoIterator<Item = [f64; 3]>) -> Box32 {
        points.into_iter().fold(Box32::EMPTY, |b, p| Box32 {
            lo: std::array::from_fn(|a| b.lo[a].min(below(p[a]))),
            hi: std::array::from_fn(|a| b.hi[a].max(above(p[a]))),
        })
    }

    /// Returns the box around both boxes.
    fn with(self, other: Box32) -> Box32 {
        Box32 {
            lo: std::array::from_fn(|a| self.lo[a].min(other.lo[a])),
            hi: std::array::from_fn(|a| self.hi[a].max(other.hi[a])),
        }
    }

    /// Whether the boxes have a point in common.
    #[inline(always)]
    fn meets(&self, other: &Box32) -> bool {
        boxes_meet([&self.lo, &self.hi], [&other.lo, &other.hi])
    }
}

/// Returns the largest f32 that is not above `x`.
fn below(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

/// Returns the smallest f32 that is not below `x`.
fn above(x: f64) -> f32 {
    -below(-x)
}

/// Tree of boxes over some triangles of a mesh.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// Triangle numbers in the order of the curve.
    order: Vec<u32>,
    /// Boxes of the triangles, parallel to `order`.
    boxes: Vec<Box32>,
    /// Levels of boxes from the leaves up to the root. Box i of a level is around the boxes 8 i to
    /// 8 i + 7 of the level below. The lowest level is around `boxes`.
    levels: Vec<Vec<Box32>>,
}

impl BoxTree {
    /// Builds the tree over the triangles numbered `chosen` of a mesh with `vertices` and
    /// `triangles`. Runs on the current rayon pool.
    pub fn new(
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
        chosen: impl IndexedParallelIterator<Item = u32>,
    ) -> Self {
        let corners = |t: u32| triangles[t as usize].map(|v| vertices[v as usize]);
        let bounds = Aabb::around(vertices.iter().map(|&v| DVec3::from(v)));
        // 21 bits per axis fill the 63 bits of a key.
        let scale = f64::from(1 << 21) / bounds.size().max_element().max(f64::MIN_POSITIVE);
        let mut keyed: Vec<(u64, u32)> = chosen
            .map(|t| {
                let [a, b, c] = corners(t).map(DVec3::from);
                let cell = ((a + b + c) / 3.0 - bounds.lo) * scale;
                (cell.to_array().iter().fold(0, |key, &x| key << 1 | spread(x as u64)), t)
            })
            .collect();
        keyed.par_sort_unstable();
        let order: Vec<u32> = keyed.par_iter().map(|&(_, t)| t).collect();
        let boxes: Vec<Box32> = order.par_iter().map(|&t| Box32::around(corners(t))).collect();
        let mut levels = vec![enclosing(&boxes, TRIANGLES_PER_LEAF)];
        while levels[levels.len() - 1].len() > 1 {
            levels.push(enclosing(&levels[levels.len() - 1], WIDTH));
        }
        BoxTree { order, boxes, levels }
    }

    /// Triangle numbers in the order of the curve: neighbours in space are near each other.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit` with each triangle whose box meets the cube of half-width `margin` around `p`.
    pub fn near(&self, p: DVec3, margin: f64, visit: impl FnMut(u32)) {
        self.meeting([p - margin, p + margin], visit);
    }

    /// Calls `visit` with each triangle whose box meets the box with these corners, the lower
    /// corner first.
    pub fn meeting(&self, corners: [DVec3; 2], mut visit: impl FnMut(u32)) {
        let query = Box32::around(corners.map(|c| c.to_array()));
        self.leaves(&query, 0, &mut Vec::new(), |leaf| {
            for position in self.leaf(leaf) {
                if self.boxes[position].meets(&query) {
                    visit(self.order[position]);
                }
            }
        });
    }

    /// Extends the box at a position of [`order`](Self::order) by the box with these corners.
    pub fn grow(&mut self, position: usize, corners: [DVec3; 2]) {
        let more = Box32::around(corners.map(|c| c.to_array()));
        self.boxes[position] = self.boxes[position].with(more);
        let mut number = position / TRIANGLES_PER_LEAF;
        for level in &mut self.levels {
            level[number] = level[number].with(more);
            number /= WIDTH;
        }
    }

    /// Finds all pairs of triangles whose boxes meet.
    ///
    /// Each task has a result of its own: `start` makes it, `visit` changes it. The results come in
    /// the order of the curve.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn pairs<T: Send>(
        &self,
        run: &RunSettings,
        start: impl Fn() -> T + Sync,
        visit: impl Fn(&mut T, u32, u32) + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let leaves = self.levels[0].len();
        (0..leaves.div_ceil(LEAVES_PER_TASK))
            .into_par_iter()
            .map(|task| {
                run.check()?;
                let (mut result, mut stack) = (start(), Vec::new());
                let first = task * LEAVES_PER_TASK;
                for leaf in first..(first + LEAVES_PER_TASK).min(leaves) {
                    self.leaves(&self.levels[0][leaf], leaf, &mut stack, |other| {
                        self.pairs_of_leaves(leaf, other, |a, b| visit(&mut result, a, b));
                    });
                }
                Ok(result)
            })
            .collect()
    }

    /// Calls `visit` with the pairs between two leaves, the lower triangle number first.
    fn pairs_of_leaves(&self, leaf: usize, other: usize, mut visit: impl FnMut(u32, u32)) {
        for j in self.leaf(other) {
            let second = &self.boxes[j];
            if !self.levels[0][leaf].meets(second) {
                continue;
            }
            let range = self.leaf(leaf);
            for i in range.start..range.end.min(j) {
                if self.boxes[i].meets(second) {
                    let (a, b) = (self.order[i], self.order[j]);
                    visit(a.min(b), a.max(b));
                }
            }
        }
    }

    /// Returns the positions of a leaf's triangles.
    fn leaf(&self, leaf: usize) -> std::ops::Range<usize> {
        leaf * TRIANGLES_PER_LEAF..((leaf + 1) * TRIANGLES_PER_LEAF).min(self.order.len())
    }

    /// Calls `visit` with each leaf from `first` on whose box meets `query`. `stack` is scratch
    /// space.
    fn leaves(
        &self,
        query: &Box32,
        first: usize,
        stack: &mut Vec<(usize, usize)>,
        mut visit: impl FnMut(usize),
    ) {
        stack.clear();
        stack.push((self.levels.len() - 1, 0));
        while let Some((level, node)) = stack.pop() {
            if level == 0 {
                visit(node);
                continue;
            }
            let below = &self.levels[level - 1];
            // Leaves under a node of the level below.
            let leaves = WIDTH.pow(level as u32 - 1);
            let first_child = node * WIDTH;
            let children = &below[first_child..(first_child + WIDTH).min(below.len())];
            for (child, child_box) in (first_child..).zip(children) {
                if (child + 1) * leaves > first && child_box.meets(query) {
                    stack.push((level - 1, child));
                }
            }
        }
    }
}

/// Returns the boxes around each `width` boxes.
fn enclosing(boxes: &[Box32], width: usize) -> Vec<Box32> {
    boxes.par_chunks(width).map(|c| c.iter().fold(Box32::EMPTY, |all, &b| all.with(b))).collect()
}

/// Spreads the 21 low bits of `x`, with two zeros between neighbours.
fn spread(x: u64) -> u64 {
    let x = x.min((1 << 21) - 1);
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
