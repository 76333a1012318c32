//! The page as a whole.

use super::*;
use crate::compare::{Lost, Measurement, Method, PhaseTime};
use crate::mesh::shapes;
use crate::quantity::Length;
use crate::verify::{VerifySettings, verify};

fn comparison(mesh: &TriMesh, run: &RunSettings) -> Comparison {
    let (distance, voxel) = (-0.25, 0.125);
    let mut inner = shapes::cube(16);
    inner.vertices.iter_mut().flatten().for_each(|x| *x *= 0.75);
    let measurement = |method, engine| Measurement {
        method,
        engine,
        phases: vec![PhaseTime::new("band", 0.5 * engine)],
        peak_memory: Some(90 << 20),
        memory_before: Some(20 << 20),
        active_voxels: None,
        triangles: inner.triangles.len() as u64,
    };
    let settings = VerifySettings {
        distance: Length::Units(distance),
        voxel: Some(voxel),
        samples: 2000,
        ..Default::default()
    };
    let result = |method: Method| {
        let median = measurement(method, 1.0 + f64::from(method as u8));
        let lost = (method == Method::OpenvdbWeno5).then(|| Lost::Failed("<no> luck".into()));
        let kept = lost.is_none();
        MethodResult {
            method,
            median: kept.then(|| median.clone()),
            runs: if kept { vec![median] } else { Vec::new() },
            lost,
            quality: kept.then(|| verify(mesh, &inner, &settings, run).unwrap()),
            mesh: kept.then(|| inner.clone()),
        }
    };
    Comparison {
        input_triangles: mesh.triangles.len(),
        diagonal: 12f64.sqrt(),
        distance,
        voxel,
        threads: 2,
        runs: 1,
        machine: "2 cores".into(),
        results: [Method::Exocarp, Method::OpenvdbWide, Method::OpenvdbWeno5].map(result).into(),
        notes: vec!["MeshLib is left out".into()],
    }
}

#[test]
fn the_page_has_every_figure() {
    let run = RunSettings::with_threads(2).unwrap();
    let mesh = shapes::cube(4);
    let comparison = comparison(&mesh, &run);
    let html = page(&comparison, &mesh, "a <cube>", &run).unwrap();
    for id in [
        "fig-time",
        "fig-memory",
        "fig-errors",
        "fig-section-1",
        "fig-whole",
        "fig-close",
        "row-openvdb-weno5",
    ] {
        assert!(html.contains(&format!("id=\"{id}\"")), "{id}");
    }
    // Two methods have a surface, and each is drawn as a whole and close up.
    assert_eq!(html.matches("<img ").count(), 4);
    assert_eq!(html.matches("src=\"data:image/png;base64,").count(), 4);
    let sections = html.matches("id=\"fig-section-").count();
    assert_eq!(html.matches("<svg ").count(), 3 + 2 * sections);
    assert!(html.contains("a &lt;cube&gt;") && html.contains("failed: &lt;no&gt; luck"));
    assert!(html.contains("MeshLib is left out") && !html.contains("NaN"));
    // Nothing is fetched from anywhere.
    for outside in ["http://", "https://", "<script", "<link", "@import", "url("] {
        assert!(!html.contains(outside), "{outside}");
    }
}

#[test]
fn the_table_marks_the_best_and_says_what_was_lost() {
    let run = RunSettings::with_threads(2).unwrap();
    let mesh = shapes::cube(4);
    let comparison = comparison(&mesh, &run);
    let text = crate::compare::text(&comparison);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5, "{text}");
    assert!(lines[2].starts_with("exocarp") && lines[2].contains(" 1.00* "), "{text}");
    assert!(lines[3].contains(" 2.00 ") && !lines[3].contains("2.00*"), "{text}");
    assert!(
        lines[4].starts_with("OpenVDB offset, WENO5") && lines[4].ends_with("failed: <no> luck"),
        "{text}"
    );
}
