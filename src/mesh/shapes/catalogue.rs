//! The list of generated models, with their volumes.

use super::{
    anchor, blocks, bracket, carved_cube, cube, cylinder, fin, flower, hollow_box, linked_tori, near_spheres,
    needle, round, sphere, torus, touching_spheres, wave, wedge,
};
use crate::mesh::TriMesh;
use std::f64::consts::PI;

/// The detail that gives each model some thousand to some ten thousand triangles.
pub const DEFAULT_DETAIL: u32 = 16;

/// A generated model.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// The name used on the command line.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Makes the mesh with about this many triangle sides per unit of length; less than 2 counts
    /// as 2.
    pub make: fn(detail: u32) -> TriMesh,
    /// The enclosed volume in cubic units; `None` for an open patch.
    pub volume: Option<Volume>,
}

/// A closed-form volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Volume {
    /// The mesh has this volume, up to rounding: all faces are flat.
    Exact(f64),
    /// The mesh approaches this volume with the inverse square of the detail.
    Limit(f64),
}

impl Volume {
    /// Returns the number, in cubic units.
    pub fn value(self) -> f64 {
        match self {
            Volume::Exact(v) | Volume::Limit(v) => v,
        }
    }
}

/// Returns the model with this name. Hyphens count as underscores.
pub fn by_name(name: &str) -> Option<&'static Shape> {
    let name = name.replace('-', "_");
    ALL.iter().find(|s| s.name == name)
}

/// All generated models.
pub static ALL: &[Shape] = &[
    Shape {
        name: "sphere",
        about: "geodesic unit sphere",
        make: sphere,
        volume: Some(Volume::Limit(4.0 / 3.0 * PI)),
    },
    Shape { name: "box", about: "cube of side 2", make: cube, volume: Some(Volume::Exact(8.0)) },
    Shape {
        name: "cylinder",
        about: "cylinder of radius 1 and height 2",
        make: cylinder,
        volume: Some(Volume::Limit(2.0 * PI)),
    },
    Shape {
        name: "torus",
        about: "torus of radii 1 and 0.4",
        make: torus,
        volume: Some(Volume::Limit(ring_volume(round::TORUS))),
    },
    Shape {
        name: "linked_tori",
        about: "two tori linked like a chain, not touching",
        make: linked_tori,
        volume: Some(Volume::Limit(2.0 * ring_volume(round::LINK))),
    },
    Shape {
        name: "carved_cube",
        about: "cube with spherical and cylindrical bites, sharp creases",
        make: carved_cube,
        volume: Some(Volume::Limit(carved_cube::VOLUME)),
    },
    Shape {
        name: "anchor",
        about: "plate with bolt holes, slots and a bored conical boss",
        make: anchor,
        volume: Some(Volume::Limit(anchor::VOLUME)),
    },
    Shape {
        name: "bracket",
        about: "L-bracket with a hole through each leg",
        make: bracket,
        volume: Some(Volume::Limit(BRACKET_VOLUME)),
    },
    Shape {
        name: "flower",
        about: "star-shaped flower with concave creases and a sharp rim",
        make: flower,
        volume: Some(Volume::Limit(flower::VOLUME)),
    },
    Shape {
        name: "touching_spheres",
        about: "two unit spheres that share one vertex",
        make: touching_spheres,
        volume: Some(Volume::Limit(8.0 / 3.0 * PI)),
    },
    Shape {
        name: "near_spheres",
        about: "two unit spheres 0.001 apart",
        make: near_spheres,
        volume: Some(Volume::Limit(8.0 / 3.0 * PI)),
    },
    Shape {
        name: "fin",
        about: "block with an upright fin 0.02 thick",
        make: fin,
        volume: Some(Volume::Exact(2.0 + 1.6 * 0.8 * blocks::FIN_THICKNESS)),
    },
    Shape {
        name: "wedge",
        about: "wedge with a knife edge of 11 degrees",
        make: wedge,
        volume: Some(Volume::Exact(4.0 * blocks::WEDGE_HALF_WIDTH)),
    },
    Shape {
        name: "needle",
        about: "four-sided spike, twenty times as long as wide",
        make: needle,
        volume: Some(Volume::Exact(8.0 / 3.0 * blocks::NEEDLE_HALF_SIDE * blocks::NEEDLE_HALF_SIDE)),
    },
    Shape {
        name: "hollow_box",
        about: "cube with a spherical cavity inside",
        make: hollow_box,
        volume: Some(Volume::Limit(8.0 - 4.0 / 3.0 * PI * CAVITY_CUBED)),
    },
    Shape { name: "wave", about: "open wavy patch over a square of side 2", make: wave, volume: None },
];

const CAVITY_CUBED: f64 = blocks::CAVITY_RADIUS * blocks::CAVITY_RADIUS * blocks::CAVITY_RADIUS;

const BRACKET_VOLUME: f64 = {
    let (leg, thickness, width, radius) = blocks::BRACKET;
    thickness * (width * (2.0 * leg - thickness) - 2.0 * PI * radius * radius)
};

const fn ring_volume((major, minor): (f64, f64)) -> f64 {
    2.0 * PI * PI * major * minor * minor
}
