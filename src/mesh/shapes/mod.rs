//! Generated models, for tests, demonstrations and measurements.
//!
//! Each is a function of a level of detail: about that many triangle sides per unit of length (the
//! models are two to three units long). The same detail gives the same mesh, bit by bit, on one
//! platform.
//!
//! All but [`wave`] are closed: every directed edge occurs exactly once together with its opposite,
//! triangles are counter-clockwise seen from outside, none is degenerate, and no two intersect.
//! Creases are exact: the vertices of a crease lie on the curve where the two ideal surfaces meet.
//!
//! ```
//! use exocarp::shapes;
//!
//! let mesh = shapes::carved_cube(shapes::DEFAULT_DETAIL);
//! let carved = shapes::by_name("carved_cube").unwrap();
//! let volume = carved.volume.unwrap().value();
//! assert!((mesh.signed_volume() - volume).abs() < 0.002 * volume);
//! ```

mod anchor;
mod blocks;
mod builder;
mod carved_cube;
mod catalogue;
mod flower;
mod open;
mod round;
mod spheres;
#[cfg(test)]
mod tests;

pub use carved_cube::carved_cube;
pub use catalogue::{ALL, Shape, by_name};
pub use open::wave;
pub use spheres::sphere;

// The others are found by their names.
#[doc(hidden)]
pub use {
    anchor::anchor,
    blocks::{bracket, cube, fin, hollow_box, needle, wedge},
    catalogue::{DEFAULT_DETAIL, Volume},
    flower::flower,
    round::{cylinder, linked_tori, torus},
    spheres::{NEAR_GAP, near_spheres, touching_spheres},
};
