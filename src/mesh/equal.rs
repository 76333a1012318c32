//! Equal items of a long list.

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;
use rayon::prelude::*;

/// Returns, for each item, the first item with the same key.
///
/// The items are dealt out by hash to shards whose tables stay in the cache of a core, and the
/// shards are worked off in parallel. Within a shard the items keep their order, so the result does
/// not depend on it.
pub(super) fn first_equal<T: Copy + Sync, K: Copy + Default + Eq + Send + Sync>(
    items: &[T],
    key: impl Fn(T) -> K + Sync,
    hash: impl Fn(&K) -> u64 + Sync,
) -> Vec<u32> {
    /// Number of items in a shard. A table of this many keys takes about 300 kB, which the second
    /// cache level holds.
    const SHARD: usize = 1 << 13;
    /// The most shards. With more, dealing out becomes slow, since it writes to all shards in turn.
    const MAX_SHARDS: usize = 256;
    /// Number of items that are dealt out in one go.
    const CHUNK: usize = 1 << 16;
    let shards = (items.len() / SHARD).next_power_of_two().min(MAX_SHARDS);
    // The table uses the low bits and the highest seven.
    let shard_of = |key: &K| (hash(key) >> 40) as usize & (shards - 1);

    // Each chunk's (key, item) sorted by shard, and where the shards begin.
    let deal = |(chunk, part): (usize, &[T])| -> (Vec<(K, u32)>, Vec<usize>) {
        let keys: Vec<K> = part.iter().map(|&item| key(item)).collect();
        let mut begin = vec![0; shards + 1];
        keys.iter().for_each(|key| begin[shard_of(key) + 1] += 1);
        (0..shards).for_each(|s| begin[s + 1] += begin[s]);
        let mut next = begin.clone();
        let mut dealt = vec![(K::default(), 0); part.len()];
        for (i, &key) in keys.iter().enumerate() {
            let end = &mut next[shard_of(&key)];
            dealt[*end] = (key, (chunk * CHUNK + i) as u32);
            *end += 1;
        }
        (dealt, begin)
    };
    let chunks: Vec<_> = items.par_chunks(CHUNK).enumerate().map(deal).collect();

    // The items that are not the first, with the first.
    let find = |shard: usize| -> Vec<[u32; 2]> {
        let mut seen: HashTable<(K, u32)> = HashTable::new();
        let mut repeated = Vec::new();
        for (dealt, begin) in &chunks {
            for &(key, item) in &dealt[begin[shard]..begin[shard + 1]] {
                match seen.entry(hash(&key), |other| other.0 == key, |other| hash(&other.0)) {
                    Entry::Occupied(entry) => repeated.push([item, entry.get().1]),
                    Entry::Vacant(entry) => drop(entry.insert((key, item))),
                }
            }
        }
        repeated
    };
    let repeated: Vec<_> = (0..shards).into_par_iter().map(find).collect();
    let mut first: Vec<u32> = (0..items.len() as u32).collect();
    repeated.iter().flatten().for_each(|&[item, earlier]| first[item as usize] = earlier);
    first
}

/// Returns a hash of three words: the halves of each product with an odd constant, folded.
/// Positions of models are f64 with many zero bits at the end, which the fold spreads over the
/// whole word.
pub(super) fn hash(words: [u64; 3]) -> u64 {
    /// 2^64 divided by the golden ratio: odd, and no pattern in its bits.
    const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
    words.into_iter().fold(FACTOR, |hash, word| {
        let product = u128::from(hash ^ word) * u128::from(FACTOR);
        (product as u64) ^ ((product >> 64) as u64).rotate_left(29)
    })
}
