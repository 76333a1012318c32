//! Table I: time by phase, per model and offset.

use super::PaperError;
use super::lab::{Lab, PUBLISHED_MACHINE};
use super::models::PaperModel;
use super::report::{Cell, Report};

/// A published row: offset, then T_s, T_d, T_c, T_tot in seconds; `None` where the table has no
/// entry.
type Row = (f64, [Option<f64>; 4]);

/// \[LW11\] Table I. T_s stands once per model. The rabbit's T_s is T_tot less the other two. T_tot
/// of the anchor plate at -0.041 is less than the sum of its parts, in the paper as well.
const PUBLISHED: [(PaperModel, &str, &[Row]); 6] = [
    (
        PaperModel::CarveCube,
        "7.1k",
        &[
            (-0.04, [Some(0.06), Some(13.2), Some(15.7), Some(28.96)]),
            (0.05, [None, Some(13.8), Some(17.8), Some(31.66)]),
        ],
    ),
    (
        PaperModel::AnchorPlate,
        "9k",
        &[
            (-0.041, [Some(0.06), Some(6.4), Some(13.0), Some(16.96)]),
            (0.013, [None, Some(7.2), Some(13.9), Some(21.16)]),
            (0.2, [None, Some(16.15), Some(18.13), Some(34.33)]),
        ],
    ),
    (
        PaperModel::OctaFlower,
        "15.8k",
        &[
            (-0.05, [Some(0.15), Some(4.95), Some(13.45), Some(18.55)]),
            (0.1, [None, Some(12.2), Some(16.2), Some(28.55)]),
        ],
    ),
    (
        PaperModel::Dragon,
        "49.4k",
        &[
            (-0.02, [Some(0.45), Some(8.16), Some(13.65), Some(22.26)]),
            (0.03, [None, Some(13.8), Some(15.37), Some(29.62)]),
        ],
    ),
    (
        PaperModel::VaseLion,
        "400k",
        &[
            (-0.02, [Some(4.2), Some(15.8), Some(15.5), Some(35.5)]),
            (0.04, [None, Some(17.0), Some(17.2), Some(38.4)]),
        ],
    ),
    (PaperModel::Rabbit, "134k", &[(-0.03, [Some(1.3), Some(5.6), Some(13.5), Some(20.4)])]),
];

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "paper's model",
        "F#",
        "offset",
        "T_s",
        "T_d",
        "T_c",
        "T_tot",
        "here",
        "triangles",
        "hierarchy",
        "band",
        "edges",
        "contour",
        "total",
        "result",
    ]);
    for (of, faces, rows) in PUBLISHED {
        let model = lab.model(of)?;
        for (fraction, published) in rows {
            let mut row = vec![Cell::text(of.name()), Cell::text(faces), Cell::Number(*fraction)];
            row.extend(published.map(|t| t.map_or(Cell::Nothing, Cell::Seconds)));
            row.extend([Cell::text(&model.name), Cell::Count(model.mesh.triangles.len() as u64)]);
            match lab.offset(&model, *fraction, lab.fitted_grid())? {
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
        "the paper's T_s is the hierarchy, T_d the band, T_c edges and contour".into(),
    ];
    Ok(report)
}
