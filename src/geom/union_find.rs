//! Disjoint sets of numbers that are joined pair by pair (union-find).

/// A partition of the numbers 0..n into sets. The lowest number of a set stands for it.
#[derive(Clone, Debug)]
pub(crate) struct UnionFind {
    /// A lower member of the same set, or the number itself where it is the lowest.
    parents: Vec<u32>,
}

impl UnionFind {
    /// Returns the partition of 0..`count` into sets of one number each.
    pub(crate) fn new(count: u32) -> UnionFind {
        UnionFind { parents: (0..count).collect() }
    }

    /// Returns the lowest number of the set that holds `n`.
    ///
    /// # Panics
    /// When `n` is out of range.
    pub(crate) fn root(&mut self, mut n: u32) -> u32 {
        // Halving the path on the way keeps the trees flat.
        while self.parents[n as usize] != n {
            self.parents[n as usize] = self.parents[self.parents[n as usize] as usize];
            n = self.parents[n as usize];
        }
        n
    }

    /// Joins the sets that hold `a` and `b`. Returns whether they were two.
    ///
    /// # Panics
    /// When one of the numbers is out of range.
    pub(crate) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_number_stands_for_its_set() {
        let mut sets = UnionFind::new(6);
        assert!(sets.join(5, 3) && sets.join(1, 5) && sets.join(4, 2));
        assert!(!sets.join(3, 1));
        let roots: Vec<u32> = (0..6).map(|n| sets.root(n)).collect();
        assert_eq!(roots, [0, 1, 2, 1, 2, 1]);
    }
}
