//! Removal of triangles without area, so that a closed surface stays closed.
//!
//! ```text
//!        r                    r
//!      / | \                / | \
//!     /  |  \              /  |  \
//!    p-------q    ->      p---m---q
//!     `--m--'
//! ```
//!
//! The corners of the triangle p m q lie on a line. Dropped alone, it would leave p m and m q
//! without the long side p q of its neighbour p q r. Below p m and m q are their neighbours, before
//! and after.
//!
//! The triangle across its longest edge gets the middle corner instead: p q r becomes p m r and m q
//! r. Their sum has exactly the edges of the two triangles before, so what was closed stays closed,
//! whatever else meets there. The neighbour may be without area itself; then its halves are taken
//! out in turn. The longest edges come first: what follows is shorter, so this ends. At a border
//! there is no neighbour, and the triangle is dropped: the border runs along its short edges then,
//! through the same points.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet};

use rayon::prelude::*;

use crate::geom::predicates::projection_axis;

/// Returns the numbers of the triangles without area: two corners are the same vertex, or all lie
/// exactly on a line.
pub(super) fn degenerate(triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<u32> {
    (0..triangles.len() as u32)
        .into_par_iter()
        .filter(|&t| is_degenerate(triangles[t as usize], vertices))
        .collect()
}

/// Whether the neighbours of one of the degenerate triangles would miss it: its corners lie on a
/// line.
pub(super) fn has_lines(degenerate: &[u32], triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> bool {
    degenerate.iter().any(|&t| longest_edge(triangles[t as usize], vertices).is_some())
}

/// Takes out the triangles with the numbers `degenerate`, which are all that have no area. What
/// remains keeps its order. Returns how many triangles with an area were split.
pub(super) fn take_out(degenerate: &[u32], triangles: &mut Vec<[u32; 3]>, vertices: &[[f64; 3]]) -> usize {
    let mut fragments = Fragments::new(degenerate, triangles, vertices);
    fragments.straighten();
    let Fragments { touched, mut all, split, .. } = fragments;
    all.retain(|fragment| fragment.is_there);
    // Those of a triangle stay in the order in which they were made.
    all.sort_by_key(|fragment| fragment.origin);
    let mut kept = Vec::with_capacity(triangles.len());
    let (mut all, mut touched) = (all.into_iter().peekable(), touched.into_iter().peekable());
    let mut gone = degenerate.iter().copied().peekable();
    for (t, triangle) in (0..).zip(triangles.iter()) {
        let is_gone = gone.next_if_eq(&t).is_some();
        if touched.next_if_eq(&t).is_some() {
            while let Some(fragment) = all.next_if(|fragment| fragment.origin == t) {
                kept.push(fragment.corners);
            }
        } else if !is_gone {
            kept.push(*triangle);
        }
    }
    *triangles = kept;
    split.len()
}

/// Whether a triangle has exactly no area.
fn is_degenerate(t: [u32; 3], vertices: &[[f64; 3]]) -> bool {
    has_equal(t) || projection_axis(t.map(|v| vertices[v as usize])).is_none()
}

fn has_equal([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Returns the longest edge of a triangle whose corners lie on a line, as the number of the corner
/// where it begins, and its length along the axis where the line is longest. `None` where no corner
/// is strictly between the others.
fn longest_edge(t: [u32; 3], vertices: &[[f64; 3]]) -> Option<(usize, f64)> {
    if has_equal(t) {
        return None;
    }
    let corners = t.map(|v| vertices[v as usize]);
    let along = |axis: usize| corners.map(|corner| corner[axis]);
    let size = |axis: usize| {
        let [a, b, c] = along(axis);
        a.max(b).max(c) - a.min(b).min(c)
    };
    let axis = (1..3).fold(0, |best, axis| if size(axis) > size(best) { axis } else { best });
    let x = along(axis);
    let is_between = |k: usize| {
        let [a, m, b] = [x[k], x[(k + 2) % 3], x[(k + 1) % 3]];
        a < m && m < b || b < m && m < a
    };
    (0..3).find(|&k| is_between(k)).map(|k| (k, size(axis)))
}

/// A triangle, or a part of one.
struct Fragment {
    corners: [u32; 3],
    /// The number of the triangle that it is, or is a part of.
    origin: u32,
    is_there: bool,
}

/// The triangles without area and those at their edges, with what becomes of them.
struct Fragments<'a> {
    vertices: &'a [[f64; 3]],
    /// The numbers of the triangles that these were in the beginning, ascending.
    touched: Vec<u32>,
    all: Vec<Fragment>,
    /// The fragments that run along an edge in its direction; some may be gone.
    by_edge: HashMap<[u32; 2], Vec<u32>>,
    /// Fragments without area, the longest first, then in the order of their numbers.
    waiting: BinaryHeap<(Length, Reverse<u32>)>,
    /// The triangles that were split.
    split: HashSet<u32>,
}

/// A finite length with an order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Length(f64);

impl Eq for Length {}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl<'a> Fragments<'a> {
    /// Returns the triangles with the numbers `degenerate` and those at their edges.
    fn new(degenerate: &[u32], triangles: &[[u32; 3]], vertices: &'a [[f64; 3]]) -> Self {
        let mut is_near = vec![false; vertices.len()];
        let mut edges = HashSet::new();
        for &t in degenerate {
            let t = triangles[t as usize];
            if longest_edge(t, vertices).is_some() {
                t.iter().for_each(|&v| is_near[v as usize] = true);
                edges.extend(sides(t).map(undirected));
            }
        }
        let touches = |t: [u32; 3]| {
            !has_equal(t)
                && t.iter().filter(|&&v| is_near[v as usize]).count() > 1
                && sides(t).into_iter().any(|side| edges.contains(&undirected(side)))
        };
        let numbers = 0..triangles.len() as u32;
        let touched: Vec<u32> = numbers.into_par_iter().filter(|&t| touches(triangles[t as usize])).collect();
        let mut fragments = Fragments {
            vertices,
            touched: Vec::new(),
            all: Vec::new(),
            by_edge: HashMap::new(),
            waiting: BinaryHeap::new(),
            split: HashSet::new(),
        };
        touched.iter().for_each(|&t| fragments.add(triangles[t as usize], t));
        Fragments { touched, ..fragments }
    }

    fn add(&mut self, corners: [u32; 3], origin: u32) {
        let number = self.all.len() as u32;
        if is_degenerate(corners, self.vertices) {
            // One that is no line in truth, but too small for the test, goes as it is.
            let length = longest_edge(corners, self.vertices).map_or(0.0, |(_, length)| length);
            self.waiting.push((Length(length), Reverse(number)));
        }
        sides(corners).into_iter().for_each(|side| self.by_edge.entry(side).or_default().push(number));
        self.all.push(Fragment { corners, origin, is_there: true });
    }

    /// Takes out all fragments without area.
    fn straighten(&mut self) {
        /// Steps for each fragment without area in the beginning. Chains of them take one or two
        /// each; only what was made to, or is too small for the test on the line, takes more.
        const STEPS: usize = 32;
        let mut steps = STEPS * self.waiting.len();
        while let Some((_, Reverse(number))) = self.waiting.pop() {
            let fragment = &mut self.all[number as usize];
            if !std::mem::replace(&mut fragment.is_there, false) || steps == 0 {
                continue;
            }
            steps -= 1;
            let corners = fragment.corners;
            if let Some((k, _)) = longest_edge(corners, self.vertices) {
                let [from, to, middle] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
                // Of neighbours that run the same way one is better than none.
                let across = self.along([to, from]).or_else(|| self.along([from, to]));
                if let Some(across) = across {
                    self.halve(across, [from, to], middle);
                }
            }
        }
    }

    /// Returns the first fragment that runs along an edge in its direction.
    fn along(&self, edge: [u32; 2]) -> Option<u32> {
        let fragments = self.by_edge.get(&edge)?;
        fragments.iter().copied().find(|&number| self.all[number as usize].is_there)
    }

    /// Splits a fragment at the vertex `middle`, which lies on its edge between `ends`.
    fn halve(&mut self, number: u32, ends: [u32; 2], middle: u32) {
        let fragment = &mut self.all[number as usize];
        fragment.is_there = false;
        let (corners, origin) = (fragment.corners, fragment.origin);
        if !is_degenerate(corners, self.vertices) {
            self.split.insert(origin);
        }
        for (k, replaced) in corners.into_iter().enumerate() {
            let mut half = corners;
            half[k] = middle;
            // The other side of the very triangle that goes has its corners.
            if ends.contains(&replaced) && !has_equal(half) {
                self.add(half, origin);
            }
        }
    }
}

/// Returns the edges of a triangle, as it runs along them.
fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn undirected([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests;
