//! The report of a verification.
//!
//! Lengths are in model units unless a name says otherwise. Vertex and triangle numbers are those
//! of the file. All types can be serialised; the names of the fields are those of the JSON file.

/// Report of [`verify`](super::verify).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VerifyReport {
    /// The case that OUTPUT was judged by.
    pub judged: Judged,
    /// Topology and intersections of OUTPUT by itself.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub soundness: Soundness,
    /// Distance of OUTPUT from the true offset surface.
    pub distance: DistanceReport,
    /// Distance of the true offset surface from OUTPUT.
    pub missing: MissingReport,
    /// Share of the true offset surface's creases that OUTPUT has.
    pub creases: CreaseReport,
    /// The wall, if OUTPUT is a shell.
    pub shell: Option<ShellReport>,
    /// The promises that OUTPUT breaks; empty when it keeps all.
    pub broken: Vec<BrokenPromise>,
}

impl VerifyReport {
    /// Whether OUTPUT keeps all promises.
    pub fn is_kept(&self) -> bool {
        self.broken.is_empty()
    }
}

/// The case that OUTPUT was judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Judged {
    /// Signed offset distance, in model units.
    pub distance: f64,
    /// Diagonal of INPUT's bounding box, in model units.
    pub diagonal: f64,
    /// Voxel size in model units, if given.
    pub voxel: Option<f64>,
    /// Maximum error allowed in model units, if given.
    pub tolerance: Option<f64>,
    /// Number of area-uniform samples asked for.
    pub samples: usize,
    /// The seed of the samples.
    pub seed: u64,
}

/// A length in the three units in which offsets are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ReportedLength {
    /// The length in model units.
    pub units: f64,
    /// The length in percent of the diagonal of INPUT's bounding box.
    pub percent_of_diagonal: f64,
    /// The length in voxels, if the voxel size is known.
    pub voxels: Option<f64>,
}

/// Statistics of a set of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Statistics {
    /// Number of samples; with none, everything else is 0.
    pub samples: usize,
    /// Mean.
    pub mean: ReportedLength,
    /// Root mean square.
    pub rms: ReportedLength,
    /// The error that 99.9 percent of the samples do not exceed.
    pub p999: ReportedLength,
    /// Maximum.
    pub max: ReportedLength,
    /// Position of the first sample with the largest error.
    pub max_at: Option<[f64; 3]>,
}

/// Topology and intersections.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Soundness {
    /// Defects of edges, vertices and triangles.
    pub topology: TopologyReport,
    /// Pairs of triangles that meet where they should not.
    pub intersections: IntersectionReport,
}

/// Topology of a mesh whose vertices at exactly the same position were made one. Nothing else is
/// repaired.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TopologyReport {
    /// Vertices that a triangle uses, after welding.
    pub vertices: usize,
    /// Triangles in the file, bad ones included.
    pub triangles: usize,
    /// Undirected edges.
    pub edges: usize,
    /// Vertices of the file that were merged into another at the same position.
    pub welded_vertices: usize,
    /// Vertices of the file that no triangle uses.
    pub unreferenced_vertices: usize,
    /// Edges with one triangle.
    pub border_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges with two triangles that run along it in the same direction.
    pub misoriented_edges: usize,
    /// Vertices whose triangles form more than one fan.
    pub non_manifold_vertices: usize,
    /// Triangles without area: with two corners at one position, or all three exactly on a line.
    /// Triangles of the first kind have no part in edges and fans.
    pub degenerate_triangles: usize,
    /// Triangles with the same three corners as an earlier one, whichever way round.
    pub duplicate_triangles: usize,
    /// Sets of triangles joined by edges.
    pub components: usize,
    /// Euler number: vertices - edges + triangles, without triangles that have two corners at one
    /// position.
    pub euler: i64,
    /// Sum of the genera of all components; `None` unless closed, 2-manifold and oriented.
    pub genus: Option<i64>,
    /// Smallest angle of a triangle with area, in degrees.
    pub smallest_angle: Option<f64>,
    /// The triangle with the smallest angle.
    pub smallest_angle_triangle: Option<u32>,
    /// Triangles with area and an angle below one degree.
    pub slivers: usize,
    /// The ends of the first border edge.
    pub first_border: Option<[[f64; 3]; 2]>,
    /// The ends of the first edge with more than two triangles.
    pub first_non_manifold_edge: Option<[[f64; 3]; 2]>,
    /// The ends of the first misoriented edge.
    pub first_misoriented: Option<[[f64; 3]; 2]>,
    /// The first vertex with more than one fan.
    pub first_non_manifold_vertex: Option<[f64; 3]>,
    /// The first degenerate triangle.
    pub first_degenerate: Option<u32>,
    /// The first duplicate triangle.
    pub first_duplicate: Option<u32>,
}

/// Pairs of triangles that have more in common than the vertices and edges they share, without
/// degenerate triangles.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IntersectionReport {
    /// Number of intersecting pairs.
    pub pairs: u64,
    /// Number of pairs with overlapping boxes; all of these were tested.
    pub tested: u64,
    /// The first intersecting pairs, in ascending order.
    pub first: Vec<IntersectingPair>,
}

