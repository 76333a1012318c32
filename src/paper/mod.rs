//! The tables of \[LW11\] (Liu and Wang, *Fast intersection-free offset surface generation from
//! freeform models with triangular meshes*, IEEE T-ASE 8(2), 2011), measured here and printed
//! beside the published figures.
//!
//! | table | file | what |
//! |---|---|---|
//! | I | `table1` | time by phase, per model and offset |
//! | II | `table2` | time over the resolution |
//! | III | `table3` | time over the offset distance |
//! | IV | `table4` | distance computations by filter |
//! | V | `table5` | edges solved after so many subdivisions, hybrid and bisection |
//! | VI | `table6` | convex/concave analysis against polygon-edge intersections |
//! | VII | `table7` | errors of the result |
//!
//! Most of the paper's models are not public. `models` says which model stands for which; a reader
//! of a table must hold figures against each other in kind, not in digits.

mod error;
mod lab;
mod models;
mod report;
mod table1;
mod table2;
mod table3;
mod table4;
mod table5;
mod table6;
mod table7;
#[cfg(test)]
mod tests;

pub use error::PaperError;
pub use report::{Cell, Report};

use crate::run::RunSettings;
use lab::Lab;
use std::path::PathBuf;

/// The grid of the paper's tables: 512 cells, 513 nodes along each axis.
pub const PUBLISHED_RESOLUTION: u32 = 512;

/// A table of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Table {
    /// I: time by phase.
    Times,
    /// II: time over the resolution.
    Resolutions,
    /// III: time over the offset distance.
    Distances,
    /// IV: distance computations by filter.
    Filters,
    /// V: edges by subdivisions.
    Edges,
    /// VI: two ways to keep triangles apart.
    Intersections,
    /// VII: errors.
    Errors,
}

impl Table {
    /// All tables in order.
    pub const ALL: [Table; 7] = [
        Table::Times,
        Table::Resolutions,
        Table::Distances,
        Table::Filters,
        Table::Edges,
        Table::Intersections,
        Table::Errors,
    ];

    /// The table with a number from 1 to 7.
    pub fn from_number(number: u32) -> Option<Table> {
        Table::ALL.into_iter().find(|table| table.number() == number)
    }

    /// Returns the number of the table, 1 to 7.
    pub fn number(self) -> u32 {
        self as u32 + 1
    }

    /// Returns the caption of the table.
    pub fn title(self) -> &'static str {
        match self {
            Table::Times => "I. Time per model and offset (seconds)",
            Table::Resolutions => "II. Time over the resolution, offset 0.02 (seconds)",
            Table::Distances => "III. Time over the offset distance (seconds)",
            Table::Filters => "IV. Number of distance computations by filter",
            Table::Edges => "V. Edges solved after S_d subdivisions",
            Table::Intersections => "VI. Convex/concave analysis against polygon-edge intersections",
            Table::Errors => "VII. Distance error of the result, relative to the offset",
        }
    }
}

/// Settings of the tables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaperSettings {
    /// Cells along the longest side where the paper has 512.
    pub resolution: u32,
    /// Mesh files to take models from, by name; generated models stand in for what is not among
    /// them.
    pub files: Vec<PathBuf>,
    /// As in [`OffsetSettings`](crate::offset::OffsetSettings).
    pub max_memory: Option<u64>,
}

impl Default for PaperSettings {
    fn default() -> Self {
        PaperSettings { resolution: PUBLISHED_RESOLUTION, files: Vec::new(), max_memory: None }
    }
}

/// Measures one table.
///
/// # Errors
/// A file that cannot be read, or what [`offset`](crate::offset::offset) fails with. An offset that
/// is empty is a row that says so.
pub fn measure(table: Table, settings: &PaperSettings, run: &RunSettings) -> Result<Report, PaperError> {
    let lab = Lab { settings, run };
    let mut report = match table {
        Table::Times => table1::measure(&lab),
        Table::Resolutions => table2::measure(&lab),
        Table::Distances => table3::measure(&lab),
        Table::Filters => table4::measure(&lab),
        Table::Edges => table5::measure(&lab),
        Table::Intersections => table6::measure(&lab),
        Table::Errors => table7::measure(&lab),
    }?;
    (report.table, report.title) = (table.number(), table.title());
    Ok(report)
}
