//! Shape processing of section and shell (\[WC13\] section 4.3).
//!
//! Each round moves the vertices at the section towards the minimisers of the quadratic error of all faces around them,
//! wherever those are; vertices of the shell alone go to the true shell. Each move is tested exactly ([`Embedding`]), and
//! none touches the patch. The normals of the section are those of the walls on the boundary's edges, or, as in the paper,
//! the faces' own, smoothed in each round.

use super::embedding::Embedding;
use crate::contour::Precision;
use crate::geom::quadric::Qef;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings, SHARE};
use crate::thicken::SectionNormals;
use crate::thicken::solid::edge_search::Part;
use crate::thicken::solid::region::Solid;
use glam::DVec3;
use rayon::prelude::*;

/// The part of the way to the minimiser that a vertex goes in a round: alpha of \[WC13\]. Exact normals stay as they are, and so
/// does the minimiser: there a vertex goes all the way at once, and this far where it must not.
const BLENDING: f64 = 0.25;

/// Moves shorter than this, in voxels, are not made: nobody sees them, and a test takes as long as for others.
const STILL: f64 = 0.02;

/// No vertex gets farther than this from where the contour had it, in voxels: two cells of the lattice.
const REACH: f64 = 2.0;

/// Section faces whose normals differ by more than this cosine's angle, 30 degrees, are on two sides of a corner of the
/// boundary, which stays.
const ALIGNED: f64 = 0.866;

/// A face of the contour, and what is known of the solid's boundary there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    pub part: Part,
    /// Where the lattice edge crosses.
    pub point: DVec3,
    /// The unit normal there.
    pub normal: DVec3,
}

/// The faces of a solid that may be moved.
#[derive(Debug)]
pub(crate) struct Moving {
    /// The number of the first of them among the mesh's triangles.
    pub first: usize,
    /// One after the other.
    pub faces: Vec<Face>,
    /// Vertices from this number on are not of the patch.
    pub first_vertex: u32,
}

/// How often, and with which normals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rounds {
    pub most: u32,
    pub normals: SectionNormals,
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shaped {
    /// Rounds after which nothing moved, or all of them.
    pub rounds: u32,
    /// Moves that were made.
    pub moves: u64,
}

/// A vertex that may be moved.
struct Vertex {
    number: u32,
    /// Where the contour had it.
    first: DVec3,
    /// All its triangles.
    star: Vec<u32>,
}

/// Where a vertex is to go.
struct Target {
    to: DVec3,
    /// Whether it is there in the next round, too, even where the normals of the section change.
    stays: bool,
}