/// Two triangles that intersect.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct IntersectingPair {
    /// Numbers of the triangles, ascending.
    pub triangles: [u32; 2],
    /// A point of both triangles, up to rounding.
    pub point: [f64; 3],
}

/// Error | |dis(p, INPUT)| - |D| | over points p of OUTPUT.
///
/// For a shell, points of the sheet at INPUT's own surface are judged against distance 0, and
/// points of walls between the sheets are left out.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DistanceReport {
    /// Error at points uniform over OUTPUT's area.
    pub surface: Statistics,
    /// Error at vertices: all, or four times as many as there are samples, evenly chosen.
    pub vertices: Statistics,
    /// Error at midpoints of edges: all, or four times as many as there are samples, evenly chosen.
    pub edge_midpoints: Statistics,
    /// Maximum of all errors.
    pub max: ReportedLength,
    /// Position of the maximum.
    pub max_at: Option<[f64; 3]>,
    /// Share of the surface samples on the wrong side of INPUT, 0 to 1; `None` if INPUT is not
    /// closed. Samples nearer to INPUT than |D| / 2 are not counted.
    pub wrong_side: Option<f64>,
    /// Errors of the surface samples by size.
    pub histogram: Histogram,
}

/// Counts by the logarithm of the error, for charts.
///
/// Bin i counts errors from 10^(first + i / per_decade) to the next bin's, as a share of the
/// diagonal. The first bin also counts smaller ones, the last also larger ones.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Histogram {
    /// Power of ten at which the first bin begins.
    pub first: i32,
    /// Bins per power of ten.
    pub per_decade: u32,
    /// Samples per bin.
    pub counts: Vec<u64>,
}

/// Distances from points of the true offset surface to OUTPUT.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MissingReport {
    /// Distance from the offsets of faces, uniform over INPUT's area.
    pub faces: Statistics,
    /// Distance from the arcs about edges: convex ones when growing, concave ones when shrinking.
    pub edges: Statistics,
    /// Distance from the caps about vertices.
    pub vertices: Statistics,
    /// Maximum of all distances.
    pub max: ReportedLength,
    /// Position of the maximum.
    pub max_at: Option<[f64; 3]>,
    /// Distance from OUTPUT, in model units, above which a point is missing: the tolerance if
    /// given, otherwise half a voxel, otherwise `None`.
    pub limit: Option<f64>,
    /// Share of all points that are missing, 0 to 1; `None` without a limit.
    pub share: Option<f64>,
}

/// Creases of the true offset surface: points with two closest points of INPUT. Creases are traced
/// from INPUT's concave edges when growing and from its convex ones when shrinking.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CreaseReport {
    /// Number of edges of INPUT that creases were traced from: sharper than the crease angle.
    pub input_edges: usize,
    /// Length of the creases, in model units.
    pub length: f64,
    /// Length along which OUTPUT has an edge, at most `within` away and nearly parallel; in model
    /// units.
    pub present: f64,
    /// Share `present / length`, 0 to 1; `None` without creases.
    pub share: Option<f64>,
    /// Maximum distance of an edge from the crease, in model units: 5% of a voxel.
    pub within: f64,
    /// First point of a crease that OUTPUT has no edge along.
    pub first_absent: Option<[f64; 3]>,
}

/// The wall of a shell.
///
/// A shell consists of a sheet at INPUT's own surface and one at distance |D|, perhaps with walls
/// between them. A triangle belongs to the sheet at |D| when all its corners are farther from INPUT
/// than |D| / 2, to the one at INPUT when none is, and to a wall otherwise. The thickness at a
/// point of the sheet at |D| is the point's distance from the other sheet.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ShellReport {
    /// Thickness that was asked for, in model units.
    pub wanted: f64,
    /// Number of triangles of the sheet at INPUT's surface.
    pub surface_triangles: usize,
    /// Number of triangles of the sheet at |D|.
    pub offset_triangles: usize,
    /// Number of triangles of walls between the sheets.
    pub wall_triangles: usize,
    /// Thickness of the wall; `None` unless both sheets are there.
    pub thickness: Option<Thickness>,
}

/// Thickness of a wall, over samples uniform over the area of the sheet at |D| and over its
/// vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Thickness {
    /// Number of samples.
    pub samples: usize,
    /// Minimum.
    pub min: ReportedLength,
    /// Mean.
    pub mean: ReportedLength,
    /// Maximum.
    pub max: ReportedLength,
    /// Position of the minimum.
    pub min_at: [f64; 3],
    /// Position of the maximum.
    pub max_at: [f64; 3],
}

/// A promise of an offset surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Promise {
    /// No border edges.
    Closed,
    /// No edge with more than two triangles, no vertex with more than one fan.
    Manifold,
    /// Triangles agree on the outside.
    Oriented,
    /// No triangle without area.
    NotDegenerate,
    /// No two triangles intersect.
    NoIntersections,
    /// No error above the tolerance, either way.
    Tolerance,
    /// A shell has two sheets, nowhere thinner than wanted less the tolerance.
    Thickness,
}

/// A promise that OUTPUT breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BrokenPromise {
    /// The promise.
    pub promise: Promise,
    /// The fault, in a few words.
    pub how: String,
}
