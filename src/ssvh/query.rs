//! Closest-triangle queries.

use super::Ssvh;
use super::node::{Level, WIDTH};
use glam::{DVec3, Vec3};
use multiversion::multiversion;

/// The closest triangle to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle's number in the mesh.
    pub triangle: u32,
    /// Squared distance of the point from it.
    pub distance_squared: f64,
}

impl Hit {
    /// Whether this hit comes before `other`: nearer, or as near with the lower number.
    #[inline(always)]
    fn before(&self, other: &Hit) -> bool {
        self.distance_squared < other.distance_squared
            || (self.distance_squared == other.distance_squared && self.triangle < other.triangle)
    }
}

/// Rounding of a bound in units of the distances involved: 64 units in the last place of f32. The bound
/// takes a few dozen roundings, each of at most half a unit. Too large would only visit more nodes; too
/// small could lose the closest triangle.
const SLACK: f64 = 64.0 / 16_777_216.0;

/// The deepest stack: at most 11 levels of nodes for 2^32 triangles, and 7 siblings wait on each.
const STACK: usize = 11 * (WIDTH - 1) + 1;

impl Ssvh {
    /// The closest triangle to `p`. Equal distances go to the lowest triangle number.
    pub fn closest(&self, p: DVec3) -> Hit {
        self.closest_from(p, self.ids[0])
    }

    /// The same as [`closest`](Self::closest), faster when `guess` is a triangle close to `p`.
    pub fn closest_from(&self, p: DVec3, guess: u32) -> Hit {
        let distance_squared = self.triangles[self.position(guess)].distance_squared(p);
        improve(self, p, Hit { triangle: guess, distance_squared })
    }

    /// The closest triangle if its distance is at most `bound`.
    pub fn closest_within(&self, p: DVec3, bound: f64) -> Option<Hit> {
        // No triangle has this number, so a real one at exactly the bound comes before it.
        let hit = improve(self, p, Hit { triangle: u32::MAX, distance_squared: bound * bound });
        (hit.triangle != u32::MAX).then_some(hit)
    }
}

/// The best of `best` and all triangles of the hierarchy.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn improve(tree: &Ssvh, p: DVec3, mut best: Hit) -> Hit {
    let relative = p - tree.centre;
    let q: Vec3 = relative.as_vec3();
    let slack = SLACK * (relative.abs().max_element() + tree.extent);
    let limit_of = |hit: &Hit| ((hit.distance_squared.sqrt() + slack) as f32).next_up();
    let mut limit = limit_of(&best);
    let mut stack = [(0.0f32, 0u32); STACK];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let (bound, number) = stack[waiting];
        if bound > limit {
            continue;
        }
        let node = &tree.nodes[number as usize];
        let distances = node.distances(q);
        match node.level {
            Level::Inner => {
                let first = waiting;
                #[allow(clippy::needless_range_loop, reason = "a slot runs through several arrays in step")]
                for slot in 0..WIDTH {
                    if distances[slot] <= limit {
                        // Insertion keeps the nearest on top.
                        let mut at = waiting;
                        while at > first && stack[at - 1].0 < distances[slot] {
                            stack[at] = stack[at - 1];
                            at -= 1;
                        }
                        stack[at] = (distances[slot], node.children[slot]);
                        waiting += 1;
                    }
                }
            }
            Level::Leaf =>
            {
                #[allow(clippy::needless_range_loop, reason = "a slot runs through several arrays in step")]
                for slot in 0..WIDTH {
                    if distances[slot] <= limit {
                        let position = node.children[slot] as usize;
                        let hit = Hit {
                            triangle: tree.ids[position],
                            distance_squared: tree.triangles[position].distance_squared(p),
                        };
                        if hit.before(&best) {
                            best = hit;
                            limit = limit_of(&best);
                        }
                    }
                }
            }
        }
    }
    best
}
