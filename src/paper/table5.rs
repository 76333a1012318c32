//! Table V: edges solved after S_d subdivisions, hybrid and bisection.

use super::PaperError;
use super::lab::Lab;
use super::models::{Model, PaperModel};
use super::report::{Cell, Report};
use crate::distance::SignedDistance;
use crate::edge::{EdgeSettings, EdgeStatistics, RootMethod, solve_by};
use crate::lattice::Slab;
use std::time::Instant;

/// Published percentages: S_d = 0, 1, 2, up to 6; bisection up to 6.
type Percent = [f64; 5];

/// \[LW11\] Table V, first part: triangles, division of the stand-in's triangle sides for about the
/// same ratio, intersected edges, percentages. Offset 0.02, 513^3.
const BY_TRIANGLES: [(&str, u32, u64, Percent); 3] = [
    ("60k", 1, 85032, [71.5, 15.4, 7.0, 99.5, 6.4]),
    ("200k", 2, 85032, [51.3, 20.6, 13.3, 98.8, 6.4]),
    ("600k", 3, 85032, [34.7, 20.3, 17.7, 97.6, 6.4]),
];

/// Second part, by offset: 60k triangles, 513^3.
const BY_OFFSET: [(f64, u64, Percent); 9] = [
    (-0.04, 16646, [64.8, 15.2, 9.5, 99.2, 6.9]),
    (-0.02, 34952, [52.0, 19.8, 13.4, 98.8, 6.6]),
    (-0.01, 49208, [44.3, 22.7, 15.8, 98.7, 6.9]),
    (0.01, 77356, [59.1, 21.5, 10.7, 99.4, 6.6]),
    (0.02, 85032, [71.5, 15.4, 7.0, 99.5, 6.4]),
    (0.04, 101458, [82.1, 9.5, 4.5, 99.7, 6.6]),
    (0.08, 139356, [89.6, 5.5, 2.5, 99.8, 6.5]),
    (0.16, 229504, [94.8, 2.7, 1.2, 99.9, 6.6]),
    (0.32, 463838, [97.6, 1.2, 0.6, 99.9, 6.4]),
];

/// Third part, by resolution: divisor of the full one, 60k triangles, offset 0.02.
const BY_RESOLUTION: [(u32, u64, Percent); 4] = [
    (8, 1268, [6.2, 15.5, 27.0, 97.7, 0.8]),
    (4, 5520, [20.4, 25.5, 22.2, 93.4, 1.5]),
    (2, 21030, [47.6, 24.7, 14.8, 99.3, 3.0]),
    (1, 85032, [72.1, 14.9, 7.0, 99.5, 6.4]),
];

/// The offset of the first and third part.
const OFFSET: f64 = 0.02;

/// The offset that the grid of all rows is fitted to.
const LARGEST: f64 = 0.32;

/// The paper's tolerance of 1e-5 in voxels of its grid of 512 cells. It has no unit; this is what
/// its bisection column needs: six halvings try 63 points, and 6.4% of the edges have one within
/// the tolerance.
const PUBLISHED_TOLERANCE: f64 = 2.6e-4;

pub(super) fn measure(lab: &Lab) -> Result<Report, PaperError> {
    let mut report = Report::new(&[
        "triangles",
        "offset",
        "cells",
        "figures",
        "edges",
        "S_d = 0",
        "S_d = 1",
        "S_d = 2",
        "S_d <= 6",
        "bisection <= 6",
        "to 1e-7 h",
        "hybrid s",
        "bisection s",
    ]);
    let full = lab.settings.resolution;
    for (faces, cuts, edges, percent) in BY_TRIANGLES {
        let model = lab.refined_model(PaperModel::Warrior, cuts)?;
        let distance = lab.distance(&model);
        report.push(published(Cell::text(faces), OFFSET, 512, edges, percent));
        report.push(here(lab, &model, &distance, OFFSET, full)?);
    }
    let model = lab.model(PaperModel::Warrior)?;
    let distance = lab.distance(&model);
    for (fraction, edges, percent) in BY_OFFSET {
        report.push(published(Cell::text("60k"), fraction, 512, edges, percent));
        report.push(here(lab, &model, &distance, fraction, full)?);
    }
    for (divisor, edges, percent) in BY_RESOLUTION {
        let published_cells = super::PUBLISHED_RESOLUTION / divisor;
        report.push(published(Cell::text("60k"), OFFSET, published_cells.into(), edges, percent));
        report.push(here(lab, &model, &distance, OFFSET, (full / divisor).max(1))?);
    }
    report.notes = vec![
        format!("paper: terracotta-warrior; here: {}", model.name),
        lab.conditions(),
        "one grid for all rows of a resolution, fitted to the offset 0.32".into(),
        "bisection <= 6: to the tolerance of the paper (2.6e-4 voxels of 1/512); to 1e-7 h: to the \
         tolerance of the hybrid method here"
            .into(),
        "times: all edges of a row, the bisection to 1e-7 h".into(),
    ];
    Ok(report)
}

fn published(faces: Cell, fraction: f64, cells: u64, edges: u64, percent: Percent) -> Vec<Cell> {
    let mut row =
        vec![faces, Cell::Number(fraction), Cell::Count(cells), Cell::text("paper"), Cell::Count(edges)];
    row.extend(percent.map(|p| Cell::Part(p / 100.0)));
    row.extend([const { Cell::Nothing }; 3]);
    row
}

fn here(
    lab: &Lab,
    model: &Model,
    distance: &SignedDistance,
    fraction: f64,
    cells: u32,
) -> Result<Vec<Cell>, PaperError> {
    let mut row = vec![
        Cell::text(model.mesh.triangles.len().to_string()),
        Cell::Number(fraction),
        Cell::Count(cells.into()),
        Cell::text("here"),
    ];
    let Some(field) = lab.field(model, distance, fraction, lab.shared_grid(model, LARGEST, cells)?)? else {
        row.extend([const { Cell::Nothing }; 9]);
        return Ok(row);
    };
    let solve = |method| -> Result<(EdgeStatistics, f64), PaperError> {
        let settings =
            EdgeSettings { lattice: field.settings.lattice, r: field.settings.r, method, slab: Slab::WHOLE };
        let numbers = field.numbers.clone();
        let started = Instant::now();
        let (_, statistics) = solve_by(distance, &settings, &field.signs, numbers, &field.near, lab.run)?;
        Ok((statistics, started.elapsed().as_secs_f64()))
    };
    let (hybrid, hybrid_seconds) = solve(RootMethod::Hybrid)?;
    // The paper's tolerance is a length: on coarser grids it is a smaller part of a voxel.
    let tolerance = PUBLISHED_TOLERANCE * f64::from(cells) / f64::from(super::PUBLISHED_RESOLUTION);
    let (loose, _) = solve(RootMethod::Bisection { tolerance })?;
    let (tight, bisection_seconds) = solve(RootMethod::PLAIN_BISECTION)?;
    let all = hybrid.intersected as f64;
    let part = |counts: &[u64]| Cell::Part(counts.iter().sum::<u64>() as f64 / all);
    row.push(Cell::Count(hybrid.intersected));
    row.extend((0..3).map(|n| part(&hybrid.by_subdivision[n..=n])));
    row.extend([part(&hybrid.by_subdivision), part(&loose.by_subdivision), part(&tight.by_subdivision)]);
    row.extend([hybrid_seconds, bisection_seconds].map(Cell::Seconds));
    Ok(row)
}
