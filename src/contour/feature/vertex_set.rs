//! A set of vertices by number.

/// A set of vertices, a bit for each. Nothing is stored for an empty set.
#[derive(Debug, Default)]
pub struct VertexSet {
    words: Vec<u64>,
}

impl VertexSet {
    /// Makes the set of some of `vertices` vertices.
    pub fn new(numbers: impl ExactSizeIterator<Item = u32>, vertices: usize) -> VertexSet {
        if numbers.len() == 0 {
            return VertexSet::default();
        }
        let mut words = vec![0u64; vertices.div_ceil(64)];
        for number in numbers {
            words[number as usize >> 6] |= 1 << (number & 63);
        }
        VertexSet { words }
    }

    /// Returns the bits, 64 vertices to a word.
    #[inline]
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// Whether a vertex is in the set. Vertices that are added to the mesh later are not.
    #[inline]
    pub fn contains(&self, vertex: u32) -> bool {
        self.words.get(vertex as usize >> 6).is_some_and(|word| word >> (vertex & 63) & 1 == 1)
    }

    /// Whether any of some vertices is in the set.
    #[inline]
    pub fn contains_any(&self, vertices: impl IntoIterator<Item = u32>) -> bool {
        !self.words.is_empty() && vertices.into_iter().any(|v| self.contains(v))
    }
}
