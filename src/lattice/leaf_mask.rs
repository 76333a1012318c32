//! A bit for each node of a leaf, or for each leaf of a block of 8^3.

/// A 512-bit mask of a leaf's nodes: word x, bit 8 y + z.
pub type LeafMask = [u64; 8];

/// The bits with z = 0 in each row of a word of a [`LeafMask`].
pub const Z_FIRST: u64 = 0x0101_0101_0101_0101;

/// The bits with z = 7 in each row of a word of a [`LeafMask`].
pub const Z_LAST: u64 = Z_FIRST << 7;

/// Returns the numbers of the set bits of a leaf mask, ascending.
#[inline]
pub fn bits(mask: &LeafMask) -> Bits<'_> {
    Bits { mask, word: 0, rest: mask[0] }
}

/// See [`bits`].
#[derive(Clone, Debug)]
pub struct Bits<'a> {
    mask: &'a LeafMask,
    word: usize,
    /// The bits of the word that are still to come.
    rest: u64,
}

impl Iterator for Bits<'_> {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        while self.rest == 0 {
            self.rest = *self.mask.get(self.word + 1)?;
            self.word += 1;
        }
        let bit = self.rest.trailing_zeros() as usize;
        self.rest &= self.rest - 1;
        Some(64 * self.word + bit)
    }
}
