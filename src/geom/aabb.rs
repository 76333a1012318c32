//! Axis-aligned bounding boxes.

use glam::DVec3;

/// An axis-aligned box. The empty box has `lo` above `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub lo: DVec3,
    /// Largest coordinates.
    pub hi: DVec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Aabb = Aabb { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    /// Returns the smallest box around `points`.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |b, p| Aabb { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    /// Returns the box grown by `margin` on every side.
    pub fn grown(self, margin: f64) -> Aabb {
        Aabb { lo: self.lo - margin, hi: self.hi + margin }
    }

    /// Returns the side lengths.
    pub fn size(&self) -> DVec3 {
        self.hi - self.lo
    }

    /// Returns the centre.
    pub fn centre(&self) -> DVec3 {
        // Halves first: the sum of two large coordinates could overflow.
        self.lo * 0.5 + self.hi * 0.5
    }

    /// Returns the length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }
}

/// Whether two closed boxes have a point in common, each given by its lowest and its highest
/// coordinates.
#[inline(always)]
pub fn boxes_meet<T: PartialOrd>([lo, hi]: [&[T; 3]; 2], [other_lo, other_hi]: [&[T; 3]; 2]) -> bool {
    // No short cuts: six comparisons side by side are faster than branches.
    (lo[0] <= other_hi[0])
        & (other_lo[0] <= hi[0])
        & (lo[1] <= other_hi[1])
        & (other_lo[1] <= hi[1])
        & (lo[2] <= other_hi[2])
        & (other_lo[2] <= hi[2])
}
