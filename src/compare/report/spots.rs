//! Spots for pictures: the worst of each method, and the sharpest crease.

use super::plane::Plane;
use crate::compare::{Comparison, Method};
use crate::distance::SignedDistance;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use glam::DVec3;
use rayon::prelude::*;

/// A place worth a picture.
#[derive(Clone, Debug)]
pub struct Spot {
    /// The reason for the picture.
    pub kind: Kind,
    /// The methods whose largest error is there.
    pub worst: Vec<Method>,
    /// The section plane, its origin at the spot, up being away from the model.
    pub plane: Plane,
}

/// Why a spot was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The sharpest crease.
    Crease,
    /// Somebody is worst there.
    Worst,
}

impl Spot {
    /// A heading.
    pub fn title(&self) -> String {
        let names: Vec<&str> = self.worst.iter().map(|m| m.title()).collect();
        match (self.kind, names.is_empty()) {
            (Kind::Crease, true) => "The sharpest crease".into(),
            (Kind::Crease, false) => format!("The sharpest crease; worst spot of {}", names.join(", ")),
            (Kind::Worst, _) => format!("Worst spot of {}", names.join(", ")),
        }
    }
}

/// Spots nearer than this many voxels show the same thing.
const SAME: f64 = 6.0;

/// More pictures would say nothing new; nobody reads twelve.
const MOST: usize = 4;

/// The sharpest crease of the true offset surface, if it has one, and the worst spots.
pub fn spots(comparison: &Comparison, distance: &SignedDistance, run: &RunSettings) -> Vec<Spot> {
    let (h, r) = (comparison.voxel, comparison.distance);
    let mut spots: Vec<Spot> = Vec::new();
    let meshes = comparison.results.iter().filter_map(|m| m.mesh.as_ref());
    if let Some(at) = meshes.take(1).find_map(|mesh| crease(mesh, distance, run)) {
        spots.push(Spot { kind: Kind::Crease, worst: Vec::new(), plane: plane(at, distance, r, h) });
    }
    for result in &comparison.results {
        let Some(quality) = &result.quality else { continue };
        let Some(at) = quality.distance.max_at.map(DVec3::from) else { continue };
        let same = |s: &&mut Spot| s.plane.origin.distance(at) <= SAME * h;
        if let Some(spot) = spots.iter_mut().find(same) {
            spot.worst.push(result.method);
        } else if spots.len() < MOST {
            let plane = plane(at, distance, r, h);
            spots.push(Spot { kind: Kind::Worst, worst: vec![result.method], plane });
        }
    }
    spots
}

/// Angles of a crease: below the first it may be a curved part; above the second it is the rim of a
/// sheet that is about to vanish, where everything is wrong.
const CREASE: std::ops::Range<f64> = 0.5..2.1;

/// The point on `mesh`, an offset surface, where the direction to the model turns most along an
/// edge.
fn crease(mesh: &TriMesh, distance: &SignedDistance, run: &RunSettings) -> Option<DVec3> {
    run.install(|| {
        let gradients: Vec<DVec3> = mesh
            .vertices
            .par_iter()
            .with_min_len(1024)
            .map_init(
                || 0,
                |guess, &v| {
                    let sample = distance.at(v.into(), *guess);
                    *guess = sample.triangle;
                    distance.gradient(v.into(), &sample, 0.0)
                },
            )
            .collect();
        let sharpest = mesh
            .triangles
            .par_iter()
            .flat_map_iter(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| (gradients[a as usize].angle_between(gradients[b as usize]), a.min(b), a.max(b)))
            .filter(|(angle, _, _)| CREASE.contains(angle))
            .max_by(|x, y| x.0.total_cmp(&y.0).then((y.1, y.2).cmp(&(x.1, x.2))))?;
        let end = |v: u32| DVec3::from(mesh.vertices[v as usize]);
        Some(end(sharpest.1).midpoint(end(sharpest.2)))
    })
}

/// The plane through `at` on which the true offset surface turns most: perpendicular to its crease
/// if there is one, along its normal otherwise.
pub fn plane(at: DVec3, distance: &SignedDistance, r: f64, h: f64) -> Plane {
    // As far from the spot as its worst error may be, and a little more.
    let reach = 1.5 * h;
    let mut directions = Vec::new();
    for i in -1..=1 {
        for j in -1..=1 {
            for k in -1..=1 {
                let p = at + DVec3::new(f64::from(i), f64::from(j), f64::from(k)) * reach;
                let sample = distance.at(p, 0);
                let gradient = distance.gradient(p, &sample, 0.0);
                // One step along the gradient is on the true surface, or near enough.
                let q = p - gradient * (sample.distance - r);
                let there = distance.at(q, sample.triangle);
                directions.push(distance.gradient(q, &there, 0.0));
            }
        }
    }
    let sum: DVec3 = directions.iter().sum();
    let up = sum.try_normalize().unwrap_or(DVec3::Y);
    let mut normal = up.any_orthonormal_vector();
    // Half a degree: less is rounding.
    let mut largest = 0.01;
    for (i, a) in directions.iter().enumerate() {
        for b in &directions[..i] {
            let cross = a.cross(*b);
            // Opposite directions have no plane of their own.
            if cross.length() > largest {
                largest = cross.length();
                normal = cross;
            }
        }
    }
    Plane::new(at, up, normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Topology, shapes};

    #[test]
    fn the_crease_of_a_shrunk_cube_is_found() {
        let mesh = shapes::cube(4);
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let run = RunSettings::with_threads(1).unwrap();
        let mut inner = shapes::cube(16);
        inner.vertices.iter_mut().flatten().for_each(|x| *x *= 0.75);
        let at = crease(&inner, &distance, &run).unwrap();
        let on_edge = at.abs().to_array().iter().filter(|x| **x > 0.6).count();
        assert!(on_edge >= 2, "{at}");
        let plane = plane(DVec3::new(0.75, 0.75, 0.0), &distance, -0.25, 0.05);
        assert!(plane.normal().cross(DVec3::Z).length() < 1e-6, "{plane:?}");
        assert!(plane.up.dot(DVec3::new(1.0, 1.0, 0.0)) > 1.0, "{plane:?}");
    }
}
