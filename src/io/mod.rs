//! Meshes in and out: OBJ, PLY, STL and OFF, chosen by the file's extension.
//!
//! | format | read | written |
//! |---|---|---|
//! | OBJ | `v` and `f`; polygons, negative numbers, `v/vt/vn` corners, continued lines | text |
//! | PLY | ascii and binary of both byte orders, further elements and properties, triangle strips | binary, little-endian |
//! | STL | binary and ascii, several solids | binary |
//! | OFF | also `COFF`, `NOFF`, `STOFF`; comments; counts on the first line; without keyword | text |
//!
//! [`TriMesh::load`](crate::TriMesh::load) returns the mesh *as it stands in the file*: vertices
//! and triangles in the file's order, nothing welded, nothing dropped but what is not finite;
//! [`clean`](crate::clean()) is the next step. Text may have the line ends of any system and a byte
//! order mark. Polygons are triangulated: quads along the shorter diagonal that leaves two
//! triangles of like orientation, larger ones by cutting ears, so that concave faces do not fold.
//! Files are streamed: beside the mesh there is a fixed buffer, except for OBJ, where the parser
//! holds about 100 bytes for each vertex and face until the end of the file.
//!
//! Where a file is wrong but leaves no doubt of the mesh, it is read, and [`load_with_notes`] says
//! what was passed over: vertices with a coordinate that is not finite (left out, with the faces
//! that have them), a number of triangles in binary STL that does not fit the file's size, lines in
//! a PLY header that begin with no keyword.
//!
//! # Promises
//! - No file makes loading panic, and no header makes it allocate more than the file's size
//!   justifies: the result is a mesh with finite coordinates, vertex numbers in range and at least
//!   one triangle, or a [`LoadError`] that names file, place, cause and remedy (fuzzed in
//!   `tests.rs`).
//! - [`save`] replaces an existing file whole and only when the new one is complete: the content
//!   goes to a temporary file beside it, which is renamed. A failure leaves the old file and no
//!   other.
//! - A mesh that was saved loads again with the same triangles and the same coordinates: those of
//!   the mesh rounded to f32, or as they are with [`Precision::F64`](crate::Precision),
//!   which STL has not. So do text formats: readers of 32 and of 64 bits get the same numbers.

pub(crate) mod atomic;
pub(crate) mod error;
mod format;
pub(crate) mod load;
pub(crate) mod loaded;
mod mesh_tiles;
mod obj;
mod off;
mod ply;
mod polygon;
mod save;
mod stl;
mod stream;
#[cfg(test)]
mod tests;
mod text;
pub(crate) mod tile;

pub use error::{LoadError, LoadErrorKind, Location, SaveError, SaveErrorKind};
pub use format::Format;
pub use load::load_with_notes;
pub use loaded::{Loaded, Note};
pub use mesh_tiles::{merge_tiles, save_tile};
pub use save::{SaveOptions, save};
pub use stream::MeshStream;
pub use tile::{MergeError, MergeErrorKind, Tile};
