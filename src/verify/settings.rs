//! Settings of a verification.

use super::error::VerifyError;
use crate::quantity::Length;

/// The seed when none is given; any would do.
pub const DEFAULT_SEED: u64 = 1;

/// Area-uniform samples when no number is given: the mean of an error is then known to about 0.3%
/// of its spread. Ten times as many would take most of the time.
pub const DEFAULT_SAMPLES: usize = 200_000;

/// The most samples: they take about 90 bytes each, and the mean of an error is known to 0.03% of
/// its spread.
pub const MOST_SAMPLES: usize = 20_000_000;

/// Settings that OUTPUT is judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifySettings {
    /// The signed distance that OUTPUT is said to be at: positive grown, negative shrunk.
    pub distance: Length,
    /// Voxel size in model units, for errors in voxels. Without it the limits for creases are taken
    /// from the mean size of OUTPUT's triangles.
    pub voxel: Option<f64>,
    /// The largest error allowed in model units, either way; `None` promises nothing about
    /// distances.
    pub tolerance: Option<f64>,
    /// Area-uniform samples on OUTPUT, and on INPUT for what is missing: 1 to [`MOST_SAMPLES`].
    pub samples: usize,
    /// Seed of the samples. The same seed gives the same report, for every number of threads.
    pub seed: u64,
    /// Creases are traced from edges of INPUT whose triangles' normals differ by more than this, in
    /// degrees.
    pub crease_angle: f64,
    /// Kind of OUTPUT.
    pub subject: Subject,
}

/// Kind of a mesh that is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Subject {
    /// The offset surface alone.
    #[default]
    Offset,
    /// A shell: INPUT's own surface and the offset surface, with the material between them.
    Shell {
        /// The wall thickness wanted, in model units; `None` for |D|.
        thickness: Option<f64>,
    },
}

impl Default for VerifySettings {
    fn default() -> Self {
        VerifySettings {
            distance: Length::DiagonalFraction(0.02),
            voxel: None,
            tolerance: None,
            samples: DEFAULT_SAMPLES,
            seed: DEFAULT_SEED,
            crease_angle: DEFAULT_CREASE_ANGLE,
            subject: Subject::default(),
        }
    }
}

/// The usual limit between a crease and a curved surface's facets. Smaller, and coarse spheres are
/// full of creases; larger, and chamfers lose theirs.
const DEFAULT_CREASE_ANGLE: f64 = 30.0;

impl VerifySettings {
    /// Checks everything that does not need the meshes.
    ///
    /// # Errors
    /// [`VerifyError::Setting`]: the first setting out of range.
    pub fn validate(&self) -> Result<(), VerifyError> {
        let (Length::Units(distance) | Length::DiagonalFraction(distance)) = self.distance;
        let check = |ok: bool, name, range, value| match ok {
            true => Ok(()),
            false => Err(VerifyError::Setting { name, range, value }),
        };
        check(distance.is_finite(), "distance", "a finite number", distance)?;
        if let Some(h) = self.voxel {
            check(h > 0.0 && h.is_finite(), "voxel size", "a positive number", h)?;
        }
        if let Some(e) = self.tolerance {
            check(e >= 0.0 && e.is_finite(), "tolerance", "0 or a positive number", e)?;
        }
        if let Subject::Shell { thickness: Some(t) } = self.subject {
            check(t > 0.0 && t.is_finite(), "wall thickness", "a positive number", t)?;
        }
        let angle = self.crease_angle;
        check(angle > 0.0 && angle < 180.0, "crease angle", "between 0 and 180 degrees", angle)?;
        let in_range = (1..=MOST_SAMPLES).contains(&self.samples);
        check(in_range, "number of samples", "1 to 20 million", self.samples as f64)
    }
}
