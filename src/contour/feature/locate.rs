//! The position of a crease or a corner of the surface, from the tangent planes that a cell sees.
//!
//! The minimiser of a cell's error function is only as good as the cell's crossings. A third plane
//! that crosses no edge of the cell is missing, and curved faces are taken as planes far from where
//! they are needed. So the triangles of the crossings are followed: the surface of each is sampled
//! where the planes meet, until that point converges. Then the surface itself is sampled there, in
//! case that another triangle of it is nearer.
//!
//! ```text
//!   planes at the     where     planes of the     where
//!   crossings     ->  they  ->  triangles     ->  these  ->  ...  ->  on the surface?
//!                     meet      there             meet                that is the feature;
//!      A \   / B        \ /                         \ /                 else follow the
//!         \ /            x                           x                  nearer triangle
//! ```

use super::probe::SurfaceProbe;
use super::tangent_planes::{HermiteSamples, MeetingPlanes, Normals, SAME_FACE, TangentPlane};
use glam::DVec3;

/// The farthest that a feature is looked for outside of its cell, in voxels.
///
/// The tip of a wedge of 22 degrees is 2.5 voxels from where it is a voxel thick.
pub const MAX_FEATURE_REACH: f64 = 2.5;

/// The distance from the crease at which its faces are sampled at first, in voxels. Later steps
/// take twice the last movement, but no more than this.
const FIRST_OFFSET: f64 = 0.2;

/// The least distance beside the crease at which its faces are sampled, in voxels, so that rounding
/// does not decide which face answers.
const LEAST_OFFSET: f64 = 1e-3;

/// The most rounds of samples beside a crease. Flat faces need one, curved ones three.
const SAMPLE_ROUNDS: usize = 5;

/// The most sets of triangles that are followed, with one sample each.
///
/// Two of three features need one, one in thirty more than two. Where more are needed the faces
/// have many triangles, and it is better to sample beside the crease.
const TRIANGLE_SETS: usize = 3;

/// The most steps to the point in which the surfaces of triangles meet. Flat ones need one, curved
/// ones three.
const TRIANGLE_STEPS: usize = 6;

/// The distance at which steps along gradients end, in voxels.
const GRADIENT_CONVERGED: f64 = 1e-6;

/// The most steps along gradients.
const GRADIENT_STEPS: usize = 12;

/// The step length, in voxels, at which the search with samples of the surface stops.
///
/// Convergence is quadratic, so the remaining error is far smaller.
const SAMPLES_CONVERGED: f64 = 5e-3;

/// The step length, in voxels, at which the search with known triangles stops. Such a step costs no
/// sample of the surface, so the bound is tighter than [`SAMPLES_CONVERGED`].
const TRIANGLES_CONVERGED: f64 = 1e-3;

/// The distance below which a point is on the surface, in voxels.
const ON_SURFACE: f64 = 1e-3;

/// A crease point or a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// The point of the feature that is nearest to the cell's crossings.
    pub point: DVec3,
    /// The unit normals of the faces that meet there, zero beyond the last one.
    pub normals: Normals,
}

/// The spread of normals below which no feature is looked for: the second eigenvalue of the error
/// function over the largest.
///
/// Five crossings on one face and one on another at 18 degrees to it have 0.013.
pub const MIN_SPREAD: f64 = 0.002;

/// Locates the feature that a sheet sees; `None` when it sees one face only, or the surface has no
/// feature within reach of the cell.
///
/// `minimiser` is the least point of the sheet's error function, `mean` the mean of the sample
/// points.
pub fn locate_feature(
    probe: &mut SurfaceProbe<'_>,
    samples: &HermiteSamples,
    minimiser: DVec3,
    mean: DVec3,
) -> Option<Feature> {
    let seen = samples.cluster_by_normal(minimiser);
    if seen.slice().len() < 2 {
        return None;
    }
    let (point, planes) = converge(probe, seen, mean)?;
    Some(Feature { point, normals: planes.normals() })
}

/// Locates the feature around the origin between the faces of the surface that are near some
/// points.
pub fn feature_between(probe: &mut SurfaceProbe<'_>, points: impl Iterator<Item = DVec3>) -> Option<DVec3> {
    let mut samples = HermiteSamples::default();
    for p in points.take(12) {
        let TangentPlane { anchor, normal, triangle } = probe.tangent_plane(p);
        samples.push(anchor, normal, triangle);
    }
    let seen = samples.cluster_by_normal(DVec3::ZERO);
    if seen.slice().len() < 2 {
        return None;
    }
    converge(probe, seen, DVec3::ZERO).map(|(point, _)| point)
}

