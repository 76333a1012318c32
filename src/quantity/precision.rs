//! The number type of coordinates.

/// The number type of a mesh's coordinates, in a result and in the files that hold it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Precision {
    /// Every coordinate is a 32-bit float. All programs read such files, and most readers of text
    /// round to 32 bits.
    #[default]
    F32,
    /// Every coordinate is a 64-bit float, for files that are written and read with those.
    F64,
}

impl Precision {
    /// Returns the nearest coordinate of this precision.
    #[inline]
    pub fn round(self, x: f64) -> f64 {
        match self {
            Precision::F32 => f64::from(x as f32),
            Precision::F64 => x,
        }
    }

    /// Returns the distance from |x| to the next larger coordinate; infinite or not a number when
    /// x is out of range.
    pub(crate) fn ulp(self, x: f64) -> f64 {
        match self {
            Precision::F32 => {
                let x = (x as f32).abs();
                f64::from(x.next_up()) - f64::from(x)
            }
            Precision::F64 => x.abs().next_up() - x.abs(),
        }
    }
}
