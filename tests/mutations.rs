//! Broken files of every format: never a panic, never an abort, and no more memory than the file's
//! size justifies.
//!
//! Small valid files are changed at random, with a fixed seed: bits turned, parts cut off,
//! inserted, doubled, numbers replaced by what no program expects. 300 changes for each kind of
//! file, 3,000 with `EXOCARP_HEAVY=1`.

mod common;

use common::exocarp;
use common::random::Random;
use exocarp::internals::mesh::Topology;
use exocarp::io::{self, SaveOptions};
use exocarp::{Precision, TriMesh, clean, shapes};
use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, which also says how much is in use.
struct Counting;

static USED: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all work is the system's allocator's; numbers are kept beside it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let used = USED.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(used, Ordering::Relaxed);
        // SAFETY: the caller's promise is handed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise is handed on.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that reading may take beside the file: buffers.
const BUFFERS: usize = 1 << 20;

/// Bytes that reading may take for each byte of the file: OBJ takes about 100 bytes for a line of
/// six.
const PER_BYTE: usize = 64;

/// Changes for each kind of file.
fn rounds() -> u64 {
    if std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1") { 3000 } else { 300 }
}

/// Numbers that no program expects, as text.
const WORDS: [&str; 16] = [
    "-1",
    "0",
    "nan",
    "-inf",
    "1e999",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "-9223372036854775808",
    "99999999999999999999",
    "1e-320",
    "1.#QNAN",
    "0x7f",
    "\\",
    "#",
    "1/2/3/4",
];

/// Values that numbers in binary files are replaced by.
const BYTES: [[u8; 4]; 6] = [
    [0xff; 4],
    [0xff, 0xff, 0xff, 0x7f],
    [0, 0, 0, 0x80],
    [0, 0, 0xc0, 0x7f],
    [0x7f, 0xff, 0xff, 0xff],
    [0; 4],
];

/// Changes a file in one to four places.
fn mutated(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut file = file.to_vec();
    for _ in 0..1 + random.below(4) {
        if file.is_empty() {
            break;
        }
        let at = random.below(file.len());
        match random.below(8) {
            0 => file[at] ^= 1 << random.below(8),
            1 => file[at] = random.next() as u8,
            2 => file.truncate(at),
            3 => {
                let inserted: Vec<u8> = (0..1 + random.below(20)).map(|_| random.next() as u8).collect();
                file.splice(at..at, inserted);
            }
            4 => {
                let end = file.len().min(at + 1 + random.below(200));
                let block = file[at..end].to_vec();
                let to = random.below(file.len());
                file.splice(to..to, block);
            }
            5 => {
                let end = file.len().min(at + 1 + random.below(200));
                file.drain(at..end);
            }
            6 => {
                let number = BYTES[random.below(BYTES.len())];
                let end = file.len().min(at + 4);
                file[at..end].copy_from_slice(&number[..end - at]);
            }
            _ => {
                // The word around the place.
                let is_blank = |b: &u8| b.is_ascii_whitespace();
                let start = file[..at].iter().rposition(is_blank).map_or(0, |n| n + 1);
                let end = file[at..].iter().position(is_blank).map_or(file.len(), |n| at + n);
                let word = WORDS[random.below(WORDS.len())].bytes();
                file.splice(start.min(end)..end, word);
            }
        }
    }
    file
}

/// A file of each kind: its extension and content.
fn files(directory: &Path) -> Vec<(&'static str, Vec<u8>)> {
    let mesh = shapes::carved_cube(2);
    let saved = |name: &str, coordinates| {
        let path = directory.join(name);
        io::save(&mesh, &path, &SaveOptions { precision: coordinates }).unwrap();
        fs::read(path).unwrap()
    };
    vec![
        ("obj", saved("a.obj", Precision::F64)),
        ("obj", quads().into_bytes()),
        ("off", saved("a.off", Precision::F64)),
        ("stl", saved("a.stl", Precision::F32)),
        ("stl", stl_text(&mesh).into_bytes()),
        ("ply", saved("a.ply", Precision::F32)),
        ("ply", saved("b.ply", Precision::F64)),
        ("ply", ply_big_endian(&mesh)),
        ("ply", ply_text(&mesh).into_bytes()),
    ]
}

/// A cube of polygons with all that OBJ has around them, and CRLF.
fn quads() -> String {
    let mut text = "# a cube\r\nmtllib a.mtl\r\no cube\r\n".to_string();
    for corner in 0..8 {
        text += &format!("v {} {} {} 0.5 0.5 0.5\r\nvt 0 1\r\n", corner & 1, corner >> 1 & 1, corner >> 2);
    }
    text += "usemtl a\r\ns off\r\nf 1/1 3/3 4/4 2/2\r\nf 5//1 6//1 8//1 7//1\r\nf 1 2 \\\r\n6 5\r\n";
    text + "f -8 -4 -2 -6\r\nf 3 7 8 4 # top\r\nf 2 4 8 6\r\n"
}

