//! The anchor plate: a machine part with through holes, a raised boss and sharp edges.

use super::builder::{Builder, add, reversed};
use crate::mesh::TriMesh;
use std::f64::consts::PI;

/// Half length, half width and thickness of the plate, and the width of its chamfered corners.
const PLATE: (f64, f64, f64, f64) = (1.5, 1.0, 0.3, 0.3);
/// The bolt holes: their places (all four signs) and radius.
const BOLT: (f64, f64, f64) = (1.1, 0.6, 0.2);
/// The boss: radius at its foot, at its top, and its height above the plate.
const BOSS: (f64, f64, f64) = (0.6, 0.5, 0.6);
/// Radius of the bore through boss and plate.
const BORE: f64 = 0.3;
/// Two slots beside the boss: half length, half width, distance of their middle from the centre.
const SLOT: (f64, f64, f64) = (0.3, 0.06, 0.75);

/// The volume that the mesh approaches with growing detail.
pub(super) const VOLUME: f64 = {
    let (x, y, thickness, chamfer) = PLATE;
    let (foot, top, height) = BOSS;
    let holes = 4.0 * PI * BOLT.2 * BOLT.2 + PI * BORE * BORE + 8.0 * SLOT.0 * SLOT.1;
    let plate = thickness * (4.0 * x * y - 2.0 * chamfer * chamfer - holes);
    plate + height * PI * ((foot * foot + foot * top + top * top) / 3.0 - BORE * BORE)
};

/// Returns a plate of 3 x 2 x 0.3 with chamfered corners, four bolt holes, two slots, and a conical
/// boss that a bore goes through.
pub fn anchor(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let (x, y, thickness, c) = PLATE;
    let up = [0.0, 0.0, thickness];
    let outline =
        [[c - x, -y], [x - c, -y], [x, c - y], [x, y - c], [x - c, y], [c - x, y], [-x, y - c], [-x, c - y]];
    let corners = b.vertices(outline.map(|[x, y]| [x, y, 0.0]));
    let low = b.outline(&corners);
    let high = b.moved(&low, up);
    b.wall(&low, &high);

    let holes = holes(&mut b);
    let holes_high: Vec<Vec<u32>> = holes.iter().map(|h| b.moved(h, up)).collect();
    for (low, high) in holes.iter().zip(&holes_high) {
        b.wall(high, low);
    }
    let bore_low = b.circle([0.0; 3], 0, 1, BORE);
    let mut loops = vec![reversed(&low)];
    loops.extend(holes.iter().cloned());
    loops.push(bore_low.clone());
    flat(&mut b, &loops);

    let foot = b.circle(up, 0, 1, BOSS.0);
    let mut loops = vec![high];
    loops.extend(holes_high.iter().map(|h| reversed(h)));
    loops.push(reversed(&foot));
    flat(&mut b, &loops);

    let rise = [0.0, 0.0, BOSS.2];
    let top = b.circle_of(foot.len(), add(up, rise), 0, 1, BOSS.1);
    b.wall(&foot, &top);
    let bore_high = b.moved(&bore_low, add(up, rise));
    b.wall(&bore_high, &bore_low);
    b.flat(&[&top, &reversed(&bore_high)]);
    b.finish()
}

/// Returns the rims of bolt holes and slots at z = 0, counter-clockwise from above.
fn holes(b: &mut Builder) -> Vec<Vec<u32>> {
    let mut all = Vec::new();
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        all.push(b.circle([sx * BOLT.0, sy * BOLT.1, 0.0], 0, 1, BOLT.2));
    }
    let (length, width, off) = SLOT;
    for side in [-1.0, 1.0] {
        let corners = [[-length, -width], [length, -width], [length, width], [-length, width]];
        let corners = b.vertices(corners.map(|[x, y]| [x, y + side * off, 0.0]));
        all.push(b.outline(&corners));
    }
    all
}

fn flat(b: &mut Builder, loops: &[Vec<u32>]) {
    b.flat(&loops.iter().map(Vec::as_slice).collect::<Vec<_>>());
}
