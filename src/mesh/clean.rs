//! Cleaning: makes a mesh as files have it into one with a topology.
//!
//! Equal positions become one vertex, and triangles that bound nothing go.

use std::fmt;

use rayon::prelude::*;

use super::TriMesh;
use super::degenerate::{degenerate, has_lines, take_out};
use super::equal::{first_equal, hash};

/// Counts of the changes that [`clean`] or [`weld`] made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CleanReport {
    /// Number of vertices that were merged into an earlier vertex at the same position.
    pub welded_vertices: usize,
    /// Number of triangles without area that were dropped.
    pub degenerate_triangles: usize,
    /// Number of triangles that were dropped because an earlier one has the same corners and
    /// orientation.
    pub duplicate_triangles: usize,
    /// Number of vertices that were dropped because no triangle has them (any more).
    pub unreferenced_vertices: usize,
    /// Number of triangles that were split at a vertex on their edge: a triangle without area that
    /// was dropped had that vertex and that edge.
    pub split_triangles: usize,
}

impl CleanReport {
    /// Whether there was nothing to do.
    pub fn is_clean(&self) -> bool {
        *self == CleanReport::default()
    }
}

impl fmt::Display for CleanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_clean() {
            return f.write_str("nothing to clean");
        }
        let plural = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
        let parts = [
            ("welded", self.welded_vertices, "vertex", "vertices"),
            (
                "split",
                self.split_triangles,
                "triangle at a vertex on its edge",
                "triangles at vertices on their edges",
            ),
            ("dropped", self.degenerate_triangles, "degenerate triangle", "degenerate triangles"),
            ("dropped", self.duplicate_triangles, "duplicate triangle", "duplicate triangles"),
            ("dropped", self.unreferenced_vertices, "unreferenced vertex", "unreferenced vertices"),
        ];
        let mut last_verb = "";
        for (verb, count, one, many) in parts.into_iter().filter(|part| part.1 > 0) {
            let separator = if last_verb.is_empty() { "" } else { ", " };
            let verb_again = if verb == last_verb { String::new() } else { format!("{verb} ") };
            write!(f, "{separator}{verb_again}{}", plural(count, one, many))?;
            last_verb = verb;
        }
        Ok(())
    }
}

/// Cleans a mesh, in this order:
///
/// 1. Vertices at exactly the same position become the first of them (-0 equals 0). No tolerance: a
///    near vertex is another vertex.
/// 2. Triangles with two equal corners or exactly no area are dropped. The area is decided by exact
///    predicates, so a sliver stays however thin it is. Where the corners lie on a line, the
///    triangle across the longest edge is split at the corner in the middle (see `degenerate.rs`):
///    so a closed mesh stays closed.
/// 3. Triangles with the corners and the orientation of an earlier one are dropped; where step 2
///    splits, those with an area also before it. Two triangles with the same corners and *opposite*
///    orientation both stay: together they are a fin without thickness, a surface that was drawn
///    from both sides. Dropping one would leave a sheet with a border where the file has a closed
///    surface, dropping both a hole where the file has something.
/// 4. Vertices that no triangle has are dropped.
///
/// What remains keeps its order, so the result depends on nothing but the mesh.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have; meshes from
/// [`TriMesh::load`] are never so.
pub fn clean(mesh: TriMesh) -> (TriMesh, CleanReport) {
    let TriMesh { mut vertices, mut triangles } = mesh;
    let mut report =
        CleanReport { welded_vertices: merge_equal(&vertices, &mut triangles), ..CleanReport::default() };

    let flat = degenerate(&triangles, &vertices);
    report.degenerate_triangles = flat.len();
    if has_lines(&flat, &triangles, &vertices) {
        // Of two neighbours that are the same only one would be split.
        report.duplicate_triangles = drop_duplicates(&mut triangles, &flat);
        let flat = degenerate(&triangles, &vertices);
        report.split_triangles = take_out(&flat, &mut triangles, &vertices);
    } else if !flat.is_empty() {
        drop_numbered(&mut triangles, &flat);
    }
    report.duplicate_triangles += drop_duplicates(&mut triangles, &[]);
    report.unreferenced_vertices = drop_unreferenced(&mut vertices, &mut triangles) - report.welded_vertices;
    (TriMesh { vertices, triangles }, report)
}

/// Steps 1 and 4 of [`clean`] alone: every triangle stays, and keeps its number.
///
/// # Panics
/// As [`clean`].
pub fn weld(mesh: TriMesh) -> (TriMesh, CleanReport) {
    let TriMesh { mut vertices, mut triangles } = mesh;
    let welded_vertices = merge_equal(&vertices, &mut triangles);
    let unreferenced_vertices = drop_unreferenced(&mut vertices, &mut triangles) - welded_vertices;
    (
        TriMesh { vertices, triangles },
        CleanReport { welded_vertices, unreferenced_vertices, ..CleanReport::default() },
    )
}

