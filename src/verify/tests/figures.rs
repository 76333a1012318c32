//! Errors, what is missing, creases and shells against closed forms.

use crate::mesh::{TriMesh, shapes};
use crate::offset::{OffsetSettings, offset};
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;
use crate::verify::{Promise, Subject, VerifyError, VerifyReport, VerifySettings, verify};

fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
    let vertices = mesh.vertices.iter().map(|v| v.map(|x| x * factor)).collect();
    TriMesh { vertices, triangles: mesh.triangles.clone() }
}

/// The cube with half-side `half`, its faces divided.
fn cube(half: f64) -> TriMesh {
    scaled(&shapes::cube(8), half)
}

fn judge(input: &TriMesh, output: &TriMesh, settings: &VerifySettings) -> VerifyReport {
    let run = RunSettings::with_threads(2).unwrap();
    let report = verify(input, output, settings, &run).unwrap();
    assert_eq!(report, verify(input, output, settings, &RunSettings::with_threads(1).unwrap()).unwrap());
    report
}

fn at(distance: f64) -> VerifySettings {
    VerifySettings {
        distance: Length::Units(distance),
        voxel: Some(0.05),
        samples: 20_000,
        ..VerifySettings::default()
    }
}

#[test]
fn a_shrunk_box_is_a_box() {
    let report = judge(&cube(1.0), &cube(0.75), &VerifySettings { tolerance: Some(1e-12), ..at(-0.25) });
    assert!(report.is_kept(), "{:?}", report.broken);
    assert!(report.distance.max.units < 1e-15 && report.missing.max.units < 1e-12);
    assert_eq!(report.distance.wrong_side, Some(0.0));
    // Twelve creases of length 1.5.
    let creases = report.creases;
    assert!((creases.length - 18.0).abs() < 0.5, "{creases:?}");
    assert_eq!((creases.share, creases.first_absent), (Some(1.0), None));
}

#[test]
fn a_box_that_is_too_small_is_off_by_the_difference() {
    let report = judge(&cube(1.0), &cube(0.7), &VerifySettings { tolerance: Some(0.04), ..at(-0.25) });
    let surface = report.distance.surface;
    assert!((surface.mean.units - 0.05).abs() < 1e-12 && (surface.rms.units - 0.05).abs() < 1e-12);
    assert!((report.distance.max.voxels.unwrap() - 1.0).abs() < 1e-12);
    assert!((surface.max.percent_of_diagonal - 5.0 / 12f64.sqrt()).abs() < 1e-9);
    // The farthest are the true corners.
    let corner = 0.05 * 3f64.sqrt();
    assert!(report.missing.max.units > 0.9 * corner && report.missing.max.units <= corner);
    assert_eq!(report.missing.share, Some(1.0));
    assert_eq!(report.creases.share, Some(0.0));
    assert!(report.broken.iter().all(|b| b.promise == Promise::Tolerance) && report.broken.len() == 2);
}

#[test]
fn edges_moved_off_a_crease_are_no_longer_along_it() {
    let mut chamfered = cube(0.75);
    // Half of the edges' vertices go inward: those with z = 0.75.
    for v in &mut chamfered.vertices {
        let on_edge = v.iter().filter(|x| x.abs() == 0.75).count() >= 2;
        if on_edge && v[2] == 0.75 {
            *v = v.map(|x| 0.98 * x);
        }
    }
    let share = judge(&cube(1.0), &chamfered, &at(-0.25)).creases.share.unwrap();
    // Four of twelve are off by 0.02, which is 0.4 voxels, and the ends of four more.
    assert!((0.55..0.68).contains(&share), "{share}");
}

#[test]
fn a_grown_sphere_against_a_scaled_one() {
    let (input, r) = (shapes::sphere(24), 0.3);
    let report = judge(&input, &scaled(&input, 1.0 + r), &at(r));
    // Vertices of the scaled sphere are outside of vertices: exact. Faces are between 1.3 of the
    // inscribed radius and it: an error of 0.3 times the height of the unit sphere's facets.
    assert!(report.distance.vertices.max.units < 1e-12);
    let height = input.triangles.iter().map(|t| {
        let c: [f64; 3] =
            std::array::from_fn(|a| t.iter().map(|&v| input.vertices[v as usize][a]).sum::<f64>() / 3.0);
        1.0 - c.iter().map(|x| x * x).sum::<f64>().sqrt()
    });
    let height = height.fold(0.0, f64::max);
    let max = report.distance.surface.max.units;
    assert!(max > 0.1 * height && max < r * height * 1.1, "{max} {height}");
    // All three kinds of points were found, and nothing is missing by more.
    let missing = &report.missing;
    assert!(missing.faces.samples > 10_000 && missing.edges.samples > 5_000, "{missing:?}");
    assert!(missing.vertices.samples > 1_000 && missing.max.units < 2.0 * height, "{missing:?}");
    assert_eq!(report.creases.input_edges, 0);
}

