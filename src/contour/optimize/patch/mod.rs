//! A part of a finished mesh that can be changed without making it intersect itself.
//!
//! The mesh is embedded: triangles meet in the vertices and edges that they share, and nowhere
//! else. A vertex is moved, a triangle or an edge split, an edge flipped or collapsed, only if the
//! changed triangles meet no other triangle and not each other (`exact_test`). Exact predicates
//! decide that, on the coordinates as they will be written. Then the mesh is embedded afterwards,
//! whatever the reason of the change. Neighbours stay neighbours (`edits`) or meet under the link
//! condition (`collapse`), so the mesh stays closed and 2-manifold.
//!
//! All triangles that a change could meet must be in the patch. It holds every triangle whose box
//! meets its bounds, and no change reaches beyond them. Triangles are looked for by the leaf that
//! they belong to, so each of them also stays near that leaf ([`PatchTriangle::home`]).

mod bounds;
mod collapse;
mod edits;
mod exact_test;
mod index;
mod patch_mesh;
mod triangle;

pub use bounds::Bounds;
pub use patch_mesh::Patch;
pub use triangle::{PatchEdge, PatchTriangle};

#[cfg(test)]
mod tests;
