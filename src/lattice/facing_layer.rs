//! The nodes of a neighbouring leaf that face a leaf.

use super::{LeafMask, Z_FIRST, Z_LAST};

/// Returns the nodes of a neighbouring leaf that face this leaf.
///
/// `delta` is the neighbour's offset in leaves. Along an axis with offset -1 the neighbour's last
/// layer of nodes is kept, with +1 its first layer, with 0 all eight layers.
pub fn facing_layer(mask: &LeafMask, [x, y, z]: [i32; 3]) -> LeafMask {
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
    fn facing_layers_are_next_to_the_leaf() {
        for n in 0..27i32 {
            let delta = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
            let found: Vec<usize> = bits(&facing_layer(&[!0; 8], delta)).collect();
            let is_next_to_leaf = |&n: &usize| {
                let local = Ijk::in_leaf(Ijk(delta.map(|d| 8 * d)), n).0;
                local.iter().all(|x| (-1..=8).contains(x))
            };
            assert_eq!(found, (0..512).filter(is_next_to_leaf).collect::<Vec<_>>(), "{delta:?}");
        }
    }
}
