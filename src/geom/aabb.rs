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
