//! Table VI: convex/concave analysis against the polygon-edge intersection test of Ju and Udeshi
//! (2006).

use super::PaperError;
use super::lab::Lab;
use super::models::PaperModel;
use super::report::{Cell, Report};
use crate::contour::{ContourSettings, DiagonalTest, time_diagonal_tests};
use crate::edge::solve;

/// A published row: offset, triangles in thousands and seconds of the method in \[8\], the same of
/// the analysis.
type Row = (f64, [(u64, f64); 2]);

/// \[LW11\] Table VI.
const PUBLISHED: [(PaperModel, &str, &[Row]); 4] = [
    (PaperModel::Buddha, "1M", &[(0.02, [(974, 0.094), (964, 0.046)])]),
    (PaperModel::Filigree, "500k", &[(0.02, [(1031, 0.093), (1021, 0.046)])]),
    (PaperModel::Chair, "400k", &[(0.02, [(1041, 0.11), (1041, 0.062)])]),
    (
        PaperModel::Warrior,
        "200k",
        &[(0.02, [(567, 0.062), (565, 0.031)]), (-0.01, [(327, 0.031), (325, 0.015)])],
    ),
];

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "paper's model",
        "F#",
        "offset",
        "figures",
        "here",
        "JU triangles",
        "JU s",
        "CC triangles",
        "CC s",
        "JU s / CC s",
        "JU split",
        "CC split",
    ]);
    for (of, faces, rows) in PUBLISHED {
        let model = lab.model(of)?;
        let distance = lab.distance(&model);
        for &(fraction, published) in rows {
            let [(ju, ju_seconds), (cc, cc_seconds)] = published;
            let mut row = vec![Cell::text(of.name()), Cell::text(faces), Cell::Number(fraction)];
            row.extend([Cell::text("paper"), Cell::text("")]);
            row.extend([Cell::Thousands(ju), Cell::Seconds(ju_seconds)]);
            row.extend([Cell::Thousands(cc), Cell::Seconds(cc_seconds)]);
            row.extend([Cell::Number(round(ju_seconds / cc_seconds)), Cell::Nothing, Cell::Nothing]);
            report.push(row);

            let mut row = vec![
                Cell::text(of.name()),
                Cell::text(model.mesh.triangles.len().to_string()),
                Cell::Number(fraction),
                Cell::text("here"),
                Cell::text(&model.name),
            ];
            let Some(field) = lab.field(&model, &distance, fraction, lab.fitted_grid())? else {
                row.extend([const { Cell::Nothing }; 7]);
                report.push(row);
                continue;
            };
            let (lattice, r) = (field.settings.lattice, field.settings.r);
            let (crossings, _) =
                solve(&distance, lattice, r, &field.signs, field.numbers, &field.near, lab.run)?;
            let settings = ContourSettings::default();
            let methods = [DiagonalTest::PolygonEdges, DiagonalTest::ConvexConcave];
            let [ju, cc] =
                time_diagonal_tests(&field.signs, &crossings, lattice, &settings, methods, lab.run)?;
            row.extend([Cell::Count(ju.triangles), Cell::Seconds(ju.seconds)]);
            row.extend([Cell::Count(cc.triangles), Cell::Seconds(cc.seconds)]);
            let ratio = round(ju.seconds / cc.seconds.max(f64::MIN_POSITIVE));
            row.extend([Cell::Number(ratio), Cell::Count(ju.split), Cell::Count(cc.split)]);
            report.push(row);
        }
    }
    report.notes = vec![
        lab.conditions(),
        "JU: polygon-edge intersections (the paper's reference [8]); CC: convex/concave analysis; split: polygons \
         that needed a vertex on their grid edge"
            .into(),
        "here: the choice and the cutting of all polygons on one thread, both over the same exact predicates".into(),
    ];
    Ok(report)
}

/// To hundredths.
fn round(x: f64) -> f64 {
    (100.0 * x).round() / 100.0
}
