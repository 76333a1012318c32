//! What of a neighbouring leaf is beside a leaf.

use crate::lattice::{LeafMask, Z_FIRST, Z_LAST};

/// Of a neighbour's mask the bits beside a leaf: along each axis the last layer of a neighbour that lies before it (`delta`
/// -1), the first one of a neighbour that follows it (1), and all of one that does neither (0).
pub fn beside(mask: &LeafMask, [x, y, z]: [i32; 3]) -> LeafMask {
    const Y_FIRST: u64 = 0xff;
    let layer = |delta: i32, first: u64, last: u64| match delta {
        -1 => last,
        0 => !0,
        _ => first,
    };
    let rows = layer(y, Y_FIRST, Y_FIRST << 56) & layer(z, Z_FIRST, Z_LAST);
    let words = layer(x, 1, 1 << 7);
    std::array::from_fn(|n| if words >> n & 1 == 1 { mask[n] & rows } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Ijk, bits};

    #[test]
    fn layers_beside_a_leaf_are_those_next_to_its_own() {
        for n in 0..27i32 {
            let delta = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
            let found: Vec<usize> = bits(&beside(&[!0; 8], delta)).collect();
            let is_beside = |&n: &usize| {
                let local = Ijk::in_leaf(Ijk(delta.map(|d| 8 * d)), n).0;
                local.iter().all(|x| (-1..=8).contains(x))
            };
            assert_eq!(found, (0..512).filter(is_beside).collect::<Vec<_>>(), "{delta:?}");
        }
    }
}
