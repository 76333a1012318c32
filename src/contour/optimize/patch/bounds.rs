//! Axis-parallel boxes.

use crate::geom::aabb::boxes_meet;

/// A closed box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The lowest coordinates.
    pub lo: [f64; 3],
    /// The highest coordinates.
    pub hi: [f64; 3],
}

impl Bounds {
    /// The box of nothing, which meets no other.
    pub const NOTHING: Bounds = Bounds { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    /// Returns the box around points; nothing around none.
    #[inline]
    pub fn around(points: impl IntoIterator<Item = [f64; 3]>) -> Bounds {
        points.into_iter().fold(Bounds::NOTHING, |all, p| all.with(&Bounds { lo: p, hi: p }))
    }

    /// Returns the box around a triangle.
    #[inline(always)]
    pub fn of_triangle([a, b, c]: [[f64; 3]; 3]) -> Bounds {
        // Without regard to what is not a number: comparisons that are faster than those of
        // `f64::min`.
        let least = |x: f64, y: f64| if x < y { x } else { y };
        let largest = |x: f64, y: f64| if x > y { x } else { y };
        Bounds {
            lo: std::array::from_fn(|i| least(a[i], least(b[i], c[i]))),
            hi: std::array::from_fn(|i| largest(a[i], largest(b[i], c[i]))),
        }
    }

    /// Returns the box with `margin` around it.
    pub fn grown(&self, margin: f64) -> Bounds {
        Bounds { lo: self.lo.map(|x| x - margin), hi: self.hi.map(|x| x + margin) }
    }

    /// Returns the intersection of two boxes.
    pub fn within(&self, other: &Bounds) -> Bounds {
        Bounds {
            lo: std::array::from_fn(|a| self.lo[a].max(other.lo[a])),
            hi: std::array::from_fn(|a| self.hi[a].min(other.hi[a])),
        }
    }

    /// Whether two boxes have a point in common.
    #[inline(always)]
    pub fn meets(&self, other: &Bounds) -> bool {
        boxes_meet([&self.lo, &self.hi], [&other.lo, &other.hi])
    }

    /// Whether a point lies in this box.
    pub fn holds(&self, p: [f64; 3]) -> bool {
        self.contains(&Bounds { lo: p, hi: p })
    }

    /// Whether `other` lies in this box.
    pub fn contains(&self, other: &Bounds) -> bool {
        (0..3).all(|a| self.lo[a] <= other.lo[a] && other.hi[a] <= self.hi[a])
    }

    /// Returns the box around two boxes.
    #[inline]
    pub fn with(&self, other: &Bounds) -> Bounds {
        Bounds {
            lo: std::array::from_fn(|a| self.lo[a].min(other.lo[a])),
            hi: std::array::from_fn(|a| self.hi[a].max(other.hi[a])),
        }
    }
}
