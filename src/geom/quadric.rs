//! The quadratic error function of a sheet (Ju et al. 2002): the sum of squared distances to the
//! tangent planes at its crossings, and where it is least, freely or within half-spaces.

use crate::geom::sym3::Sym3;

/// Eigenvalues below this fraction of the largest one count as zero, and the minimiser stays at the
/// mean of the crossings along their eigenvectors.
///
/// For two planes that meet at an exterior angle a, the ratio is tan^2(a / 2): 1e-3 keeps creases
/// above 3.6 degrees. Larger values blunt weaker creases (1e-2: 11 degrees, 1e-1: 35 degrees).
/// Smaller ones place vertices by the noise of the normals: an error e of a tangent plane moves the
/// minimiser along the weak direction by e / sqrt(ratio), 32 e here.
pub const CUTOFF: f64 = 1e-3;

/// Violations of a half-space up to this, in voxels, count as none while looking for a minimum: the
/// rounding of a 3 x 3 solve with a condition of 1 / CUTOFF is about 1e-12.
const TOLERANCE: f64 = 1e-9;

/// The points w with `normal . w >= offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Points into the half-space, not necessarily of unit length.
    pub normal: [f64; 3],
    /// The product on the boundary.
    pub offset: f64,
}

impl HalfSpace {
    /// How far `w` is inside, in multiples of the normal's length.
    #[inline]
    pub fn depth(&self, w: [f64; 3]) -> f64 {
        dot(self.normal, w) - self.offset
    }
}

/// A sum of squared distances to planes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Qef {
    matrix: Sym3,
    right: [f64; 3],
    points: [f64; 3],
    count: f64,
}

impl Qef {
    /// Adds the plane through `point` with unit normal `normal`. A normal that is zero or not
    /// finite adds the point to the mean only.
    #[inline]
    pub fn add(&mut self, point: [f64; 3], normal: [f64; 3]) {
        self.count += 1.0;
        self.points = along(self.points, 1.0, point);
        let distance = dot(normal, point);
        if !distance.is_finite() {
            return;
        }
        self.matrix.add_outer(normal);
        self.right = along(self.right, distance, normal);
    }

    /// Returns the mean of the added points, at least one.
    pub fn mean(&self) -> [f64; 3] {
        self.points.map(|x| x / self.count)
    }

    /// Returns the least point of the function, nearest to the mean of the added points where it is
    /// not unique. At least one plane must have been added.
    pub fn minimiser(&self) -> Minimiser {
        self.minimiser_near(self.mean())
    }

    /// Returns the least point of the function, nearest to `mean` where it is not unique.
    pub fn minimiser_near(&self, mean: [f64; 3]) -> Minimiser {
        let right = along(self.right, -1.0, self.matrix.times(mean));
        let eigen = self.matrix.eigen();
        let largest = eigen.values[0];
        let mut point = mean;
        let mut weights = [1.0; 3];
        if largest > 0.0 {
            for ((value, vector), weight) in eigen.values.iter().zip(eigen.vectors).zip(&mut weights) {
                if *value > CUTOFF * largest {
                    let step = dot(vector, right) / value;
                    point = along(point, step, vector);
                }
                *weight = (value / largest).max(CUTOFF);
            }
        }
        Minimiser { point, vectors: eigen.vectors, weights }
    }
}

/// The least point of a [`Qef`], and how steeply the function grows around it. Directions that the
/// function does not determine count with the weight of the cut-off, as a pull towards the mean.
#[derive(Clone, Copy, Debug)]
pub struct Minimiser {
    /// The least point.
    pub point: [f64; 3],
    vectors: [[f64; 3]; 3],
    weights: [f64; 3],
}

impl Minimiser {
    /// How much the planes differ in direction: the second eigenvalue as a part of the largest.
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
    pub fn within(&self, region: &[HalfSpace]) -> Option<[f64; 3]> {
        let feasible = |w: [f64; 3]| region.iter().all(|half| half.depth(w) >= -TOLERANCE);
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
    fn on_boundary(&self, set: &[HalfSpace]) -> Option<[f64; 3]> {
        let k = set.len();
        let mut pulled = [[0.0; 3]; 3];
        let mut rows = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut right = [0.0; 3];
        for i in 0..k {
            pulled[i] = self.inverse_times(set[i].normal);
            right[i] = -set[i].depth(self.point);
        }
        for i in 0..k {
            for j in 0..k {
                rows[i][j] = dot(set[i].normal, pulled[j]);
            }
        }
        let multipliers = solve(rows, right)?;
        if multipliers[..k].iter().any(|&m| m < 0.0) {
            return None;
        }
        let mut w = self.point;
        for i in 0..k {
            w = along(w, multipliers[i], pulled[i]);
        }
        Some(w)
    }

    /// Returns the inverse of the function's matrix times `v`.
    fn inverse_times(&self, v: [f64; 3]) -> [f64; 3] {
        let mut out = [0.0; 3];
        for (vector, weight) in self.vectors.iter().zip(self.weights) {
            let part = dot(*vector, v) / weight;
            out = along(out, part, *vector);
        }
        out
    }
}

/// Solves a 3 x 3 system by Cramer's rule; `None` when it is singular.
fn solve(rows: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = rows;
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let det = dot(a, bc);
    let size = rows.iter().map(|r| dot(*r, *r).sqrt()).product::<f64>();
    // Boundaries that are parallel give a determinant of rounding size.
    if det.abs() <= 1e-12 * size {
        return None;
    }
    Some(std::array::from_fn(|i| (right[0] * bc[i] + right[1] * ca[i] + right[2] * ab[i]) / det))
}

/// Returns the inner product.
#[inline]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the outer product.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + scale b.
#[inline]
pub fn along(a: [f64; 3], scale: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + scale * b[i])
}

/// Returns the square of the distance of two points.
#[inline]
pub fn distance2(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = along(a, -1.0, b);
    dot(d, d)
}

#[cfg(test)]
mod tests;
