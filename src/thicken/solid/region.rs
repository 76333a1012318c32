//! The solid as a rule: the region of space that a point is in.
//!
//! ```text
//!        S  ________________________
//!  inset    ........................  |     inset: at depth d below S
//!           |        inside       |   |     section: where the closest point
//!  shell    |_____________________|   |              leaves the boundary of S
//!                                           shell: at depth r
//! ```
//!
//! The contour is that of \[WC13\] Definition 2 without the layer between S and the inset, so that
//! no face of the contour comes near S. The strip from the boundary of S to the rim of the inset
//! closes the solid.

use super::vertex_pillars::VertexPillars;
use crate::candidates::CandidateLists;
use crate::distance::{Sample, SignedDistance};
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;

/// Region of space, as seen from the solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Region {
    /// In the solid, below the inset.
    Inside,
    /// Nearer to S than the inset, or on the other side of S.
    Above,
    /// Farther from S than the shell.
    Below,
    /// Beside the solid: the closest point is on the boundary of S.
    Beside,
}

/// The solid on the negative side of an open or closed mesh S.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid<'a> {
    /// Distance from S.
    pub distance: &'a SignedDistance<'a>,
    /// Boundary of S.
    pub boundary: &'a Boundary,
    /// Thickness r, in model units.
    pub thickness: f64,
    /// Thickness at each vertex of S, in model units, instead of `thickness`.
    pub thickness_map: Option<&'a [f64]>,
    /// Depth of the inset, in model units.
    pub inset_depth: f64,
    /// Pillars below vertices in which parts of S touch.
    pub pillars: &'a VertexPillars,
    /// Triangles of S near each point.
    pub lists: Option<&'a CandidateLists>,
}

impl Solid<'_> {
    /// Finds the closest point of S to `p`. `hint` is a triangle near `p`.
    #[inline]
    pub fn sample(&self, p: DVec3, hint: u32) -> Sample {
        match self.lists.and_then(|lists| lists.at(p.to_array())) {
            Some(near) => {
                let hit = near.closest(self.distance.ssvh(), p);
                self.distance.from_triangle(p, hit.triangle)
            }
            None => self.distance.at(p, hint),
        }
    }

    /// Returns the thickness below a point of S, in model units.
    #[inline]
    pub fn thickness_at(&self, sample: &Sample) -> f64 {
        let Some(map) = self.thickness_map else { return self.thickness };
        let mesh = self.distance.mesh();
        let [a, b, c] = mesh.corners(sample.triangle as usize).map(DVec3::from);
        let values = mesh.triangles[sample.triangle as usize].map(|v| map[v as usize]);
        let normal = (b - a).cross(c - a);
        let part = |p: DVec3, q: DVec3| (p - sample.closest).cross(q - sample.closest).dot(normal).max(0.0);
        let parts = [part(b, c), part(c, a), part(a, b)];
        let whole: f64 = parts.iter().sum();
        let mean = || parts.iter().zip(values).map(|(part, value)| part * value).sum::<f64>() / whole;
        if whole > 0.0 { mean() } else { values[0] }
    }

    /// Returns the region of a point `p` whose closest point is known.
    #[inline]
    pub fn classify(&self, p: DVec3, sample: &Sample) -> Region {
        let mut depth = -sample.distance;
        if self.boundary.holds(self.distance.mesh(), sample.triangle, sample.feature) {
            match self.pillars.at(p) {
                Some((at, _)) => depth = depth.copysign(at).min(at),
                None => return Region::Beside,
            }
        }
        if depth < self.inset_depth {
            Region::Above
        } else if depth >= self.thickness_at(sample) {
            Region::Below
        } else {
            Region::Inside
        }
    }

    /// Returns how far `p` is beyond the shell, in model units, negative above it. `None` where the
    /// closest point is on the boundary of S, or `p` is not below the inset.
    pub fn depth_beyond_shell(&self, p: DVec3) -> Option<f64> {
        self.sample_below_inset(p).map(|sample| -sample.distance - self.thickness_at(&sample))
    }

    /// Projects `p` to the shell, along the line through its closest point. `None` as for
    /// [`depth_beyond_shell`](Self::depth_beyond_shell).
    pub fn project_to_shell(&self, p: DVec3) -> Option<DVec3> {
        let along = |sample: Sample| (p - sample.closest) * (self.thickness_at(&sample) / -sample.distance);
        self.sample_below_inset(p).map(|sample| sample.closest + along(sample))
    }

    fn sample_below_inset(&self, p: DVec3) -> Option<Sample> {
        let sample = self.sample(p, 0);
        let is_below = sample.distance < -self.inset_depth
            && !self.boundary.holds(self.distance.mesh(), sample.triangle, sample.feature);
        is_below.then_some(sample)
    }
}
