//! The policy of the band around S: of its nodes only those on the side of the solid matter.

use crate::band::{BlockCandidates, BlockState, LeafPolicy};

/// The band of an open mesh for a solid on its negative side. Signs of distances jump where an open
/// mesh has no surface, so the band has none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneSided<'a> {
    /// Maximum height, in model units, of nodes over the planes of all triangles that can be
    /// closest to them. Higher nodes are left out: whatever feature of these triangles they are
    /// closest to, they are on its positive side.
    pub max_height: f64,
    /// Least and largest distance, in model units, of nodes that are sure to be inside the solid.
    /// Such nodes must be under the planes of all triangles that can be closest to them, and none
    /// of these triangles may be at the boundary.
    pub sure_inside: [f64; 2],
    /// Per triangle, whether a vertex of it is on the boundary.
    pub at_boundary: &'a [bool],
}

impl LeafPolicy for OneSided<'_> {
    const IS_SIGNED: bool = false;

    fn decide(&self, block: &BlockCandidates<'_>) -> Option<BlockState> {
        if block.is_above(self.max_height) {
            return Some(BlockState::Unwanted);
        }
        let [least, most] = block.distances();
        if least <= self.sure_inside[0] || most >= self.sure_inside[1] {
            return None;
        }
        let at_boundary = |triangle: u32| self.at_boundary[triangle as usize];
        block.is_below(at_boundary).then_some(BlockState::Inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::band::{BandSettings, build_with_policy, grid_nodes};
    use crate::distance::SignedDistance;
    use crate::geom::aabb::Aabb;
    use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, Lattice, Slab};
    use crate::mesh::Topology;
    use crate::run::{Cancelled, RunSettings};
    use glam::DVec3;
    use std::collections::{HashMap, HashSet};

    #[test]
    fn below_an_open_mesh_nodes_are_known_or_not_wanted() {
        let mesh = (crate::mesh::shapes::by_name("wave").unwrap().make)(24);
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let lattice = Lattice { voxel: 0.05 };
        let settings = BandSettings { lattice, r: 0.0, half_width: 6.0, slab: Slab::WHOLE };
        // A vertex has more neighbours than triangles where it is on the boundary.
        let is_on_boundary = |v: u32| {
            let around = topology.around_vertex(v);
            let neighbours: HashSet<u32> =
                around.iter().flat_map(|&t| mesh.triangles[t as usize]).filter(|&w| w != v).collect();
            neighbours.len() > around.len()
        };
        let at_boundary: Vec<bool> =
            mesh.triangles.iter().map(|t| t.iter().any(|&v| is_on_boundary(v))).collect();
        assert!(at_boundary.iter().any(|b| *b) && at_boundary.iter().any(|b| !b));
        let (max_height, sure_inside) = (0.02, [0.08, 0.22]);
        let run = RunSettings::with_threads(2).unwrap();
        // What is known of each node: its closest triangle, or that it is inside.
        let mut closest: HashMap<Ijk, u32> = HashMap::new();
        let mut known: HashSet<Ijk> = HashSet::new();
        let policy = OneSided { max_height, sure_inside, at_boundary: &at_boundary };
        build_with_policy(&distance, &settings, policy, &run, |batch| {
            assert!(batch.values.is_empty());
            for (n, &origin) in batch.origins.iter().enumerate() {
                for number in 0..LEAF_SIZE {
                    let node = Ijk::in_leaf(origin, number);
                    if let Ok(triangle) = u32::try_from(batch.closest[n * LEAF_SIZE + number]) {
                        closest.insert(node, triangle);
                    }
                    if batch.inside[n][number >> 6] >> (number & 63) & 1 == 1 {
                        known.insert(node);
                    }
                }
            }
            for &(origin, side) in &batch.inside_blocks {
                assert_eq!(side, LEAF_DIM);
                known.extend((0..LEAF_SIZE).map(|number| Ijk::in_leaf(origin, number)));
            }
            Ok::<_, Cancelled>(())
        })
        .unwrap();
        let (mut evaluated, mut left_out) = (0, 0);
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let [lo, hi] = grid_nodes(bounds, &settings);
        for x in lo.0[0]..=hi.0[0] {
            for y in lo.0[1]..=hi.0[1] {
                for z in lo.0[2]..=hi.0[2] {
                    let node = Ijk::new(x, y, z);
                    let sample = distance.at(DVec3::from(lattice.world_from_index(node)), 0);
                    let away = sample.distance.abs();
                    if known.contains(&node) {
                        assert!(sample.distance < 0.0, "{node:?} {sample:?}");
                        assert!((sure_inside[0]..sure_inside[1]).contains(&away), "{node:?} {sample:?}");
                        assert!(!at_boundary[sample.triangle as usize], "{node:?} {sample:?}");
                    } else if let Some(&triangle) = closest.get(&node) {
                        assert_eq!(triangle, sample.triangle, "{node:?}");
                        evaluated += 1;
                    } else if away < 0.99 * f64::from(settings.background()) {
                        assert!(sample.distance > max_height, "{node:?} {sample:?} is wanted and unknown");
                        left_out += 1;
                    }
                }
            }
        }
        let known = known.len();
        assert!(evaluated > 1_000 && left_out > 1_000 && known > 1_000, "{evaluated} {left_out} {known}");
    }
}
