//! The closest point of the boundary curve.

use crate::geom::triangle::Feature;
use crate::mesh::TriMesh;
use crate::ssvh::Ssvh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;

/// The boundary's edges, ready for queries.
#[derive(Debug)]
pub(crate) struct Curve<'a> {
    mesh: &'a TriMesh,
    boundary: &'a Boundary,
    ssvh: Ssvh,
    /// Per edge its loop and its number there.
    edges: Vec<[u32; 2]>,
    /// Per loop the arc length at each of its vertices, and its whole length.
    arcs: Vec<Vec<f64>>,
}

/// A point of the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePoint {
    /// The loop.
    pub number: u32,
    /// The arc length from the loop's first vertex.
    pub arc: f64,
    pub distance: f64,
}

impl<'a> Curve<'a> {
    /// The boundary curve of `mesh`, which must have one.
    pub fn new(mesh: &'a TriMesh, boundary: &'a Boundary) -> Curve<'a> {
        let mut segments = TriMesh { vertices: mesh.vertices.clone(), triangles: Vec::new() };
        let (mut edges, mut arcs) = (Vec::new(), Vec::new());
        for (number, around) in (0u32..).zip(&boundary.loops) {
            let mut own = vec![0.0];
            let mut length = 0.0;
            for (position, &a) in (0u32..).zip(around) {
                let b = around[(position as usize + 1) % around.len()];
                // A segment is a triangle of which two corners are one.
                segments.triangles.push([a, b, b]);
                edges.push([number, position]);
                let [p, q] = [a, b].map(|v| DVec3::from(mesh.vertices[v as usize]));
                length += (q - p).length();
                own.push(length);
            }
            arcs.push(own);
        }
        Curve { mesh, boundary, ssvh: Ssvh::new(&segments), edges, arcs }
    }

    /// The closest point to `p`; `guess` is the number of an edge near it.
    pub fn closest(&self, p: DVec3) -> CurvePoint {
        let hit = self.ssvh.closest(p);
        let [number, position] = self.edges[hit.triangle as usize];
        let segment = self.ssvh.triangle(hit.triangle);
        let closest = segment.closest(p);
        let arcs = &self.arcs[number as usize];
        let along = match closest.feature {
            Feature::Vertex(_) | Feature::Edge(_) | Feature::Face => {
                (closest.point - segment.corners[0]).length()
            }
        };
        CurvePoint { number, arc: arcs[position as usize] + along, distance: hit.distance_squared.sqrt() }
    }

    /// The closest point to `p` of one loop, of those with arc lengths `within` a distance of one if that is given.
    pub fn closest_of(&self, p: DVec3, number: u32, within: Option<(f64, f64)>) -> Option<CurvePoint> {
        let arcs = &self.arcs[number as usize];
        let whole = arcs[arcs.len() - 1];
        let mut best: Option<CurvePoint> = None;
        for (position, ends) in arcs.windows(2).enumerate() {
            if let Some((arc, reach)) = within {
                let apart = |end: f64| (end - arc - whole * ((end - arc) / whole).round()).abs();
                let is_around = (arc - ends[0]) * (arc - ends[1]) <= 0.0;
                if !is_around && apart(ends[0]).min(apart(ends[1])) > reach {
                    continue;
                }
            }
            let [a, b] = [position, (position + 1) % (arcs.len() - 1)]
                .map(|n| DVec3::from(self.mesh.vertices[self.vertices(number)[n] as usize]));
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let distance = p.distance(a.lerp(b, share));
            if best.is_none_or(|best| distance < best.distance) {
                best = Some(CurvePoint { number, arc: ends[0] + share * (ends[1] - ends[0]), distance });
            }
        }
        best
    }

    /// The arc length at each vertex of a loop, and the whole.
    pub fn arcs(&self, number: u32) -> &[f64] {
        &self.arcs[number as usize]
    }

    /// The length of a loop.
    pub fn whole(&self, number: u32) -> f64 {
        self.arcs[number as usize].last().copied().unwrap_or_default()
    }

    /// The vertices of a loop.
    pub fn vertices(&self, number: u32) -> &[u32] {
        &self.boundary.loops[number as usize]
    }
}
