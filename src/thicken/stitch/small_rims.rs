//! Lids over small rims that run around nothing.
//!
//! Where sheets are nearer to each other than a voxel, or the walls of two holes meet, the lattice can leave a hole of a
//! few triangles between section and shell. It is closed by its minimal-area triangulation (\[WC13\] section 4.2).

use super::strip_fitting::{Around, Conflict};
use crate::geom::triangle_pair::meeting_point;
use crate::run::{Cancelled, RunSettings};
use crate::thicken::patch::minimal_triangulation::Polygon;
use glam::DVec3;

/// Vertices up to which a rim is closed by a lid. What is larger is no flaw of the lattice, but shape.
pub(crate) const MOST: usize = 24;

/// Triangulations of a rim are chosen anew this often without the triangles that meet something: each try forbids one at
/// least.
const TRIES: usize = 60;

impl Around<'_> {
    /// Adds lids over these rims to a strip, or says where they would meet something.
    pub fn fit_lids(
        &self,
        rims: &[Polygon],
        mut strip: Vec<[u32; 3]>,
        run: &RunSettings,
    ) -> Result<Result<Vec<[u32; 3]>, Vec<Conflict>>, Cancelled> {
        let mut conflicts = Vec::new();
        for rim in rims {
            run.check()?;
            let mut polygon = rim.clone();
            match self.lid(&mut polygon, &strip) {
                Some(lid) => strip.extend(lid),
                None => {
                    let mut section = Vec::new();
                    for &places in &polygon.forbidden {
                        self.meeting(polygon.triangle(places), |n| section.extend(n.checked_sub(self.patch)));
                    }
                    let at = rim.points[0].to_array();
                    conflicts.push(Conflict { rim: rim.vertices.clone(), section, at, ribbon: None });
                }
            }
        }
        Ok(if conflicts.is_empty() { Ok(strip) } else { Err(conflicts) })
    }

    /// Triangles over a rim that meet nothing. What they must not be is added to the polygon.
    fn lid(&self, polygon: &mut Polygon, strip: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
        for _ in 0..TRIES {
            let places = polygon.least_area(|a, b| self.is_edge(a, b, strip))?;
            let triangles: Vec<[u32; 3]> = places.iter().map(|&p| polygon.triangle(p)).collect();
            let mut bad = Vec::new();
            for (n, &t) in triangles.iter().enumerate() {
                let before = triangles[..n].iter().chain(strip);
                if self.meets(t) || before.into_iter().any(|&other| self.do_meet(t, other)) {
                    bad.push(places[n]);
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

    /// Whether two vertices have an edge in what is there, or in the strip.
    fn is_edge(&self, a: u32, b: u32, strip: &[[u32; 3]]) -> bool {
        let mut found = strip.iter().any(|t| t.contains(&a) && t.contains(&b));
        self.tree.near(DVec3::from(self.mesh.vertices[a as usize]), 0.0, |n| {
            let n = n as usize;
            let t = self.mesh.triangles[n];
            found |= t.contains(&a) && t.contains(&b) && (n < self.patch || self.kept[n - self.patch]);
        });
        found
    }
}
