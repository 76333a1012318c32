//! The strip of triangles between a boundary loop of S and the rim of the section below it.
//!
//! ```text
//!   b0 ------- b1 ------------ b2     boundary of S
//!    | \      / | \  ...        |
//!    |   \  /   |   \           |
//!   l0 -- l1 -- l2 -- l3 - ... -lm    rim
//! ```
//!
//! A *cross edge* (i, j) joins boundary vertex i to rim vertex j. A strip is a path of cross edges
//! from (0, 0) to (n, m), a step along the boundary or the rim at a time. Dynamic programming finds
//! the cheapest path (the minimal-area triangulation of Barequet and Sharir, \[WC13\] section 4.2,
//! for two polygons), without the triangles that are known to meet something.

use glam::DVec3;
use std::collections::BTreeSet;

/// A step of a path: a triangle of the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Step {
    /// From cross edge (i, j) to (i + 1, j): the triangle of the boundary's edge i and rim vertex
    /// j.
    Boundary(u32, u32),
    /// From cross edge (i, j) to (i, j + 1): the triangle of the rim's edge j and boundary vertex
    /// i.
    Rim(u32, u32),
}

/// A closed polygon at a long edge of a strip. Its first vertex occurs once more at its end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polyline {
    /// Vertex numbers.
    pub vertices: Vec<u32>,
    /// Positions of the vertices.
    pub points: Vec<DVec3>,
    /// Arc length along the boundary at each vertex, in model units. For a vertex of the rim, it is
    /// the one at the closest point of the boundary.
    pub arc_lengths: Vec<f64>,
}

/// A strip that is to be triangulated.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    /// The boundary loop, in the direction of the triangles of S.
    pub boundary: Polyline,
    /// The rim in the same direction, against that of the section's triangles.
    pub rim: Polyline,
    /// Maximum distance along the boundary, in model units, that a cross edge may span beyond the
    /// adjacent vertices.
    pub max_slide: f64,
    /// Steps that must not be taken.
    pub forbidden: BTreeSet<Step>,
}

/// The cheapest path to a cross edge.
#[derive(Clone, Copy, Debug)]
struct PathState {
    cost: f64,
    /// The last step, and the flags of [`BOTH_TURNS`] before it; `None` at the start.
    last: Option<(Step, usize)>,
}

/// Weight of a cross edge's squared length against a triangle's area. On a flat wall all strips
/// have the same area, and the one with the shortest cross edges has the best triangles. Much more,
/// and the strip would not follow the wall's bends.
const CROSS_EDGE_WEIGHT: f64 = 0.2;

/// Weight of a fold against the area of the triangles at it: more than any detour.
const FOLD_WEIGHT: f64 = 30.0;

/// Flags that a path must have at its end, a bit each: a step along the boundary at another vertex
/// of the rim than its first one, and a step along the rim at another vertex of the boundary.
///
/// A path without one of them has all steps along the rim at a single vertex of the boundary, or
/// the other way round. Such a path comes to its first cross edge there once more at the end: four
/// triangles at one edge.
const BOTH_TURNS: usize = 0b11;

impl Strip {
    /// Finds the cheapest path that takes no cross edge twice; `None` when there is none.
    pub fn cheapest(&self) -> Option<Vec<Step>> {
        let path = self.cheapest_path()?;
        let done = path.iter().fold(0, |done, &step| done | self.turns(step));
        if done == BOTH_TURNS { Some(path) } else { self.cheapest_turning() }
    }

    /// Returns the flags of [`BOTH_TURNS`] that a step sets.
    fn turns(&self, step: Step) -> usize {
        let is_inner = |line: &Polyline, k: u32| (1..line.points.len() - 1).contains(&(k as usize));
        match step {
            Step::Boundary(_, j) => usize::from(is_inner(&self.rim, j)),
            Step::Rim(i, _) => usize::from(is_inner(&self.boundary, i)) << 1,
        }
    }

