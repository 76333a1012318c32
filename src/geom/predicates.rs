//! Exact orientation tests, over the adaptive predicates of the `robust` crate.
//!
//! The sign of a result is exact for all finite coordinates whose products neither overflow nor
//! underflow; its size is only approximate.

use robust::{Coord, Coord3D};

fn coord(p: [f64; 3]) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// Returns six times the signed volume of the tetrahedron abcd: ((b - a) x (c - a)) . (d - a).
/// Positive when d sees the triangle abc counter-clockwise, zero when the four points are coplanar.
#[inline]
pub fn orient3d(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> f64 {
    // `robust` counts the other side as positive.
    robust::orient3d(coord(b), coord(a), coord(c), coord(d))
}

/// Bound of the rounding error of a determinant of three rows, relative to the sum of the sizes of
/// its products: the first bound of Shewchuk's adaptive test (1997), (7 + 56 e) e with e = 2^-53.
const ROUNDING: f64 = (7.0 + 56.0 * (0.5 * f64::EPSILON)) * (0.5 * f64::EPSILON);

/// Whether `above` sees the triangle abc counter-clockwise and `below` clockwise, both strictly:
/// exactly what two calls of [`orient3d`] say, in one go and without a call where the signs are
/// clear.
#[inline]
pub fn are_apart([a, b, c]: [[f64; 3]; 3], above: [f64; 3], below: [f64; 3]) -> bool {
    let minus = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| p[i] - a[i]) };
    let (u, v) = (minus(b), minus(c));
    let product = |i: usize, j: usize| (u[i] * v[j], u[j] * v[i]);
    let products = [product(1, 2), product(2, 0), product(0, 1)];
    let [x, y, z] = products.map(|(p, q)| p - q);
    let [sx, sy, sz] = products.map(|(p, q)| p.abs() + q.abs());
    let side = |d: [f64; 3]| {
        let w = minus(d);
        let size = sx * w[0].abs() + sy * w[1].abs() + sz * w[2].abs();
        let volume = x * w[0] + y * w[1] + z * w[2];
        if volume.abs() > ROUNDING * size { volume } else { orient3d(a, b, c, d) }
    };
    side(above) > 0.0 && side(below) < 0.0
}

/// Returns twice the signed area of the triangle abc: positive when it is counter-clockwise, zero
/// when the three points are collinear.
#[inline]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Returns an axis along which the triangle abc can be projected without losing its area: the first
/// of x, y and z. `None` if and only if the corners lie exactly on a line, which they do when they
/// do so in all three projections.
#[inline]
pub fn projection_axis(corners: [[f64; 3]; 3]) -> Option<usize> {
    (0..3).find(|&axis| {
        let [a, b, c] = corners.map(|p| project(p, axis));
        orient2d(a, b, c) != 0.0
    })
}

/// Returns the point without its coordinate along `axis` (0, 1 or 2).
#[inline]
pub fn project(p: [f64; 3], axis: usize) -> [f64; 2] {
    [p[(axis + 1) % 3], p[(axis + 2) % 3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_follow_the_right_hand() {
        let (o, x, y) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert!(orient3d(o, x, y, [0.3, 0.3, 1e-300]) > 0.0);
        assert!(orient3d(o, x, y, [0.3, 0.3, -1.0]) < 0.0);
        assert_eq!(orient3d(o, x, y, [7.0, -3.0, 0.0]), 0.0);
        assert!(orient2d([0.0; 2], [1.0, 0.0], [0.0, 1.0]) > 0.0);
    }

    #[test]
    fn apart_is_what_two_orientations_say() {
        let mut state = 11u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            // Few different coordinates, so that many points are in a plane, and some a bit away
            // from it.
            let coarse = f64::from((state >> 40) as u32 % 4);
            if (state >> 33).is_multiple_of(8) { coarse.next_up() } else { coarse }
        };
        let mut apart = 0;
        for _ in 0..20_000 {
            let [a, b, c, d, e] = [(); 5].map(|()| [(); 3].map(|()| random()));
            let expected = orient3d(a, b, c, d) > 0.0 && orient3d(a, b, c, e) < 0.0;
            assert_eq!(are_apart([a, b, c], d, e), expected, "{a:?} {b:?} {c:?} {d:?} {e:?}");
            apart += u32::from(expected);
        }
        assert!(apart > 1_000);
    }

    #[test]
    fn the_last_bit_decides() {
        let n = 1.0 + f64::EPSILON;
        let (a, b, c) = ([n, 1.0, 1.0], [1.0, n, 1.0], [1.0, 1.0, n]);
        // x + y + z = 3 + epsilon on the plane; a third of an ulp off it cannot be seen in floating
        // point.
        assert!(orient3d(a, b, c, [n, n, 1.0]) > 0.0);
        assert!(orient3d(a, b, c, [1.0, 1.0, 1.0]) < 0.0);
        assert_eq!(orient3d(a, b, c, [n, 1.0, 1.0]), 0.0);
    }
}
