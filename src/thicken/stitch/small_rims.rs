//! Caps over small rims that run around no boundary loop.
//!
//! Where sheets are nearer to each other than a voxel, or the walls of two holes meet, the lattice
//! can leave a hole of a few triangles between section and shell. Its minimal-area triangulation
//! closes it (\[WC13\] section 4.2).

use super::strip_fitting::{Conflict, Fit, Surroundings};
use crate::geom::triangle_pair::meeting_point;
use crate::run::{Cancelled, RunSettings};
use crate::thicken::patch::minimal_triangulation::Polygon;
use glam::DVec3;

/// Maximum number of vertices of a rim that a cap closes. A larger rim is no flaw of the lattice,
/// but shape.
pub(super) const MAX_RIM_VERTICES: usize = 24;

/// Maximum number of triangulations of a rim, each without the triangles that met something before.
/// Each try forbids one triangle at least.
const MAX_TRIES: usize = 60;

impl Surroundings<'_> {
    /// Adds caps over these rims to the triangles of strips, or returns the conflicts.
    pub fn fit_caps(
        &self,
        rims: &[Polygon],
        mut triangles: Vec<[u32; 3]>,
        run: &RunSettings,
    ) -> Result<Fit, Cancelled> {
        let mut conflicts = Vec::new();
        for rim in rims {
            run.check()?;
            let mut polygon = rim.clone();
            match self.cap(&mut polygon, &triangles) {
                Some(cap) => triangles.extend(cap),
                None => {
                    let mut contour = Vec::new();
                    for &indices in &polygon.forbidden {
                        let triangle = polygon.triangle(indices);
                        self.meeting(triangle, |n| contour.extend(n.checked_sub(self.patch)));
                    }
                    let at = rim.points[0].to_array();
                    conflicts.push(Conflict { rim: rim.vertices.clone(), contour, at, strip: None });
                }
            }
        }
        Ok(if conflicts.is_empty() { Fit::Triangles(triangles) } else { Fit::Conflicts(conflicts) })
    }

    /// Finds triangles over a rim that meet nothing. Triangles that met something are forbidden in
    /// `polygon` afterwards.
    fn cap(&self, polygon: &mut Polygon, strips: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
        for _ in 0..MAX_TRIES {
            let indices = polygon.minimal_triangulation(|a, b| self.is_edge(a, b, strips))?;
            let triangles: Vec<[u32; 3]> = indices.iter().map(|&t| polygon.triangle(t)).collect();
            let mut bad = Vec::new();
            for (n, &t) in triangles.iter().enumerate() {
                let before = triangles[..n].iter().chain(strips);
                if self.meets(t) || before.into_iter().any(|&other| self.do_meet(t, other)) {
                    bad.push(indices[n]);
                }
            }
            if bad.is_empty() {
                return Some(triangles);
            }
            polygon.forbidden.extend(bad);
        }
        None
    }

    /// Whether two triangles meet beyond what they share.
    fn do_meet(&self, a: [u32; 3], b: [u32; 3]) -> bool {
        let [pa, pb] = [a, b].map(|t| t.map(|v| self.mesh.vertices[v as usize]));
        let apart = (0..3).any(|i| {
            let span =
                |p: [[f64; 3]; 3]| (p[0][i].min(p[1][i]).min(p[2][i]), p[0][i].max(p[1][i]).max(p[2][i]));
            let (a, b) = (span(pa), span(pb));
            a.1 < b.0 || b.1 < a.0
        });
        !apart && meeting_point(a, pa, b, pb).is_some()
    }

    /// Whether two vertices have an edge in the surroundings or in the strips.
    fn is_edge(&self, a: u32, b: u32, strips: &[[u32; 3]]) -> bool {
        let mut found = strips.iter().any(|t| t.contains(&a) && t.contains(&b));
        self.tree.near(DVec3::from(self.mesh.vertices[a as usize]), 0.0, |n| {
            let n = n as usize;
            let t = self.mesh.triangles[n];
            found |= t.contains(&a) && t.contains(&b) && (n < self.patch || self.kept[n - self.patch]);
        });
        found
    }
}