    /// Finds the cheapest path among those with both turns.
    ///
    /// This takes four times as long, and is seldom needed: where the boundary is small beside the
    /// edges of the rim, or the rim beside the edges of the boundary.
    fn cheapest_turning(&self) -> Option<Vec<Step>> {
        let (n, m) = (self.boundary.points.len() as u32, self.rim.points.len() as u32);
        let rows = self.rows();
        // Per cross edge and flags: the least cost, the last step, and the flags before it.
        let mut best: Vec<Vec<[Option<PathState>; BOTH_TURNS + 1]>> = Vec::with_capacity(rows.len());
        for (i, &[low, high]) in (0..n).zip(&rows) {
            best.push(vec![[None; BOTH_TURNS + 1]; high + 1 - low]);
            for j in low as u32..=high as u32 {
                let along = i.checked_sub(1).map(|i| (i, j, Step::Boundary(i, j)));
                let across = j.checked_sub(1).map(|j| (i, j, Step::Rim(i, j)));
                let mut states = [None; BOTH_TURNS + 1];
                if (i, j) == (0, 0) {
                    states[0] = Some(PathState { cost: 0.0, last: None });
                }
                for (i, j, step) in along.into_iter().chain(across) {
                    let column = (j as usize).checked_sub(rows[i as usize][0]);
                    let Some(before) = column.and_then(|j| best[i as usize].get(j)).copied() else {
                        continue;
                    };
                    let cost = self.cost(step);
                    for (done, state) in before.into_iter().enumerate() {
                        let Some(state) = state.filter(|state| (state.cost + cost).is_finite()) else {
                            continue;
                        };
                        let to: &mut Option<PathState> = &mut states[done | self.turns(step)];
                        if to.is_none_or(|other| state.cost + cost < other.cost) {
                            *to = Some(PathState { cost: state.cost + cost, last: Some((step, done)) });
                        }
                    }
                }
                best[i as usize][j as usize - low] = states;
            }
        }
        let mut steps = Vec::with_capacity((n + m) as usize);
        let (mut i, mut j, mut done) = (n as usize - 1, m as usize - 1, BOTH_TURNS);
        loop {
            let state = best[i].get(j.checked_sub(rows[i][0])?)?[done]?;
            let Some((step, before)) = state.last else { break };
            steps.push(step);
            done = before;
            match step {
                Step::Boundary(..) => i -= 1,
                Step::Rim(..) => j -= 1,
            }
        }
        steps.reverse();
        Some(steps)
    }

    /// Finds the cheapest path; `None` when there is none.
    fn cheapest_path(&self) -> Option<Vec<Step>> {
        let (n, m) = (self.boundary.points.len(), self.rim.points.len());
        let rows = self.rows();
        let width = |i: usize| (rows[i][1] + 1).saturating_sub(rows[i][0]);
        let mut starts = vec![0usize];
        for i in 0..n {
            starts.push(starts[i] + width(i));
        }
        // Per cross edge, whether its best path comes along the boundary.
        let mut along_boundary = vec![false; starts[n]];
        let mut previous: Vec<f64> = Vec::new();
        for i in 0..n {
            let [low, high] = rows[i];
            let mut costs = vec![f64::INFINITY; width(i)];
            for j in low..=high {
                let mut best = if (i, j) == (0, 0) { 0.0 } else { f64::INFINITY };
                if i > 0 && (rows[i - 1][0]..=rows[i - 1][1]).contains(&j) {
                    let before = previous[j - rows[i - 1][0]];
                    let cost = before + self.cost(Step::Boundary(i as u32 - 1, j as u32));
                    if cost < best {
                        best = cost;
                        along_boundary[starts[i] + j - low] = true;
                    }
                }
                if j > low {
                    let cost = costs[j - 1 - low] + self.cost(Step::Rim(i as u32, j as u32 - 1));
                    if cost < best {
                        best = cost;
                        along_boundary[starts[i] + j - low] = false;
                    }
                }
                costs[j - low] = best;
            }
            previous = costs;
        }
        if !previous.last().is_some_and(|cost| cost.is_finite()) || rows[n - 1][1] != m - 1 {
            return None;
        }
        let mut steps = Vec::with_capacity(n + m);
        let (mut i, mut j) = (n - 1, m - 1);
        while (i, j) != (0, 0) {
            if along_boundary[starts[i] + j - rows[i][0]] {
                i -= 1;
                steps.push(Step::Boundary(i as u32, j as u32));
            } else {
                j -= 1;
                steps.push(Step::Rim(i as u32, j as u32));
            }
        }
        steps.reverse();
        Some(steps)
    }

