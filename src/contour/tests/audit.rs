//! An independent judge of meshes: topology, and intersections by exact predicates.

use crate::geom::predicates::{orient2d, orient3d};
use crate::mesh::TriMesh;
use std::collections::HashMap;

/// What is wrong with a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Audit {
    /// Directed edges that occur more than once, or whose opposite does not occur once.
    pub bad_edges: usize,
    /// Vertices whose triangles do not form one fan.
    pub bad_vertices: usize,
    /// Triangles without area, or with a repeated vertex.
    pub degenerate: usize,
    /// Pairs of triangles that meet elsewhere than in the vertices and edges that they share.
    pub intersections: Vec<(u32, u32)>,
    /// Pairs of triangles with overlapping boxes, all tested.
    pub pairs: usize,
}

impl Audit {
    /// Judges a mesh.
    pub fn of(mesh: &TriMesh) -> Audit {
        let (bad_edges, bad_vertices) = topology(mesh);
        let degenerate = (0..mesh.triangles.len()).filter(|&t| is_degenerate(mesh, t)).count();
        let mut audit = Audit { bad_edges, bad_vertices, degenerate, ..Audit::default() };
        for_close_pairs(mesh, |a, b| {
            audit.pairs += 1;
            if intersect(mesh, a, b) {
                audit.intersections.push((a, b));
            }
        });
        audit
    }

    /// Whether nothing is wrong.
    pub fn is_clean(&self) -> bool {
        self.bad_edges + self.bad_vertices + self.degenerate + self.intersections.len() == 0
    }
}

fn topology(mesh: &TriMesh) -> (usize, usize) {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    // Around each vertex: from the next corner of a triangle to the one after it.
    let mut around: Vec<HashMap<u32, u32>> = vec![HashMap::new(); mesh.vertices.len()];
    for t in &mesh.triangles {
        for i in 0..3 {
            let [a, b, c] = [t[i], t[(i + 1) % 3], t[(i + 2) % 3]];
            *edges.entry((a, b)).or_default() += 1;
            around[a as usize].insert(b, c);
        }
    }
    let bad_edges = edges.iter().filter(|&(&(a, b), &n)| n != 1 || edges.get(&(b, a)) != Some(&1)).count();
    let is_fan = |links: &HashMap<u32, u32>| {
        let Some(&first) = links.keys().next() else { return false };
        let mut at = first;
        for steps in 1..=links.len() {
            match links.get(&at) {
                Some(&next) => at = next,
                None => return false,
            }
            if at == first {
                return steps == links.len();
            }
        }
        false
    };
    (bad_edges, around.iter().filter(|links| !is_fan(links)).count())
}

fn is_degenerate(mesh: &TriMesh, t: usize) -> bool {
    flat_axis(mesh.corners(t)).is_none()
}

fn drop_axis(p: [f64; 3], axis: usize) -> [f64; 2] {
    [p[(axis + 1) % 3], p[(axis + 2) % 3]]
}

/// An axis along which the triangle can be projected without losing its area.
fn flat_axis(t: [[f64; 3]; 3]) -> Option<usize> {
    (0..3).find(|&axis| {
        let [a, b, c] = t.map(|p| drop_axis(p, axis));
        orient2d(a, b, c) != 0.0
    })
}

/// Whether triangles `a` and `b` meet elsewhere than in what they share by number.
fn intersect(mesh: &TriMesh, a: u32, b: u32) -> bool {
    let (ta, tb) = (mesh.triangles[a as usize], mesh.triangles[b as usize]);
    let shared: Vec<u32> = ta.into_iter().filter(|v| tb.contains(v)).collect();
    let at = |v: u32| mesh.vertices[v as usize];
    let (pa, pb) = (ta.map(at), tb.map(at));
    if flat_axis(pa).is_none() || flat_axis(pb).is_none() {
        return false; // counted as degenerate
    }
    let opposite = |t: [u32; 3]| {
        let rest: Vec<u32> = t.into_iter().filter(|v| !shared.contains(v)).collect();
        rest.into_iter().map(at).collect::<Vec<_>>()
    };
    let (ra, rb) = (opposite(ta), opposite(tb));
    match shared.len() {
        0 => {
            let hits = |s: [[f64; 3]; 3], t| (0..3).any(|i| segment_meets(s[i], s[(i + 1) % 3], t));
            hits(pa, pb) || hits(pb, pa)
        }
        1 => segment_meets(ra[0], ra[1], pb) || segment_meets(rb[0], rb[1], pa),
        2 => {
            let [e, f] = [at(shared[0]), at(shared[1])];
            orient3d(e, f, ra[0], rb[0]) == 0.0 && {
                let axis = flat_axis(pa).expect("checked above");
                let side = |p| orient2d(drop_axis(e, axis), drop_axis(f, axis), drop_axis(p, axis));
                (side(ra[0]) > 0.0) == (side(rb[0]) > 0.0)
            }
        }
        _ => true,
    }
}