/// At most `rounds` rounds over a solid.
pub(crate) fn process(
    mesh: &mut TriMesh,
    mut moving: Moving,
    solid: &Solid<'_>,
    voxel: f64,
    precision: Precision,
    Rounds { most: rounds, normals }: Rounds,
    run: &RunSettings,
) -> Result<Shaped, Cancelled> {
    let mut shaped = Shaped::default();
    if rounds == 0 {
        return Ok(shaped);
    }
    let vertices = movable(mesh, &moving, voxel);
    let mut embedding = Embedding::new(mesh, REACH * voxel);
    let round_off = |p: DVec3| DVec3::from(p.to_array().map(|x| precision.round(x)));
    let mut active: Vec<&Vertex> = vertices.iter().collect();
    while shaped.rounds < rounds {
        run.check()?;
        shaped.rounds += 1;
        if normals == SectionNormals::Smoothed {
            smooth(&embedding, &mut moving);
        }
        let targets: Vec<Option<Target>> = active
            .par_iter()
            .with_max_len(SHARE)
            .map(|vertex| target(&embedding, &moving, solid, vertex, voxel))
            .collect();
        let mut moved = Vec::new();
        for (vertex, to) in active.into_iter().zip(targets) {
            let Some(Target { to, stays }) = to else { continue };
            let from = embedding.at(vertex.number);
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
        shaped.moves += moved.len() as u64;
        if moved.is_empty() {
            break;
        }
        // Without new normals a vertex that stays has no reason to go later.
        active = match normals {
            SectionNormals::Exact => moved,
            SectionNormals::Smoothed => vertices.iter().collect(),
        };
    }
    Ok(shaped)
}

/// The vertices at the section, and those of the shell that are not on it.
fn movable(mesh: &TriMesh, moving: &Moving, voxel: f64) -> Vec<Vertex> {
    let mut is_wanted = vec![false; mesh.vertices.len()];
    for (n, face) in moving.faces.iter().enumerate() {
        for v in mesh.triangles[moving.first + n] {
            let off = face.normal.dot(DVec3::from(mesh.vertices[v as usize]) - face.point).abs();
            is_wanted[v as usize] |= face.part == Part::Section || off > STILL * voxel;
        }
    }
    is_wanted[..moving.first_vertex as usize].fill(false);
    let mut slots = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::new();
    for (v, _) in is_wanted.iter().enumerate().filter(|&(_, &wanted)| wanted) {
        slots[v] = vertices.len() as u32;
        let first = DVec3::from(mesh.vertices[v]);
        vertices.push(Vertex { number: v as u32, first, star: Vec::new() });
    }
    // The patch has none of them.
    for (t, triangle) in mesh.triangles.iter().enumerate().skip(moving.first) {
        for slot in triangle.map(|v| slots[v as usize]).into_iter().filter(|&slot| slot != u32::MAX) {
            vertices[slot as usize].star.push(t as u32);
        }
    }
    vertices
}

impl Moving {
    fn face(&self, triangle: u32) -> Option<&Face> {
        self.faces.get((triangle as usize).checked_sub(self.first)?)
    }
}

/// Steps 1, 2 and 4: the normals of the section's faces become the mean of those around them, as they are now.
fn smooth(embedding: &Embedding<'_>, moving: &mut Moving) {
    let sections: Vec<u32> = (0..moving.faces.len())
        .filter(|&n| moving.faces[n].part == Part::Section)
        .map(|n| (moving.first + n) as u32)
        .collect();
    let areas: Vec<DVec3> = sections.par_iter().with_min_len(256).map(|&t| embedding.area(t)).collect();
    // Per corner its vertex and its triangle.
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
            let is_near = |other: &DVec3| other.dot(own) >= ALIGNED * other.length() * own.length();
            embedding.vertices(t).into_iter().flat_map(around).filter(is_near).sum::<DVec3>()
        })
        .collect();
    for (&t, sum) in sections.iter().zip(&smoothed) {
        let face = &mut moving.faces[t as usize - moving.first];
        face.normal = sum.try_normalize().unwrap_or(face.normal);
    }
}

/// Step 3: where a vertex is to go, if that is far enough to go.
fn target(
    embedding: &Embedding<'_>,
    moving: &Moving,
    solid: &Solid<'_>,
    vertex: &Vertex,
    voxel: f64,
) -> Option<Target> {
    let from = embedding.at(vertex.number);
    // Triangles of strips and lids have no Hermite data of their own.
    let faces: Vec<&Face> = vertex.star.iter().filter_map(|&t| moving.face(t)).collect();
    let mut qef = Qef::default();
    faces.iter().for_each(|face| qef.add(face.point.to_array(), face.normal.to_array()));
    let least = DVec3::from(qef.minimiser_near(from.to_array()).point);
    let is_shell = faces.iter().all(|face| face.part == Part::Shell);
    let to = if is_shell {
        // On a crease of the shell if there is one, and nowhere else.
        let error = |p: DVec3| solid.off_shell(p).map(f64::abs);
        let is_better = error(least)? < 0.5 * error(from)?;
        if is_better { least } else { solid.onto_shell(from)? }
    } else {
        least
    };
    (to.distance(from) > STILL * voxel).then_some(Target { to, stays: is_shell })
}
