//! Why a patch cannot be thickened.

use crate::contour::ContourError;
use crate::lattice::LatticeError;
use crate::mesh::{LENGTHS, MeshError};
use crate::offset::{MemoryError, OffsetError};
use crate::run::Cancelled;
use std::fmt;

/// Why [`thicken`](super::thicken) refused its settings or its patch, or gave up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ThickenError {
    /// A setting makes no sense, by itself or for this patch.
    #[error(transparent)]
    Settings(#[from] ThickenSettingsError),
    /// The patch cannot be thickened.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// The lattice is too coarse for a place of the patch, also after all halvings.
    #[error(
        "the solid cannot be closed near {}: {obstacle}, with voxel size {voxel:.6}; choose a \
         smaller voxel size or thickness, or mend the patch there", Point(*.at)
    )]
    Obstacle {
        /// The obstacle.
        obstacle: Obstacle,
        /// A point near the obstacle.
        at: [f64; 3],
        /// The last voxel size that was tried, in model units.
        voxel: f64,
    },
    /// The work would not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The lattice is too fine for the indices or the precision.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The offset that a closed patch needs cannot be made.
    #[error(transparent)]
    Offset(OffsetError),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for ThickenError {
    fn from(Cancelled: Cancelled) -> Self {
        ThickenError::Cancelled
    }
}

impl From<ContourError> for ThickenError {
    fn from(error: ContourError) -> Self {
        OffsetError::from(error).into()
    }
}

impl From<OffsetError> for ThickenError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Cancelled => ThickenError::Cancelled,
            OffsetError::Memory(error) => ThickenError::Memory(error),
            OffsetError::Lattice(error) => ThickenError::Lattice(error),
            other => ThickenError::Offset(other),
        }
    }
}

/// A setting of a thickening that makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ThickenSettingsError {
    /// The thickness is zero, negative, infinite or not a number.
    #[error("the thickness must be a positive number, not {0}")]
    Thickness(f64),
    /// The thickness map does not belong to the patch.
    #[error("the thickness map has {values} values, and the patch {vertices} vertices")]
    Map {
        /// Number of values in the map.
        values: usize,
        /// Number of vertices of the patch.
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
        /// The voxel size, in model units.
        voxel: f64,
        /// The thickness, in model units.
        thickness: f64,
    },
    /// A length is too large or too small to work with ([`LENGTHS`]).
    #[error("the {what} is {length:e}, and lengths from {:e} to {:e} can be worked with; choose another one", LENGTHS.start(), LENGTHS.end())]
    Length {
        /// Name of the length, for messages.
        what: &'static str,
        /// The length, in model units.
        length: f64,
    },
    /// Lattice indices would leave the range of 32-bit integers.
    #[error(
        "with voxel size {voxel} the solid spans more than 2^30 lattice indices from the origin; choose a voxel size \
         of at least {smallest}, or move the patch towards the origin"
    )]
    Range {
        /// The voxel size, in model units.
        voxel: f64,
        /// The smallest voxel size that works, in model units.
        smallest: f64,
    },
}

/// A fault of a patch.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatchError {
    /// The patch has no triangle.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A vertex or a triangle cannot be worked with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An edge has more than two triangles.
    #[error("the patch is not 2-manifold: the edge from {} to {} has more than two triangles", Point(.ends[0]), Point(.ends[1]))]
    NonManifoldEdge {
        /// Both ends of the edge.
        ends: [[f64; 3]; 2],
    },
    /// The triangles of an edge do not agree on the outside.
    #[error(
        "the patch is not consistently oriented: the triangles at the edge from {} to {} run the same way; reorient \
         them (a surface with one side only cannot be thickened)", Point(.ends[0]), Point(.ends[1])
    )]
    Misoriented {
        /// Both ends of the edge.
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
        /// The first two triangles that meet, numbered from 0.
        triangles: [u32; 2],
        /// A point of both triangles.
        at: [f64; 3],
    },
    /// A triangle has no area once coordinates are rounded as they will be written.
    #[error(
        "triangle {triangle} near {} has no area in the coordinates of the output; write 64-bit coordinates, or drop it",
        Point(*.at)
    )]
    Degenerate {
        /// The triangle, numbered from 0.
        triangle: u32,
        /// One of the triangle's vertices.
        at: [f64; 3],
    },
}

/// A reason why a solid could not be closed on a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// The section has a rim where the patch has no boundary: sheets of the patch are nearer to
    /// each other than the lattice resolves.
    Sheets,
    /// Boundary loops of the patch are nearer to each other than the lattice resolves.
    Loops,
    /// A boundary loop has no rim of the section near it.
    Hole,
    /// Every strip between a boundary loop and the section would intersect something.
    Strip,
    /// The section or the shell meets the patch.
    Shell,
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Obstacle::Sheets => "sheets of the patch are too near to each other",
            Obstacle::Loops => "boundary loops of the patch are too near to each other",
            Obstacle::Hole => "a boundary loop is too narrow for a wall",
            Obstacle::Strip => "the wall along the boundary would intersect something",
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
