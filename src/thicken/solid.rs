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

use super::boundary::Boundary;
use crate::candidates::CandidateLists;
use crate::distance::{Sample, SignedDistance};
use glam::DVec3;

/// Where a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
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
pub(super) struct Solid<'a> {
    pub distance: &'a SignedDistance<'a>,
    pub boundary: &'a Boundary,
    /// Thickness r, in model units.
    pub thickness: f64,
    /// Depth of the lid, in model units.
    pub lid: f64,
    /// Radius of the rods below vertices in which parts of S touch, in model units.
    pub rod: f64,
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

    /// Where a point is whose closest point is known.
    #[inline]
    pub fn place(&self, p: DVec3, sample: &Sample) -> Place {
        if self.boundary.holds(self.distance.mesh(), sample.triangle, sample.feature)
            && !self.bridges(sample, p)
        {
            Place::Beside
        } else if sample.distance > -self.lid {
            Place::Above
        } else if sample.distance <= -self.thickness {
            Place::Below
        } else {
            Place::Inside
        }
    }

    /// Whether `p`, beside S, is below a vertex in which parts of S touch. They are joined by a rod there: the solid is
    /// thickened around that vertex, or it would hang together by an edge.
    fn bridges(&self, sample: &Sample, p: DVec3) -> bool {
        if self.boundary.touching.is_empty() || sample.distance > 0.0 {
            return false;
        }
        let mesh = self.distance.mesh();
        self.boundary.touching.iter().any(|&v| {
            let across = p - DVec3::from(mesh.vertices[v as usize]);
            let normal = self.boundary.touching_normal(v);
            let depth = across.dot(normal);
            depth < 0.0 && (across - normal * depth).length() <= self.rod
        })
    }
}
