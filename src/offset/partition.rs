//! Partition of the lattice into slabs: by memory, or into equal shares of the surface.

use crate::band::Layers;
use crate::lattice::{LEAF_DIM, Slab};
use crate::quantity::TileIndex;

/// The layers `start` to `end`, as a slab. The first and the last reach beyond all layers, so that
/// everything has an owner.
fn slab(layers: &Layers, halo: i32, start: usize, end: usize) -> Slab {
    let plane = |layer: usize| match layer {
        0 => i32::MIN,
        n if n >= layers.leaves.len() => i32::MAX,
        n => layers.first + LEAF_DIM * n as i32,
    };
    Slab::new(plane(start), plane(end), halo)
}

/// Returns the slab of one of several tiles with about the same share of the surface each. Where
/// there are fewer layers than tiles, some own nothing; where there are none, the first one owns
/// everything: the sign may still jump where no surface is.
pub(super) fn share(layers: &Layers, halo: i32, tile: TileIndex) -> Slab {
    let (number, count) = (tile.index(), tile.count());
    if layers.leaves.is_empty() {
        return if number == 1 { Slab::WHOLE } else { Slab::new(i32::MAX, i32::MAX, halo) };
    }
    let [total, count] = [layers.total(), count.into()].map(u128::from);
    // Where share n ends: a layer goes to the share that its middle is in.
    let end = |n: u32| {
        let (n, mut sum) = (u128::from(n), 0);
        if n == count {
            return layers.leaves.len();
        }
        let is_in = |leaves: &&u64| {
            let leaves = u128::from(**leaves);
            let middle = 2 * sum + leaves;
            sum += leaves;
            middle * count <= 2 * n * total
        };
        layers.leaves.iter().take_while(is_in).count()
    };
    slab(layers, halo, end(number - 1), end(number))
}

/// As few slabs as possible with at most `most` leaves each, halo included. Fails with the leaves
/// of the fullest layer and its halo where those alone are more.
pub(super) fn within(layers: &Layers, halo: i32, most: u64) -> Result<Vec<Slab>, u64> {
    let around = (halo / LEAF_DIM) as usize;
    let count = layers.leaves.len();
    let computed = |start: usize, end: usize| -> u64 {
        layers.leaves[start.saturating_sub(around)..(end + around).min(count)].iter().sum()
    };
    let least = (0..count).map(|n| computed(n, n + 1)).max().unwrap_or(0);
    if least > most {
        return Err(least);
    }
    let mut slabs = Vec::new();
    let mut start = 0;
    while start < count {
        let mut end = start + 1;
        while end < count && computed(start, end + 1) <= most {
            end += 1;
        }
        slabs.push(slab(layers, halo, start, end));
        start = end;
    }
    Ok(slabs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Ijk;

    fn layers(leaves: &[u64]) -> Layers {
        Layers { first: -16, leaves: leaves.to_vec() }
    }

    /// The leaves that each slab owns.
    fn owned(layers: &Layers, slabs: &[Slab]) -> Vec<u64> {
        let x = |n: usize| Ijk::new(layers.first + LEAF_DIM * n as i32, 0, 0);
        let of = |slab: &Slab| -> u64 {
            let layers = layers.leaves.iter().enumerate();
            layers.filter(|&(n, _)| slab.owns(x(n))).map(|(_, leaves)| leaves).sum()
        };
        slabs.iter().map(of).collect()
    }

    fn in_shares(layers: &Layers, halo: i32, count: u32) -> Vec<Slab> {
        (1..=count).map(|number| share(layers, halo, TileIndex::new(number, count).unwrap())).collect()
    }

    #[test]
    fn shares_are_balanced_and_whole() {
        let even = layers(&[10; 12]);
        assert_eq!(owned(&even, &in_shares(&even, 16, 4)), [30; 4]);
        let uneven = layers(&[1, 1, 1, 1, 20, 1, 1, 1, 1]);
        let shares = owned(&uneven, &in_shares(&uneven, 16, 3));
        assert_eq!(shares.iter().sum::<u64>(), uneven.total());
        assert_eq!(owned(&uneven, &in_shares(&uneven, 16, 1)), [uneven.total()]);
        // More slabs than layers.
        let shares = owned(&layers(&[5, 5]), &in_shares(&layers(&[5, 5]), 16, 5));
        assert_eq!((shares.len(), shares.iter().sum::<u64>()), (5, 10));
        // No layers at all: still, everything has one owner.
        let slabs = in_shares(&layers(&[]), 16, 3);
        for x in [i32::MIN, -8, 0, 1 << 30] {
            assert_eq!(slabs.iter().filter(|slab| slab.owns(Ijk::new(x, 0, 0))).count(), 1, "{x}");
        }
        assert!(slabs[1..].iter().all(|slab| !slab.computes(Ijk::new(1 << 30, 0, 0), 1 << 20)));
        // As many as can be numbered, of as many leaves as there can be.
        let many = layers(&[1 << 40, 1 << 40]);
        for (number, leaves) in [(1, 0), (1 << 30, 1 << 40), (u32::MAX, 0)] {
            assert_eq!(
                owned(&many, &[share(&many, 16, TileIndex::new(number, u32::MAX).unwrap())]),
                [leaves],
                "{number}"
            );
        }
    }

    #[test]
    fn slabs_within_a_limit_are_few() {
        let even = layers(&[10; 12]);
        // Two layers of halo, and none beyond the ends.
        let slabs = within(&even, 16, 70).unwrap();
        assert_eq!(owned(&even, &slabs), [50, 30, 40]);
        assert_eq!(within(&even, 16, 120).unwrap().len(), 1);
        assert_eq!(within(&even, 16, 40), Err(50));
    }
}
