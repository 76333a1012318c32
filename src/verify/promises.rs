//! The promises that OUTPUT breaks.

use super::report::{
    BrokenPromise, DistanceReport, IntersectionReport, MissingReport, Promise, ShellReport, Soundness,
    TopologyReport,
};

impl Soundness {
    /// Returns the promises that the mesh breaks by itself, whatever it is the offset of.
    pub fn broken(&self) -> Vec<BrokenPromise> {
        let TopologyReport {
            border_edges,
            non_manifold_edges,
            non_manifold_vertices,
            misoriented_edges,
            degenerate_triangles,
            ..
        } = self.topology;
        let IntersectionReport { pairs, .. } = self.intersections;
        let counts = [
            (Promise::Closed, border_edges as u64, "border edge"),
            (Promise::Manifold, non_manifold_edges as u64, "edge with more than two triangles"),
            (Promise::Manifold, non_manifold_vertices as u64, "vertex with more than one fan"),
            (Promise::Oriented, misoriented_edges as u64, "misoriented edge"),
            (Promise::NotDegenerate, degenerate_triangles as u64, "degenerate triangle"),
            (Promise::NoIntersections, pairs, "intersecting pair of triangles"),
        ];
        let broken = counts.into_iter().filter(|&(_, count, _)| count > 0);
        broken.map(|(promise, count, what)| BrokenPromise { promise, how: counted(count, what) }).collect()
    }

    /// Whether the mesh is closed, 2-manifold, oriented, and free of degenerate and intersecting
    /// triangles.
    pub fn is_sound(&self) -> bool {
        self.broken().is_empty()
    }
}

/// Returns a count with its noun in the right number.
fn counted(count: u64, what: &str) -> String {
    match (count, what.split_once(' ')) {
        (1, _) => format!("1 {what}"),
        (n, Some(("border" | "misoriented" | "degenerate", _))) => format!("{n} {what}s"),
        (n, Some(("edge", rest))) => format!("{n} edges {rest}"),
        (n, Some(("vertex", rest))) => format!("{n} vertices {rest}"),
        (n, _) => format!("{n} intersecting pairs of triangles"),
    }
}

/// Returns the errors above the tolerance, either way.
pub(super) fn of_errors(
    distance: &DistanceReport,
    missing: &MissingReport,
    tolerance: f64,
) -> Vec<BrokenPromise> {
    let errors = [
        (distance.max.units, "OUTPUT is off by up to"),
        (missing.max.units, "parts of the true offset surface are missing, up to"),
    ];
    let above = errors.into_iter().filter(|&(error, _)| error > tolerance);
    let describe = |(error, what)| BrokenPromise {
        promise: Promise::Tolerance,
        how: format!("{what} {error:.6e}, above {tolerance:.6e}"),
    };
    above.map(describe).collect()
}

/// Returns the fault of a wall that is not there, or too thin.
pub(super) fn of_shell(shell: &ShellReport, tolerance: Option<f64>) -> Option<BrokenPromise> {
    let how = match (shell.thickness, tolerance) {
        (None, _) => {
            let missing = if shell.offset_triangles == 0 { "the offset" } else { "INPUT's surface" };
            format!("a shell has two sheets, and the one at {missing} is not there")
        }
        (Some(t), Some(tolerance)) if t.min.units < shell.wanted - tolerance => {
            format!("the wall is {:.6e} at its thinnest, of {:.6e}", t.min.units, shell.wanted)
        }
        _ => return None,
    };
    Some(BrokenPromise { promise: Promise::Thickness, how })
}
