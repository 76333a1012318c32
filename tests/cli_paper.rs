//! `exocarp paper` on small generated models.

mod common;

use common::{exocarp, names};
use serde_json::Value;
use std::fs;

/// Cells enough for something to be left of every model at most offsets.
const CELLS: &str = "24";

#[test]
fn every_table_is_printed_beside_the_published_figures() {
    // A figure of the paper per table.
    let published = ["28.960", "21.600", "50.700", "40370k", "71.5%", "0.094", "2.40e-5"];
    let numerals = ["I.", "II.", "III.", "IV.", "V.", "VI.", "VII."];
    let dir = tempfile::tempdir().unwrap();
    let json = dir.path().join("tables.json");
    for (n, (figure, numeral)) in (1..).zip(published.iter().zip(numerals)) {
        let number = n.to_string();
        let path = json.to_str().unwrap();
        let run = exocarp(&["paper", "--table", &number, "--resolution", CELLS, "--json", path]);
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{run:?}");
        assert!(run.stdout.starts_with(&format!("Table {numeral} ")), "{}", run.stdout);
        assert!(run.stdout.contains(figure), "{figure} is missing:\n{}", run.stdout);
        assert!(run.stdout.contains("not the published 513^3"), "{}", run.stdout);

        let file: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
        assert_eq!(file["settings"]["resolution"], 24);
        let tables = file["tables"].as_array().unwrap();
        assert_eq!((tables.len(), &tables[0]["table"]), (1, &Value::from(n)));
        let rows = tables[0]["rows"].as_array().unwrap();
        assert!(rows.len() >= 6, "{rows:?}");
        let columns = rows[0].as_object().unwrap().len();
        assert!(columns >= 10 && rows.iter().all(|row| row.as_object().unwrap().len() == columns));
    }
    assert_eq!(names(dir.path()), ["tables.json"]);
}

#[test]
fn models_come_from_the_directory_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let rocker = dir.path().join("Rocker-Arm.ply");
    assert_eq!(exocarp(&["model", "box", "-o", rocker.to_str().unwrap(), "--detail", "2"]).code, 0);
    let models = dir.path().to_str().unwrap();
    let run = exocarp(&["paper", "--table", "3", "--models", models, "--resolution", CELLS]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_eq!(run.stdout.lines().filter(|line| line.contains("Rocker-Arm")).count(), 6, "{}", run.stdout);
}

#[test]
fn wrong_use_is_one_sentence() {
    for arguments in [["--table", "0"], ["--table", "IV"], ["--resolution", "0"], ["--resolution", "x"]] {
        exocarp(&["paper", arguments[0], arguments[1]]).fails_with(2);
    }
    exocarp(&["paper", "--models", "/no/such/directory"]).fails_with(3);
    exocarp(&["paper", "--table", "1", "--json", "/no/such/directory/file.json"]).fails_with(2);
}