#[test]
fn arcs_and_caps_of_a_grown_box() {
    // The box itself: all of the true offset is 0.25 away.
    let report = judge(&cube(1.0), &cube(1.0), &at(0.25));
    for part in [report.missing.faces, report.missing.edges, report.missing.vertices] {
        assert!(part.samples > 4_000 && (part.mean.units - 0.25).abs() < 1e-12, "{part:?}");
    }
    assert_eq!(report.distance.surface.mean.units, 0.25);
    assert_eq!(report.distance.wrong_side, Some(0.0));
}

#[test]
fn a_hole_is_missing() {
    let mut holed = cube(0.75);
    let mesh = holed.clone();
    let is_in_hole = |t: usize| mesh.corners(t).iter().all(|p| p[2] == 0.75 && p[0] > 0.0);
    let mut numbers = 0..;
    holed.triangles.retain(|_| !is_in_hole(numbers.next().unwrap()));
    let report = judge(&cube(1.0), &holed, &at(-0.25));
    assert!(report.distance.max.units < 1e-15, "what is there is right");
    // Half of one of six faces.
    let share = report.missing.share.unwrap();
    assert!((0.06..0.0834).contains(&share), "{share}");
    assert!(report.missing.max.units > 0.3);
    let p = report.missing.max_at.unwrap();
    assert!((p[2] - 0.75).abs() < 1e-9 && p[0] > 0.0);
    assert_eq!(report.broken[0].promise, Promise::Closed);
}

#[test]
fn the_other_side_is_noticed() {
    let report = judge(&cube(1.0), &cube(0.75), &at(0.25));
    assert!(report.distance.max.units < 1e-15);
    assert_eq!(report.distance.wrong_side, Some(1.0));
}

#[test]
fn the_offset_has_no_errors_but_those_it_names() {
    let run = RunSettings::with_threads(2).unwrap();
    let input = shapes::bracket(8);
    for distance in [0.06, -0.06] {
        let settings = OffsetSettings {
            distance: Length::Units(distance),
            voxel: VoxelSize::Units(0.02),
            ..OffsetSettings::default()
        };
        let output = offset(&input, &settings, &run).unwrap().mesh;
        let settings = VerifySettings { voxel: Some(0.02), tolerance: Some(0.02), ..at(distance) };
        let report = judge(&input, &output, &settings);
        assert!(report.is_kept(), "{distance}: {:?}", report.broken);
        assert!(report.distance.surface.mean.voxels.unwrap() < 0.01);
        assert!(report.creases.length > 1.0 && report.creases.share.unwrap() > 0.99, "{:?}", report.creases);
    }
}

#[test]
fn the_wall_of_a_shell() {
    let mut shell = cube(1.0);
    let inner = cube(0.75);
    let first = shell.vertices.len() as u32;
    shell.vertices.extend(&inner.vertices);
    shell.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a + first, c + first, b + first]));
    let subject = Subject::Shell { thickness: None };
    let settings = VerifySettings { subject, tolerance: Some(1e-9), ..at(-0.25) };
    let report = judge(&cube(1.0), &shell, &settings);
    assert!(report.is_kept(), "{:?}", report.broken);
    let found = report.shell.unwrap();
    assert_eq!((found.surface_triangles, found.offset_triangles, found.wall_triangles), {
        let n = inner.triangles.len();
        (n, n, 0)
    });
    let thickness = found.thickness.unwrap();
    assert!((thickness.min.units - 0.25).abs() < 1e-12 && (thickness.max.units - 0.25).abs() < 1e-12);

    let thicker = Subject::Shell { thickness: Some(0.3) };
    let broken = judge(&cube(1.0), &shell, &VerifySettings { subject: thicker, ..settings.clone() }).broken;
    assert_eq!(broken[0].promise, Promise::Thickness);
    let broken = judge(&cube(1.0), &inner, &settings).broken;
    assert_eq!(broken[0].promise, Promise::Thickness);
}

#[test]
fn what_nothing_can_be_said_about_is_refused() {
    let run = RunSettings::with_threads(1).unwrap();
    let fails = |output: &TriMesh, settings: &VerifySettings| {
        verify(&cube(1.0), output, settings, &run).unwrap_err().to_string()
    };
    assert_eq!(fails(&TriMesh::default(), &at(0.1)), "OUTPUT has no triangles");
    let mut bad = cube(1.0);
    bad.vertices[3][1] = f64::NAN;
    assert_eq!(fails(&bad, &at(0.1)), "OUTPUT: vertex 3 has a coordinate that is not a finite number");
    bad = cube(1.0);
    bad.triangles[2][0] = 1 << 30;
    assert_eq!(fails(&bad, &at(0.1)), "OUTPUT: triangle 2 names vertex 1073741824, and there are 1538");
    let nan = VerifySettings { tolerance: Some(f64::NAN), ..at(0.1) };
    assert!(matches!(nan.validate(), Err(VerifyError::Setting { name: "tolerance", .. })));
    assert!(at(f64::INFINITY).validate().is_err());
    // Points only: no area, no error, no panic.
    let points = TriMesh { vertices: vec![[0.5; 3], [0.7; 3], [0.9; 3]], triangles: vec![[0, 1, 2]] };
    let report = verify(&cube(1.0), &points, &at(0.1), &run).unwrap();
    assert_eq!((report.soundness.topology.degenerate_triangles, report.distance.surface.samples), (1, 0));
}
