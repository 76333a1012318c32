//! Parts of an array moved together or apart where they are, in large pieces.

use std::ops::Range;

/// Adds a range of a slice, and where it shall begin, to those that [`move_pieces`] shall move. What goes on where the last one
/// ends, before and after, is of one piece with it.
pub fn push_piece(moves: &mut Vec<(Range<usize>, usize)>, piece: Range<usize>, to: usize) {
    match moves.last_mut() {
        Some((last, at)) if last.end == piece.start && *at + last.len() == to => last.end = piece.end,
        _ => moves.push((piece, to)),
    }
}

/// Moves ranges of a slice to where they shall begin. They are in order, before and after.
pub fn move_pieces<T: Copy>(all: &mut [T], moves: &[(Range<usize>, usize)]) {
    // Those that go back from the first one on, those that go forth from the last one on: none lands on one that still
    // waits, since the order stays.
    for (piece, to) in moves.iter().filter(|(piece, to)| *to < piece.start) {
        all.copy_within(piece.clone(), *to);
    }
    for (piece, to) in moves.iter().rev().filter(|(piece, to)| *to > piece.start) {
        all.copy_within(piece.clone(), *to);
    }
}
