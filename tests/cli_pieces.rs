//! The program in pieces: streamed, in tiles that are merged, the band alone. All must give the
//! bytes of the whole.

mod common;

use common::{exocarp, names};
use exocarp::{TriMesh, shapes};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// So fine that slabs with their halos are less than the whole.
const RESOLUTION: &str = "384";

/// Less than the whole takes.
const MEMORY: &str = "180M";

/// A model and a directory for what is made of it.
struct Bench {
    dir: tempfile::TempDir,
    input: String,
    distance: &'static str,
    resolution: &'static str,
}

impl Bench {
    fn new(resolution: &'static str) -> Bench {
        Bench::of(&shapes::carved_cube(8), "3%", resolution)
    }

    fn of(model: &TriMesh, distance: &'static str, resolution: &'static str) -> Bench {
        let dir = tempfile::tempdir().unwrap();
        let input = dir.path().join("model.ply");
        model.save(&input).unwrap();
        Bench { input: input.display().to_string(), dir, distance, resolution }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.at(name).display().to_string()
    }

    /// `exocarp offset` of the model with these arguments.
    fn run(&self, arguments: &[&str]) -> common::Outcome {
        let distance = ["-d", self.distance, "--resolution", self.resolution];
        let mut all = [&["offset", self.input.as_str()], &distance[..]].concat();
        all.extend(arguments);
        exocarp(&all)
    }

    /// As [`run`](Self::run), which must succeed.
    fn offset(&self, arguments: &[&str]) {
        let outcome = self.run(arguments);
        assert_eq!(outcome.code, 0, "{arguments:?} {outcome:?}");
    }

    /// As [`offset`](Self::offset), with the statistics.
    fn counted(&self, arguments: &[&str]) -> Value {
        let stats = self.text("counted.json");
        self.offset(&[arguments, &["--stats", &stats]].concat());
        serde_json::from_str(&fs::read_to_string(&stats).unwrap()).unwrap()
    }

    /// Makes tiles named `tile1.ply` and so on, and returns their paths.
    fn tiles(&self, of: usize, extension: &str, more: &[&str]) -> Vec<String> {
        let one = |n: usize| {
            let path = self.text(&format!("tile{n}.{extension}"));
            let (mesh, tile) = (self.text(&format!("mesh{n}.ply")), format!("{n}/{of}"));
            let outputs: &[&str] =
                if extension == "vdb" { &["-o", &mesh, "--vdb", &path] } else { &["-o", &path] };
            self.offset(&[outputs, &["--tile", &tile], more].concat());
            path
        };
        (1..=of).map(one).collect()
    }

    fn merge(&self, tiles: &[String], output: &str) -> common::Outcome {
        let output = self.text(output);
        let mut all: Vec<&str> = vec!["merge", "-o", &output];
        all.extend(tiles.iter().map(String::as_str));
        exocarp(&all)
    }

    fn same(&self, a: &str, b: &str) -> bool {
        fs::read(self.at(a)).unwrap() == fs::read(self.at(b)).unwrap()
    }
}

#[test]
fn a_streamed_mesh_is_the_whole_mesh() {
    let bench = Bench::new(RESOLUTION);
    for (name, more) in [("out.ply", &[][..]), ("out.ply", &["--f64"]), ("out.stl", &[])] {
        let (whole, streamed) = (bench.text(&format!("whole-{name}")), bench.text(name));
        let at_once = bench.counted(&[&["-o", &whole], more].concat());
        assert_eq!(at_once["slabs"], 1);
        let memory = ["--stream", "--max-memory", MEMORY];
        let counted = bench.counted(&[&["-o", streamed.as_str()][..], more, &memory].concat());
        assert!(counted["slabs"].as_u64().unwrap() > 1, "{}", counted["slabs"]);
        assert!(bench.same(name, &format!("whole-{name}")), "{name} {more:?}");
        for counts in ["filter", "edges", "contour"] {
            assert_eq!(counted[counts], at_once[counts], "{counts}");
        }
    }
}