    /// Returns, per boundary vertex, the first and the last rim vertex of its cross edges; both
    /// ascend.
    fn rows(&self) -> Vec<[usize; 2]> {
        let (n, m) = (self.boundary.points.len(), self.rim.points.len());
        // The rim may go back a little along the boundary.
        let mut farthest = self.rim.arc_lengths.clone();
        for j in 1..m {
            farthest[j] = farthest[j].max(farthest[j - 1]);
        }
        let mut nearest = self.rim.arc_lengths.clone();
        for j in (1..m).rev() {
            nearest[j - 1] = nearest[j - 1].min(nearest[j]);
        }
        (0..n)
            .map(|i| {
                let arcs = &self.boundary.arc_lengths;
                let from = arcs[i.saturating_sub(1)] - self.max_slide;
                let to = arcs[(i + 1).min(n - 1)] + self.max_slide;
                let low = if i == 0 { 0 } else { farthest.partition_point(|&arc| arc < from).min(m - 1) };
                let high = if i + 1 == n { m } else { nearest.partition_point(|&arc| arc <= to) };
                [low, high.saturating_sub(1).max(low)]
            })
            .collect()
    }

    /// Returns the cost of a step, also for a choice between two that exclude each other. A
    /// forbidden step costs infinitely much.
    pub fn cost(&self, step: Step) -> f64 {
        if !self.forbidden.is_empty() && self.forbidden.contains(&step) {
            return f64::INFINITY;
        }
        let [a, b, c] = self.points(step);
        let normal = (b - a).cross(c - a);
        let area = 0.5 * normal.length();
        // Squared length of the next cross edge.
        let cross_edge = match step {
            Step::Boundary(i, j) => {
                self.boundary.points[i as usize + 1].distance_squared(self.rim.points[j as usize])
            }
            Step::Rim(i, j) => {
                self.boundary.points[i as usize].distance_squared(self.rim.points[j as usize + 1])
            }
        };
        // A triangle is the right way round when its normal is that of the wall: the boundary's
        // direction, turned towards the rim.
        let (direction, down) = match step {
            Step::Boundary(i, j) => {
                let i = i as usize;
                (self.boundary.points[i + 1] - self.boundary.points[i], self.down_to(j as usize))
            }
            Step::Rim(_, j) => {
                let j = j as usize;
                (self.rim.points[j + 1] - self.rim.points[j], self.down_to(j))
            }
        };
        let wall = down.cross(direction);
        let folded = normal.dot(wall) < 0.0;
        area + CROSS_EDGE_WEIGHT * cross_edge + if folded { FOLD_WEIGHT * (area + cross_edge) } else { 0.0 }
    }

    /// Returns the vector from the boundary to a rim vertex.
    fn down_to(&self, j: usize) -> DVec3 {
        let arcs = &self.boundary.arc_lengths;
        let arc = self.rim.arc_lengths[j].clamp(0.0, arcs[arcs.len() - 1]);
        let i = arcs.partition_point(|&a| a <= arc).clamp(1, arcs.len() - 1);
        let length = arcs[i] - arcs[i - 1];
        let share = if length > 0.0 { (arc - arcs[i - 1]) / length } else { 0.0 };
        self.rim.points[j] - self.boundary.points[i - 1].lerp(self.boundary.points[i], share)
    }