fn stl_text(mesh: &TriMesh) -> String {
    let mut text = "solid cube\n".to_string();
    for t in 0..mesh.triangles.len() {
        text += "facet normal 0 0 0\n outer loop\n";
        for [x, y, z] in mesh.corners(t) {
            text += &format!("  vertex {x:e} {y} {z}\n");
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

/// The header of a file with properties that are of no interest, and an element more.
fn ply_header(mesh: &TriMesh, format: &str) -> String {
    let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
    format!(
        "ply\nformat {format} 1.0\ncomment a\nelement vertex {vertices}\nproperty double x\n\
         property float y\nproperty uchar red\nproperty float z\nelement face {triangles}\n\
         property list ushort uint vertex_indices\nproperty list uchar float more\nelement edge 1\nproperty int a\nend_header\n"
    )
}

fn ply_big_endian(mesh: &TriMesh) -> Vec<u8> {
    let mut file = ply_header(mesh, "binary_big_endian").into_bytes();
    for [x, y, z] in &mesh.vertices {
        file.extend(x.to_be_bytes());
        file.extend((*y as f32).to_be_bytes());
        file.push(7);
        file.extend((*z as f32).to_be_bytes());
    }
    for t in &mesh.triangles {
        file.extend([0, 3]);
        t.iter().for_each(|v| file.extend(v.to_be_bytes()));
        file.extend([1, 0, 0, 0, 0]);
    }
    file.extend([0; 4]);
    file
}

fn ply_text(mesh: &TriMesh) -> String {
    let mut text = ply_header(mesh, "ascii");
    for [x, y, z] in &mesh.vertices {
        text += &format!("{x} {y} 7 {z}\n");
    }
    for [a, b, c] in &mesh.triangles {
        text += &format!("3 {a} {b} {c} 0\n");
    }
    text + "0\n"
}

/// Reads a file and checks what comes of it, and what it took. Whether it was a mesh.
fn check(path: &Path, size: usize) -> bool {
    let before = USED.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    let loaded = io::load_with_notes(path);
    let taken = MOST.load(Ordering::Relaxed).saturating_sub(before);
    assert!(taken <= BUFFERS + PER_BYTE * size, "{taken} bytes for a file of {size}");
    let mesh = match loaded {
        Ok(loaded) => loaded.mesh,
        Err(error) => {
            let sentence = error.to_string();
            assert!(!sentence.contains('\n') && sentence.len() < 1000, "{sentence}");
            return false;
        }
    };
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.as_flattened().iter().all(|&v| (v as usize) < mesh.vertices.len()));
    assert!(mesh.vertices.as_flattened().iter().all(|x| x.is_finite()));
    let was_closed = Topology::new(&mesh).defects().is_closed();
    let (cleaned, report) = clean(mesh);
    if was_closed && report.duplicate_triangles == 0 {
        assert!(Topology::new(&cleaned).defects().is_closed());
    }
    true
}

/// One test, as the allocator counts for all threads.
#[test]
fn mutated_meshes_are_read_or_refused() {
    let directory = tempfile::tempdir().unwrap();
    for (number, (extension, file)) in (0..).zip(files(directory.path())) {
        let path = directory.path().join("model").with_extension(extension);
        let (mut read, mut refused) = (0, 0);
        for round in 0..=rounds() {
            let mut random = Random(number << 32 | round);
            // The first one as it is.
            let content = if round == 0 { file.clone() } else { mutated(&file, &mut random) };
            fs::write(&path, &content).unwrap();
            let done = std::panic::catch_unwind(|| check(&path, content.len()));
            match done.unwrap_or_else(|_| panic!("{extension} file {number}, change {round}")) {
                true => read += 1,
                false => refused += 1,
            }
            assert!(round > 0 || read == 1, "{extension} file {number} is in order");
        }
        // Not all changes are too small to be seen, or too large to be read.
        assert!(read > 1 && refused > 0, "{extension} file {number}: {read} read, {refused} refused");
    }
    mutated_bands_are_refused(directory.path());
}

/// Files of OpenVDB go through the program: a crash of the library would end the test.
fn mutated_bands_are_refused(directory: &Path) {
    /// Position of a file's hash, which tells that it was changed. Without, a file is taken on
    /// trust.
    const HASH: std::ops::Range<usize> = 21..57;
    /// A process each: a tenth of them is enough.
    const SHARE: u64 = 10;
    let (input, band) = (directory.join("box.ply"), directory.join("band.vdb"));
    shapes::by_name("box").map(|shape| (shape.make)(2)).unwrap().save(&input).unwrap();
    let [input, path] = [&input, &band].map(|p| p.to_str().unwrap());
    let made = exocarp(&["offset", input, "-d", "0.1", "--resolution", "8", "--vdb", path]);
    assert_eq!(made.code, 0, "{made:?}");
    let file = fs::read(&band).unwrap();
    for round in 1..=rounds() / SHARE {
        let changed = mutated(&file, &mut Random(1 << 60 | round));
        if changed.get(HASH) != file.get(HASH) || changed == file {
            continue;
        }
        fs::write(&band, changed).unwrap();
        exocarp(&["info", path]).fails_with(3);
    }
}
