//! Lengths in the units that users give them in.

use std::fmt;
use std::str::FromStr;

/// The largest lattice index in size: a leaf or a bounding box beyond it must still fit into an
/// i32.
pub(crate) const MAX_LATTICE_INDEX: f64 = (1 << 30) as f64;

/// A length given by a user: `0.5` in model units, `2%` of a model's size.
///
/// ```
/// use exocarp::Length;
///
/// assert_eq!("-0.5".parse(), Ok(Length::Units(-0.5)));
/// assert_eq!("2%".parse(), Ok(Length::DiagonalFraction(0.02)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Length {
    /// A length in model units.
    Units(f64),
    /// A fraction of the diagonal of the input's bounding box: 0.02 is two percent.
    DiagonalFraction(f64),
}

/// The fineness of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VoxelSize {
    /// The width h of a cell, in model units.
    Units(f64),
    /// The number N of voxels along the longest side of the result's bounding box:
    /// h = (longest side of the input's bounding box + 2 max(r, 0)) / N.
    Resolution(u32),
}

/// The largest distance allowed between a result and the true offset surface: `0.01` in model
/// units, `0.05h` in voxels.
///
/// ```
/// use exocarp::Tolerance;
///
/// assert_eq!("0.05h".parse(), Ok(Tolerance::Voxels(0.05)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tolerance {
    /// A distance in model units.
    Units(f64),
    /// A distance in voxels.
    Voxels(f64),
}

/// A text that is not the number or length it should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ParseQuantityError(pub(crate) String);

impl FromStr for Length {
    type Err = ParseQuantityError;

    fn from_str(text: &str) -> Result<Length, ParseQuantityError> {
        match text.strip_suffix('%') {
            Some(percent) => Ok(Length::DiagonalFraction(finite(percent)? / 100.0)),
            None => Ok(Length::Units(finite(text)?)),
        }
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Length::Units(length) => write!(f, "{length}"),
            Length::DiagonalFraction(fraction) => write!(f, "{}%", 100.0 * fraction),
        }
    }
}

impl FromStr for Tolerance {
    type Err = ParseQuantityError;

    fn from_str(text: &str) -> Result<Tolerance, ParseQuantityError> {
        let (number, unit): (_, fn(f64) -> Tolerance) = match text.strip_suffix('h') {
            Some(voxels) => (voxels, Tolerance::Voxels),
            None => (text, Tolerance::Units),
        };
        match finite(number)? {
            t if t > 0.0 => Ok(unit(t)),
            _ => Err(ParseQuantityError("a tolerance is positive".into())),
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Tolerance::Units(length) => write!(f, "{length}"),
            Tolerance::Voxels(voxels) => write!(f, "{voxels}h"),
        }
    }
}

fn finite(text: &str) -> Result<f64, ParseQuantityError> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(ParseQuantityError("the number is not finite".into())),
        Err(_) => Err(ParseQuantityError("this is not a number, nor one with % behind it".into())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_units_or_percent_of_the_diagonal() {
        assert_eq!("-0.5".parse(), Ok(Length::Units(-0.5)));
        assert_eq!("-1e-3".parse(), Ok(Length::Units(-1e-3)));
        assert_eq!("2%".parse(), Ok(Length::DiagonalFraction(0.02)));
        assert_eq!("-2%".parse(), Ok(Length::DiagonalFraction(-0.02)));
        for wrong in ["", "%", "two", "nan", "inf%", "1e999", "2%%", "2 mm"] {
            assert!(wrong.parse::<Length>().is_err(), "{wrong}");
        }
        for text in ["0.5", "-3", "25%"] {
            assert_eq!(text.parse::<Length>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn tolerances_are_units_or_voxels() {
        assert_eq!("0.25".parse(), Ok(Tolerance::Units(0.25)));
        assert_eq!("0.05h".parse(), Ok(Tolerance::Voxels(0.05)));
        for wrong in ["0", "-1h", "h", "1%", "nan", ""] {
            assert!(wrong.parse::<Tolerance>().is_err(), "{wrong}");
        }
        for text in ["0.5", "0.05h"] {
            assert_eq!(text.parse::<Tolerance>().unwrap().to_string(), text);
        }
    }
}
