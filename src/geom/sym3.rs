//! Symmetric 3 x 3 matrices and their eigen decomposition.
//!
//! Own code instead of a crate, for speed: a matrix with one dominant eigenvalue, as nearly
//! parallel planes have, is decomposed three times as fast as by rotations, and the contour
//! decomposes one per sheet.

use glam::DVec3;

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym3 {
    /// Diagonal entries xx, yy, zz.
    pub diagonal: [f64; 3],
    /// Entries yz, zx, xy: entry a is the one whose row and column are not a.
    pub off: [f64; 3],
}

/// An eigen decomposition: eigenvalues in descending order and their unit eigenvectors, mutually
/// orthogonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// Eigenvalues, largest first.
    pub values: [f64; 3],
    /// Eigenvectors: `vectors[i]` belongs to `values[i]`.
    pub vectors: [[f64; 3]; 3],
}

/// The most sweeps; the iteration stops after them whatever is left. Jacobi sweeps converge
/// quadratically: 3 x 3 matrices need three or four, and more than six have never been seen.
const MAX_SWEEPS: usize = 12;

/// Off-diagonal entries below this fraction of the trace norm count as zero: the rounding of the
/// entries themselves is of that size, so that going on would only turn noise.
const NEGLIGIBLE_ENTRY: f64 = 1e-16;

/// The sum of the principal minors, relative to the squared trace, up to which the largest
/// eigenvalue is at least 17 times the sum of the others. Sixteen powers of it leave nothing of the
/// others.
const MAX_MINORS: f64 = 0.05;

impl Sym3 {
    /// Adds the outer product v v^T.
    #[inline]
    pub fn add_outer(&mut self, v: [f64; 3]) {
        for a in 0..3 {
            self.diagonal[a] += v[a] * v[a];
            self.off[a] += v[(a + 1) % 3] * v[(a + 2) % 3];
        }
    }

    /// Returns the product of the matrix and a vector.
    #[inline]
    pub fn times(&self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            self.diagonal[a] * v[a] + self.off[c] * v[b] + self.off[b] * v[c]
        })
    }

    /// Returns the eigenvalues and eigenvectors. Entries must be finite.
    #[inline]
    pub fn eigen(&self) -> Eigen {
        self.dominated().unwrap_or_else(|| self.jacobi())
    }

    /// Returns the product of the matrix with itself, divided by the square of the trace.
    #[inline]
    fn squared(&self) -> Sym3 {
        let [x, y, z] = self.diagonal;
        let [yz, zx, xy] = self.off;
        let trace = x + y + z;
        let scale = 1.0 / (trace * trace);
        Sym3 {
            diagonal: [x * x + xy * xy + zx * zx, y * y + xy * xy + yz * yz, z * z + zx * zx + yz * yz]
                .map(|e| scale * e),
            off: [xy * zx + yz * (y + z), xy * yz + zx * (x + z), zx * yz + xy * (x + y)].map(|e| scale * e),
        }
    }

    /// Returns the decomposition of a matrix with one eigenvalue far above the others, as nearly
    /// parallel planes have. Powers of the matrix have its eigenvector in every column; a rotation
    /// in the plane of the other two is left. Three times as fast as [`jacobi`](Self::jacobi).
    /// `None` for other matrices.
    fn dominated(&self) -> Option<Eigen> {
        let [x, y, z] = self.diagonal;
        let [yz, zx, xy] = self.off;
        let trace = x + y + z;
        let minors = (x * y - xy * xy) + (y * z - yz * yz) + (z * x - zx * zx);
        if !((trace * trace).is_normal() && minors <= MAX_MINORS * trace * trace) {
            return None;
        }
        let eighth = self.squared().squared().squared();
        // The largest column is nearly the first eigenvector; another product makes it one.
        let [xx, yy, zz] = eighth.diagonal;
        let column = if xx >= yy && xx >= zz {
            [xx, eighth.off[2], eighth.off[1]]
        } else if yy >= zz {
            [eighth.off[2], yy, eighth.off[0]]
        } else {
            [eighth.off[1], eighth.off[0], zz]
        };
        let first = unit(eighth.times(column));
        let [second, third] = complement(first);
        let product = |a: [f64; 3], b: [f64; 3]| DVec3::from(a).dot(b.into());
        let (to_second, to_third) = (self.times(second), self.times(third));
        // Some matrices with negative eigenvalues get here, and their powers are another matter.
        let coupled = product(first, to_second).abs().max(product(first, to_third).abs());
        if coupled > 4.0 * f64::EPSILON * trace.abs() {
            return None;
        }
        let mut values =
            [product(first, self.times(first)), product(second, to_second), product(third, to_third)];
        let mut off = [product(second, to_third), 0.0, 0.0];
        let mut vectors = [first, second, third];
        if off[0].abs() > NEGLIGIBLE_ENTRY * trace {
            rotate(&mut values, &mut off, &mut vectors, 0);
        }
        if values[1] < values[2] {
            values.swap(1, 2);
            vectors.swap(1, 2);
        }
        (values[0] >= values[1]).then_some(Eigen { values, vectors })
    }

    /// Returns the decomposition by cyclic Jacobi rotations. They are a little slower than the
    /// closed form, but accurate for repeated and for tiny eigenvalues, where the closed form loses
    /// half the digits.
    fn jacobi(&self) -> Eigen {
        let mut d = self.diagonal;
        let mut off = self.off;
        let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let floor = NEGLIGIBLE_ENTRY * (d[0].abs() + d[1].abs() + d[2].abs());
        for _ in 0..MAX_SWEEPS {
            let mut turned = false;
            // Axis a stays, b and c turn.
            for a in 0..3 {
                if off[a].abs() > floor {
                    turned = true;
                    rotate(&mut d, &mut off, &mut vectors, a);
                }
            }
            if !turned {
                break;
            }
        }
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if d[i] < d[j] {
                d.swap(i, j);
                vectors.swap(i, j);
            }
        }
        Eigen { values: d, vectors }
    }
}

