//! Where the lattice is cut into slabs: by memory, or into equal shares of the surface.

use crate::band::{LEAF_DIM, Layers};
use crate::slab::Slab;

/// The layers of leaves, as slabs. The first and the last reach beyond all layers, so that everything has an owner.
fn slabs(layers: &Layers, halo: i32, ends: &[usize]) -> Vec<Slab> {
    let plane = |layer: usize| match layer {
        0 => i32::MIN,
        n if n >= layers.leaves.len() => i32::MAX,
        n => layers.first + LEAF_DIM * n as i32,
    };
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(ends).map(|(start, &end)| Slab::new(plane(start), plane(end), halo)).collect()
}

/// `count` slabs with about the same share of the surface each. Where there are fewer layers than slabs, some
/// own nothing; where there are none, the first one owns everything: the sign may still jump where no surface
/// is.
pub(super) fn in_shares(layers: &Layers, halo: i32, count: u32) -> Vec<Slab> {
    if layers.leaves.is_empty() {
        let nothing = Slab::new(i32::MAX, i32::MAX, halo);
        return std::iter::once(Slab::WHOLE).chain((1..count).map(|_| nothing)).collect();
    }
    let total = layers.total();
    let mut ends = Vec::with_capacity(count as usize);
    let (mut sum, mut end) = (0, 0);
    for n in 1..=u64::from(count) {
        // A layer goes to the share that its middle is in.
        while end < layers.leaves.len() && (2 * sum + layers.leaves[end]) * u64::from(count) <= 2 * n * total
        {
            sum += layers.leaves[end];
            end += 1;
        }
        ends.push(if n == u64::from(count) { layers.leaves.len() } else { end });
    }
    slabs(layers, halo, &ends)
}

/// As few slabs as possible with at most `most` leaves each, halo included. Fails with the leaves of the fullest layer
/// and its halo where those alone are more.
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
    let mut ends = Vec::new();
    let mut start = 0;
    while start < count {
        let mut end = start + 1;
        while end < count && computed(start, end + 1) <= most {
            end += 1;
        }
        ends.push(end);
        start = end;
    }
    Ok(slabs(layers, halo, &ends))
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
