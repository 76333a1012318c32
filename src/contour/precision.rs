//! The precision of coordinates.

/// The coordinates that the contour is decided on, and must be written with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every coordinate is a 32-bit float: what files hold, or most readers of text.
    #[default]
    F32,
    /// 64-bit floats, for files that are written and read with those.
    F64,
}

impl Precision {
    /// The nearest coordinate of this precision.
    #[inline]
    pub fn round(self, x: f64) -> f64 {
        match self {
            Precision::F32 => f64::from(x as f32),
            Precision::F64 => x,
        }
    }

    /// The distance from |x| to the next larger coordinate; infinite or not a number when x is out of range.
    pub fn ulp(self, x: f64) -> f64 {
        match self {
            Precision::F32 => {
                let x = (x as f32).abs();
                f64::from(x.next_up()) - f64::from(x)
            }
            Precision::F64 => x.abs().next_up() - x.abs(),
        }
    }
}
