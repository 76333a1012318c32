use exocarp::{band::*, distance::*, edge::*, mesh::*, run::*};
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let mut mesh = TriMesh::default();
    for l in text.lines() {
        let f: Vec<&str> = l.split_whitespace().collect();
        match f.first() {
            Some(&"v") => mesh.vertices.push([1, 2, 3].map(|i| f[i].parse().unwrap())),
            Some(&"f") => {
                let ix: Vec<u32> =
                    f[1..].iter().map(|s| s.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for i in 1..ix.len() - 1 {
                    mesh.triangles.push([ix[0], ix[i], ix[i + 1]]);
                }
            }
            _ => {}
        }
    }
    let [lo, hi] = mesh.bounding_box().unwrap();
    let e: [f64; 3] = std::array::from_fn(|i| hi[i] - lo[i]);
    let diag = (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]).sqrt();
    let r = a[2].parse::<f64>().unwrap() * diag;
    let n: f64 = a[3].parse().unwrap();
    let w: f64 = a[4].parse().unwrap();
    let h = (e[0].max(e[1]).max(e[2]) + 2.0 * r.max(0.0)) / n;
    let run = RunSettings::with_threads(a[5].parse().unwrap()).unwrap();
    let t = Instant::now();
    let topology = Topology::new(&mesh);
    println!("topology {:?} {:?}", t.elapsed(), topology.defects());
    let t = Instant::now();
    let d = run.install(|| SignedDistance::new(&mesh, &topology));
    println!("hierarchy {:?}", t.elapsed());
    let t = Instant::now();
    let settings = BandSettings { lattice: Lattice { voxel: h }, r, half_width: w };
    let mut all = LeafBatch::default();
    let s = build(&d, &settings, &run, |mut b| {
        all.append(&mut b);
        Ok::<_, Cancelled>(())
    })
    .unwrap();
    println!("band {:?} leaves {} {:?}", t.elapsed(), all.len(), s);
    let t = Instant::now();
    let inside: Vec<LeafMask> = all.values.chunks(512).map(inside_mask).collect();
    let tiles = &all.inside_blocks;
    let mut set = std::collections::HashSet::new();
    for &(o, side) in tiles {
        for x in 0..side / 8 {
            for y in 0..side / 8 {
                for z in 0..side / 8 {
                    set.insert(o + Ijk::new(8 * x, 8 * y, 8 * z));
                }
            }
        }
    }
    println!("tiles {:?}", t.elapsed());
    let t = Instant::now();
    let signs = SignField::new(&all.origins, &inside, |m| {
        Ok::<_, Cancelled>(m.iter().map(|o| set.contains(o)).collect())
    })
    .unwrap();
    println!("signs {:?} {}", t.elapsed(), signs.len());
    let t = Instant::now();
    let numbers = EdgeNumbers::new(&signs).unwrap();
    println!("numbers {:?} {}", t.elapsed(), numbers.len());
    let t = Instant::now();
    let nt = NodeTriangles::new(&signs, &all.origins, std::mem::take(&mut all.closest));
    let (c, s) = solve(&d, settings.lattice, r, &signs, numbers, &nt, &run).unwrap();
    println!("edges {:?} {} {:?}", t.elapsed(), c.samples.len(), s);
}