#[test]
fn what_does_not_fit_is_streamed_by_itself() {
    let bench = Bench::new(RESOLUTION);
    let (whole, streamed) = (bench.text("whole.ply"), bench.text("out.ply"));
    bench.offset(&["-o", &whole]);
    let counted = bench.counted(&["-o", &streamed, "--max-memory", MEMORY]);
    assert!(counted["slabs"].as_u64().unwrap() > 1);
    assert!(bench.same("whole.ply", "out.ply"));
    // A format that is not written in pieces: the limit is said, and nothing is left behind.
    let before = names(bench.dir.path());
    let output = bench.text("out.obj");
    bench.run(&["-o", &output, "--max-memory", MEMORY]).fails_with(5);
    bench.run(&["-o", &output, "--stream"]).fails_with(2);
    // No slab is thin enough.
    let output = bench.text("thin.ply");
    let outcome = bench.run(&["-o", &output, "--max-memory", "8M", "--stream"]);
    outcome.fails_with(5);
    assert!(outcome.stderr.contains("and 8 MB are allowed"), "{}", outcome.stderr);
    assert_eq!(names(bench.dir.path()), before);
}

#[test]
fn merged_tiles_are_the_whole_mesh() {
    let bench = Bench::new("72");
    // More tiles than the lattice has layers: some are empty.
    for (extension, of, more) in [("ply", 3, &[][..]), ("ply", 24, &["--f64"]), ("stl", 2, &[])] {
        let whole = bench.text(&format!("whole.{extension}"));
        bench.offset(&[&["-o", &whole], more].concat());
        let mut tiles = bench.tiles(of, extension, more);
        tiles.reverse();
        let outcome = bench.merge(&tiles, &format!("merged.{extension}"));
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
        assert!(bench.same(&format!("whole.{extension}"), &format!("merged.{extension}")), "{of} {more:?}");
    }
}

#[test]
fn merged_bands_are_the_whole_band() {
    let bench = Bench::new("72");
    let (mesh, whole) = (bench.text("whole.ply"), bench.text("whole.vdb"));
    for more in [&["--unit", "mm"][..], &["--half", "--vdb-compression", "zip"], &["--closest"]] {
        bench.offset(&[&["-o", &mesh, "--vdb", &whole], more].concat());
        let outcome = bench.merge(&bench.tiles(3, "vdb", more), "merged.vdb");
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
        assert!(bench.same("whole.vdb", "merged.vdb"), "{more:?}");
    }
}

#[test]
fn tiles_of_an_inside_out_model_are_the_whole() {
    let mut cube = shapes::cube(1);
    cube.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    // At a distance of some voxels, and where nothing is left of the hollow but the end of the
    // lattice.
    for distance in ["-3%", "150%"] {
        let bench = Bench::of(&cube, distance, "24");
        let (mesh, band) = (bench.text("whole.ply"), bench.text("whole.vdb"));
        let warned = bench.run(&["-o", &mesh, "--vdb", &band, "--closest"]);
        assert_eq!(warned.code, 0, "{warned:?}");
        for of in [1, 2, 5] {
            bench.tiles(of, "vdb", &["--closest"]);
            let tiles = |name: &str, extension: &str| -> Vec<String> {
                (1..=of).map(|n| bench.text(&format!("{name}{n}.{extension}"))).collect()
            };
            assert_eq!(bench.merge(&tiles("tile", "vdb"), "merged.vdb").code, 0);
            assert_eq!(bench.merge(&tiles("mesh", "ply"), "merged.ply").code, 0);
            assert!(bench.same("whole.vdb", "merged.vdb"), "{distance} {of}: the bands differ");
            assert!(bench.same("whole.ply", "merged.ply"), "{distance} {of}: the meshes differ");
        }
        let (streamed, band) = (bench.text("streamed.ply"), bench.text("streamed.vdb"));
        bench.offset(&["-o", &streamed, "--vdb", &band, "--closest", "--stream"]);
        assert!(bench.same("whole.ply", "streamed.ply") && bench.same("whole.vdb", "streamed.vdb"));
    }
}