/// Returns `v` scaled to length 1. `v` must not be zero.
#[inline]
fn unit(v: [f64; 3]) -> [f64; 3] {
    let v = DVec3::from(v);
    (v * (1.0 / v.length())).to_array()
}

/// Returns two unit vectors perpendicular to a third and to each other (Duff et al. 2017).
#[inline]
fn complement([x, y, z]: [f64; 3]) -> [[f64; 3]; 2] {
    let sign = 1f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// Makes entry `off[a]` zero by one Jacobi rotation in the plane of the two axes other than `a`.
#[inline]
fn rotate(d: &mut [f64; 3], off: &mut [f64; 3], vectors: &mut [[f64; 3]; 3], a: usize) {
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let p = off[a];
    // The smaller of the two rotations that work, from tan(2 angle) = 2 p / (d_c - d_b), written
    // without a quotient that could overflow.
    let q = 0.5 * (d[c] - d[b]);
    let tan = p.copysign(q * p) / (q.abs() + (q * q + p * p).sqrt());
    let cos = 1.0 / (1.0 + tan * tan).sqrt();
    let sin = tan * cos;
    d[b] -= tan * p;
    d[c] += tan * p;
    off[a] = 0.0;
    // off[c] is entry (a, b), off[b] is entry (c, a).
    (off[c], off[b]) = (cos * off[c] - sin * off[b], sin * off[c] + cos * off[b]);
    let (vb, vc) = (vectors[b], vectors[c]);
    for k in 0..3 {
        vectors[b][k] = cos * vb[k] - sin * vc[k];
        vectors[c][k] = sin * vb[k] + cos * vc[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(m: Sym3) {
        let Eigen { values, vectors } = m.eigen();
        let scale = values[0].abs().max(values[2].abs()).max(1e-300);
        assert!(values[0] >= values[1] && values[1] >= values[2]);
        for i in 0..3 {
            let image = m.times(vectors[i]);
            for k in 0..3 {
                assert!((image[k] - values[i] * vectors[i][k]).abs() < 1e-14 * scale, "{m:?}");
            }
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((DVec3::from(vectors[i]).dot(vectors[j].into()) - expected).abs() < 1e-14, "{m:?}");
            }
        }
    }

    #[test]
    fn eigenvectors_are_orthogonal_and_solve() {
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for round in 0..10_000 {
            let mut m = Sym3::default();
            // Rank 1, 2, 3 and nearly repeated eigenvalues.
            for row in 0..=round % 4 {
                let tiny = if round % 7 == 0 && row > 0 { 1e-6 } else { 1.0 };
                let v: [f64; 3] = std::array::from_fn(|_| random() * tiny);
                m.add_outer(v);
            }
            check(m);
        }
        // One eigenvalue far above the others, and others of either sign.
        for round in 0..10_000 {
            let mut m = Sym3::default();
            for _ in 0..2 + round % 3 {
                let spread = [1e-9, 1e-3, 0.03, 0.2][round % 4];
                m.add_outer([1.0 + spread * random(), spread * random(), 0.5 + spread * random()]);
            }
            check(m);
            if round % 5 == 0 {
                m.diagonal[1] -= 0.1 * random();
                check(m);
            }
        }
        check(Sym3::default());
        check(Sym3 { diagonal: [2.0; 3], off: [0.0; 3] });
        check(Sym3 { diagonal: [1.0; 3], off: [1.0; 3] });
    }

    #[test]
    fn products_use_the_right_entries() {
        let m = Sym3 { diagonal: [1.0, 2.0, 3.0], off: [10.0, 20.0, 30.0] };
        assert_eq!(m.times([1.0, 0.0, 0.0]), [1.0, 30.0, 20.0]);
        assert_eq!(m.times([0.0, 1.0, 0.0]), [30.0, 2.0, 10.0]);
        assert_eq!(m.times([0.0, 0.0, 1.0]), [20.0, 10.0, 3.0]);
    }
}
