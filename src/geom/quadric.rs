//! The quadratic error function (QEF, Ju et al. 2002): the sum of squared distances to planes.
//!
//! Its minimiser is found freely, or within half-spaces. For a sheet of the contour the planes are
//! the tangent planes at its crossings.

use crate::geom::sym3::Sym3;
use glam::DVec3;

/// The fraction of the largest eigenvalue below which eigenvalues count as zero.
///
/// Along their eigenvectors the minimiser stays at the mean of the crossings.
///
/// For two planes that meet at an exterior angle a, the ratio is tan^2(a / 2): 1e-3 keeps creases
/// above 3.6 degrees. Larger values blunt weaker creases (1e-2: 11 degrees, 1e-1: 35 degrees).
/// Smaller ones place vertices by the noise of the normals: an error e of a tangent plane moves the
/// minimiser along the weak direction by e / sqrt(ratio), 32 e here.
pub const CUTOFF: f64 = 1e-3;

/// The largest violation of a half-space, in voxels, that counts as none while a minimum is looked
/// for.
///
/// The rounding of a 3 x 3 solve with a condition of 1 / CUTOFF is about 1e-12.
const TOLERANCE: f64 = 1e-9;

/// The points w with `normal . w >= offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// The direction into the half-space, not necessarily of unit length.
    pub normal: DVec3,
    /// The inner product of the normal with any point of the boundary.
    pub offset: f64,
}

impl HalfSpace {
    /// Returns the depth of `w` in the half-space, in multiples of the normal's length; negative
    /// outside.
    #[inline]
    pub fn depth(&self, w: DVec3) -> f64 {
        self.normal.dot(w) - self.offset
    }
}

/// A sum of squared distances to planes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Qef {
    matrix: Sym3,
    right: DVec3,
    points: DVec3,
    count: f64,
}

impl Qef {
    /// Adds the plane through `point` with unit normal `normal`.
    ///
    /// A normal that is zero or not finite adds the point to the mean only.
    #[inline]
    pub fn add(&mut self, point: DVec3, normal: DVec3) {
        self.count += 1.0;
        self.points += point;
        let distance = normal.dot(point);
        if !distance.is_finite() {
            return;
        }
        self.matrix.add_outer(normal.to_array());
        self.right += distance * normal;
    }

    /// Returns the mean of the added points, at least one.
    pub fn mean(&self) -> DVec3 {
        self.points / self.count
    }

    /// Returns the least point of the function, nearest to the mean of the added points where it is
    /// not unique. At least one plane must have been added.
    pub fn minimiser(&self) -> Minimiser {
        self.minimiser_near(self.mean())
    }

    /// Returns the least point of the function, nearest to `mean` where it is not unique.
    pub fn minimiser_near(&self, mean: DVec3) -> Minimiser {
        let right = self.right - DVec3::from(self.matrix.times(mean.to_array()));
        let eigen = self.matrix.eigen();
        let largest = eigen.values[0];
        let mut point = mean;
        let mut weights = [1.0; 3];
        let vectors = eigen.vectors.map(DVec3::from);
        if largest > 0.0 {
            for ((value, vector), weight) in eigen.values.iter().zip(vectors).zip(&mut weights) {
                if *value > CUTOFF * largest {
                    let step = vector.dot(right) / value;
                    point += step * vector;
                }
                *weight = (value / largest).max(CUTOFF);
            }
        }
        Minimiser { point, vectors, weights }
    }
}

/// The least point of a [`Qef`], and the growth of the function around it.
///
/// Directions that the function does not determine count with the weight of the cut-off, as a pull
/// towards the mean.
#[derive(Clone, Copy, Debug)]
pub struct Minimiser {
    /// The least point.
    pub point: DVec3,
    vectors: [DVec3; 3],
    weights: [f64; 3],
}

impl Minimiser {
    /// Returns the spread of the planes' directions: the second eigenvalue as a part of the
    /// largest, 0 to 1.
    #[inline]
    pub fn spread(&self) -> f64 {
        self.weights[1]
    }

    /// Returns the least point within the intersection of `region`, up to a rounding error; `None`
    /// when none is found, as when the intersection is empty.
    ///
    /// The minimum of a convex quadratic function lies on the boundaries of at most three of the
    /// half-spaces, with multipliers that are not negative (Karush, Kuhn, Tucker): all such sets
    /// are tried, smaller ones first.
    pub fn within(&self, region: &[HalfSpace]) -> Option<DVec3> {
        let feasible = |w: DVec3| region.iter().all(|half| half.depth(w) >= -TOLERANCE);
        if feasible(self.point) {
            return Some(self.point);
        }
        // A set without a violated half-space cannot hold the minimum.
        let violated = |h: &HalfSpace| h.depth(self.point) < 0.0;
        let try_set = |set: &[HalfSpace]| self.on_boundary(set).filter(|&w| feasible(w));
        let n = region.len();
        for &a in region.iter().filter(|h| violated(h)) {
            if let Some(w) = try_set(&[a]) {
                return Some(w);
            }
        }
        for (i, &a) in region.iter().enumerate() {
            for &b in region[i + 1..].iter().filter(|b| violated(&a) || violated(b)) {
                if let Some(w) = try_set(&[a, b]) {
                    return Some(w);
                }
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                for k in j + 1..n {
                    let set = [region[i], region[j], region[k]];
                    if set.iter().any(violated)
                        && let Some(w) = try_set(&set)
                    {
                        return Some(w);
                    }
                }
            }
        }
        None
    }

    /// Returns the least point on the boundaries of one to three half-spaces, if the function
    /// pushes outwards through all of them there.
    fn on_boundary(&self, set: &[HalfSpace]) -> Option<DVec3> {
        let k = set.len();
        let mut pulled = [DVec3::ZERO; 3];
        let mut rows = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut right = [0.0; 3];
        for i in 0..k {
            pulled[i] = self.inverse_times(set[i].normal);
            right[i] = -set[i].depth(self.point);
        }
        for i in 0..k {
            for j in 0..k {
                rows[i][j] = set[i].normal.dot(pulled[j]);
            }
        }
        let multipliers = solve(rows.map(DVec3::from), right)?;
        if multipliers[..k].iter().any(|&m| m < 0.0) {
            return None;
        }
        let mut w = self.point;
        for i in 0..k {
            w += multipliers[i] * pulled[i];
        }
        Some(w)
    }

    /// Returns the inverse of the function's matrix times `v`.
    fn inverse_times(&self, v: DVec3) -> DVec3 {
        let mut out = DVec3::ZERO;
        for (vector, weight) in self.vectors.iter().zip(self.weights) {
            let part = vector.dot(v) / weight;
            out += part * *vector;
        }
        out
    }
}

/// Solves a 3 x 3 system by Cramer's rule; `None` when it is singular.
fn solve(rows: [DVec3; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = rows;
    let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
    let det = a.dot(bc);
    let size = rows.iter().map(|row| row.length()).product::<f64>();
    // Boundaries that are parallel give a determinant of rounding size.
    if det.abs() <= 1e-12 * size {
        return None;
    }
    Some(std::array::from_fn(|i| (right[0] * bc[i] + right[1] * ca[i] + right[2] * ab[i]) / det))
}

#[cfg(test)]
mod tests;
