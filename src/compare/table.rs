//! The table: the same cells for the terminal and for the page.

use super::{Comparison, Measurement, MethodResult};
use crate::verify::VerifyReport;

/// A column: its heading in two lines (what, in what unit), and what it says.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Heading.
    pub name: &'static str,
    /// Unit, below the heading; may be empty.
    pub unit: &'static str,
    /// Meaning of the column, in a sentence.
    pub about: &'static str,
    cell: fn(&Measurement, &VerifyReport) -> Option<f64>,
    show: fn(f64) -> String,
    best: Best,
}

/// The good end of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Best {
    Lowest,
    Highest,
    Neither,
}

/// A row: a method, and its cells or what happened to it.
#[derive(Clone, Debug)]
pub struct Row<'a> {
    /// The method and all that is known of it.
    pub result: &'a MethodResult,
    /// The text of each column, and whether it is the best of its column; empty when there is no
    /// measurement.
    pub cells: Vec<(String, bool)>,
}

impl Column {
    /// The columns of the table.
    pub const ALL: [Column; 14] = [
        column(
            "hierarchy",
            "s",
            "building the search structure, where it is a phase of its own",
            |m, _| phase(m, &["hierarchy"]),
            seconds,
            Best::Neither,
        ),
        column("band", "s", "distances on the lattice", |m, _| phase(m, &["band"]), seconds, Best::Neither),
        column(
            "edges / offset",
            "s",
            "edge intersections (exocarp) or moving the level set (OpenVDB)",
            |m, _| phase(m, &["edges", "offset"]),
            seconds,
            Best::Neither,
        ),
        column("contour", "s", "polygons", |m, _| phase(m, &["contour"]), seconds, Best::Neither),
        column(
            "engine",
            "s",
            "wall time from mesh in memory to offset surface in memory",
            |m, _| Some(m.engine),
            seconds,
            Best::Lowest,
        ),
        column(
            "memory",
            "MB",
            "most memory resident in the process",
            |m, _| m.peak_memory.map(|b| b as f64),
            megabytes,
            Best::Lowest,
        ),
        column(
            "active",
            "voxels",
            "active voxels of the grid that is contoured",
            |m, _| m.active_voxels.map(|n| n as f64),
            count,
            Best::Neither,
        ),
        column(
            "triangles",
            "",
            "triangles of the result",
            |m, _| Some(m.triangles as f64),
            count,
            Best::Neither,
        ),
        column(
            "mean error",
            "voxels",
            "mean of | |dis| - |D| | over the surface",
            |_, q| q.distance.surface.mean.voxels,
            error,
            Best::Lowest,
        ),
        column(
            "max error",
            "voxels",
            "the largest of surface samples, vertices and edge midpoints",
            |_, q| q.distance.max.voxels,
            error,
            Best::Lowest,
        ),
        column(
            "missing",
            "voxels",
            "how far the true offset surface gets from the result",
            |_, q| q.missing.max.voxels,
            error,
            Best::Lowest,
        ),
        column(
            "creases",
            "%",
            "length of the true offset's creases along which the result has an edge",
            |_, q| q.creases.share.map(|s| 100.0 * s),
            percent,
            Best::Highest,
        ),
        column(
            "crossing",
            "pairs",
            "pairs of triangles that intersect",
            |_, q| Some(q.soundness.intersections.pairs as f64),
            count,
            Best::Lowest,
        ),
        column(
            "non-manifold",
            "",
            "edges with more than two triangles, and vertices with more than one fan",
            |_, q| {
                Some(
                    (q.soundness.topology.non_manifold_edges + q.soundness.topology.non_manifold_vertices)
                        as f64,
                )
            },
            count,
            Best::Lowest,
        ),
    ];
}

const fn column(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    cell: fn(&Measurement, &VerifyReport) -> Option<f64>,
    show: fn(f64) -> String,
    best: Best,
) -> Column {
    Column { name, unit, about, cell, show, best }
}

fn phase(m: &Measurement, names: &[&str]) -> Option<f64> {
    m.phases.iter().find(|p| names.contains(&p.name.as_str())).map(|p| p.seconds)
}

/// The cells of all methods.
pub fn rows(comparison: &Comparison) -> Vec<Row<'_>> {
    let values: Vec<Vec<Option<f64>>> = comparison
        .results
        .iter()
        .map(|r| match (&r.median, &r.quality) {
            (Some(m), Some(q)) => Column::ALL.iter().map(|c| (c.cell)(m, q)).collect(),
            _ => Vec::new(),
        })
        .collect();
    let best = |k: usize| {
        let of_column = || values.iter().filter_map(|row| row.get(k).copied().flatten());
        match Column::ALL[k].best {
            Best::Lowest => of_column().reduce(f64::min),
            Best::Highest => of_column().reduce(f64::max),
            Best::Neither => None,
        }
    };
    let cells = |row: &[Option<f64>]| {
        let cell = |(k, value): (usize, &Option<f64>)| match value {
            // Compared as shown: a hundredth of what is printed makes no winner.
            Some(x) => {
                let show = Column::ALL[k].show;
                (show(*x), best(k).is_some_and(|b| show(b) == show(*x)))
            }
            None => ("-".into(), false),
        };
        row.iter().enumerate().map(cell).collect()
    };
    comparison.results.iter().zip(&values).map(|(result, row)| Row { result, cells: cells(row) }).collect()
}

/// The table for a terminal; an asterisk marks the best of a column.
pub fn text(comparison: &Comparison) -> String {
    let rows = rows(comparison);
    let first = rows.iter().map(|r| r.result.method.title().len()).max().unwrap_or(0);
    let marked = |(text, best): &(String, bool)| format!("{text}{}", if *best { "*" } else { " " });
    let width = |k: usize| {
        let column = Column::ALL[k];
        let widest = rows.iter().filter_map(|r| r.cells.get(k)).map(|c| marked(c).len()).max();
        widest.unwrap_or(0).max(column.name.len() + 1).max(column.unit.len() + 1)
    };
    let widths: Vec<usize> = (0..Column::ALL.len()).map(width).collect();
    let line = |head: &str, cells: Vec<String>| {
        let cells: String = cells.iter().zip(&widths).map(|(c, w)| format!(" {c:>w$}")).collect();
        format!("{}\n", format!("{head:<first$}{cells}").trim_end())
    };
    let mut table = line("method", Column::ALL.iter().map(|c| format!("{} ", c.name)).collect());
    table += &line("", Column::ALL.iter().map(|c| format!("{} ", c.unit)).collect());
    for row in &rows {
        let title = row.result.method.title();
        if !row.cells.is_empty() {
            table += &line(title, row.cells.iter().map(marked).collect());
        }
        if let Some(lost) = &row.result.lost {
            table += &format!("{title:<first$} {lost}\n");
        }
    }
    table
}

pub(super) fn seconds(x: f64) -> String {
    format!("{x:.2}")
}

fn megabytes(bytes: f64) -> String {
    format!("{:.0}", bytes / 1_048_576.0)
}

fn percent(x: f64) -> String {
    // A sum of nothing is -0.
    format!("{:.1}", x + 0.0)
}

/// An error in voxels: two significant digits, and never shorter than they are worth.
pub(super) fn error(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        _ if x < 0.0001 => format!("{x:.0e}"),
        _ if x < 0.01 => format!("{x:.4}"),
        _ => format!("{x:.3}"),
    }
}

/// A count as text, `1234567.0` as `1,234,567`.
pub(super) fn count(n: f64) -> String {
    grouped(n.round_ties_even() as u64)
}

/// Returns a number with commas: `1234567` as `1,234,567`.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(c);
    }
    text
}
