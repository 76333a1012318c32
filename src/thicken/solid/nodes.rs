//! Which nodes are in the solid (\[WC13\] section 3): those of the band around S whose closest triangle says so.

use super::one_sided::OneSided;
use super::region::{Place, Solid};
use crate::band::{BandSettings, NodeTriangles, PartTriangles, SignField, build_with_policy};
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::error::Error;
use crate::lattice::{Ijk, LEAF_SIZE, Lattice, LeafMask, Slab};
use crate::run::{RunSettings, SHARE};
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use rayon::prelude::*;
use std::convert::Infallible;

/// The band of all nodes that can be in the solid or next to it.
#[derive(Debug)]
pub(crate) struct Nodes {
    origins: Vec<Ijk>,
    /// Leaf by leaf 512 closest triangles; -1 beyond the band, and where nobody needs them. In the pieces in which they were made.
    closest: Vec<Vec<i32>>,
    /// Leaf by leaf the nodes that are known to be in the solid.
    inside: Vec<LeafMask>,
    /// Leaves that are in the solid as a whole.
    whole: Vec<Ijk>,
}

/// Where nodes are looked for, in model units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// The distance from the mesh up to which they matter.
    pub reach: f64,
    /// What is clearly more than this over the mesh does not.
    pub above: f64,
    /// Distances that are sure to be in the solid where the closest point is not on the boundary, with all nodes beside.
    pub inside: [f64; 2],
}

impl Nodes {
    /// The nodes of the candidate region of \[WC13\] Definition 4, on one side of the mesh, and the triangles near them.
    pub fn new(
        distance: &SignedDistance,
        boundary: &Boundary,
        lattice: Lattice,
        Extent { reach, above, inside }: Extent,
        run: &RunSettings,
    ) -> Result<(Nodes, CandidateLists), Error> {
        let settings = BandSettings { lattice, r: 0.0, half_width: reach / lattice.voxel, slab: Slab::WHOLE };
        let at_boundary = boundary.triangles(distance.mesh());
        let policy = OneSided { max_height: above, sure_inside: inside, at_boundary: &at_boundary };
        let mut nodes =
            Nodes { origins: Vec::new(), closest: Vec::new(), inside: Vec::new(), whole: Vec::new() };
        let mut lists = Vec::new();
        build_with_policy(distance, &settings, policy, run, |batch| {
            nodes.origins.extend_from_slice(&batch.origins);
            nodes.inside.extend_from_slice(&batch.inside);
            nodes.whole.extend(batch.inside_blocks.iter().map(|&(origin, _)| origin));
            nodes.closest.push(batch.closest);
            lists.push((batch.origins, batch.lists));
            Ok::<_, Error>(())
        })?;
        Ok((nodes, CandidateLists::new(lattice, lists)))
    }

    /// Which of them are in the solid, and the closest triangles of all.
    pub fn classify(
        self,
        solid: &Solid<'_>,
        lattice: Lattice,
        run: &RunSettings,
    ) -> (SignField, NodeTriangles) {
        run.install(|| {
            let leaves: Vec<&[i32]> =
                self.closest.iter().flat_map(|part| part.chunks_exact(LEAF_SIZE)).collect();
            let mut inside: Vec<LeafMask> = self
                .origins
                .par_iter()
                .zip(leaves)
                .zip(&self.inside)
                .with_max_len(SHARE)
                .map(|((&origin, closest), known)| {
                    let found = inside_in_leaf(solid, lattice, origin, closest);
                    std::array::from_fn(|x| found[x] | known[x])
                })
                .collect();
            inside.resize(self.origins.len() + self.whole.len(), [!0; 8]);
            let origins = [&self.origins[..], &self.whole].concat();
            // Nodes beyond the band are farther from S than the shell, or over S.
            let outside = |missing: &[Ijk]| Ok::<_, Infallible>(vec![false; missing.len()]);
            let signs = match SignField::new(&origins, &inside, Slab::WHOLE, outside) {
                Ok(signs) => signs,
                Err(never) => match never {},
            };
            let parts = self.closest.into_par_iter().map(|part| PartTriangles::new(&part)).collect();
            let triangles = NodeTriangles::new(&signs, &self.origins, parts);
            (signs, triangles)
        })
    }
}

fn inside_in_leaf(solid: &Solid<'_>, lattice: Lattice, origin: Ijk, closest: &[i32]) -> LeafMask {
    let mut mask = [0; 8];
    for (number, &triangle) in closest.iter().enumerate() {
        let Ok(triangle) = u32::try_from(triangle) else { continue };
        let p = DVec3::from(lattice.world_from_index(Ijk::in_leaf(origin, number)));
        let sample = solid.distance.from_triangle(p, triangle);
        if solid.place(p, &sample) == Place::Inside {
            mask[number >> 6] |= 1 << (number & 63);
        }
    }
    mask
}