    /// Returns the corners of a step's triangle.
    fn points(&self, step: Step) -> [DVec3; 3] {
        let (b, l) = (&self.boundary.points, &self.rim.points);
        match step {
            Step::Boundary(i, j) => [b[i as usize + 1], b[i as usize], l[j as usize]],
            Step::Rim(i, j) => [l[j as usize], l[j as usize + 1], b[i as usize]],
        }
    }

    /// Returns the triangle of a step, in the orientation of its neighbours on both sides.
    pub fn triangle(&self, step: Step) -> [u32; 3] {
        let (b, l) = (&self.boundary.vertices, &self.rim.vertices);
        match step {
            Step::Boundary(i, j) => [b[i as usize + 1], b[i as usize], l[j as usize]],
            Step::Rim(i, j) => [l[j as usize], l[j as usize + 1], b[i as usize]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a strip between two circles, the rim below the boundary.
    fn circles(n: usize, m: usize) -> Strip {
        let circle = |count: usize, z: f64, first: u32| {
            let point = |i: usize| {
                let angle = std::f64::consts::TAU * i as f64 / count as f64;
                DVec3::new(angle.cos(), angle.sin(), z)
            };
            Polyline {
                vertices: (0..=count).map(|i| first + (i % count) as u32).collect(),
                points: (0..=count).map(point).collect(),
                arc_lengths: (0..=count).map(|i| std::f64::consts::TAU * i as f64 / count as f64).collect(),
            }
        };
        Strip {
            boundary: circle(n, 0.0, 0),
            rim: circle(m, -0.1, n as u32),
            max_slide: 0.3,
            forbidden: BTreeSet::new(),
        }
    }

    #[test]
    fn a_strip_takes_every_edge_once_and_faces_outward() {
        for (n, m) in [(40, 40), (4, 60), (90, 25), (3, 3)] {
            let strip = circles(n, m);
            let steps = strip.cheapest().unwrap();
            assert_eq!(steps.len(), n + m);
            for &step in &steps {
                let [a, b, c] = strip.points(step);
                let middle = (a + b + c) / 3.0;
                assert!((b - a).cross(c - a).dot(middle.with_z(0.0)) > 0.0, "{n} {m} {step:?}");
            }
        }
    }

    #[test]
    fn no_cross_edge_is_taken_twice_however_small_one_polygon_is() {
        for (n, m, small) in [(28, 7, 1e-3), (3, 3, 1e-6), (5, 40, 0.0), (40, 5, 0.01)] {
            for boundary_is_small in [true, false] {
                let mut strip = circles(n, m);
                let small_one = if boundary_is_small { &mut strip.boundary } else { &mut strip.rim };
                let middle = DVec3::new(0.9, 0.1, 0.0);
                small_one.points.iter_mut().for_each(|p| *p = middle + small * (*p - middle));
                // Cross edges to a polygon that is next to nothing may lead anywhere.
                strip.max_slide = std::f64::consts::TAU;
                let steps = strip.cheapest().unwrap();
                assert_eq!(steps.len(), n + m);
                let ends = steps.iter().map(|step| match *step {
                    Step::Boundary(i, j) => [i as usize + 1, j as usize],
                    Step::Rim(i, j) => [i as usize, j as usize + 1],
                });
                let cross_edges: BTreeSet<[usize; 2]> = ends.map(|[i, j]| [i % n, j % m]).collect();
                assert_eq!(cross_edges.len(), n + m, "{n} {m} {small}");
            }
        }
    }

    #[test]
    fn forbidden_steps_are_not_taken() {
        let mut strip = circles(30, 30);
        // Two cross edges can be reached by seven steps, and four steps lead from them.
        for _ in 0..3 {
            let steps = strip.cheapest().unwrap();
            assert!(steps.iter().all(|step| !strip.forbidden.contains(step)));
            strip.forbidden.insert(steps[7]);
        }
        // Nothing but the end is reached when every step from the start is forbidden.
        let all = (0..=30).flat_map(|i| [Step::Boundary(0, i), Step::Rim(i, 0)]);
        strip.forbidden.extend(all);
        assert!(strip.cheapest().is_none());
    }
}
