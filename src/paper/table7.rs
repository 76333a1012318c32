//! Table VII: the distance error of the result.
//!
//! The paper's errors are relative to the offset value: taken as parts of the diagonal, the
//! dragon's maximum of 0.094 would be 48 voxels; relative to its offset of 0.02 it is about one.

use super::PaperError;
use super::lab::Lab;
use super::models::{Model, PaperModel};
use super::report::{Cell, Report};
use crate::offset::OffsetResult;
use crate::quantity::Length;
use crate::verify::judge::distance_error;
use crate::verify::{DistanceReport, VerifySettings};

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

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
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
        for &(fraction, mean, max) in rows {
            let mut row = vec![Cell::text(of.name()), Cell::text(faces), Cell::Number(fraction)];
            row.extend([Cell::Number(mean), Cell::Number(max), Cell::text(&model.name)]);
            match lab.offset(&model, fraction, lab.fitted_grid())? {
                Some(result) => {
                    let (r, h) = (result.statistics.distance, result.statistics.voxel);
                    let found = errors(lab, &model, &result)?;
                    let (mean, max) = (found.surface.mean.units, found.max.units);
                    row.extend([mean / r.abs(), max / r.abs(), mean / h, max / h].map(Cell::Number));
                    let samples = [&found.surface, &found.vertices, &found.edge_midpoints].map(|s| s.samples);
                    row.push(Cell::Count(samples.iter().sum::<usize>() as u64));
                }
                None => row.extend([const { Cell::Nothing }; 5]),
            }
            report.push(row);
        }
    }
    report.notes = vec![
        lab.conditions(),
        "errors: | |dis(p)| - |r| | / |r|; avg over the area, max also at vertices and edge midpoints; h is the \
         voxel size"
            .into(),
    ];
    Ok(report)
}

/// The errors of a result, as `verify` takes them.
pub(super) fn errors(lab: &Lab, model: &Model, result: &OffsetResult) -> Result<DistanceReport, PaperError> {
    let settings = VerifySettings {
        distance: Length::Units(result.statistics.distance),
        // verify looks at no more than four times as many vertices and edge midpoints: with a
        // sample for each triangle it leaves none out, and a table of maxima wants them all.
        samples: result.mesh.triangles.len(),
        ..VerifySettings::default()
    };
    Ok(distance_error(&model.mesh, &result.mesh, &settings, lab.run)?)
}
