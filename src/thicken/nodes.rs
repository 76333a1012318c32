//! Which nodes are in the solid (\[WC13\] section 3): those of the band around S whose closest triangle says so.

use super::solid::{Place, Solid};
use crate::band::{BandSettings, LeafMask, SignField, build};
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::edge::NodeTriangles;
use crate::error::Error;
use crate::lattice::{Ijk, LEAF_SIZE, Lattice};
use crate::run::RunSettings;
use crate::slab::Slab;
use glam::DVec3;
use rayon::prelude::*;
use std::convert::Infallible;

/// The band of all nodes that can be in the solid or next to it.
#[derive(Debug)]
pub(super) struct Nodes {
    origins: Vec<Ijk>,
    /// Leaf by leaf 512 closest triangles; -1 beyond the band. In the pieces in which they were made.
    closest: Vec<Vec<i32>>,
    pub lists: CandidateLists,
}

impl Nodes {
    /// The nodes within `reach`, in model units, of the mesh: the candidate region of \[WC13\] Definition 4. A distance
    /// without its sign decides, since the sign of an open mesh's distance jumps.
    pub fn new(
        distance: &SignedDistance,
        lattice: Lattice,
        reach: f64,
        run: &RunSettings,
    ) -> Result<Nodes, Error> {
        let settings = BandSettings { lattice, r: 0.0, half_width: reach / lattice.voxel, slab: Slab::WHOLE };
        let (mut origins, mut closest, mut lists) = (Vec::new(), Vec::new(), Vec::new());
        build(distance, &settings, run, |batch| {
            origins.extend_from_slice(&batch.origins);
            closest.push(batch.closest);
            lists.push((batch.origins, batch.lists));
            Ok::<_, Error>(())
        })?;
        Ok(Nodes { origins, closest, lists: CandidateLists::new(lattice, lists) })
    }

    /// Which of them are in the solid, and the closest triangles of all.
    pub fn classify(
        &self,
        solid: &Solid<'_>,
        lattice: Lattice,
        run: &RunSettings,
    ) -> (SignField, NodeTriangles) {
        run.install(|| {
            let leaves: Vec<&[i32]> =
                self.closest.iter().flat_map(|part| part.chunks_exact(LEAF_SIZE)).collect();
            let inside: Vec<LeafMask> = self
                .origins
                .par_iter()
                .zip(leaves)
                .with_min_len(16)
                .map(|(&origin, closest)| inside_in_leaf(solid, lattice, origin, closest))
                .collect();
            // Nodes beyond the band are farther from S than the shell.
            let outside = |missing: &[Ijk]| Ok::<_, Infallible>(vec![false; missing.len()]);
            let signs = match SignField::new(&self.origins, &inside, Slab::WHOLE, outside) {
                Ok(signs) => signs,
                Err(never) => match never {},
            };
            let triangles = NodeTriangles::new(&signs, &self.origins, self.closest.clone());
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
