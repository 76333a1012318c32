use super::*;

/// Coarse enough for a second per table.
fn coarse(table: Table) -> Report {
    let settings = PaperSettings { resolution: 32, ..PaperSettings::default() };
    measure(table, &settings, &RunSettings::with_threads(2).unwrap()).unwrap()
}

fn column(report: &Report, name: &str) -> usize {
    report.columns.iter().position(|&c| c == name).unwrap()
}

fn counts(report: &Report, row: &[Cell], names: &[&str]) -> Vec<u64> {
    let count = |name: &&str| match row[column(report, name)] {
        Cell::Count(n) | Cell::Thousands(n) => n,
        ref other => panic!("{name}: {other:?}"),
    };
    names.iter().map(count).collect()
}

#[test]
fn numbers_name_the_tables() {
    for (n, table) in (1..).zip(Table::ALL) {
        assert_eq!((table.number(), Table::from_number(n)), (n, Some(table)));
    }
    assert_eq!(Table::from_number(0), None);
    assert_eq!(Table::from_number(8), None);
}

#[test]
fn the_map_of_the_paper_names_files_that_exist() {
    let text = std::fs::read_to_string("docs/paper-map.md").unwrap();
    let names: Vec<&str> = text.split('`').filter(|part| part.starts_with("src/")).collect();
    assert!(names.len() > 30, "{names:?}");
    for name in names {
        assert!(std::path::Path::new(name).is_file(), "{name}");
    }
}

#[test]
fn columns_of_a_table_have_different_names() {
    for table in [Table::Filters, Table::Intersections] {
        let report = coarse(table);
        let mut names = report.columns.clone();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), report.columns.len());
    }
}

#[test]
fn distance_computations_shrink_with_each_filter() {
    let report = coarse(Table::Filters);
    assert_eq!(report.rows.len(), 18);
    for row in &report.rows {
        let [plain, signed] =
            [["BB 64", "BB 32", "BB 16", "BB 8"], ["BB+SD 64", "BB+SD 32", "BB+SD 16", "BB+SD 8"]]
                .map(|names| counts(&report, row, &names));
        assert!(plain.windows(2).all(|w| w[0] >= w[1]), "{row:?}");
        // The paper has 2,018k beside 2,017k.
        assert!(plain.iter().zip(&signed).all(|(a, b)| a + 1 >= *b), "{row:?}");
        let all = counts(&report, row, &["BB+OT", "BB+SD+OT"]);
        assert!(all[0] >= all[1], "{row:?}");
    }
}

#[test]
fn errors_are_small_and_relative() {
    let report = coarse(Table::Errors);
    let mut measured = 0;
    for row in &report.rows {
        let [mean, max] = ["avg / h", "max / h"].map(|name| row[column(&report, name)].clone());
        let (Cell::Number(mean), Cell::Number(max)) = (mean, max) else { continue };
        // The largest are 0.022 and 0.56: 32 voxels along a side are coarse.
        assert!(0.0 < mean && mean < 0.03 && mean < max && max < 0.6, "{row:?}");
        measured += 1;
    }
    assert_eq!(measured, 12);
}

#[test]
fn errors_leave_out_no_vertex_and_no_edge() {
    // Large enough that with the usual number of samples verify would leave some out.
    let settings = PaperSettings::default();
    let run = RunSettings::with_threads(2).unwrap();
    let lab = Lab { settings: &settings, run: &run };
    let model = lab.model(models::PaperModel::OctaFlower).unwrap();
    let result = lab.offset(&model, 0.1, lab.fitted_grid()).unwrap().unwrap();
    let found = table7::errors(&lab, &model, &result).unwrap();
    let mesh = &result.mesh;
    assert!(
        3 * mesh.triangles.len() / 2 > 4 * crate::verify::settings::DEFAULT_SAMPLES,
        "{}",
        mesh.triangles.len()
    );
    assert_eq!(found.surface.samples, mesh.triangles.len());
    assert_eq!(found.vertices.samples, mesh.vertices.len());
    assert_eq!(found.edge_midpoints.samples, 3 * mesh.triangles.len() / 2);
}