#[test]
fn closest_triangles_are_stored_on_request_only() {
    let bench = Bench::new("48");
    let grids = |name: &str, more: &[&str]| -> (Vec<Value>, u64) {
        let path = bench.text(name);
        let counted = bench.counted(&[&["--vdb", &path], more].concat());
        let info: Value = serde_json::from_str(&exocarp(&["info", "--json", &path]).stdout).unwrap();
        let names = info["grids"].as_array().unwrap().iter().map(|grid| grid["name"].clone()).collect();
        (names, counted["vdb"]["memory"].as_u64().unwrap())
    };
    let (names, memory) = grids("surface.vdb", &[]);
    assert_eq!(names, ["surface"]);
    let (names, more_memory) = grids("both.vdb", &["--closest"]);
    assert_eq!(names, ["surface", "surface_closest"]);
    // As many leaves of numbers of the same size.
    assert!(more_memory > memory * 3 / 2, "{more_memory} {memory}");
    let size = |name: &str| fs::metadata(bench.at(name)).unwrap().len();
    assert!(size("both.vdb") > size("surface.vdb"));
    let outcome = bench.run(&["-o", &bench.text("out.ply"), "--closest"]);
    outcome.fails_with(2);
    assert!(outcome.stderr.contains("--vdb"), "{}", outcome.stderr);
}

#[test]
fn a_band_without_a_mesh_is_the_band() {
    let bench = Bench::new("72");
    let (mesh, whole, alone) = (bench.text("whole.ply"), bench.text("whole.vdb"), bench.text("alone.vdb"));
    bench.offset(&["-o", &mesh, "--vdb", &whole]);
    let counted = bench.counted(&["--vdb", &alone]);
    assert!(bench.same("whole.vdb", "alone.vdb"));
    // Edges and contour are for the mesh.
    assert_eq!((&counted["edges"]["intersected"], &counted["contour"]["triangles"]), (&0.into(), &0.into()));
    bench.run(&[]).fails_with(2);
    bench.run(&["--vdb", &alone, "--tile", "1/2"]).fails_with(2);
}

#[test]
fn tiles_that_do_not_belong_together_are_refused_and_nothing_is_left() {
    let bench = Bench::new("72");
    let tiles = bench.tiles(3, "ply", &[]);
    let bands = bench.tiles(3, "vdb", &[]);
    let (other, cut, whole) = (bench.text("other.ply"), bench.text("cut.ply"), bench.text("whole.ply"));
    bench.offset(&["-o", &other, "--tile", "3/3", "--f64"]);
    bench.offset(&["-o", &whole]);
    let bytes = fs::read(&tiles[2]).unwrap();
    fs::write(&cut, &bytes[..bytes.len() - 7]).unwrap();
    let closest = bench.text("closest.vdb");
    bench.offset(&["-o", &bench.text("closest.ply"), "--vdb", &closest, "--closest", "--tile", "3/3"]);
    let with_closest = [bands[0].clone(), bands[1].clone(), closest];
    let before = names(bench.dir.path());
    let [a, b, c] = [0, 1, 2].map(|n| tiles[n].clone());
    let cases: [(&[String], &str, &str); 10] = [
        (&[a.clone(), b.clone()], "out.ply", "tile 3 of 3 is missing"),
        (&[a.clone(), b.clone(), b.clone()], "out.ply", "tile 2 is there twice"),
        (&[a.clone(), b.clone(), other], "out.ply", "of another model"),
        (&[a.clone(), b.clone(), cut], "out.ply", "cut off"),
        (&[a.clone(), b.clone(), whole], "out.ply", "not a tile"),
        (&[a.clone(), b.clone(), bench.text("missing.ply")], "out.ply", "cannot be read"),
        (&[a.clone(), b.clone(), c], "out.stl", "must have the same format; here it is .ply"),
        (&[a, b], "out.vdb", "not an OpenVDB file"),
        (&bands[..2], "out.vdb", "tile 3 of 3 is missing"),
        (&with_closest, "out.vdb", "was made with other settings"),
    ];
    for (tiles, output, reason) in cases {
        let outcome = bench.merge(tiles, output);
        outcome.fails_with(3);
        assert!(outcome.stderr.contains(reason), "{reason}: {}", outcome.stderr);
        assert_eq!(names(bench.dir.path()), before);
    }
    for wrong in ["0/3", "4/3", "1", "1/0", "a/b"] {
        let output = Path::new("x.ply").display().to_string();
        bench.run(&["-o", &output, "--tile", wrong]).fails_with(2);
    }
}
