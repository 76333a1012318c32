//! Distances from the surface that were sampled before: changes of a patch look at the same middles
//! of edges again and again.

use glam::DVec3;

/// The number of slots. A patch samples 50 points most of the time, and seldom more than this.
const SLOTS: usize = 512;

/// Distances by point. Each point has one slot, and a later point takes it.
#[derive(Clone, Debug)]
pub struct DistanceCache(Vec<(DVec3, f64)>);

impl DistanceCache {
    /// Makes an empty cache.
    pub fn new() -> DistanceCache {
        // Nothing equals this point.
        DistanceCache(vec![(DVec3::NAN, 0.0); SLOTS])
    }

    /// Returns the distance of a point, by `sample` where it is not known: always the same one for
    /// the same point.
    pub fn get(&mut self, p: DVec3, sample: impl FnOnce() -> f64) -> f64 {
        let slot = &mut self.0[slot(p)];
        if slot.0 != p {
            *slot = (p, sample());
        }
        slot.1
    }
}

/// Returns the slot of a point.
fn slot(p: DVec3) -> usize {
    /// 2^64 divided by the golden ratio: odd, and no pattern in its bits.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    // Zeros of either sign are one number, so they have one slot.
    let mix = |hash: u64, x: f64| (hash.rotate_left(23) ^ (x + 0.0).to_bits()).wrapping_mul(FACTOR);
    let mixed = p.to_array().into_iter().fold(0, mix);
    (mixed >> 32) as usize % SLOTS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_sampled_once_until_its_slot_is_taken() {
        let mut cache = DistanceCache::new();
        let mut sampled = 0;
        let mut get = |p: [f64; 3], distance: f64| {
            cache.get(p.into(), || {
                sampled += 1;
                distance
            })
        };
        assert_eq!(get([1.0, 2.0, 3.0], 5.0), 5.0);
        assert_eq!(get([1.0, 2.0, 3.0], 6.0), 5.0);
        assert_eq!(get([0.0, 2.0, 3.0], 7.0), 7.0);
        assert_eq!(get([-0.0, 2.0, 3.0], 8.0), 7.0);
        for n in 0..10_000 {
            let p = [f64::from(n), 0.25, -3.5];
            assert_eq!(get(p, f64::from(n)), f64::from(n));
            assert_eq!(get(p, -1.0), f64::from(n));
        }
        assert_eq!(sampled, 10_002);
    }
}
