//! Ranges of an array moved where they are, in large steps, and slices cut into parts.

use std::ops::Range;

/// Adds a range of a slice and its new start to the moves for [`shift_ranges`].
///
/// A range that goes on where the last one ends, before and after the move, is joined to it.
pub fn push_range(moves: &mut Vec<(Range<usize>, usize)>, range: Range<usize>, to: usize) {
    match moves.last_mut() {
        Some((last, at)) if last.end == range.start && *at + last.len() == to => last.end = range.end,
        _ => moves.push((range, to)),
    }
}

/// Moves ranges of a slice to their new starts. The ranges must be in order, before and after.
pub fn shift_ranges<T: Copy>(all: &mut [T], moves: &[(Range<usize>, usize)]) {
    // Ranges that go down are moved from the first one on, ranges that go up from the last one on.
    // None lands on one that still waits, since the order stays.
    for (range, to) in moves.iter().filter(|(range, to)| *to < range.start) {
        all.copy_within(range.clone(), *to);
    }
    for (range, to) in moves.iter().rev().filter(|(range, to)| *to > range.start) {
        all.copy_within(range.clone(), *to);
    }
}

/// Cuts a slice into consecutive parts of the given lengths.
pub fn split_slices<T>(mut slice: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    lengths
        .map(|length| {
            let (part, rest) = std::mem::take(&mut slice).split_at_mut(length);
            slice = rest;
            part
        })
        .collect()
}
