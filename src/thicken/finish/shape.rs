//! Shape processing of section and shell (\[WC13\] section 4.3).
//!
//! Each round moves the vertices at the section towards the minimisers of the quadratic error of
//! all faces around them, wherever the minimisers are. Vertices of the shell alone go to the true
//! shell. Each move is tested exactly ([`Embedding`]), and none touches the patch. The normals of
//! the section are those of the walls on the boundary's edges, or, as in the paper, the faces' own,
//! smoothed in each round.

use super::embedding::Embedding;
use crate::contour::Precision;
use crate::geom::quadric::Qef;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings, SHARE};
use crate::thicken::solid::edge_search::SolidFace;
use crate::thicken::solid::region::Solid;
use crate::thicken::{SectionNormals, ShapeCounts};
use glam::DVec3;
use rayon::prelude::*;

/// Share of the way to the minimiser that a vertex goes in a round: alpha of \[WC13\]. Exact
/// normals stay as they are, and so does the minimiser: there a vertex goes all the way at once,
/// and only this far where an exact test refuses that.
const BLENDING: f64 = 0.25;

/// Minimum length of a move, in voxels. Nobody sees shorter ones, and their tests take as long.
const MIN_MOVE: f64 = 0.02;

/// Maximum distance of a vertex from where the contour had it, in voxels: two cells of the lattice.
const MAX_TRAVEL: f64 = 2.0;

/// Minimum cosine between the normals of two section faces that are smoothed together: 30 degrees.
/// Faces at a larger angle are on two sides of a corner of the boundary, which stays.
const MIN_ALIGNMENT: f64 = 0.866;

/// A triangle of the contour, with the solid's boundary at its lattice edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContourFace {
    /// The face of the solid that the lattice edge crosses.
    pub of: SolidFace,
    /// Crossing of the lattice edge.
    pub point: DVec3,
    /// Unit normal at the crossing.
    pub normal: DVec3,
}

/// The triangles of a solid whose vertices may be moved.
#[derive(Debug)]
pub(crate) struct MovableFaces {
    /// Number of the first face among the mesh's triangles.
    pub first: usize,
    /// The faces, in the order of the triangles.
    pub faces: Vec<ContourFace>,
    /// Number of the first vertex that is not of the patch.
    pub first_vertex: u32,
}

/// Settings of shape processing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeSettings {
    /// Maximum number of rounds.
    pub max_rounds: u32,
    /// Normals of the section.
    pub normals: SectionNormals,
    /// Precision of the moved coordinates.
    pub precision: Precision,
}

/// A vertex that may be moved.
struct MovableVertex {
    /// Number of the vertex.
    number: u32,
    /// Position that the contour gave it.
    first: DVec3,
    /// All triangles of the vertex.
    star: Vec<u32>,
}

/// Target of a move.
struct Target {
    to: DVec3,
    /// Whether the target will be the same in the next round, even where the normals of the section
    /// change.
    stays: bool,
}

/// Moves vertices of section and shell, in rounds, until nothing moves.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn process_shape(
    mesh: &mut TriMesh,
    mut movable: MovableFaces,
    solid: &Solid<'_>,
    voxel: f64,
    settings: ShapeSettings,
    run: &RunSettings,
) -> Result<ShapeCounts, Cancelled> {
    let ShapeSettings { max_rounds, normals, precision } = settings;
    let mut counts = ShapeCounts::default();
    if max_rounds == 0 {
        return Ok(counts);
    }
    let vertices = movable_vertices(mesh, &movable, voxel);
    let mut embedding = Embedding::new(mesh, MAX_TRAVEL * voxel);
    let round_off = |p: DVec3| DVec3::from(p.to_array().map(|x| precision.round(x)));
    let mut active: Vec<&MovableVertex> = vertices.iter().collect();
    while counts.rounds < max_rounds {
        run.check()?;
        counts.rounds += 1;
        if normals == SectionNormals::Smoothed {
            smooth(&embedding, &mut movable);
        }
        let targets: Vec<Option<Target>> = active
            .par_iter()
            .with_max_len(SHARE)
            .map(|vertex| target(&embedding, &movable, solid, vertex, voxel))
            .collect();
        let mut moved = Vec::new();
        for (vertex, to) in active.into_iter().zip(targets) {
            let Some(Target { to, stays }) = to else { continue };
            let from = embedding.position(vertex.number);
            let steps: &[f64] =
                if stays || normals == SectionNormals::Exact { &[1.0, BLENDING] } else { &[BLENDING] };
            let mut go = |step: &f64| {
                let to = round_off(from + step * (to - from));
                embedding.try_move(vertex.number, &vertex.star, vertex.first, to)
            };
            if steps.iter().any(&mut go) {
                moved.push(vertex);
            }
        }
        counts.moves += moved.len() as u64;
        if moved.is_empty() {
            break;
        }
        // Without new normals a vertex that stays has no reason to go later.
        active = match normals {
            SectionNormals::Exact => moved,
            SectionNormals::Smoothed => vertices.iter().collect(),
        };
    }
    Ok(counts)
}

