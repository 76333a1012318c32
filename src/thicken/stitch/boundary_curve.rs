//! Closest points of the boundary loops.

use crate::mesh::TriMesh;
use crate::ssvh::Ssvh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;

/// The edges of the boundary, ready for closest-point queries.
#[derive(Debug)]
pub(crate) struct BoundaryCurve<'a> {
    mesh: &'a TriMesh,
    boundary: &'a Boundary,
    ssvh: Ssvh,
    /// Per edge, the number of its loop and its position there.
    edges: Vec<[u32; 2]>,
    /// Per loop, the arc length at each of its vertices and the whole length, in model units.
    arc_lengths: Vec<Vec<f64>>,
}

/// A point of a boundary loop, seen from another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePoint {
    /// Number of the loop.
    pub loop_number: u32,
    /// Arc length from the loop's first vertex, in model units.
    pub arc_length: f64,
    /// Distance from the other point, in model units.
    pub distance: f64,
}

impl<'a> BoundaryCurve<'a> {
    /// Collects the boundary loops of `mesh`, of which there must be one at least.
    pub fn new(mesh: &'a TriMesh, boundary: &'a Boundary) -> BoundaryCurve<'a> {
        let mut segments = TriMesh { vertices: mesh.vertices.clone(), triangles: Vec::new() };
        let (mut edges, mut arc_lengths) = (Vec::new(), Vec::new());
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
            arc_lengths.push(own);
        }
        BoundaryCurve { mesh, boundary, ssvh: Ssvh::new(&segments), edges, arc_lengths }
    }

    /// Returns the closest point to `p`.
    pub fn closest(&self, p: DVec3) -> CurvePoint {
        let hit = self.ssvh.closest(p);
        let [number, position] = self.edges[hit.triangle as usize];
        let segment = self.ssvh.triangle(hit.triangle);
        let closest = segment.closest(p);
        let arcs = &self.arc_lengths[number as usize];
        let along = (closest.point - segment.corners[0]).length();
        CurvePoint {
            loop_number: number,
            arc_length: arcs[position as usize] + along,
            distance: hit.distance_squared.sqrt(),
        }
    }

    /// Returns the closest point of loop `number` to `p`. With `near`, an arc length and a distance
    /// along the loop, only points within that distance of that arc length count.
    pub fn closest_of(&self, p: DVec3, number: u32, near: Option<(f64, f64)>) -> Option<CurvePoint> {
        let arcs = &self.arc_lengths[number as usize];
        let whole = arcs[arcs.len() - 1];
        let mut best: Option<CurvePoint> = None;
        for (position, ends) in arcs.windows(2).enumerate() {
            if let Some((arc, distance)) = near {
                let apart = |end: f64| (end - arc - whole * ((end - arc) / whole).round()).abs();
                let is_around = (arc - ends[0]) * (arc - ends[1]) <= 0.0;
                if !is_around && apart(ends[0]).min(apart(ends[1])) > distance {
                    continue;
                }
            }
            let [a, b] = [position, (position + 1) % (arcs.len() - 1)]
                .map(|n| DVec3::from(self.mesh.vertices[self.vertices(number)[n] as usize]));
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let distance = p.distance(a.lerp(b, share));
            if best.is_none_or(|best| distance < best.distance) {
                let arc_length = ends[0] + share * (ends[1] - ends[0]);
                best = Some(CurvePoint { loop_number: number, arc_length, distance });
            }
        }
        best
    }

    /// Returns the arc length at each vertex of a loop and the whole length, in model units.
    pub fn arc_lengths(&self, number: u32) -> &[f64] {
        &self.arc_lengths[number as usize]
    }

    /// Returns the length of a loop, in model units.
    pub fn length(&self, number: u32) -> f64 {
        self.arc_lengths[number as usize].last().copied().unwrap_or_default()
    }

    /// Returns the vertices of a loop.
    pub fn vertices(&self, number: u32) -> &[u32] {
        &self.boundary.loops[number as usize]
    }
}
