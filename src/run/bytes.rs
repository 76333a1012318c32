//! Amounts of memory, as a person reads them.

use std::fmt;

/// An amount of memory in bytes. Shown with powers of 1024, in the unit that it was given in where
/// that can be told: `1G` is `1 GB`, `1500M` is `1500 MB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

/// Numbers above this are shown in the next larger unit, rounded: more digits than that are hard to
/// read.
const MOST: u64 = 10_000;

/// The units with their sizes in bytes, the largest first.
const UNITS: [(&str, u64); 5] =
    [("TB", 1 << 40), ("GB", 1 << 30), ("MB", 1 << 20), ("KB", 1 << 10), ("bytes", 1)];

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bytes(n) = *self;
        if n == 1 {
            return f.write_str("1 byte");
        }
        let fitting = || UNITS.into_iter().filter(|&(_, size)| n >= size);
        // Two decimals are what people type: `1.25G`.
        let is_exact =
            |&(_, size): &(&str, u64)| n / size < MOST && u128::from(n) * 100 % u128::from(size) == 0;
        let Some((unit, size)) = fitting().find(is_exact).or_else(|| fitting().next()) else {
            return write!(f, "{n} bytes");
        };
        let text = format!("{:.2}", n as f64 / size as f64);
        write!(f, "{} {unit}", text.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_said_in_the_unit_that_it_was_given_in() {
        for (given, said) in [
            (0, "0 bytes"),
            (1, "1 byte"),
            (1000, "1000 bytes"),
            (4 << 10, "4 KB"),
            (8 << 20, "8 MB"),
            (1500 << 20, "1500 MB"),
            (1 << 30, "1 GB"),
            (3 << 29, "1.5 GB"),
            (5 << 40, "5 TB"),
            // Of nobody's making: rounded.
            (1_234_567_890, "1.15 GB"),
            (202_375_168, "193 MB"),
            (202_380_001, "193 MB"),
            (u64::MAX, "16777216 TB"),
        ] {
            assert_eq!(Bytes(given).to_string(), said, "{given}");
        }
    }
}
