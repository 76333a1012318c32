//! Creases and corners that lie outside the cells that see them.
//!
//! The construction keeps every vertex in its cell, and blunts features there that pass beside it: the tip of
//! a wedge that is thinner than a voxel, a corner between the nodes. When the mesh is finished, such vertices are
//! moved to where they belong, and edges are flipped along the crease, each only if the mesh stays embedded
//! (see `patch`). Leaves that are far enough apart not to touch the same triangles are worked on together, in
//! eight rounds, so that the result does not depend on the number of threads.

use super::cells::Cells;
use super::feature::{Asker, REACH, feature_between, nearest};
use super::features::{Features, Sides};
use super::grid::Grid;
use super::patch::{Bounds, Changes, NEW_TRIANGLE, NEW_VERTEX, Patch, PatchEdge, PatchTriangle};
use super::qef::{cross, dot};
use super::surface::Surface;
use crate::band::{LEAF_DIM, LeafId};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use rayon::prelude::*;

type Point = [f64; 3];

/// How far the triangles at the vertices of a leaf reach beyond it, in voxels: their other vertices lie in the
/// next cells or up to REACH outside of those. Two leaves with another one between them are 8 voxels apart, more
/// than twice this.
const MARGIN: f64 = 1.0 + REACH;

const _: () =
    assert!(2.0 * MARGIN < LEAF_DIM as f64, "leaves of one round must not touch the same triangles");

/// Edges whose triangles' normals differ by less than this (cosine of 5 degrees) are not worth flipping.
const FLAT: f64 = 0.996;

/// Edges whose middle is nearer to the surface than this, in voxels, stay.
const GOOD_EDGE: f64 = 0.01;

/// Points that are nearer than this, in voxels, to the sides that features nearby know are not asked about.
const SURE: f64 = 0.03;

/// A flip must bring the middle of the edge this much nearer.
const GAIN: f64 = 0.5;

/// Triangles and edges that are farther from the surface than this, in voxels, are split.
const SPLIT: f64 = 0.05;

/// How often what was split is split again.
const DEPTH: u32 = 3;

/// A place is taken when a vertex is as near as this, in voxels.
const TAKEN: f64 = 0.01;

/// Where a vertex ought to be.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// The vertex.
    pub vertex: u32,
    /// Its own place, rounded; `None` when it is there, but the surface around it is far.
    pub place: Option<Point>,
}

/// What became of the wishes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recovered {
    /// Vertices moved to where they belong.
    pub granted: u64,
    /// Vertices that got half-way only, or stayed.
    pub refused: u64,
    /// Edges flipped.
    pub flipped: u64,
    /// Triangles and edges split.
    pub split: u64,
}

/// Moves vertices of the finished mesh to where they belong. `wishes` has a list for each leaf, `ranges` the first
/// triangle of each leaf and the number of all.
///
/// # Errors
/// When the run is cancelled.
pub fn recover(
    cells: &Cells<'_>,
    surface: &dyn Surface,
    wishes: &[Vec<Wish>],
    ranges: &[usize],
    mesh: &mut TriMesh,
    run: &RunSettings,
) -> Result<Recovered, Cancelled> {
    let mut recovered = Recovered::default();
    // Triangles that a leaf added, by leaf.
    let mut added: Vec<Vec<usize>> = vec![Vec::new(); wishes.len()];
    for round in 0..8 {
        let leaves: Vec<LeafId> = cells
            .signs
            .leaves()
            .filter(|&leaf| {
                !wishes[leaf.0 as usize].is_empty() && colour(cells.signs.origin(leaf).0) == round
            })
            .collect();
        let changes: Vec<(Changes, Recovered)> = leaves
            .par_iter()
            .map(|&leaf| {
                run.check()?;
                let wishes = &wishes[leaf.0 as usize];
                let patch = patch(cells, ranges, &added, mesh, leaf, wishes);
                let mut work = Work {
                    patch,
                    surface,
                    grid: &cells.grid,
                    features: &cells.features,
                    voxel: cells.grid.voxel(),
                    hint: 0,
                };
                let done = work.grant_all(wishes);
                Ok((work.patch.changes, done))
            })
            .collect::<Result<_, Cancelled>>()?;
        for (leaf, (changes, done)) in leaves.into_iter().zip(changes) {
            apply(changes, mesh, &mut added[leaf.0 as usize]);
            recovered.split += done.split;
            recovered.granted += done.granted;
            recovered.refused += done.refused;
            recovered.flipped += done.flipped;
        }
    }
    Ok(recovered)
}

