//! What the surface was asked before: changes of a patch look at the same middles of edges again and again.

type Point = [f64; 3];

/// Answers that are kept: a patch asks for 50 points most of the time, and seldom for more than this.
const KEPT: usize = 512;

/// Answers by point. Each point has one place, and what comes later takes it.
#[derive(Clone, Debug)]
pub struct Answers(Vec<(Point, f64)>);

impl Answers {
    /// None yet.
    pub fn new() -> Answers {
        // Nothing equals this point.
        Answers(vec![([f64::NAN; 3], 0.0); KEPT])
    }

    /// The answer for a point, which `ask` gives where it is not known: always the same one for the same point.
    pub fn get(&mut self, p: Point, ask: impl FnOnce() -> f64) -> f64 {
        let place = &mut self.0[place(p)];
        if place.0 != p {
            *place = (p, ask());
        }
        place.1
    }
}

fn place(p: Point) -> usize {
    /// 2^64 divided by the golden ratio: odd, and no pattern in its bits.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    // Zeros of either sign are one number, so they have one place.
    let mixed =
        p.iter().fold(0, |hash: u64, x| (hash.rotate_left(23) ^ (x + 0.0).to_bits()).wrapping_mul(FACTOR));
    (mixed >> 32) as usize % KEPT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_asked_once_until_its_place_is_taken() {
        let mut answers = Answers::new();
        let mut asked = 0;
        let mut get = |p: Point, answer: f64| {
            answers.get(p, || {
                asked += 1;
                answer
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
        assert_eq!(asked, 10_002);
    }
}
