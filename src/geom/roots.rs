//! Roots of quadratics on an interval, guarded against cancellation.

/// Returns the real roots of a x^2 + b x + c in ascending order, without cancellation: the larger
/// root in magnitude comes from the stable formula, the other from the product of both.
pub fn quadratic(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let (first, second) = solve(a, b, c);
    [first, second].into_iter().flatten()
}

fn solve(a: f64, b: f64, c: f64) -> (Option<f64>, Option<f64>) {
    if a == 0.0 {
        return if b == 0.0 { (None, None) } else { (Some(-c / b), None) };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return (None, None);
    }
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    if q == 0.0 {
        return (Some(0.0), None);
    }
    let (x, y) = (q / a, c / q);
    (Some(x.min(y)), (x != y).then_some(x.max(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_roots_keep_their_digits() {
        // (x - 1e-9)(x - 1e9): the textbook formula loses the small root.
        let roots: Vec<f64> = quadratic(1.0, -(1e9 + 1e-9), 1.0).collect();
        assert_eq!(roots.len(), 2);
        assert!((roots[0] / 1e-9 - 1.0).abs() < 1e-14 && (roots[1] / 1e9 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn degenerate_cases() {
        assert_eq!(quadratic(0.0, 2.0, -1.0).collect::<Vec<_>>(), [0.5]);
        assert_eq!(quadratic(0.0, 0.0, 1.0).count(), 0);
        assert_eq!(quadratic(1.0, 0.0, 1.0).count(), 0);
        assert_eq!(quadratic(1.0, 0.0, 0.0).collect::<Vec<_>>(), [0.0]);
        assert_eq!(quadratic(1.0, -2.0, 1.0).collect::<Vec<_>>(), [1.0]);
    }
}
