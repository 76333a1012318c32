//! Triangle intersections over exact rational numbers, as the oracle of the tests.
//!
//! The tested code decides by signs of determinants and never computes what two triangles have in
//! common. The oracle computes exactly that set: it clips one triangle by the plane of the other
//! one and by its three sides (Sutherland and Hodgman 1974). The two share no code, no predicate
//! and no case distinction.

use num_bigint::BigInt;
use num_rational::{BigRational, Ratio};
use num_traits::{One, Signed};

/// An exact number.
pub trait Exact: Clone + PartialOrd + Signed {
    /// Returns the value of a finite floating-point number.
    fn exactly(x: f64) -> Self;
}

/// Enough for integers up to some tens.
impl Exact for Ratio<i128> {
    fn exactly(x: f64) -> Self {
        assert_eq!(x.fract(), 0.0, "{x} is no integer");
        Ratio::from_integer(x as i128)
    }
}

/// Enough for everything.
impl Exact for BigRational {
    fn exactly(x: f64) -> Self {
        // The conversion of the crate would round nothing either, but it does not promise that.
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i32;
        assert!(exponent < 0x7ff, "{x} is not finite");
        let fraction = bits & ((1 << 52) - 1);
        let (digits, exponent) =
            if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
        let power = BigInt::one() << exponent.unsigned_abs();
        let digits = if x.is_sign_negative() { -BigInt::from(digits) } else { BigInt::from(digits) };
        if exponent < 0 { BigRational::new(digits, power) } else { BigRational::from(digits * power) }
    }
}

/// A point with exact coordinates.
pub type ExactPoint<T> = [T; 3];

/// Returns the exact point with the given coordinates.
pub fn exact_point<T: Exact>(p: [f64; 3]) -> ExactPoint<T> {
    p.map(T::exactly)
}

fn difference<T: Exact>(a: &ExactPoint<T>, b: &ExactPoint<T>) -> ExactPoint<T> {
    std::array::from_fn(|axis| a[axis].clone() - b[axis].clone())
}

fn cross<T: Exact>(a: &ExactPoint<T>, b: &ExactPoint<T>) -> ExactPoint<T> {
    std::array::from_fn(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        a[i].clone() * b[j].clone() - a[j].clone() * b[i].clone()
    })
}

fn dot<T: Exact>(a: &ExactPoint<T>, b: &ExactPoint<T>) -> T {
    (0..3).fold(T::zero(), |sum, axis| sum + a[axis].clone() * b[axis].clone())
}

/// Returns the normal of a triangle, of any length; zero if and only if its corners are on a line.
pub fn normal<T: Exact>([a, b, c]: &[ExactPoint<T>; 3]) -> ExactPoint<T> {
    cross(&difference(b, a), &difference(c, a))
}

/// Returns six times the signed volume of the tetrahedron of a triangle and a point.
pub fn volume<T: Exact>(triangle: &[ExactPoint<T>; 3], d: &ExactPoint<T>) -> T {
    dot(&normal(triangle), &difference(d, &triangle[0]))
}

/// Returns the part of a convex polygon where `height`, an affine function, is not negative. A
/// polygon of one or two points is a point or a segment.
fn clipped<T: Exact>(polygon: &[ExactPoint<T>], height: impl Fn(&ExactPoint<T>) -> T) -> Vec<ExactPoint<T>> {
    let heights: Vec<T> = polygon.iter().map(height).collect();
    let mut part = Vec::new();
    for (k, (p, from)) in polygon.iter().zip(&heights).enumerate() {
        let next = (k + 1) % polygon.len();
        let (q, to) = (&polygon[next], &heights[next]);
        if !from.is_negative() {
            part.push(p.clone());
        }
        if from.is_negative() != to.is_negative() && !from.is_zero() && !to.is_zero() {
            let share = from.clone() / (from.clone() - to.clone());
            let along = difference(q, p);
            part.push(std::array::from_fn(|axis| p[axis].clone() + share.clone() * along[axis].clone()));
        }
    }
    part.dedup();
    part
}

/// Returns the corners of the convex set that two closed triangles have in common; none if they do
/// not meet. The second triangle must have area.
pub fn common_part<T: Exact>(a: &[ExactPoint<T>; 3], b: &[ExactPoint<T>; 3]) -> Vec<ExactPoint<T>> {
    let normal = normal(b);
    let above = |p: &ExactPoint<T>| dot(&normal, &difference(p, &b[0]));
    let mut part = clipped(a, above);
    part = clipped(&part, |p| -above(p));
    for k in 0..3 {
        let inward = cross(&normal, &difference(&b[(k + 1) % 3], &b[k]));
        part = clipped(&part, |p| dot(&inward, &difference(p, &b[k])));
    }
    part
}

/// Whether two triangles with area, vertex numbers `va` and `vb` and corners `pa` and `pb`, have a
/// point in common that is not of a vertex or an edge that they share by number. Triangles that
/// share three vertices always have.
pub fn meet_elsewhere<T: Exact>(
    va: [u32; 3],
    pa: &[ExactPoint<T>; 3],
    vb: [u32; 3],
    pb: &[ExactPoint<T>; 3],
) -> bool {
    let part = common_part(pa, pb);
    let shared: Vec<&ExactPoint<T>> =
        va.iter().zip(pa).filter(|(v, _)| vb.contains(v)).map(|(_, p)| p).collect();
    match shared[..] {
        [] => !part.is_empty(),
        [vertex] => part.iter().any(|p| p != vertex),
        [from, to] => {
            // A triangle meets the line through its side in nothing but that side.
            let side = difference(to, from);
            part.iter().any(|p| cross(&side, &difference(p, from)).iter().any(|x| !x.is_zero()))
        }
        _ => true,
    }
}
