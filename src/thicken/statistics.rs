//! What happened during a thickening.

use serde::Serialize;

/// Counts and times of one thickening.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ThickenStatistics {
    /// The thickness r in model units.
    pub thickness: f64,
    /// The voxel size h in model units, the last one if it was halved.
    pub voxel: f64,
    /// How often it was halved.
    pub halvings: u32,
    /// Seconds per stage.
    pub times: ThickenTimes,
    /// Triangles of the result.
    pub triangles: TriangleCounts,
    /// Holes that are too narrow for the lattice and were closed: a point of each.
    pub capped: Vec<[f64; 3]>,
    /// What shape processing did.
    pub shape: ShapeCounts,
}

/// Counts of shape processing (\[WC13\] section 4.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ShapeCounts {
    /// Rounds until nothing moved, or as many as were allowed.
    pub rounds: u32,
    /// Moves of vertices that were made.
    pub moves: u64,
}

/// Triangles of the result by origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TriangleCounts {
    /// Triangles of the patch that are in the result with the same coordinates.
    pub kept: u64,
    /// Triangles of the patch that were split.
    pub split: u64,
    /// Triangles that are not of the patch.
    pub new: u64,
}

/// Seconds per stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ThickenTimes {
    /// Checking the patch, and building the hierarchy.
    pub hierarchy: f64,
    /// Grid nodes: band and inside (\[WC13\] section 3; "Grid Eva." of its Table 1).
    pub nodes: f64,
    /// Boundary loops, and the strips along them (\[WC13\] section 4.1).
    pub boundary: f64,
    /// Crossings, contour (\[WC13\] section 4.2; "Face Gene.").
    pub faces: f64,
    /// Shape processing (\[WC13\] section 4.3; "Shape Opt.").
    pub shape: f64,
}