/// Puts what a patch changed into the mesh.
fn apply(changes: Changes, mesh: &mut TriMesh, added: &mut Vec<usize>) {
    let (first_vertex, first_triangle) = (mesh.vertices.len(), mesh.triangles.len());
    mesh.vertices.resize(first_vertex + changes.new_vertices as usize, [0.0; 3]);
    mesh.triangles.resize(first_triangle + changes.new_triangles, [0; 3]);
    added.extend(first_triangle..mesh.triangles.len());
    let vertex = |v: u32| v.checked_sub(NEW_VERTEX).map_or(v, |n| first_vertex as u32 + n);
    let triangle = |t: usize| t.checked_sub(NEW_TRIANGLE).map_or(t, |n| first_triangle + n);
    for (number, position) in changes.moved {
        mesh.vertices[vertex(number) as usize] = position;
    }
    for (number, vertices) in changes.triangles {
        mesh.triangles[triangle(number)] = vertices.map(vertex);
    }
}

/// Leaves of one colour have another leaf between them along some axis.
fn colour(origin: [i32; 3]) -> i32 {
    let [x, y, z] = origin.map(|x| x.div_euclid(LEAF_DIM) & 1);
    4 * x + 2 * y + z
}

/// The triangles near the wishes of a leaf.
fn patch(
    cells: &Cells<'_>,
    ranges: &[usize],
    added: &[Vec<usize>],
    mesh: &TriMesh,
    leaf: LeafId,
    wishes: &[Wish],
) -> Patch {
    let voxel = cells.grid.voxel();
    let margin = MARGIN * voxel;
    // The leaf and its margin, and of that what is near the wishes.
    let of_leaf = |leaf: LeafId| {
        let origin = cells.signs.origin(leaf).0.map(|x| voxel * f64::from(x));
        Bounds { lo: origin, hi: origin.map(|x| x + voxel * f64::from(LEAF_DIM)) }.grown(margin)
    };
    let places = wishes.iter().flat_map(|w| w.place.into_iter().chain([mesh.vertices[w.vertex as usize]]));
    let bounds = Bounds::around(places).grown(margin).within(&of_leaf(leaf));
    let around = (0..27)
        .filter_map(|n| cells.signs.neighbour(leaf, [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1]))
        .filter(|&leaf| of_leaf(leaf).meets(&bounds));
    let numbers = around.flat_map(|leaf| {
        let n = leaf.0 as usize;
        (ranges[n]..ranges[n + 1]).chain(added[n].iter().copied())
    });
    Patch::new(
        bounds,
        numbers.map(|number| PatchTriangle {
            number,
            vertices: mesh.triangles[number],
            corners: mesh.corners(number),
        }),
    )
}

/// The work on one leaf.
struct Work<'a> {
    patch: Patch,
    surface: &'a dyn Surface,
    grid: &'a Grid,
    features: &'a Features,
    voxel: f64,
    hint: u32,
}

