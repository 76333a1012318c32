//! `exocarp compare`, as a user sees it: processes, table, JSON, page.

mod common;

use common::{exocarp, names};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn model(directory: &Path, name: &str) -> String {
    let path = directory.join(format!("{name}.ply")).display().to_string();
    assert_eq!(exocarp(&["model", name, "-o", &path, "--detail", "8", "--f64", "--quiet"]).code, 0);
    path
}

#[test]
fn methods_are_compared_in_a_table_and_in_json() {
    let directory = tempfile::tempdir().unwrap();
    let input = model(directory.path(), "carved_cube");
    let json = directory.path().join("figures.json").display().to_string();
    let outcome = exocarp(&[
        "compare",
        &input,
        "-d",
        "-2%",
        "--resolution",
        "40",
        "--runs",
        "2",
        "--threads",
        "2",
        "--methods",
        "exocarp,openvdb-wide,openvdb-weno5,exocarp",
        "--json",
        &json,
    ]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{outcome:?}");
    let lines: Vec<&str> = outcome.stdout.lines().collect();
    assert_eq!(lines.len(), 5, "{}", outcome.stdout);
    assert!(lines[2].starts_with("exocarp ") && lines[4].starts_with("OpenVDB offset, WENO5 "));

    let figures: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let results = figures["results"].as_array().unwrap();
    assert_eq!(results.len(), 3);
    let number = |k: usize, path: &str| results[k].pointer(path).and_then(|v| v.as_f64()).unwrap();
    for (k, result) in results.iter().enumerate() {
        assert_eq!(result["runs"].as_array().unwrap().len(), 2);
        let engine = |run: usize| number(k, &format!("/runs/{run}/engine"));
        for run in 0..2 {
            let phases = result["runs"][run]["phases"].as_array().unwrap();
            let named: f64 = phases.iter().map(|phase| phase["seconds"].as_f64().unwrap()).sum();
            // Phases are parts of the engine's time; 1e-6 s is for rounding.
            assert!(!phases.is_empty() && 0.0 < named && named <= engine(run) + 1e-6, "{result}");
        }
        // The median of two is their mean.
        let mean = 0.5 * (engine(0) + engine(1));
        assert!((number(k, "/median/engine") / mean - 1.0).abs() < 1e-9, "{result}");
        assert!(number(k, "/median/peak_memory") > number(k, "/median/memory_before"));
        assert!(number(k, "/median/active_voxels") > 1000.0);
    }
    // What the comparison is for: the crossing-free sharp surface is nearer to the truth than the
    // peers'.
    let mean = |k| number(k, "/quality/distance/surface/mean/voxels");
    assert!(mean(0) < mean(1) && mean(1) < mean(2), "{} {} {}", mean(0), mean(1), mean(2));
    assert_eq!(number(0, "/quality/intersections/pairs"), 0.0);
    // One voxel size for all: triangle counts are alike.
    let ratio = number(1, "/median/triangles") / number(0, "/median/triangles");
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn a_peer_that_is_not_there_is_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let input = model(directory.path(), "box");
    let missing = directory.path().join("no-python").display().to_string();
    let common = ["compare", &input, "-d", "5%", "--resolution", "20", "--runs", "1", "--python", &missing];
    let outcome = exocarp(&[&common[..], &["--methods", "exocarp,meshlib-sharp"]].concat());
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("MeshLib is left out"), "{}", outcome.stderr);
    assert!(outcome.stdout.contains("exocarp") && !outcome.stdout.contains("MeshLib"));
    exocarp(&[&common[..], &["--methods", "meshlib-sharp", "--quiet"]].concat()).fails_with(2);
}

#[test]
fn wrong_use_is_one_sentence() {
    let directory = tempfile::tempdir().unwrap();
    let input = model(directory.path(), "box");
    exocarp(&["compare", &input]).fails_with(2);
    exocarp(&["compare", &input, "-d", "1", "--methods", "magic"]).fails_with(2);
    exocarp(&["compare", &input, "-d", "1", "--runs", "0"]).fails_with(2);
    exocarp(&["compare", "missing.ply", "-d", "1"]).fails_with(3);
    let open = model(directory.path(), "wave");
    exocarp(&["compare", &open, "-d", "1%"]).fails_with(3);
}

/// Writes the report of a comparison of two methods to `directory`. Returns its page.
fn report(directory: &Path) -> String {
    let input = model(directory, "carved_cube");
    let report = directory.join("report");
    let outcome = exocarp(&[
        "compare",
        &input,
        "-d",
        "-3%",
        "--resolution",
        "32",
        "--runs",
        "1",
        "--methods",
        "exocarp,openvdb-wide",
        "--report",
        report.to_str().unwrap(),
        "--quiet",
    ]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (0, ""), "{outcome:?}");
    assert_eq!(names(&report), ["index.html"]);
    std::fs::read_to_string(report.join("index.html")).unwrap()
}

/// The number of figures of a page.
fn figures(html: &str) -> usize {
    html.matches("<figure ").count()
}

#[test]
fn a_report_is_one_page_with_figures() {
    let directory = tempfile::tempdir().unwrap();
    let html = report(directory.path());
    assert!(figures(&html) >= 6, "{}", figures(&html));
}

mod needs_browser {
    use super::*;

    /// Verdict of the browser about each figure: drawn, if every picture in it was decoded and
    /// every drawing has an extent.
    const PROBE: &str = r#"<script>
addEventListener('load', () => {
  for (const figure of document.querySelectorAll('figure')) {
    const images = [...figure.querySelectorAll('img')].every(i => i.complete && i.naturalWidth > 100);
    const drawings = [...figure.querySelectorAll('svg')].every(s => {
      const box = s.getBBox();
      return box.width > 50 && box.height > 50 && s.getBoundingClientRect().width > 50;
    });
    const some = figure.querySelectorAll('img, svg').length > 0;
    figure.setAttribute('data-drawn', images && drawings && some ? 'yes' : 'no');
  }
});
</script>"#;

    #[test]
    #[ignore = "needs Chromium"]
    fn a_browser_draws_every_figure_of_the_report() {
        let directory = tempfile::tempdir().unwrap();
        let html = report(directory.path());
        let browser = browser().expect("Chromium in PATH");
        let probed = directory.path().join("probed.html");
        std::fs::write(&probed, html.replace("</body>", &format!("{PROBE}</body>"))).unwrap();
        let profile = tempfile::tempdir().unwrap();
        let output = Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(["--virtual-time-budget=10000", "--dump-dom"])
            .arg(format!("file://{}", probed.display()))
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let dom = String::from_utf8_lossy(&output.stdout);
        assert_eq!(
            dom.matches("data-drawn=\"yes\"").count(),
            figures(&html),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }

    fn browser() -> Option<PathBuf> {
        let path = std::env::var_os("PATH")?;
        let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
        std::env::split_paths(&path).flat_map(|d| names.map(|n| d.join(n))).find(|p| p.is_file())
    }
}
