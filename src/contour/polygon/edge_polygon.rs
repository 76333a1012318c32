//! The polygon around each crossed grid edge: the vertices of the four cells, and face vertices
//! between them.

use super::envelope::Envelope;
use super::leaf_cells::LeafCells;
use super::triangulate::{Fit, Polygon, PolygonCorner};
use crate::band::LeafId;
use crate::contour::cell::Edge;
use crate::contour::feature::CreasePlanes;
use crate::contour::vertex::{Cells, FaceVertices};
use crate::edge::EdgeId;
use crate::lattice::{Axis, Ijk, LEAF_DIM, bits};
use glam::DVec3;

/// The polygon around a crossed edge, and all that decides how it is split.
#[derive(Clone, Copy, Debug)]
pub struct EdgePolygon<'a> {
    /// The cell and face vertices around the edge.
    pub polygon: &'a Polygon,
    /// The edge's envelope.
    pub envelope: Envelope,
    /// The surface at the crossing.
    pub fit: Fit<'a>,
    /// The triangle of the crossing ([`Crossing::triangle`](crate::edge::Crossing)).
    pub triangle: u32,
    /// The edge's lower node.
    pub node: Ijk,
    /// The number of that node in the leaf.
    pub number: u16,
    /// The axis of the edge, and the crossing on it in voxels from the lower node, 0 to 1.
    pub along: (Axis, f64),
    /// Whether the sign jumps there ([`Crossing::is_jump`](crate::edge::Crossing::is_jump)).
    pub is_jump: bool,
}

/// Hands the polygons around the crossed edges that start in `leaf` to `visit`, in the order of the
/// edges.
#[inline]
pub fn for_polygons(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    vertices: &[[f64; 3]],
    leaf: LeafId,
    mut visit: impl FnMut(EdgePolygon<'_>),
) {
    let numbers = &cells.context.crossings.numbers;
    if numbers.range(leaf).is_empty() {
        return;
    }
    let lattice = &cells.context.lattice;
    let inside = cells.context.signs.inside(leaf);
    let origin = cells.context.signs.origin(leaf);
    let around = LeafCells::new(cells, faces, leaf);
    // The node planes of the leaf, and the next ones.
    let planes: [[f64; LEAF_DIM as usize + 1]; 3] =
        std::array::from_fn(|a| std::array::from_fn(|i| lattice.plane(origin.0[a] + i as i32)));
    let at = |local: [i32; 3]| std::array::from_fn(|a| planes[a][local[a] as usize]);
    let mut ids = numbers.range(leaf).map(EdgeId);
    // Made once: a polygon is large, and most have four corners.
    let mut polygon = Polygon::default();
    for axis in Axis::ALL {
        for (number, id) in bits(numbers.mask(leaf, axis)).zip(&mut ids) {
            let local = Ijk::in_leaf(Ijk::default(), number);
            if axis != Axis::X && is_at_border(cells, leaf, local) {
                continue;
            }
            let node = origin + local;
            let low_is_inside = inside[number >> 6] >> (number & 63) & 1 == 1;
            let ends = [at(local.0), at(local.next(axis).0)];
            let (outside, envelope) = if low_is_inside {
                (End::High, Envelope { above: ends[1], below: ends[0] })
            } else {
                (End::Low, Envelope { above: ends[0], below: ends[1] })
            };
            fill(&mut polygon, &around, vertices, local, axis, outside);
            let sample = cells.context.crossings.sample(id);
            let point = lattice.unrounded(node, on_axis(axis, sample.t).into());
            let corners = || polygon.corners().iter().map(|c| c.vertex);
            // Most polygons are near no feature, and crease planes are large.
            let found;
            let planes = if cells.features.has_any(corners()) {
                found = cells.features.crease_planes(corners());
                &found
            } else {
                &CreasePlanes::NONE
            };
            let fit = Fit::new(point, DVec3::from(sample.normal.map(f64::from)), planes, lattice.voxel());
            let (triangle, number) = (sample.triangle, number as u16);
            let (polygon, along, is_jump) = (&polygon, (axis, sample.t), sample.is_jump());
            visit(EdgePolygon { polygon, envelope, fit, triangle, node, number, along, is_jump });
        }
    }
}

/// Whether cells around the edges across x from node `local` of `leaf` are missing, since the field
/// is cut off there.
fn is_at_border(cells: &Cells<'_>, leaf: LeafId, local: Ijk) -> bool {
    const LAST: i32 = LEAF_DIM - 1;
    match local.0[0] {
        0 => cells.context.signs.is_border(leaf, -1),
        LAST => cells.context.signs.is_border(leaf, 1),
        _ => false,
    }
}

/// Returns the offset `t` along `axis`.
pub fn on_axis(axis: Axis, t: f64) -> [f64; 3] {
    let mut along = [0.0; 3];
    along[axis as usize] = t;
    along
}

/// An end of a grid edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Low,
    High,
}

/// The cells around an edge along an axis as offsets (0 or -1) in the other two axes (u, v),
/// counter-clockwise seen from the upper end.
const AROUND: [[i32; 2]; 4] = [[0, 0], [-1, 0], [-1, -1], [0, -1]];

/// The lower one of the cells i and i + 1 around an edge, and the axis along which the other one
/// follows: u (0) or v (1).
const BETWEEN: [(usize, usize); 4] = [(1, 0), (2, 1), (2, 0), (3, 1)];

/// Makes `polygon` the one around the edge from node `local` of a leaf along `axis`,
/// counter-clockwise seen from the end that is outside.
#[inline]
fn fill(
    polygon: &mut Polygon,
    cells: &LeafCells<'_>,
    vertices: &[[f64; 3]],
    local: Ijk,
    axis: Axis,
    outside: End,
) {
    let corner = |vertex: u32| PolygonCorner { vertex, position: vertices[vertex as usize] };
    let quad = |[a, b, c, d]: [PolygonCorner; 4]| match outside {
        End::High => [a, b, c, d],
        End::Low => [a, d, c, b],
    };
    // Most cells have one sheet, and there are no face vertices.
    if let Some(vertices) = cells.single_vertices(local.0, axis) {
        return polygon.set_quad(quad(vertices.map(corner)));
    }
    let (u, v) = axis.others();
    let around = AROUND.map(|[du, dv]| {
        let mut at = local.0;
        at[u as usize] += du;
        at[v as usize] += dv;
        (at, Edge::new(axis, -du as u8, -dv as u8))
    });
    let cell_vertex = |i: usize| corner(cells.vertex(around[i].0, around[i].1));
    let face_vertex = |i: usize| {
        let (lower, along) = BETWEEN[i];
        let (at, edge) = around[lower];
        cells.face_vertex(at, [u, v][along], edge).map(corner)
    };
    if !cells.have_face_vertices() {
        return polygon.set_quad(quad([0, 1, 2, 3].map(cell_vertex)));
    }
    polygon.clear();
    for i in 0..4 {
        let (cell, face) = match outside {
            End::High => (i, i),
            // Backwards: 0, 3, 2, 1, with the face between cells i and i + 1 before cell i.
            End::Low => ((4 - i) % 4, 3 - i),
        };
        polygon.push(cell_vertex(cell));
        if let Some(corner) = face_vertex(face) {
            polygon.push(corner);
        }
    }
}