impl Work<'_> {
    fn grant_all(&mut self, wishes: &[Wish]) -> Recovered {
        let mut recovered = Recovered::default();
        let mut open: Vec<&Wish> = wishes.iter().collect();
        // A move can be in the way of another one, and an edge in the way of either.
        for _ in 0..2 {
            let before = open.len();
            open.retain(|wish| !self.grant(wish));
            for wish in wishes {
                recovered.flipped += self.flip_around(wish.vertex);
            }
            if open.is_empty() || open.len() == before {
                break;
            }
        }
        for wish in &open {
            self.console(wish);
        }
        for wish in wishes {
            recovered.split += self.split_around(wish.vertex, 0);
        }
        recovered.refused = open.len() as u64;
        recovered.granted = (wishes.len() - open.len()) as u64;
        recovered
    }

    fn grant(&mut self, wish: &Wish) -> bool {
        match wish.place.or_else(|| self.place_on_surface(wish.vertex)) {
            Some(place) => self.patch.try_move(wish.vertex, place),
            None => true,
        }
    }

    /// Where a vertex that is far from the surface would be on it.
    fn place_on_surface(&mut self, vertex: u32) -> Option<Point> {
        let origin = self.patch.position(vertex)?;
        let mut ask = Asker { surface: self.surface, origin, voxel: self.voxel, hint: self.hint, count: 0 };
        let is_far = ask.at([0.0; 3]).0.abs() > SPLIT;
        let place = if is_far { nearest(&mut ask, [0.0; 3]) } else { None };
        self.hint = ask.hint;
        place.map(|p| self.grid.round(std::array::from_fn(|i| origin[i] + self.voxel * p[i])))
    }

    /// The next best for a vertex that cannot have its place: half-way there, or some place on the surface.
    fn console(&mut self, wish: &Wish) {
        let Some(from) = self.patch.position(wish.vertex) else { return };
        let half = wish.place.map(|place| self.grid.round(middle(from, place)));
        let places = [half, self.place_on_surface(wish.vertex)];
        for place in places.into_iter().flatten() {
            if self.error(place, &Sides::NONE) < self.error(from, &Sides::NONE)
                && self.patch.try_move(wish.vertex, place)
            {
                return;
            }
        }
    }

    /// Flips edges at and around a vertex that cut through the solid or the air beside a crease.
    fn flip_around(&mut self, vertex: u32) -> u64 {
        let mut flipped = 0;
        // Every flip brings the surface nearer; the limit is for rounding.
        while flipped < 8 {
            let edges = self.patch.edges_around(vertex);
            let Some(()) = edges.iter().find_map(|edge| self.flip(edge)) else { break };
            flipped += 1;
        }
        flipped
    }

    fn flip(&mut self, edge: &PatchEdge) -> Option<()> {
        let PatchEdge { a, b, c, d, .. } = *edge;
        if is_flat(edge) {
            return None;
        }
        let sides = self.features.sides([a, b, c, d].map(|v| v.0).into_iter());
        let now = self.error(middle(a.1, b.1), &sides);
        if now < GOOD_EDGE {
            return None;
        }
        let then = self.error(middle(c.1, d.1), &Sides::NONE);
        (then < GAIN * now && self.patch.try_flip(edge)).then_some(())
    }

    /// Splits the triangles at a vertex, and their edges, where they are far from the surface.
    fn split_around(&mut self, vertex: u32, depth: u32) -> u64 {
        let mut split = 0;
        let mut open = self.patch.star(vertex);
        while let Some(n) = open.pop() {
            let Some(new) = self.split(n) else { continue };
            split += 1;
            self.flip_around(new);
            if depth < DEPTH {
                split += self.split_around(new, depth + 1);
            }
            open.retain(|&n| self.patch.triangle_at(n).vertices.contains(&vertex));
        }
        split
    }

    /// Splits a triangle, or an edge of it, where it is farthest from the surface.
    fn split(&mut self, n: usize) -> Option<u32> {
        let t = *self.patch.triangle_at(n);
        let [a, b, c] = t.corners;
        let centre = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        let places = [middle(a, b), middle(b, c), middle(c, a), centre];
        let sides = self.features.sides(t.vertices.into_iter());
        let errors = places.map(|p| self.error(p, &sides));
        let worst = (0..4).max_by(|&i, &j| errors[i].total_cmp(&errors[j]))?;
        if errors[worst] < SPLIT {
            return None;
        }
        let edge = if worst < 3 { self.patch.edge(n, worst) } else { None };
        let around: Vec<Point> = match &edge {
            Some(edge) => vec![edge.a.1, edge.b.1, edge.c.1, edge.d.1],
            None => vec![a, b, c],
        };
        let from = places[worst];
        for target in self.surface_points(from, &around).into_iter().flatten() {
            let target = self.grid.round(target);
            if self.patch.is_taken(target, TAKEN * self.voxel, u32::MAX) {
                continue;
            }
            let new = match &edge {
                Some(edge) => self.patch.try_split_edge(edge, target),
                None => self.patch.try_split_face(n, target),
            };
            if new.is_some() {
                return new;
            }
        }
        None
    }

    /// Points of the surface near `from`: the crease or corner between the sides that are seen from there towards
    /// the points around, and the next point at all.
    fn surface_points(&mut self, from: Point, around: &[Point]) -> [Option<Point>; 2] {
        let mut ask =
            Asker { surface: self.surface, origin: from, voxel: self.voxel, hint: self.hint, count: 0 };
        let towards = around.iter().map(|p| std::array::from_fn(|i| 0.5 * (p[i] - from[i]) / self.voxel));
        let crease = feature_between(&mut ask, towards);
        let next = nearest(&mut ask, [0.0; 3]);
        self.hint = ask.hint;
        let world = |p: Point| std::array::from_fn(|i| from[i] + self.voxel * p[i]);
        [crease.map(world), next.map(world)]
    }

    /// The distance of a point from the surface, in voxels, if that can be more than [`SURE`] by what the sides of
    /// features near it say; else 0.
    fn error(&mut self, p: Point, sides: &Sides) -> f64 {
        if !sides.is_empty() && sides.distance(p) < SURE * self.voxel {
            return 0.0;
        }
        self.surface.at(p, &mut self.hint).0.abs() / self.voxel
    }
}

fn middle(p: Point, q: Point) -> Point {
    std::array::from_fn(|i| 0.5 * (p[i] + q[i]))
}

fn is_flat(edge: &PatchEdge) -> bool {
    let PatchEdge { a, b, c, d, .. } = edge;
    let minus = |p: Point, q: Point| -> Point { std::array::from_fn(|i| p[i] - q[i]) };
    let along = minus(b.1, a.1);
    let (n, m) = (cross(along, minus(c.1, a.1)), cross(minus(d.1, a.1), along));
    dot(n, m) > FLAT * (dot(n, n) * dot(m, m)).sqrt()
}