/// Collects the vertices at the section, and the vertices of the shell that are off the shell.
fn movable_vertices(mesh: &TriMesh, movable: &MovableFaces, voxel: f64) -> Vec<MovableVertex> {
    let mut is_wanted = vec![false; mesh.vertices.len()];
    for (n, face) in movable.faces.iter().enumerate() {
        for v in mesh.triangles[movable.first + n] {
            let off = face.normal.dot(DVec3::from(mesh.vertices[v as usize]) - face.point).abs();
            is_wanted[v as usize] |= face.of == SolidFace::Section || off > MIN_MOVE * voxel;
        }
    }
    is_wanted[..movable.first_vertex as usize].fill(false);
    let mut slots = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::new();
    for (v, _) in is_wanted.iter().enumerate().filter(|&(_, &wanted)| wanted) {
        slots[v] = vertices.len() as u32;
        let first = DVec3::from(mesh.vertices[v]);
        vertices.push(MovableVertex { number: v as u32, first, star: Vec::new() });
    }
    // No triangle of the patch has one of these vertices.
    for (t, triangle) in mesh.triangles.iter().enumerate().skip(movable.first) {
        for slot in triangle.map(|v| slots[v as usize]).into_iter().filter(|&slot| slot != u32::MAX) {
            vertices[slot as usize].star.push(t as u32);
        }
    }
    vertices
}

impl MovableFaces {
    /// Returns the face of a triangle, unless the triangle is of the patch, a strip or a cap.
    fn face(&self, triangle: u32) -> Option<&ContourFace> {
        self.faces.get((triangle as usize).checked_sub(self.first)?)
    }
}

/// Replaces the normal of each face of the section by the mean normal of the faces around it (steps
/// 1, 2 and 4 of \[WC13\] section 4.3).
fn smooth(embedding: &Embedding<'_>, movable: &mut MovableFaces) {
    let sections: Vec<u32> = (0..movable.faces.len())
        .filter(|&n| movable.faces[n].of == SolidFace::Section)
        .map(|n| (movable.first + n) as u32)
        .collect();
    let areas: Vec<DVec3> = sections.par_iter().with_min_len(256).map(|&t| embedding.area(t)).collect();
    // Per triangle corner, its vertex and its triangle.
    let mut corners: Vec<(u32, u32)> = Vec::with_capacity(3 * sections.len());
    for (n, &t) in (0u32..).zip(&sections) {
        corners.extend(embedding.vertices(t).map(|v| (v, n)));
    }
    corners.sort_unstable();
    let around = |v: u32| {
        let first = corners.partition_point(|&(w, _)| w < v);
        corners[first..].iter().take_while(move |&&(w, _)| w == v).map(|&(_, n)| areas[n as usize])
    };
    let smoothed: Vec<DVec3> = sections
        .par_iter()
        .zip(&areas)
        .with_min_len(64)
        .map(|(&t, &own)| {
            let is_near = |other: &DVec3| other.dot(own) >= MIN_ALIGNMENT * other.length() * own.length();
            embedding.vertices(t).into_iter().flat_map(around).filter(is_near).sum::<DVec3>()
        })
        .collect();
    for (&t, sum) in sections.iter().zip(&smoothed) {
        let face = &mut movable.faces[t as usize - movable.first];
        face.normal = sum.try_normalize().unwrap_or(face.normal);
    }
}

/// Returns the target of a vertex, if a move there is long enough (step 3).
fn target(
    embedding: &Embedding<'_>,
    movable: &MovableFaces,
    solid: &Solid<'_>,
    vertex: &MovableVertex,
    voxel: f64,
) -> Option<Target> {
    let from = embedding.position(vertex.number);
    // Triangles of strips and caps have no Hermite data of their own.
    let faces: Vec<&ContourFace> = vertex.star.iter().filter_map(|&t| movable.face(t)).collect();
    let mut qef = Qef::default();
    faces.iter().for_each(|face| qef.add(face.point, face.normal));
    let least = qef.minimiser_near(from).point;
    let is_shell = faces.iter().all(|face| face.of == SolidFace::Shell);
    let to = if is_shell {
        // On a crease of the shell if there is one, and nowhere else.
        let error = |p: DVec3| solid.depth_beyond_shell(p).map(f64::abs);
        let is_better = error(least)? < 0.5 * error(from)?;
        if is_better { least } else { solid.project_to_shell(from)? }
    } else {
        least
    };
    (to.distance(from) > MIN_MOVE * voxel).then_some(Target { to, stays: is_shell })
}
