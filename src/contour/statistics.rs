//! Counts of a contour.

use std::ops::AddAssign;

/// Counts of one contour: the part `contour` of the statistics file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ContourStatistics {
    /// Cells with corners of both signs.
    pub cells: u64,
    /// Cells with more than one sheet.
    pub several_sheets: u64,
    /// Crossed grid edges, each with its polygon of four cell vertices and perhaps some face
    /// vertices.
    pub quads: u64,
    /// Polygons that were split along diagonals.
    pub diagonal: u64,
    /// Polygons that were split, wholly or in part, around a vertex on their grid edge.
    pub split: u64,
    /// Vertices on faces between cells.
    pub face_vertices: u64,
    /// Cell vertices whose minimiser is outside of their cell or their walls.
    pub clamped: u64,
    /// Vertices moved out of their cells to the crease or corner that they belong to.
    pub recovered: u64,
    /// Vertices that belong outside of their cells and could not be moved there.
    pub refused: u64,
    /// Vertices removed by edge collapses, because they were in the way of a relocated one.
    pub merged: u64,
    /// Edges flipped along a crease.
    pub flipped: u64,
    /// Vertices added where the surface was too far away.
    pub refined: u64,
    /// Times that adding vertices around one ended at its limit, with the surface still too far
    /// away.
    pub given_up: u64,
    /// Triangles that are farther from the surface than the tolerance all the same; `None` without
    /// a tolerance.
    pub beyond_tolerance: Option<u64>,
    /// Vertices of the result.
    pub vertices: u64,
    /// Triangles of the result.
    pub triangles: u64,
}

impl AddAssign for ContourStatistics {
    fn add_assign(&mut self, other: ContourStatistics) {
        self.cells += other.cells;
        self.several_sheets += other.several_sheets;
        self.quads += other.quads;
        self.diagonal += other.diagonal;
        self.split += other.split;
        self.face_vertices += other.face_vertices;
        self.clamped += other.clamped;
        self.recovered += other.recovered;
        self.refused += other.refused;
        self.merged += other.merged;
        self.flipped += other.flipped;
        self.refined += other.refined;
        self.given_up += other.given_up;
        self.beyond_tolerance = match (self.beyond_tolerance, other.beyond_tolerance) {
            (Some(a), Some(b)) => Some(a + b),
            (a, b) => a.or(b),
        };
        self.vertices += other.vertices;
        self.triangles += other.triangles;
    }
}
