//! The program `exocarp`.

fn main() {}
