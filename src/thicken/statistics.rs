//! Counts and times of a thickening.

/// Counts and times of one thickening.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ThickenStatistics {
    /// Thickness r, in model units.
    pub thickness: f64,
    /// Voxel size h, in model units; the last one if it was halved.
    pub voxel: f64,
    /// Number of times that the voxel size was halved.
    pub halvings: u32,
    /// Seconds that each stage took.
    pub times: ThickenTimes,
    /// Triangles of the result.
    pub triangles: TriangleCounts,
    /// A point of each hole that was too narrow for the lattice and was closed by a cap.
    pub capped: Vec<[f64; 3]>,
    /// Counts of shape processing.
    pub shape: ShapeCounts,
}

/// Counts of shape processing (\[WC13\] section 4.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ShapeCounts {
    /// Number of rounds until nothing moved, or the maximum.
    pub rounds: u32,
    /// Number of moves of vertices that were made.
    pub moves: u64,
}

/// Numbers of triangles of the result, by origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TriangleCounts {
    /// Triangles of the patch that are in the result with the same coordinates.
    pub kept: u64,
    /// Triangles of the patch that were split.
    pub split: u64,
    /// Triangles of shell, section, strips and caps.
    pub new: u64,
}

/// Seconds that each stage took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ThickenTimes {
    /// Checks of the patch, and the hierarchy.
    pub hierarchy: f64,
    /// Nodes: the band, and which are inside (\[WC13\] section 3; "Grid Eva." of its Table 1).
    pub nodes: f64,
    /// Boundary loops, and the strips along them (\[WC13\] section 4.1).
    pub boundary: f64,
    /// Crossings and contour (\[WC13\] section 4.2; "Face Gene.").
    pub faces: f64,
    /// Shape processing (\[WC13\] section 4.3; "Shape Opt.").
    pub shape: f64,
}
