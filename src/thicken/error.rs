//! Why a patch cannot be thickened.

use crate::mesh::{LENGTHS, MeshError};
use std::fmt;

/// Why [`thicken`](super::thicken) refused its settings or gave up.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ThickenError {
    /// The thickness is zero, negative, infinite or not a number.
    #[error("the thickness must be a positive number, not {0}; --side outer has the solid on the other side")]
    Thickness(f64),
    /// The thickness map does not belong to the patch.
    #[error("the thickness map has {values} values, and the patch {vertices} vertices")]
    Map {
        /// Values in the map.
        values: usize,
        /// Vertices of the patch.
        vertices: usize,
    },
    /// The voxel size is zero, negative, infinite or not a number.
    #[error("the voxel size must be a positive number, not {0}")]
    Voxel(f64),
    /// The resolution is zero.
    #[error("the resolution must be at least 1")]
    Resolution,
    /// The voxel size is half of the thickness or more (\[WC13\] Remark 1).
    #[error(
        "voxel size {voxel:.6} is too coarse for thickness {thickness:.6}: it must be less than half of it; choose \
         a voxel size below {:.6}, or leave it out", 0.5 * .thickness
    )]
    TooCoarse {
        /// The voxel size.
        voxel: f64,
        /// The thickness.
        thickness: f64,
    },
    /// A length is too large or too small to work with ([`LENGTHS`]).
    #[error("the {what} is {length:e}, and lengths from {:e} to {:e} can be worked with; choose another one", LENGTHS.start(), LENGTHS.end())]
    Length {
        /// Which length.
        what: &'static str,
        /// The length.
        length: f64,
    },
    /// Lattice indices would leave the range of 32-bit integers.
    #[error(
        "with voxel size {voxel} the solid spans more than 2^30 lattice indices from the origin; choose a voxel size \
         of at least {smallest}, or move the patch towards the origin"
    )]
    Range {
        /// The voxel size.
        voxel: f64,
        /// The smallest voxel size that works.
        smallest: f64,
    },
    /// The patch cannot be thickened.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// The lattice is too coarse for a place of the patch, also after all halvings.
    #[error(
        "the solid cannot be closed near {}: {obstacle}, with voxel size {voxel:.6}; choose a \
         smaller voxel size or thickness, or mend the patch there", Point(*.at)
    )]
    Obstacle {
        /// What is in the way.
        obstacle: Obstacle,
        /// Where.
        at: [f64; 3],
        /// The last voxel size that was tried.
        voxel: f64,
    },
}

/// What is wrong with a patch.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatchError {
    /// There is no triangle.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A vertex or a triangle cannot be worked with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An edge has more than two triangles.
    #[error("the patch is not 2-manifold: the edge from {} to {} has more than two triangles", Point(.ends[0]), Point(.ends[1]))]
    NonManifoldEdge {
        /// Its ends.
        ends: [[f64; 3]; 2],
    },
    /// The triangles of an edge do not agree on the outside.
    #[error(
        "the patch is not consistently oriented: the triangles at the edge from {} to {} run the same way; reorient \
         them (a surface with one side only cannot be thickened)", Point(.ends[0]), Point(.ends[1])
    )]
    Misoriented {
        /// Its ends.
        ends: [[f64; 3]; 2],
    },
    /// A part of the patch touches the inside of another one in a vertex.
    #[error("parts of the patch touch in the vertex at {}, inside one of them: separate them there", Point(*.at))]
    NonManifoldVertex {
        /// The vertex.
        at: [f64; 3],
    },
    /// The patch intersects itself.
    #[error("the patch intersects itself: triangles {} and {} meet near {}", .triangles[0], .triangles[1], Point(*.at))]
    Intersects {
        /// Two of its triangles, numbered from 0.
        triangles: [u32; 2],
        /// Where they meet.
        at: [f64; 3],
    },
    /// A triangle has no area, or two vertices are one, once coordinates are rounded as they will be written.
    #[error(
        "triangle {triangle} near {} has no area in the coordinates of the output; write 64-bit coordinates, or drop it",
        Point(*.at)
    )]
    Degenerate {
        /// The triangle, numbered from 0.
        triangle: u32,
        /// One of its corners.
        at: [f64; 3],
    },
}

/// What kept a solid from being closed on a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// The solid's section has a rim where the patch has no boundary: sheets are nearer to each other than the lattice sees.
    Sheets,
    /// Boundary loops of the patch are nearer to each other than the lattice sees.
    Loops,
    /// A boundary loop has no rim of the section near it.
    Hole,
    /// The ribbon between a boundary loop and the section cannot do without intersections.
    Ribbon,
    /// The section or the shell meets the patch.
    Shell,
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Obstacle::Sheets => "sheets of the patch are too near to each other",
            Obstacle::Loops => "boundary loops of the patch are too near to each other",
            Obstacle::Hole => "a boundary loop is too narrow for a wall",
            Obstacle::Ribbon => "the wall along the boundary would intersect something",
            Obstacle::Shell => "the wall or the shell would meet the patch",
        })
    }
}

/// A point in messages.
struct Point([f64; 3]);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "({x:.6}, {y:.6}, {z:.6})")
    }
}

/// A place where a lattice does not do.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blocked {
    pub obstacle: Obstacle,
    pub at: [f64; 3],
    /// A boundary edge of each loop that is in the way there and elsewhere.
    pub edges: Vec<[u32; 2]>,
}
