//! Geometry below everything else: points, triangles and pairs of them, swept spheres, roots,
//! predicates, small matrices.

pub mod aabb;
pub mod box_tree;
pub mod simd;
pub mod predicates;
pub mod quadric;
pub mod roots;
pub mod swept;
pub mod sym3;
pub mod triangle;
pub mod triangle_pair;
pub(crate) mod union_find;