/// Whether the closed segment pq and the closed triangle have a point in common.
fn segment_meets(p: [f64; 3], q: [f64; 3], t: [[f64; 3]; 3]) -> bool {
    let [a, b, c] = t;
    let (sp, sq) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    if (sp > 0.0 && sq > 0.0) || (sp < 0.0 && sq < 0.0) {
        return false;
    }
    if sp == 0.0 && sq == 0.0 {
        let axis = flat_axis(t).expect("not degenerate");
        return segment_meets_flat(drop_axis(p, axis), drop_axis(q, axis), t.map(|x| drop_axis(x, axis)));
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
}

fn segment_meets_flat(p: [f64; 2], q: [f64; 2], t: [[f64; 2]; 3]) -> bool {
    let contains = |x: [f64; 2]| {
        let turns = [orient2d(t[0], t[1], x), orient2d(t[1], t[2], x), orient2d(t[2], t[0], x)];
        turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
    };
    contains(p) || contains(q) || (0..3).any(|i| segments_cross(p, q, t[i], t[(i + 1) % 3]))
}

/// Whether two closed segments in the plane meet, for segments with no end of the first on a triangle that the
/// second is a side of: collinear overlaps then contain an end of the second in the first.
fn segments_cross(p: [f64; 2], q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> bool {
    let (pa, pb) = (orient2d(p, q, a), orient2d(p, q, b));
    let (ap, aq) = (orient2d(a, b, p), orient2d(a, b, q));
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    if apart(pa, pb) || apart(ap, aq) {
        return false;
    }
    if [pa, pb, ap, aq].iter().any(|&x| x != 0.0) {
        return true;
    }
    (0..2).all(|i| p[i].min(q[i]) <= a[i].max(b[i]) && a[i].min(b[i]) <= p[i].max(q[i]))
}

/// Calls `visit` once for each pair of triangles whose boxes overlap, found over a grid of buckets.
fn for_close_pairs(mesh: &TriMesh, mut visit: impl FnMut(u32, u32)) {
    let boxes: Vec<[[f64; 3]; 2]> = (0..mesh.triangles.len())
        .map(|t| {
            let p = mesh.corners(t);
            let fold = |f: fn(f64, f64) -> f64| std::array::from_fn(|a| f(f(p[0][a], p[1][a]), p[2][a]));
            [fold(f64::min), fold(f64::max)]
        })
        .collect();
    let extent = boxes.iter().map(|[lo, hi]| (0..3).map(|a| hi[a] - lo[a]).fold(0.0, f64::max));
    let size = (extent.sum::<f64>() / boxes.len().max(1) as f64).max(1e-300);
    let bucket = |p: [f64; 3]| p.map(|x| (x / size).floor() as i64);
    let mut buckets: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (t, [lo, hi]) in (0..).zip(&boxes) {
        let (lo, hi) = (bucket(*lo), bucket(*hi));
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    buckets.entry([x, y, z]).or_default().push(t);
                }
            }
        }
    }
    for (&key, members) in &buckets {
        for (i, &a) in members.iter().enumerate() {
            for &b in &members[i + 1..] {
                let ([la, ha], [lb, hb]) = (boxes[a as usize], boxes[b as usize]);
                let overlap = (0..3).all(|k| la[k] <= hb[k] && lb[k] <= ha[k]);
                // Only in the bucket with the lowest corner of the common box.
                if overlap && bucket(std::array::from_fn(|k| la[k].max(lb[k]))) == key {
                    visit(a, b);
                }
            }
        }
    }
}