/// Steps along gradients from `from` to the surface, and returns the point there, or the nearest
/// one on the way.
///
/// Between two faces the way goes to and fro, with shorter steps.
pub fn project_to_surface(probe: &mut SurfaceProbe<'_>, from: DVec3) -> Option<DVec3> {
    let mut point = from;
    let (mut distance, mut normal) = probe.sample(point);
    let mut share = 1.0;
    for _ in 0..GRADIENT_STEPS {
        if distance.abs() <= GRADIENT_CONVERGED {
            break;
        }
        let next = point + -share * distance * normal;
        let (next_distance, next_normal) = probe.sample(next);
        if next_distance.abs() < distance.abs() {
            (point, distance, normal) = (next, next_distance, next_normal);
        } else {
            share *= 0.5;
        }
    }
    is_within_reach(point).then_some(point)
}

/// Follows planes to the point of the surface in which they meet: by their triangles, or, where
/// these lead away, by samples beside that point.
fn converge(
    probe: &mut SurfaceProbe<'_>,
    planes: MeetingPlanes,
    mean: DVec3,
) -> Option<(DVec3, MeetingPlanes)> {
    by_triangles(probe, planes, mean).or_else(|| by_samples(probe, planes, mean))
}

/// Follows the triangles of the planes to the point in which their surfaces meet, and takes other
/// triangles where the surface has nearer ones, until that point is on the surface.
fn by_triangles(
    probe: &mut SurfaceProbe<'_>,
    mut planes: MeetingPlanes,
    mean: DVec3,
) -> Option<(DVec3, MeetingPlanes)> {
    for _ in 0..TRIANGLE_SETS {
        let point = meet_of_triangles(probe, &mut planes, mean)?;
        let (distance, normal) = probe.sample(point);
        if distance.abs() <= ON_SURFACE {
            return Some((point, planes));
        }
        let cosine = |p: &TangentPlane| p.normal.dot(normal);
        let face = planes.iter_mut().max_by(|a, b| cosine(a).total_cmp(&cosine(b)))?;
        if cosine(face) <= SAME_FACE || face.triangle == probe.triangle {
            return None;
        }
        *face = TangentPlane { anchor: point + -distance * normal, normal, triangle: probe.triangle };
    }
    None
}

/// Samples the surface beside the point in which the planes meet, until that point is on the
/// surface.
fn by_samples(
    probe: &mut SurfaceProbe<'_>,
    mut planes: MeetingPlanes,
    mean: DVec3,
) -> Option<(DVec3, MeetingPlanes)> {
    let mut point = planes.meet(mean)?;
    let mut offset = FIRST_OFFSET;
    for _ in 0..SAMPLE_ROUNDS {
        if !is_within_reach(point) {
            return None;
        }
        for plane in planes.iter_mut() {
            let back = plane.anchor - point;
            let length = back.length();
            let step = if length > offset { offset / length } else { 1.0 };
            *plane = probe.tangent_plane(point + step * back);
        }
        let next = planes.meet(mean)?;
        let moved = next.distance(point);
        point = next;
        if moved < SAMPLES_CONVERGED {
            break;
        }
        offset = (2.0 * moved).clamp(LEAST_OFFSET, FIRST_OFFSET);
    }
    if !is_within_reach(point) {
        return None;
    }
    let (distance, normal) = probe.sample(point);
    if distance.abs() <= ON_SURFACE {
        return Some((point, planes));
    }
    // A face that no crossing of the cell showed.
    let third = TangentPlane { anchor: point + -distance * normal, normal, triangle: probe.triangle };
    corner(probe, &planes, third, mean)
}

/// Returns the corner in which a third plane ends the crease of two.
fn corner(
    probe: &mut SurfaceProbe<'_>,
    planes: &MeetingPlanes,
    third: TangentPlane,
    mean: DVec3,
) -> Option<(DVec3, MeetingPlanes)> {
    if planes.slice().iter().any(|p| p.normal.dot(third.normal) > SAME_FACE) {
        return None;
    }
    let planes = planes.with(third)?;
    let point = planes.meet(mean)?;
    if !is_within_reach(point) {
        return None;
    }
    let (distance, _) = probe.sample(point);
    (distance.abs() <= ON_SURFACE).then_some((point, planes))
}

/// Returns the point in which the surfaces of the planes' triangles meet, as near to `mean` as they
/// do; `None` when it does not converge. The planes become the tangent planes there.
fn meet_of_triangles(probe: &SurfaceProbe<'_>, planes: &mut MeetingPlanes, mean: DVec3) -> Option<DVec3> {
    let mut point = planes.meet(mean)?;
    for _ in 0..TRIANGLE_STEPS {
        if !is_within_reach(point) {
            return None;
        }
        for plane in planes.iter_mut() {
            *plane = probe.tangent_plane_of(plane.triangle, point);
        }
        let next = planes.meet(mean)?;
        let moved = next.distance_squared(point);
        point = next;
        if moved < TRIANGLES_CONVERGED * TRIANGLES_CONVERGED {
            return is_within_reach(point).then_some(point);
        }
    }
    None
}

/// Whether a point, in voxels from the cell's lowest corner, is near enough to the cell.
fn is_within_reach(point: DVec3) -> bool {
    point.to_array().iter().all(|x| (-MAX_FEATURE_REACH..=1.0 + MAX_FEATURE_REACH).contains(x))
}