/// Lets triangles name the first vertex at each position. Returns how many vertices are another one
/// again.
fn merge_equal(vertices: &[[f64; 3]], triangles: &mut [[u32; 3]]) -> usize {
    let first = first_at_position(vertices);
    let merged = first.par_iter().enumerate().filter(|&(i, &v)| i != v as usize).count();
    if merged > 0 {
        triangles.par_iter_mut().for_each(|t| *t = t.map(|v| first[v as usize]));
    }
    merged
}

/// For each vertex the first one at the same position.
fn first_at_position(vertices: &[[f64; 3]]) -> Vec<u32> {
    // Adding 0 turns -0 into 0.
    first_equal(vertices, |v| v.map(|x| (x + 0.0).to_bits()), |&key| hash(key))
}

/// Drops the triangles with these numbers, which ascend.
fn drop_numbered(triangles: &mut Vec<[u32; 3]>, numbers: &[u32]) {
    let (mut number, mut next) = (0, numbers.iter().peekable());
    triangles.retain(|_| {
        let goes = next.next_if_eq(&&number).is_some();
        number += 1;
        !goes
    });
}

/// Drops triangles that are an earlier one again, whichever corner they begin with, but not those
/// with the numbers `kept`, which ascend. Returns how many.
fn drop_duplicates(triangles: &mut Vec<[u32; 3]>, kept: &[u32]) -> usize {
    let key = |t: [u32; 3]| match t {
        [a, b, c] if a < b && a < c => [a, b, c],
        [a, b, c] if b < c => [b, c, a],
        [a, b, c] => [c, a, b],
    };
    let first = first_equal(triangles, key, |&key| hash(key.map(u64::from)));
    let before = triangles.len();
    let (mut numbers, mut kept) = (first.iter().zip(0..), kept.iter().peekable());
    triangles
        .retain(|_| numbers.next().is_some_and(|(&first, t)| kept.next_if_eq(&&t).is_some() || first == t));
    before - triangles.len()
}

