//! The data that all parts of a verification share: INPUT with its distance, OUTPUT with its tree,
//! the scale.

use super::error::{MeshRole, VerifyError};
use super::sampling::{Random, Scale};
use super::settings::{Subject, VerifySettings};
use super::welded::{Welded, check};
use crate::distance::SignedDistance;
use crate::geom::aabb::Aabb;
use crate::geom::box_tree::BoxTree;
use crate::mesh::{Topology, TriMesh, clean, measure};
use crate::quantity::Length;
use crate::run::RunSettings;
use crate::ssvh::Ssvh;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Both meshes: INPUT cleaned, OUTPUT welded.
#[derive(Debug)]
pub(super) struct Meshes {
    input: TriMesh,
    input_topology: Topology,
    output: Welded,
}

impl Meshes {
    /// Prepares both meshes.
    ///
    /// # Errors
    /// [`VerifyError::NoTriangles`], [`VerifyError::Mesh`].
    pub fn new(input: &TriMesh, output: &TriMesh) -> Result<Self, VerifyError> {
        check(input, MeshRole::Input)?;
        let (input, _) = clean(input.clone());
        let output = Welded::new(output, MeshRole::Output)?;
        for (which, mesh) in [(MeshRole::Input, &input), (MeshRole::Output, &output.mesh)] {
            if mesh.triangles.is_empty() {
                return Err(VerifyError::NoTriangles(which));
            }
        }
        let input_topology = Topology::new(&input);
        Ok(Meshes { input, input_topology, output })
    }
}

/// A verification in progress.
#[derive(Debug)]
pub(super) struct Case<'m> {
    pub settings: &'m VerifySettings,
    pub run: &'m RunSettings,
    /// Signed distance from INPUT.
    pub distance: SignedDistance<'m>,
    /// INPUT's triangles in an order in which neighbours in space are near each other.
    pub input_order: Vec<u32>,
    pub output: &'m Welded,
    /// A tree over OUTPUT's triangles with area.
    pub tree: BoxTree,
    output_ssvh: OnceLock<Ssvh>,
    /// Signed offset distance in model units.
    pub r: f64,
    pub scale: Scale,
    pub random: Random,
}

/// Share of the diagonal by which the distance of a point of the true offset surface may differ
/// from |D|: far above rounding (1e-16 of the coordinates), far below what an offset could be
/// judged by.
const EXACT: f64 = 1e-9;

impl<'m> Case<'m> {
    /// Builds everything but the hierarchy over OUTPUT, which not all parts need. Runs on the
    /// current rayon pool.
    ///
    /// # Errors
    /// - [`VerifyError::Setting`]: the distance is not finite for this INPUT.
    /// - [`VerifyError::Cancelled`].
    pub fn new(
        meshes: &'m Meshes,
        settings: &'m VerifySettings,
        run: &'m RunSettings,
    ) -> Result<Self, VerifyError> {
        let distance = SignedDistance::new(&meshes.input, &meshes.input_topology);
        run.check()?;
        let tree = BoxTree::new(
            &meshes.output.mesh.vertices,
            &meshes.output.mesh.triangles,
            meshes.output.with_area().into_par_iter(),
        );
        let all = 0..meshes.input.triangles.len() as u32;
        let input_order = BoxTree::new(&meshes.input.vertices, &meshes.input.triangles, all.into_par_iter())
            .order()
            .to_vec();
        let diagonal = Aabb::around(meshes.input.vertices.iter().map(|&v| DVec3::from(v))).diagonal();
        let r = match settings.distance {
            Length::Units(r) => r,
            Length::DiagonalFraction(fraction) => fraction * diagonal,
        };
        if !r.is_finite() {
            return Err(VerifyError::Setting { name: "distance", range: "a finite number", value: r });
        }
        Ok(Case {
            settings,
            run,
            distance,
            input_order,
            output: &meshes.output,
            tree,
            output_ssvh: OnceLock::new(),
            r,
            scale: Scale { diagonal, voxel: settings.voxel },
            random: Random::new(settings.seed),
        })
    }

    /// Returns the hierarchy over INPUT's triangles.
    pub fn input(&self) -> &Ssvh {
        self.distance.ssvh()
    }

    /// Returns the hierarchy over OUTPUT's triangles.
    pub fn output_ssvh(&self) -> &Ssvh {
        self.output_ssvh.get_or_init(|| Ssvh::new(&self.output.mesh))
    }

    /// Returns the amount, in model units, by which the distance of a point of the true offset
    /// surface may differ from |D|.
    pub fn exact(&self) -> f64 {
        EXACT * self.scale.diagonal
    }

    /// Returns the voxel size in model units. Without one, the mean area of OUTPUT's triangles
    /// suggests it: two triangles to the square of a voxel.
    pub fn voxel(&self) -> f64 {
        self.settings.voxel.unwrap_or_else(|| {
            let mesh = &self.output.mesh;
            (2.0 * measure::area(mesh) / mesh.triangles.len() as f64).sqrt()
        })
    }

    /// Whether OUTPUT is a shell.
    pub fn is_shell(&self) -> bool {
        matches!(self.settings.subject, Subject::Shell { .. })
    }

    /// Returns the unsigned distance from INPUT. `guess` is a triangle near `p`, and becomes the
    /// closest one.
    pub fn to_input(&self, p: DVec3, guess: &mut u32) -> f64 {
        let hit = self.input().closest_from(p, *guess);
        *guess = hit.triangle;
        hit.distance_squared.sqrt()
    }

    /// Returns the distance from OUTPUT. `guess` is a triangle near `p`, and becomes the closest
    /// one.
    pub fn to_output(&self, p: DVec3, guess: &mut u32) -> f64 {
        let hit = self.output_ssvh().closest_from(p, *guess);
        *guess = hit.triangle;
        hit.distance_squared.sqrt()
    }

    /// Returns the corners of a triangle of OUTPUT.
    pub fn corners(&self, t: u32) -> [DVec3; 3] {
        self.output.mesh.corners(t as usize).map(DVec3::from)
    }
}

/// Returns twice the area of a triangle, as a weight.
pub(super) fn weight([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length()
}
