//! The test of Ju and Udeshi (2006) for a diagonal, by intersections of polygon edges with
//! triangles.
//!
//! The convex/concave analysis of [`envelope`](super::envelope) replaces it (\[LW11\] section VI).
//! The test is here to be measured against (Table VI).
//!
//! The diagonal ac of the quad abcd around a grid edge e = v+ v- passes e on the side of b or on
//! that of d:
//!
//! ```text
//!      a ----- d
//!      | \ e   |
//!      |  \    |
//!      b ----- c
//! ```
//!
//! On the side of b the diagonal stays in the envelope when it crosses the triangle (b, v+, v-),
//! the wall between the tetrahedra (a, b, v+, v-) and (b, c, v+, v-). The triangle abc is then in
//! these two. The triangle acd is in the envelope when e crosses it: it falls apart into parts in
//! the four tetrahedra.
//!
//! Both tests are strict. A diagonal that meets the grid edge itself crosses neither wall and is
//! given up for a vertex on the edge, which is what \[LW11\] says of such cases.

use super::envelope::Envelope;
use crate::geom::predicates::orient3d;

/// Whether both triangles that the diagonal from the first to the third corner of `quad` makes stay
/// in the envelope, decided by segment-triangle intersections.
#[inline]
pub fn is_legal([a, b, c, d]: [[f64; 3]; 4], envelope: &Envelope) -> bool {
    let Envelope { above, below } = *envelope;
    let passes = |corner, beyond| crosses([a, c], [corner, above, below]) && crosses([above, below], beyond);
    passes(b, [a, c, d]) || passes(d, [a, b, c])
}

/// Whether the segment passes through the inside of the triangle.
#[inline]
fn crosses([p, q]: [[f64; 3]; 2], [a, b, c]: [[f64; 3]; 3]) -> bool {
    let (before, after) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    if !((before > 0.0 && after < 0.0) || (before < 0.0 && after > 0.0)) {
        return false;
    }
    let turns = [[a, b], [b, c], [c, a]].map(|[s, t]| orient3d(p, q, s, t));
    turns.iter().all(|&x| x > 0.0) || turns.iter().all(|&x| x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ENVELOPE: Envelope = Envelope { above: [0.0, 0.0, 1.0], below: [0.0; 3] };

    #[test]
    fn a_diagonal_through_the_grid_edge_is_given_up() {
        let [a, b, c, d] = [[1.0, 1.0, 0.5], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.5], [1.0, -1.0, 0.5]];
        assert!(!is_legal([a, b, c, d], &ENVELOPE));
        assert!(ENVELOPE.is_good(a, b, c) && ENVELOPE.is_good(c, d, a), "the analysis takes it");
        // A little to either side it is taken.
        assert!(is_legal([[1.0, 0.9, 0.5], b, c, d], &ENVELOPE));
        assert!(is_legal([[0.9, 1.0, 0.5], b, c, d], &ENVELOPE));
    }

    proptest! {
        /// Off the grid edge both tests agree; on it, only the analysis takes the diagonal.
        #[test]
        fn it_takes_no_diagonal_that_the_analysis_refuses(
            xy in prop::array::uniform4(prop::array::uniform2(1e-3..1.0f64)),
            z in prop::array::uniform4(1e-3..0.999f64),
            power in 1..5i32,
        ) {
            let signs = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
            let quad: [[f64; 3]; 4] = std::array::from_fn(|i| {
                // Powers, to have many close to the edge.
                [signs[i][0] * xy[i][0].powi(power), signs[i][1] * xy[i][1].powi(power), z[i]]
            });
            let [a, b, c, d] = quad;
            let good = ENVELOPE.is_good(a, b, c) && ENVELOPE.is_good(c, d, a);
            prop_assert_eq!(is_legal(quad, &ENVELOPE), good);
        }
    }
}