/// Drops vertices that no triangle has, and renumbers the others in order. Returns how many.
fn drop_unreferenced(vertices: &mut Vec<[f64; 3]>, triangles: &mut [[u32; 3]]) -> usize {
    const UNUSED: u32 = u32::MAX;
    let mut renumbered = vec![UNUSED; vertices.len()];
    for &v in triangles.as_flattened() {
        renumbered[v as usize] = 0;
    }
    let before = vertices.len();
    let mut count = 0;
    for (v, number) in renumbered.iter_mut().enumerate() {
        if *number != UNUSED {
            *number = count;
            vertices[count as usize] = vertices[v];
            count += 1;
        }
    }
    vertices.truncate(count as usize);
    if count as usize != before {
        triangles.par_iter_mut().for_each(|t| *t = t.map(|v| renumbered[v as usize]));
    }
    before - vertices.len()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn mesh(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriMesh {
        TriMesh { vertices: vertices.to_vec(), triangles: triangles.to_vec() }
    }

    #[test]
    fn everything_at_once_in_order() {
        let vertices = [
            [5.0, 5.0, 5.0],
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, -0.0],
            [2.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        // The second has two corners at one place, the third lies on a line, the fourth and the
        // sixth are the first again, the fifth is its other side.
        let triangles = [[1, 2, 3], [1, 4, 3], [4, 2, 5], [2, 3, 4], [3, 2, 1], [3, 1, 2], [4, 3, 6]];
        let (cleaned, report) = clean(mesh(&vertices, &triangles));
        assert_eq!(cleaned.vertices, [vertices[1], vertices[2], vertices[3], vertices[6]]);
        assert_eq!(cleaned.triangles, [[0, 1, 2], [2, 1, 0], [0, 2, 3]]);
        let expected = CleanReport {
            welded_vertices: 1,
            degenerate_triangles: 2,
            duplicate_triangles: 2,
            unreferenced_vertices: 2,
            split_triangles: 0,
        };
        assert_eq!(report, expected);
        assert_eq!(
            report.to_string(),
            "welded 1 vertex, dropped 2 degenerate triangles, 2 duplicate triangles, 2 unreferenced vertices"
        );
        #[cfg(feature = "serde")]
        {
            let json = serde_json::to_string(&report).unwrap();
            assert!(json.starts_with(r#"{"welded_vertices":1,"degenerate_triangles":2,"#), "{json}");
        }
    }

    #[test]
    fn a_clean_mesh_stays_as_it_is() {
        let clean_mesh = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let (cleaned, report) = clean(clean_mesh.clone());
        assert_eq!(cleaned, clean_mesh);
        assert!(report.is_clean());
        assert_eq!(report.to_string(), "nothing to clean");
        assert_eq!(clean(TriMesh::default()), (TriMesh::default(), CleanReport::default()));
    }

    #[test]
    fn area_is_decided_exactly() {
        // The third corner lies on the line, which rounding would deny; or beside it by one bit of
        // its last coordinate, which rounding would not see.
        let on: [[f64; 3]; 3] = [[0.1, 0.1, 0.1], [0.3, 0.3, 0.3], [0.7, 0.7, 0.7]];
        let mut beside = on;
        beside[2][2] = beside[2][2].next_up();
        assert_eq!(clean(mesh(&on, &[[0, 1, 2]])).1.degenerate_triangles, 1);
        assert_eq!(clean(mesh(&beside, &[[0, 1, 2]])).1.degenerate_triangles, 0);
        // An upright triangle has no area in one projection only.
        let upright = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(clean(mesh(&upright, &[[0, 1, 2]])).1.is_clean());
    }

    /// Cleans as the doc comment of [`clean`] says, word by word, where no triangle is to be split.
    fn slow_clean(mesh: &TriMesh) -> TriMesh {
        let position = |v: u32| mesh.vertices[v as usize];
        let first = |v: u32| (0..).find(|&u| position(u) == position(v)).unwrap();
        let mut kept: Vec<[u32; 3]> = Vec::new();
        for t in &mesh.triangles {
            let t = t.map(first);
            let [p, q] = [t[1], t[2]]
                .map(|v| -> [f64; 3] { std::array::from_fn(|a| position(v)[a] - position(t[0])[a]) });
            let parallel = (0..3).all(|a| p[a] * q[(a + 1) % 3] == p[(a + 1) % 3] * q[a]);
            let known = (0..3).any(|k| kept.contains(&[t[k], t[(k + 1) % 3], t[(k + 2) % 3]]));
            if !parallel && !known {
                kept.push(t);
            }
        }
        let used: Vec<u32> =
            (0..mesh.vertices.len() as u32).filter(|v| kept.as_flattened().contains(v)).collect();
        let number = |v: u32| used.iter().position(|&u| u == v).unwrap() as u32;
        TriMesh {
            vertices: used.iter().map(|&v| position(v)).collect(),
            triangles: kept.iter().map(|t| t.map(number)).collect(),
        }
    }

    /// Cleans a soup of several chunks and shards: a sheet of squares, each triangle with vertices
    /// of its own, and some triangles twice.
    #[test]
    fn a_large_soup_becomes_a_sheet_on_any_number_of_threads() {
        const SIDE: usize = 200;
        let corner = |i: usize, j: usize| [i as f64 / 3.0, 0.0, j as f64 * -0.7];
        let mut vertices = Vec::new();
        for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            vertices.extend([a, b, c, a, c, d]);
            if j % 10 == 0 {
                vertices.extend([b, c, a]);
            }
        }
        let triangles: Vec<[u32; 3]> =
            (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let soup = mesh(&vertices, &triangles);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| clean(soup.clone()))
        };
        let (sheet, report) = on(1);
        assert_eq!(sheet.vertices.len(), (SIDE + 1) * (SIDE + 1));
        assert_eq!(sheet.triangles.len(), 2 * SIDE * SIDE);
        assert_eq!(report.welded_vertices, vertices.len() - sheet.vertices.len());
        assert_eq!(report.duplicate_triangles, SIDE * SIDE / 10);
        assert_eq!((report.degenerate_triangles, report.unreferenced_vertices), (0, 0));
        assert_eq!(sheet.triangles[..2], [[0, 1, 2], [0, 2, 3]]);
        for threads in [2, 8] {
            assert_eq!(on(threads), (sheet.clone(), report));
        }
    }

    proptest! {
        /// On a coarse lattice, where everything that is to be cleaned is frequent and products are
        /// exact.
        #[test]
        fn agrees_with_the_definition(
            vertices in prop::collection::vec(prop::array::uniform3(-1i8..2), 12),
            triangles in prop::collection::vec(prop::array::uniform3(0u32..12), 0..40),
        ) {
            let vertices: Vec<_> = vertices.into_iter().map(|v| v.map(f64::from)).collect();
            // Lines, which have splits of their own, with corners at one place only.
            let is_line = |t: &[u32; 3]| !degenerate(&[*t], &vertices).is_empty();
            let has_equal = |t: &[u32; 3]| (0..3).any(|k| vertices[t[k] as usize] == vertices[t[(k + 1) % 3] as usize]);
            let triangles: Vec<_> = triangles.into_iter().filter(|t| !is_line(t) || has_equal(t)).collect();
            let raw = mesh(&vertices, &triangles);
            let (cleaned, report) = clean(raw.clone());
            prop_assert_eq!(&cleaned, &slow_clean(&raw));
            prop_assert_eq!(
                raw.triangles.len() - cleaned.triangles.len(),
                report.degenerate_triangles + report.duplicate_triangles
            );
            prop_assert_eq!(
                raw.vertices.len() - cleaned.vertices.len(),
                report.welded_vertices + report.unreferenced_vertices
            );
            prop_assert!(clean(cleaned).1.is_clean());
        }
    }
}
