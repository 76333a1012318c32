//! Nodes in the solid (\[WC13\] section 3): those of the band around S whose closest triangle says
//! so.

use super::one_sided::OneSided;
use super::region::{Region, Solid};
use crate::band::{BandSettings, NodeTriangles, PartTriangles, SignField, build_with_policy};
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::lattice::{Ijk, LEAF_SIZE, Lattice, LeafMask, Slab};
use crate::run::{RunSettings, SHARE};
use crate::thicken::ThickenError;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use rayon::prelude::*;
use std::convert::Infallible;

/// Band of all nodes that can be in the solid or next to it.
#[derive(Debug)]
pub(crate) struct Nodes {
    origins: Vec<Ijk>,
    /// Leaf by leaf 512 closest triangles, -1 beyond the band and where nobody needs them; in the
    /// batches in which they were made.
    closest: Vec<Vec<i32>>,
    /// Leaf by leaf, the nodes that are known to be in the solid.
    inside: Vec<LeafMask>,
    /// Origins of leaves that are in the solid as a whole.
    inside_leaves: Vec<Ijk>,
}

/// Range of the nodes that matter, in model units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeRange {
    /// Maximum distance from S.
    pub max_distance: f64,
    /// Maximum height over S. Nodes that are clearly higher are left out.
    pub max_height: f64,
    /// Least and largest distance of nodes that are in the solid, with all nodes next to them, if
    /// the closest point is not on the boundary.
    pub sure_inside: [f64; 2],
}

impl Nodes {
    /// Collects the nodes of the candidate region of \[WC13\] Definition 4 on one side of S, and
    /// the triangles near them.
    pub fn new(
        distance: &SignedDistance,
        boundary: &Boundary,
        lattice: Lattice,
        range: NodeRange,
        run: &RunSettings,
    ) -> Result<(Nodes, CandidateLists), ThickenError> {
        let settings = BandSettings {
            lattice,
            r: 0.0,
            half_width: range.max_distance / lattice.voxel,
            slab: Slab::WHOLE,
        };
        let at_boundary = boundary.triangles_at(distance.mesh());
        let policy = OneSided {
            max_height: range.max_height,
            sure_inside: range.sure_inside,
            at_boundary: &at_boundary,
        };
        let mut nodes =
            Nodes { origins: Vec::new(), closest: Vec::new(), inside: Vec::new(), inside_leaves: Vec::new() };
        let mut lists = Vec::new();
        build_with_policy(distance, &settings, policy, run, |batch| {
            nodes.origins.extend_from_slice(&batch.origins);
            nodes.inside.extend_from_slice(&batch.inside);
            nodes.inside_leaves.extend(batch.inside_blocks.iter().map(|&(origin, _)| origin));
            nodes.closest.push(batch.closest);
            lists.push((batch.origins, batch.lists));
            Ok::<_, ThickenError>(())
        })?;
        Ok((nodes, CandidateLists::new(lattice, lists)))
    }

    /// Finds the nodes that are in the solid. Returns them with the closest triangles of all nodes.
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
            inside.resize(self.origins.len() + self.inside_leaves.len(), [!0; 8]);
            let origins = [&self.origins[..], &self.inside_leaves].concat();
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

/// Returns the nodes of a leaf that are in the solid.
fn inside_in_leaf(solid: &Solid<'_>, lattice: Lattice, origin: Ijk, closest: &[i32]) -> LeafMask {
    let mut mask = [0; 8];
    for (number, &triangle) in closest.iter().enumerate() {
        let Ok(triangle) = u32::try_from(triangle) else { continue };
        let p = DVec3::from(lattice.world_from_index(Ijk::in_leaf(origin, number)));
        let sample = solid.distance.from_triangle(p, triangle);
        if solid.classify(p, &sample) == Region::Inside {
            mask[number >> 6] |= 1 << (number & 63);
        }
    }
    mask
}
