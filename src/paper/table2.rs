//! Table II: time over the resolution.

use super::PaperError;
use super::lab::{Lab, PUBLISHED_MACHINE};
use super::models::PaperModel;
use super::report::{Cell, Report};
use crate::quantity::VoxelSize;

/// The offset of the table, as a part of the diagonal.
const OFFSET: f64 = 0.02;

/// \[LW11\] Table II: triangles, by how much the sides of the stand-in's triangles are divided to
/// be in the same ratio (9 for 10), and seconds on grids of 65^3, 129^3, 257^3, 513^3 nodes.
const PUBLISHED: [(&str, u32, [f64; 4]); 2] =
    [("40k", 1, [0.53, 0.98, 3.34, 21.6]), ("400k", 3, [4.6, 5.3, 8.4, 28.7])];

/// The grids' cells, as divisors of the full resolution.
const DIVISORS: [u32; 4] = [8, 4, 2, 1];

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "paper's model",
        "F#",
        "paper's grid",
        "paper T_tot",
        "here",
        "triangles",
        "cells",
        "hierarchy",
        "band",
        "edges",
        "contour",
        "total",
        "result",
    ]);
    for (faces, cuts, published) in PUBLISHED {
        let model = lab.refined_model(PaperModel::Chair, cuts)?;
        for (seconds, divisor) in published.into_iter().zip(DIVISORS) {
            let cells = (lab.settings.resolution / divisor).max(1);
            let mut row = vec![
                Cell::text(PaperModel::Chair.name()),
                Cell::text(faces),
                Cell::text(format!("{}^3", super::PUBLISHED_RESOLUTION / divisor + 1)),
                Cell::Seconds(seconds),
                Cell::text(&model.name),
                Cell::Count(model.mesh.triangles.len() as u64),
                Cell::Count(cells.into()),
            ];
            match lab.offset(&model, OFFSET, VoxelSize::Resolution(cells))? {
                Some(result) => {
                    let times = result.statistics.times;
                    row.extend(
                        [times.hierarchy, times.band, times.edges, times.contour, times.total()]
                            .map(Cell::Seconds),
                    );
                    row.push(Cell::Count(result.mesh.triangles.len() as u64));
                }
                None => row.extend([const { Cell::Nothing }; 5].into_iter().chain([Cell::text("empty")])),
            }
            report.push(row);
        }
    }
    report.notes = vec![
        PUBLISHED_MACHINE.into(),
        lab.conditions(),
        "the finer model has the same surface, each triangle cut into nine".into(),
    ];
    Ok(report)
}
