//! Convex/concave analysis (\[LW11\] section VI): the test whether triangles stay in the envelope
//! of a grid edge.
//!
//! The envelope of a crossed grid edge e with ends v+ and v- is the union of the tetrahedra (a, b,
//! v+, v-) over the sides ab of the polygon around e (Definition 5). Envelopes of different edges
//! do not overlap.
//!
//! Call a triangle abc of polygon corners *good* when v+ lies strictly on one side of its plane and
//! v- strictly on the other, the right way round. A disc of good triangles is seen one-to-one from
//! v+ as well as from v-, so it stays in the envelope. For a quad s, p, q, r this is the paper's
//! analysis: p is a concave envelope vertex (Definition 6) when it is below one of the oriented
//! planes s-q-v+ and q-s-v- (Remark 8), which are the planes that decide whether spq is good. So a
//! diagonal is legal when neither of the two corners that it cuts off is concave (Propositions 2
//! and 3). By Remark 10 opposite corners are never both concave, and with two concave corners side
//! by side no diagonal is left (Remark 11).

use crate::geom::predicates::{are_apart, orient3d};

/// The ends of a crossed grid edge.
#[derive(Clone, Copy, Debug)]
pub struct Envelope {
    /// The end v+, from which the polygon around the edge is counter-clockwise: the outside one.
    pub above: [f64; 3],
    /// The other end, v-.
    pub below: [f64; 3],
}

impl Envelope {
    /// Whether the triangle abc is good: strictly between the two ends, counter-clockwise seen from
    /// v+.
    #[inline]
    pub fn is_good(&self, a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> bool {
        are_apart([a, b, c], self.above, self.below)
    }

    /// Whether the side ab turns counter-clockwise around the edge by less than half a turn, so
    /// that the triangle of ab and any point within the edge is good.
    #[inline]
    pub fn turns(&self, a: [f64; 3], b: [f64; 3]) -> bool {
        orient3d(self.below, self.above, a, b) > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENVELOPE: Envelope = Envelope { above: [0.0, 0.0, 1.0], below: [0.0, 0.0, 0.0] };

    #[test]
    fn a_flat_quad_is_good_both_ways() {
        let [p, q, r, s] = [[1.0, 1.0, 0.5], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.5], [1.0, -1.0, 0.5]];
        for (a, b, c) in [(p, q, r), (r, s, p), (q, r, s), (s, p, q)] {
            assert!(ENVELOPE.is_good(a, b, c) && !ENVELOPE.is_good(a, c, b));
        }
        assert!(ENVELOPE.turns(p, q) && !ENVELOPE.turns(q, p));
    }

    #[test]
    fn a_corner_close_to_the_edge_is_concave() {
        // q - s passes the edge on p's side, and p - q - s is not seen counter-clockwise from both
        // ends.
        let [p, q, r, s] = [[0.1, 0.1, 0.9], [-0.1, 0.9, 0.1], [-0.9, -0.9, 0.5], [0.9, -0.1, 0.1]];
        assert!(!ENVELOPE.is_good(s, p, q));
        assert!(ENVELOPE.is_good(p, q, r) && ENVELOPE.is_good(r, s, p));
    }

    #[test]
    fn touching_an_end_is_not_good() {
        let [a, b, c] = [[1.0, 0.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]];
        assert!(!ENVELOPE.is_good(a, b, c));
    }
}
