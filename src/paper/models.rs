//! The paper's models, and what stands for them here.
//!
//! Only the rocker arm is the same model; the dragon is another scan of a dragon, the anchor
//! another plate of the kind. The others stand for their kind: a sharp machine part, a statue, a
//! thing with many holes.

use super::PaperError;
use crate::io;
use crate::mesh::{Topology, TriMesh, clean, shapes};
use crate::offset::OpenInput;
use crate::run::RunSettings;
use std::path::PathBuf;

/// A model of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum PaperModel {
    CarveCube,
    AnchorPlate,
    OctaFlower,
    Dragon,
    VaseLion,
    Rabbit,
    Chair,
    RockerArm,
    Warrior,
    Filigree,
    Buddha,
}

/// A stand-in for a model.
struct StandIn {
    /// The paper's name.
    name: &'static str,
    /// Names of files without extension, the first that is there.
    files: &'static [&'static str],
    /// The generated model otherwise, and its detail: about the paper's number of triangles up to
    /// 50,000.
    shape: (&'static str, u32),
}

impl PaperModel {
    #[cfg(test)]
    pub const ALL: [PaperModel; 11] = [
        PaperModel::CarveCube,
        PaperModel::AnchorPlate,
        PaperModel::OctaFlower,
        PaperModel::Dragon,
        PaperModel::VaseLion,
        PaperModel::Rabbit,
        PaperModel::Chair,
        PaperModel::RockerArm,
        PaperModel::Warrior,
        PaperModel::Filigree,
        PaperModel::Buddha,
    ];

    fn stand_in(self) -> StandIn {
        let stand_in = |name, files, shape| StandIn { name, files, shape };
        match self {
            PaperModel::CarveCube => stand_in("Carve-cube", &["fandisk"], ("carved_cube", 14)),
            PaperModel::AnchorPlate => stand_in("Anchor-plate", &["anchor_dense", "anchor"], ("anchor", 14)),
            PaperModel::OctaFlower => stand_in("Octa-flower", &["flower"], ("flower", 20)),
            PaperModel::Dragon => stand_in("Dragon", &["dragon"], ("linked_tori", 20)),
            PaperModel::VaseLion => stand_in("Vase-lion", &["armadillo"], ("near_spheres", 32)),
            PaperModel::Rabbit => stand_in("Rabbit", &["bunny00", "bunny"], ("sphere", 32)),
            PaperModel::Chair => stand_in("Chair", &["elephant"], ("bracket", 16)),
            PaperModel::RockerArm => stand_in("Rock-arm", &["rocker-arm"], ("cylinder", 24)),
            PaperModel::Warrior => stand_in("Terracotta-warrior", &["armadillo"], ("torus", 16)),
            PaperModel::Filigree => stand_in("Filigree", &["cheese"], ("linked_tori", 24)),
            PaperModel::Buddha => stand_in("Buddha", &["dragon"], ("hollow_box", 32)),
        }
    }

    /// The paper's name.
    pub fn name(self) -> &'static str {
        self.stand_in().name
    }
}

/// A model to measure on.
#[derive(Debug)]
pub(super) struct Model {
    /// The name of the stand-in.
    pub name: String,
    pub mesh: TriMesh,
    pub topology: Topology,
    pub open_input: OpenInput,
}

impl Model {
    /// Loads or generates what stands for `of`. `cuts` divides each side of each triangle, which
    /// keeps the surface and gives `cuts`^2 times the triangles.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn load(
        of: PaperModel,
        files: &[PathBuf],
        cuts: u32,
        run: &RunSettings,
    ) -> Result<Model, PaperError> {
        run.check()?;
        let stand_in = of.stand_in();
        let file = stand_in.files.iter().find_map(|name| {
            files.iter().find(|file| {
                file.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case(name))
                    && io::Format::of(file).is_ok()
            })
        });
        let (mesh, mut name) = match file {
            Some(file) => {
                let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                (run.install(|| io::load::load(file))?, stem)
            }
            None => {
                let (name, detail) = stand_in.shape;
                let shape = shapes::by_name(name).expect("stand-ins are in the list of shapes");
                ((shape.make)(detail), format!("{name} {detail}"))
            }
        };
        let (mesh, _) = run.install(|| clean(mesh));
        let mesh = if cuts > 1 { refined(&mesh, cuts) } else { mesh };
        if cuts > 1 {
            name += &format!(" / {cuts}");
        }
        let topology = run.install(|| Topology::new(&mesh));
        let defects = topology.defects();
        let solid = defects.first_boundary.is_none() && defects.first_misoriented.is_none();
        let open_input = if solid { OpenInput::Refuse } else { OpenInput::Accept };
        Ok(Model { name, mesh, topology, open_input })
    }
}

/// Each triangle cut into `cuts`^2 similar ones, then welded.
fn refined(mesh: &TriMesh, cuts: u32) -> TriMesh {
    let mut fine = TriMesh::default();
    let n = f64::from(cuts);
    for (t, numbers) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(t);
        // Points are summed in the order of the vertex numbers, so that both sides of an edge get
        // the same bits.
        let mut order = [0, 1, 2];
        order.sort_unstable_by_key(|&i| numbers[i]);
        let point = |weights: [u32; 3]| -> [f64; 3] {
            if let Some(i) = weights.iter().position(|&w| w == cuts) {
                return corners[i];
            }
            std::array::from_fn(|a| order.iter().map(|&i| f64::from(weights[i]) / n * corners[i][a]).sum())
        };
        for i in 0..cuts {
            for j in 0..cuts - i {
                let at = |i: u32, j: u32| point([cuts - i - j, i, j]);
                push(&mut fine, [at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < cuts {
                    push(&mut fine, [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    clean(fine).0
}

fn push(mesh: &mut TriMesh, corners: [[f64; 3]; 3]) {
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::measure;

    #[test]
    fn all_generated_stand_ins_are_solids() {
        let run = RunSettings::with_threads(2).unwrap();
        for model in PaperModel::ALL {
            let loaded = Model::load(model, &[], 1, &run).unwrap();
            assert_eq!(loaded.open_input, OpenInput::Refuse, "{}", model.name());
            assert!(
                (1_000..60_000).contains(&loaded.mesh.triangles.len()),
                "{model:?} {}",
                loaded.mesh.triangles.len()
            );
        }
    }

    #[test]
    fn finer_triangles_are_the_same_solid() {
        let mesh = shapes::anchor(6);
        for cuts in [2, 3] {
            let fine = refined(&mesh, cuts);
            assert_eq!(fine.triangles.len(), mesh.triangles.len() * (cuts * cuts) as usize);
            assert!(Topology::new(&fine).defects().is_closed());
            let volumes = [&mesh, &fine].map(measure::signed_volume);
            assert!((volumes[0] / volumes[1] - 1.0).abs() < 1e-12);
        }
    }
}
