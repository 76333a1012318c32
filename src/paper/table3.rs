//! Table III: time over the offset distance.

use super::PaperError;
use super::lab::{Lab, PUBLISHED_MACHINE};
use super::models::PaperModel;
use super::report::{Cell, Report};

/// A published row: offset, T_tot in seconds.
type Row = (f64, f64);

/// \[LW11\] Table III, Figs. 17 to 19.
const PUBLISHED: [(PaperModel, &str, [Row; 6]); 3] = [
    (
        PaperModel::RockerArm,
        "20k",
        [(0.01, 19.8), (0.02, 20.7), (0.04, 22.4), (0.08, 26.0), (0.16, 31.7), (0.32, 50.7)],
    ),
    (
        PaperModel::Warrior,
        "200k",
        [(-0.02, 18.6), (-0.01, 19.2), (0.01, 19.7), (0.02, 21.2), (0.04, 23.1), (0.08, 26.6)],
    ),
    (
        PaperModel::Filigree,
        "260k",
        [(-0.005, 26.8), (0.005, 29.5), (0.01, 30.6), (0.02, 33.5), (0.04, 37.4), (0.08, 49.2)],
    ),
];

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "paper's model",
        "F#",
        "offset",
        "paper T_tot",
        "here",
        "triangles",
        "band",
        "edges",
        "contour",
        "total",
        "result",
    ]);
    for (of, faces, rows) in PUBLISHED {
        let model = lab.model(of)?;
        let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row.0));
        let grid = lab.shared_grid(&model, largest, lab.settings.resolution)?;
        for (fraction, seconds) in rows {
            let mut row = vec![
                Cell::text(of.name()),
                Cell::text(faces),
                Cell::Number(fraction),
                Cell::Seconds(seconds),
                Cell::text(&model.name),
                Cell::Count(model.mesh.triangles.len() as u64),
            ];
            match lab.offset(&model, fraction, grid)? {
                Some(result) => {
                    let times = result.statistics.times;
                    row.extend([times.band, times.edges, times.contour, times.total()].map(Cell::Seconds));
                    row.push(Cell::Count(result.mesh.triangles.len() as u64));
                }
                None => row.extend([const { Cell::Nothing }; 4].into_iter().chain([Cell::text("empty")])),
            }
            report.push(row);
        }
    }
    report.notes = vec![
        PUBLISHED_MACHINE.into(),
        lab.conditions(),
        "one grid per model, fitted to its largest offset".into(),
    ];
    Ok(report)
}
