//! The signed distance filter (\[LW11\] section IV.C, Remarks 3a and 3b): of the two surfaces at
//! distance d, the one on the wrong side goes.
//!
//! The paper's intervals are closed at abs(phi) = l + delta; here they are open there, because a
//! node at exactly abs(phi) = l is valid by Definition 1.

/// Whether no node of a block that passed the bounding box filter is valid.
///
/// `signed` is the signed distance at the centre, `r` the offset distance, `reach` = band
/// half-width plus the block's radius, all in model units.
pub(super) fn rejects(signed: f64, r: f64, reach: f64) -> bool {
    let d = r.abs();
    if r > 0.0 {
        // Remark 3a.
        -d - reach <= signed && signed <= -d + reach && signed < d - reach
    } else {
        // Remark 3b. At r = 0 both surfaces are one and nothing is on the wrong side.
        d - reach <= signed && signed <= d + reach && signed > -d + reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::bounding_box;

    #[test]
    fn both_filters_together_are_remark_one() {
        for step in -400..=400 {
            let signed = f64::from(step) * 0.01;
            for r in [-2.0, -0.3, 0.0, 0.3, 2.0] {
                for reach in [0.1, 0.5, 1.5] {
                    let together =
                        bounding_box::rejects(signed.abs(), f64::abs(r), reach) || rejects(signed, r, reach);
                    let slack = (f64::abs(signed - r) - reach).abs();
                    if slack > 1e-12 {
                        assert_eq!(together, (signed - r).abs() > reach, "{signed} {r} {reach}");
                    }
                }
            }
        }
    }
}
