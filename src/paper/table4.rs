//! Table IV: number of distance computations by filter.
//!
//! The subscript of the paper's BB_m is said to be the box's side in cells. Its figures say
//! otherwise: those of BB_8 are multiples of 64^3 = 262,144, and those of BB_64 multiples of 8^3,
//! so m counts the boxes along an axis. Here the columns are named by cells; 64 cells stand beside
//! BB_8. They are nodes only, too: queries at the boxes' centres are not in them. For BB + OT and
//! BB + SD + OT the figures are sums, with the queries at boxes as their part in brackets. Section
//! IV.D has the octree filter test signed distances, but then SD could save little after it; the
//! counts of BB + OT fit unsigned ones, and so it is done here without SD.

use super::PaperError;
use super::lab::Lab;
use super::models::PaperModel;
use super::report::{Cell, Report};
use crate::band::{self, LeafBatch, count_queries};
use crate::filter::{BoxSide, FilterSettings, FilterStatistics, Switch};

/// A published row, in thousands: offset; BB_8 to BB_64; the same with SD; BB + OT and BB + SD +
/// OT, each with its part for boxes.
type Row = (f64, [u64; 4], [u64; 4], [u64; 2], [u64; 2]);

/// \[LW11\] Table IV, on the terracotta warrior with 60k triangles. At 0.02 the paper prints 3,113
/// without its k for BB_16 + SD.
const PUBLISHED: [Row; 9] = [
    (-0.04, [5767, 2982, 2023, 1583], [3670, 1737, 1110, 556], [585, 159], [120, 41]),
    (-0.02, [5243, 2785, 1790, 1322], [4194, 2228, 1307, 819], [620, 152], [240, 72]),
    (-0.01, [5243, 2654, 1638, 1196], [4981, 2294, 1397, 943], [625, 129], [325, 89]),
    (0.01, [5505, 2785, 1818, 1269], [5505, 2785, 1818, 1269], [642, 136], [476, 122]),
    (0.02, [6029, 3113, 2073, 1506], [6029, 3113, 2073, 1506], [775, 169], [534, 139]),
    (0.04, [6291, 3899, 2699, 2017], [6291, 3899, 2699, 2018], [750, 203], [630, 170]),
    (0.08, [10224, 5833, 4227, 2668], [10224, 5833, 4104, 2668], [865, 240], [858, 234]),
    (0.16, [16777, 11239, 7258, 4248], [16777, 11239, 7258, 4248], [1410, 389], [1410, 389]),
    (0.32, [40370, 26116, 15667, 8847], [40370, 26116, 15667, 8847], [2846, 797], [2846, 797]),
];

/// The offset that the grid of all rows is fitted to.
const LARGEST: f64 = 0.32;

/// Box sides of the first eight columns as powers of two: 64, 32, 16 and 8 cells.
const SIDES: [u32; 4] = [6, 5, 4, 3];

/// The box side with the octree filter: 128 cells.
const OCTREE_SIDE: u32 = 7;

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "offset",
        "figures",
        "BB 64",
        "BB 32",
        "BB 16",
        "BB 8",
        "BB+SD 64",
        "BB+SD 32",
        "BB+SD 16",
        "BB+SD 8",
        "BB+OT",
        "(boxes of BB+OT)",
        "BB+SD+OT",
        "(boxes of BB+SD+OT)",
        "valid nodes",
        "of all nodes",
    ]);
    let model = lab.model(PaperModel::Warrior)?;
    let distance = lab.distance(&model);
    let grid = lab.shared_grid(&model, LARGEST, lab.settings.resolution)?;
    for (fraction, bb, sd, ot, all) in PUBLISHED {
        let mut row = vec![Cell::Number(fraction), Cell::text("paper")];
        row.extend([bb, sd].as_flattened().iter().chain(&ot).chain(&all).map(|&n| Cell::Thousands(n)));
        row.push(Cell::Nothing);
        row.push(Cell::Part(1e3 * all[0] as f64 / 513f64.powi(3)));
        report.push(row);

        let settings = lab.offset_settings(&model, fraction, grid).in_model_units(&model.mesh)?;
        let count = |n, signed_distance, octree| {
            let side = BoxSide::PowerOfTwo(n);
            let filters = FilterSettings { side, signed_distance, octree, ..FilterSettings::default() };
            count_queries(&distance, &settings, &filters, lab.run)
        };
        let mut row = vec![Cell::Nothing, Cell::text("here")];
        for signed_distance in [Switch::Off, Switch::On] {
            for n in SIDES {
                row.push(Cell::Count(count(n, signed_distance, Switch::Off)?.node_queries));
            }
        }
        let mut last = FilterStatistics::default();
        for signed_distance in [Switch::Off, Switch::On] {
            last = count(OCTREE_SIDE, signed_distance, Switch::On)?;
            row.push(Cell::Count(last.distance_computations()));
            row.push(Cell::Count(last.distance_computations() - last.node_queries));
        }
        let built = band::build(&distance, &settings, lab.run, |_: LeafBatch| Ok::<_, PaperError>(()))?;
        row.push(Cell::Count(built.valid_nodes));
        let cube = f64::from(lab.settings.resolution + 1).powi(3);
        row.push(Cell::Part(last.distance_computations() as f64 / cube));
        report.push(row);
    }
    report.notes = vec![
        format!("paper: terracotta-warrior, 60k triangles, 513^3 nodes; here: {}, {} triangles", model.name, model.mesh.triangles.len()),
        lab.conditions(),
        "one grid for all rows, fitted to the offset 0.32".into(),
        "columns by the box's side in cells; the paper's BB_8 to BB_64 are its boxes along an axis, and have 64 to \
         8 cells"
            .into(),
        "BB and BB+SD: nodes in the boxes that are kept, without the queries at the boxes' centres, as in the paper; \
         the nodes are counted, not evaluated"
            .into(),
        "BB+OT and BB+SD+OT: all queries, with boxes of 128 cells, and those at boxes among them".into(),
        "of all nodes: BB+SD+OT as a part of the full cube of nodes".into(),
    ];
    Ok(report)
}
