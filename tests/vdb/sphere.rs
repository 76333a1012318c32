//! The narrow band of a sphere, built by hand.

use exocarp::internals::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, Lattice, LeafMask};
use exocarp::vdb::Band;
use exocarp::vdb::{ClosestGrid, SurfaceGrid};

/// A sphere around the world origin.
#[derive(Clone, Copy)]
pub struct Sphere {
    pub radius: f64,
    pub voxel: f64,
    /// In voxels.
    pub half_width: f64,
}

/// Leaves as they cross the bridge.
#[derive(Default, Debug, PartialEq)]
pub struct Leaves {
    pub origins: Vec<Ijk>,
    pub values: Vec<f32>,
    pub active: Vec<LeafMask>,
    pub ids: Vec<i32>,
}

/// Position of a leaf.
enum Place {
    Band,
    Inside,
    Outside,
}

impl Sphere {
    pub fn lattice(&self) -> Lattice {
        Lattice { voxel: self.voxel }
    }

    /// Signed distance at a node.
    pub fn phi(&self, node: Ijk) -> f64 {
        let p = self.lattice().world_from_index(node);
        p.iter().map(|c| c * c).sum::<f64>().sqrt() - self.radius
    }

    /// The stored value: the distance clamped to the background, never 0.
    pub fn value(&self, node: Ijk, background: f32) -> f32 {
        let phi = (self.phi(node) as f32).clamp(-background, background);
        if phi == 0.0 { f32::MIN_POSITIVE } else { phi }
    }

    /// Origins of all leaves in a cube around the sphere.
    fn cube(&self) -> Vec<Ijk> {
        let reach = (self.radius / self.voxel + self.half_width).ceil() as i32 / LEAF_DIM + 1;
        let range = move || (-reach..reach).map(|b| b * LEAF_DIM);
        range().flat_map(|i| range().flat_map(move |j| range().map(move |k| Ijk::new(i, j, k)))).collect()
    }

    fn place(&self, origin: Ijk, background: f32) -> Place {
        let values = (0..LEAF_SIZE).map(|n| self.value(Ijk::in_leaf(origin, n), background));
        let (low, high) =
            values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        match () {
            () if low >= background => Place::Outside,
            () if high <= -background => Place::Inside,
            () => Place::Band,
        }
    }

    /// The leaves of the band and the origins of those inside of it.
    pub fn leaves(&self, background: f32) -> (Leaves, Vec<Ijk>) {
        let (mut band, mut inside) = (Leaves::default(), Vec::new());
        for origin in self.cube() {
            match self.place(origin, background) {
                Place::Outside => {}
                Place::Inside => inside.push(origin),
                Place::Band => {
                    let mut mask = [0; 8];
                    for number in 0..LEAF_SIZE {
                        let value = self.value(Ijk::in_leaf(origin, number), background);
                        let active = value.abs() < background;
                        mask[number / 64] |= u64::from(active) << (number % 64);
                        band.values.push(value);
                        band.ids.push(if active {
                            (band.origins.len() * LEAF_SIZE + number) as i32
                        } else {
                            -1
                        });
                    }
                    band.origins.push(origin);
                    band.active.push(mask);
                }
            }
        }
        (band, inside)
    }

    /// The band in OpenVDB.
    pub fn band(&self) -> Band {
        let mut surface = SurfaceGrid::new(self.lattice(), self.half_width).unwrap();
        let (leaves, inside) = self.leaves(surface.background());
        assert!(!leaves.origins.is_empty());
        surface.insert_leaves(&leaves.origins, &leaves.values, &leaves.active).unwrap();
        surface.fill_inside(&inside, &vec![8; inside.len()]).unwrap();
        surface.prune();
        let mut closest = ClosestGrid::new(self.lattice()).unwrap();
        closest.insert_leaves(&leaves.origins, &leaves.ids, &leaves.active).unwrap();
        Band { surface, closest: Some(closest) }
    }
}

/// All leaves of a band, sorted by origin.
pub fn read_out(band: &Band) -> Leaves {
    let origins = band.surface.leaf_origins();
    let count = origins.len();
    let mut all = Leaves {
        values: vec![0.0; count * LEAF_SIZE],
        active: vec![[0; 8]; count],
        ids: vec![0; count * LEAF_SIZE],
        origins,
    };
    // In batches, as the engine does.
    for first in (0..count).step_by(100) {
        let end = (first + 100).min(count);
        let values = first * LEAF_SIZE..end * LEAF_SIZE;
        band.surface
            .read_leaves(first, &mut all.values[values.clone()], &mut all.active[first..end])
            .unwrap();
        let mut active = all.active[first..end].to_vec();
        let closest = band.closest.as_ref().expect("a band with closest triangles");
        closest.read_leaves(first, &mut all.ids[values], &mut active).unwrap();
        assert_eq!(active, all.active[first..end]);
    }
    all.sorted()
}

impl Leaves {
    /// Sorts the leaves by their origins.
    pub fn sorted(self) -> Leaves {
        let mut order: Vec<usize> = (0..self.origins.len()).collect();
        order.sort_by_key(|&n| self.origins[n]);
        let block = |n: usize| n * LEAF_SIZE..(n + 1) * LEAF_SIZE;
        Leaves {
            origins: order.iter().map(|&n| self.origins[n]).collect(),
            values: order.iter().flat_map(|&n| self.values[block(n)].to_vec()).collect(),
            active: order.iter().map(|&n| self.active[n]).collect(),
            ids: order.iter().flat_map(|&n| self.ids[block(n)].to_vec()).collect(),
        }
    }
}
