//! The contour without the faces below the patch: an open mesh whose rims run along the boundary of S.

use super::crossings::{Part, SolidCrossings};
use crate::band::SignField;
use crate::contour::{Precision, contour_by_edge};
use crate::error::Error;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;

/// Section and shell.
#[derive(Debug)]
pub(super) struct OpenMesh {
    pub mesh: TriMesh,
    /// Per triangle.
    pub parts: Vec<Part>,
    /// The vertices of each rim, in the direction in which the triangles run through its edges.
    pub rims: Vec<Vec<u32>>,
}

impl OpenMesh {
    /// Contours the solid and leaves out the lid.
    pub fn new(
        signs: &SignField,
        found: &SolidCrossings,
        lattice: Lattice,
        precision: Precision,
        run: &RunSettings,
    ) -> Result<OpenMesh, Error> {
        let (mesh, sizes) = contour_by_edge(signs, &found.crossings, lattice, precision, run)?;
        let per_triangle = sizes.iter().zip(&found.parts);
        let parts: Vec<Part> =
            per_triangle.flat_map(|(&size, &part)| std::iter::repeat_n(part, usize::from(size))).collect();
        Ok(run.install(|| without_lid(mesh, parts)))
    }
}

/// Drops the lid, and what would hang on a rim by a vertex alone.
fn without_lid(mesh: TriMesh, parts: Vec<Part>) -> OpenMesh {
    let topology = Topology::new(&mesh);
    let mut kept: Vec<bool> = parts.iter().map(|&part| part != Part::Lid).collect();
    // Vertices at the rim.
    let mut open: Vec<u32> = (0..mesh.vertices.len() as u32)
        .filter(|&v| {
            let mut around = topology.around_vertex(v).iter().map(|&t| kept[t as usize]);
            let first = around.next();
            around.any(|k| Some(k) != first)
        })
        .collect();
    while let Some(v) = open.pop() {
        let around = topology.around_vertex(v);
        let starts = around.iter().filter(|&&t| starts_rim(&mesh, &topology, &kept, t, v)).count();
        if starts > 1 {
            for &t in around {
                if std::mem::replace(&mut kept[t as usize], false) {
                    open.extend(mesh.triangles[t as usize]);
                }
            }
        }
    }
    let mut next = vec![u32::MAX; mesh.vertices.len()];
    for (t, triangle) in (0u32..).zip(&mesh.triangles) {
        if !kept[t as usize] {
            continue;
        }
        for side in crate::geom::triangle::Side::ALL {
            let open = topology.around_edge(t, side).nth(1).is_none_or(|(other, _)| !kept[other as usize]);
            if open {
                next[triangle[side.index()] as usize] = triangle[side.next().index()];
            }
        }
    }
    // Numbers without those that no triangle has any more.
    let mut numbers = vec![u32::MAX; mesh.vertices.len()];
    for (triangle, _) in mesh.triangles.iter().zip(&kept).filter(|(_, kept)| **kept) {
        triangle.iter().for_each(|&v| numbers[v as usize] = 0);
    }
    let mut vertices = Vec::with_capacity(mesh.vertices.len());
    for (number, position) in numbers.iter_mut().zip(&mesh.vertices).filter(|(n, _)| **n == 0) {
        *number = vertices.len() as u32;
        vertices.push(*position);
    }
    let mut rims = Vec::new();
    for start in 0..next.len() {
        let (mut at, mut rim) = (start, Vec::new());
        while next[at] != u32::MAX {
            rim.push(numbers[at]);
            at = std::mem::replace(&mut next[at], u32::MAX) as usize;
        }
        if !rim.is_empty() {
            rims.push(rim);
        }
    }
    let keep = |t: usize| kept[t];
    let triangles = (0..mesh.triangles.len())
        .filter(|&t| keep(t))
        .map(|t| mesh.triangles[t].map(|v| numbers[v as usize]))
        .collect();
    let parts = (0..parts.len()).filter(|&t| keep(t)).map(|t| parts[t]).collect();
    OpenMesh { mesh: TriMesh { vertices, triangles }, parts, rims }
}

/// Whether the edge of triangle `t` that starts at `v` is on a rim.
fn starts_rim(mesh: &TriMesh, topology: &Topology, kept: &[bool], t: u32, v: u32) -> bool {
    let corners = mesh.triangles[t as usize];
    kept[t as usize]
        && crate::geom::triangle::Side::ALL
            .into_iter()
            .filter(|s| corners[s.index()] == v)
            .any(|side| topology.around_edge(t, side).nth(1).is_none_or(|(other, _)| !kept[other as usize]))
}
