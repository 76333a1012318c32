//! Round trips: meshes that are written are read back.

use proptest::prelude::*;

use super::*;

fn bits(v: &[f64; 3]) -> [u64; 3] {
    v.map(f64::to_bits)
}

fn single_bits(v: &[f64; 3]) -> [u32; 3] {
    v.map(|x| (x as f32).to_bits())
}

#[test]
fn files_on_disk_in_every_format() {
    let directory = tempfile::tempdir().unwrap();
    let mesh = tetrahedron();
    for format in Format::ALL {
        let path = directory.path().join("mesh").with_extension(format.extension().to_uppercase());
        mesh.save(&path).unwrap();
        let again = TriMesh::load(&path).unwrap();
        assert_eq!(again.triangles.len(), mesh.triangles.len());
        for t in 0..mesh.triangles.len() {
            let [expected, found] = [&mesh, &again].map(|m| m.corners(t).each_ref().map(single_bits));
            assert_eq!(found, expected, "{format}");
        }
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), Format::ALL.len());
}

#[test]
fn numbers_are_as_short_as_they_can_be() {
    let text = |x: f64| {
        let mut bytes = Vec::new();
        text::write_number(x, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    let cases = [
        (0.0, "0"),
        (-0.0, "-0"),
        (1.0, "1"),
        (-2.5, "-2.5"),
        (f64::from(0.1f32), "0.10000000149011612"),
        (0.1, "0.1"),
        (123456.789, "123456.789"),
        (1.0 / 3.0, "0.3333333333333333"),
        (1e300, "1e300"),
        (1e-7, "1e-7"),
        (f64::from(f32::MIN_POSITIVE), "1.1754943508222875e-38"),
        (5e-324, "5e-324"),
        (16777217.0, "16777217"),
    ];
    for (x, expected) in cases {
        assert_eq!(text(x), expected);
    }
}

/// Meshes whose coordinates come from `coordinate`.
fn meshes(coordinate: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = TriMesh> {
    let vertex = [coordinate.clone(), coordinate.clone(), coordinate];
    prop::collection::vec(vertex, 1..20).prop_flat_map(|vertices| {
        let v = 0..vertices.len() as u32;
        let triangle = [v.clone(), v.clone(), v];
        (Just(vertices), prop::collection::vec(triangle, 1..20))
            .prop_map(|(vertices, triangles)| TriMesh { vertices, triangles })
    })
}

fn finite_f32() -> impl Strategy<Value = f64> + Clone {
    any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()).prop_map(f64::from)
}

fn finite_f64() -> impl Strategy<Value = f64> + Clone {
    any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #[test]
    fn single_precision_survives_every_format(mesh in meshes(finite_f32())) {
        for format in Format::ALL {
            for coordinates in [Precision::F32, Precision::F64] {
                let again = good(format, written(&mesh, format, coordinates));
                if format != Format::Stl {
                    prop_assert_eq!(&again.triangles, &mesh.triangles);
                    prop_assert!(again.vertices.iter().map(single_bits).eq(mesh.vertices.iter().map(single_bits)));
                }
                for t in 0..mesh.triangles.len() {
                    let [expected, found] = [&mesh, &again].map(|m| m.corners(t).each_ref().map(single_bits));
                    prop_assert_eq!(found, expected);
                }
            }
        }
    }

    #[test]
    fn text_is_the_same_number_to_readers_of_32_and_of_64_bits(x in finite_f64()) {
        let rounded = Precision::F32.round(x);
        prop_assume!(rounded.is_finite());
        for written in [x, rounded] {
            let mut bytes = Vec::new();
            text::write_number(written, &mut bytes).unwrap();
            let word = std::str::from_utf8(&bytes).unwrap();
            prop_assert_eq!(word.parse::<f64>().unwrap().to_bits(), written.to_bits());
            // Whoever reads 32 bits, or 64 and rounds them.
            prop_assert_eq!(f64::from(word.parse::<f32>().unwrap()).to_bits(), rounded.to_bits());
        }
    }

    #[test]
    fn every_format_has_the_same_32_bits(mesh in meshes(-1e30..1e30)) {
        let expected = good(Format::Ply, written(&mesh, Format::Ply, Precision::F32));
        for format in [Format::Obj, Format::Off] {
            let found = good(format, written(&mesh, format, Precision::F32));
            prop_assert_eq!(&found, &expected, "{}", format);
        }
    }

    #[test]
    fn double_precision_survives_where_it_is_written(mesh in meshes(finite_f64())) {
        for format in [Format::Obj, Format::Ply, Format::Off] {
            let again = good(format, written(&mesh, format, Precision::F64));
            prop_assert_eq!(&again.triangles, &mesh.triangles);
            for (found, expected) in again.vertices.iter().zip(&mesh.vertices) {
                prop_assert_eq!(bits(found), bits(expected), "{}", format);
            }
        }
    }
}
