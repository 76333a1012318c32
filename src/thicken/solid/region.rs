//! The thickened solid as a rule: on which side of which of its faces a point is.
//!
//! ```text
//!        S  ________________________
//!  lid      ......................  |     lid: at depth d below S
//!           |        inside       | |     section: where the closest point leaves the boundary of S
//!  shell    |_____________________| |     shell: at depth r
//! ```
//!
//! What is contoured is \[WC13\] Definition 2 without a layer of depth d below S, the lid, so that no face of the
//! contour comes near S: the ribbon from the boundary of S to the lid's rim closes the solid.

use super::vertex_pillars::Rods;
use crate::candidates::CandidateLists;
use crate::distance::{Sample, SignedDistance};
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;

/// Where a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the solid, below the lid.
    Inside,
    /// Nearer to S than the lid, or on the other side of S.
    Above,
    /// Farther from S than the shell.
    Below,
    /// The closest point is on the boundary of S.
    Beside,
}

/// The solid on the negative side of an open or closed mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid<'a> {
    pub distance: &'a SignedDistance<'a>,
    pub boundary: &'a Boundary,
    /// Thickness r, in model units.
    pub thickness: f64,
    /// Instead of that, the thickness at each vertex of S.
    pub map: Option<&'a [f64]>,
    /// Depth of the lid, in model units.
    pub lid: f64,
    /// The solid is thickened around vertices in which parts of S touch.
    pub rods: &'a Rods,
    /// The triangles near each point.
    pub lists: Option<&'a CandidateLists>,
}

impl Solid<'_> {
    /// The closest point of S to `p`.
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

    /// The thickness below a point of S.
    #[inline]
    pub fn thickness_at(&self, sample: &Sample) -> f64 {
        let Some(map) = self.map else { return self.thickness };
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

    /// Where a point is whose closest point is known.
    #[inline]
    pub fn place(&self, p: DVec3, sample: &Sample) -> Place {
        let mut depth = -sample.distance;
        if self.boundary.holds(self.distance.mesh(), sample.triangle, sample.feature) {
            match self.rods.at(p) {
                Some((at, _)) => depth = depth.copysign(at).min(at),
                None => return Place::Beside,
            }
        }
        if depth < self.lid {
            Place::Above
        } else if depth >= self.thickness_at(sample) {
            Place::Below
        } else {
            Place::Inside
        }
    }

    /// How far a point below S is beyond the shell, negative above it; `None` where its closest point is on the boundary of S,
    /// or on the other side.
    pub fn off_shell(&self, p: DVec3) -> Option<f64> {
        self.below(p).map(|sample| -sample.distance - self.thickness_at(&sample))
    }

    /// The point of the shell in line with such a point and its closest point.
    pub fn onto_shell(&self, p: DVec3) -> Option<DVec3> {
        let along = |sample: Sample| (p - sample.closest) * (self.thickness_at(&sample) / -sample.distance);
        self.below(p).map(|sample| sample.closest + along(sample))
    }

    fn below(&self, p: DVec3) -> Option<Sample> {
        let sample = self.sample(p, 0);
        let is_below = sample.distance < -self.lid
            && !self.boundary.holds(self.distance.mesh(), sample.triangle, sample.feature);
        is_below.then_some(sample)
    }
}
