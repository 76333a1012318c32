//! Table VII: the distance error of the result.
//!
//! The paper's errors are relative to the offset value: taken as parts of the diagonal, the dragon's maximum of
//! 0.094 would be 48 voxels; relative to its offset of 0.02 it is about one.

use super::error_samples::errors;
use super::lab::Lab;
use super::models::PaperModel;
use super::report::{Cell, Report};
use crate::error::Error;

/// A published row: offset, average and maximum error, both relative to the offset.
type Row = (f64, f64, f64);

/// \[LW11\] Table VII.
const PUBLISHED: [(PaperModel, &str, &[Row]); 6] = [
    (PaperModel::CarveCube, "7.1k", &[(-0.04, 0.000029, 0.0009), (0.05, 0.000038, 0.00074)]),
    (
        PaperModel::AnchorPlate,
        "9k",
        &[(-0.041, 0.00017, 0.033), (0.013, 0.00072, 0.016), (0.2, 0.000024, 0.0017)],
    ),
    (PaperModel::OctaFlower, "15.8k", &[(-0.05, 0.00006, 0.02), (0.1, 0.000063, 0.0027)]),
    (PaperModel::Dragon, "49.4k", &[(-0.02, 0.000094, 0.094), (0.03, 0.0008, 0.061)]),
    (PaperModel::VaseLion, "400k", &[(-0.02, 0.00078, 0.07), (0.04, 0.0004, 0.027)]),
    (PaperModel::Rabbit, "134k", &[(-0.03, 0.000096, 0.053)]),
];

pub(super) fn measure(lab: &Lab) -> Result<Report, Error> {
    let mut report = Report::new(&[
        "paper's model",
        "F#",
        "offset",
        "paper avg",
        "paper max",
        "here",
        "avg",
        "max",
        "avg / h",
        "max / h",
        "samples",
    ]);
    for (of, faces, rows) in PUBLISHED {
        let model = lab.model(of)?;
        let distance = lab.distance(&model);
        for &(fraction, mean, max) in rows {
            let mut row = vec![Cell::text(of.name()), Cell::text(faces), Cell::Number(fraction)];
            row.extend([Cell::Number(mean), Cell::Number(max), Cell::text(&model.name)]);
            match lab.offset(&model, fraction, lab.fitted_grid())? {
                Some(result) => {
                    let (r, h) = (result.statistics.distance, result.statistics.voxel);
                    let found = errors(&distance, &result.mesh, r, lab.run)?;
                    let relative = [found.mean / r.abs(), found.max / r.abs(), found.mean / h, found.max / h];
                    row.extend(relative.map(Cell::Number));
                    row.push(Cell::Count(found.samples));
                }
                None => row.extend([const { Cell::Nothing }; 5]),
            }
            report.push(row);
        }
    }
    report.notes = vec![
        lab.conditions(),
        "errors: | |dis(p)| - |r| | / |r| at vertices, edge midpoints and centroids; h is the voxel size"
            .into(),
    ];
    Ok(report)
}
