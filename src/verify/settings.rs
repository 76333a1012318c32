//! Settings of a verification.

use super::error::VerifyError;
use crate::quantity::Length;

/// Default seed; any would do.
pub const DEFAULT_SEED: u64 = 1;

/// Default number of area-uniform samples. The mean of an error is then known to about 0.3% of its
/// spread; ten times as many would take most of the time.
pub const DEFAULT_SAMPLES: usize = 200_000;

/// Maximum number of samples. They take about 90 bytes each, and the mean of an error is known to
/// 0.03% of its spread.
pub const MAX_SAMPLES: usize = 20_000_000;

/// Settings of [`verify`](super::verify).
#[derive(Clone, Debug, PartialEq)]
pub struct VerifySettings {
    /// Signed distance that OUTPUT is said to be at: positive grown, negative shrunk.
    pub distance: Length,
    /// Voxel size in model units, for errors in voxels. Without it the limits for creases follow
    /// from the mean size of OUTPUT's triangles.
    pub voxel: Option<f64>,
    /// Maximum error allowed, either way, in model units; `None` promises nothing about distances.
    pub tolerance: Option<f64>,
    /// Number of area-uniform samples on OUTPUT, and on INPUT for what is missing: 1 to
    /// [`MAX_SAMPLES`].
    pub samples: usize,
    /// Seed of the samples. Equal seeds give equal reports, for every number of threads.
    pub seed: u64,
    /// Angle in degrees, between 0 and 180, above which an edge of INPUT is sharp. Creases are
    /// traced from edges whose triangles' normals differ by more.
    pub crease_angle: f64,
    /// The kind of OUTPUT.
    pub subject: Subject,
}

/// The kind of OUTPUT.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Subject {
    /// The offset surface alone.
    #[default]
    Offset,
    /// A shell: INPUT's own surface and the offset surface, with the material between them.
    Shell {
        /// Wall thickness wanted, in model units; `None` for |D|.
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

/// Default crease angle in degrees: the usual limit between a crease and the facets of a curved
/// surface. Smaller, and coarse spheres are full of creases; larger, and chamfers lose theirs.
const DEFAULT_CREASE_ANGLE: f64 = 30.0;

impl VerifySettings {
    /// Checks the settings, as far as that needs no mesh.
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
        let in_range = (1..=MAX_SAMPLES).contains(&self.samples);
        check(in_range, "number of samples", "1 to 20 million", self.samples as f64)
    }
}
