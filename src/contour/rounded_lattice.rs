//! The lattice as it is written: node planes and vertices rounded to the output's precision.
//!
//! They are rounded *before* anything is decided on them. Rounding afterwards would void every
//! decision.

use crate::lattice::{Ijk, Lattice, LatticeError};
use crate::quantity::Precision;
use glam::DVec3;

/// The distance that vertices keep from the walls of their cell, in voxels, as long as rounding
/// allows.
///
/// Smaller values let triangles degenerate to needles of that width. Larger ones blunt features
/// that lie close to a cell's wall by up to as much.
const MARGIN: f64 = 1e-3;

/// The largest margin, in voxels.
///
/// Beyond it a cell has fewer than 16 representable coordinates along an axis, vertices are
/// displaced visibly, and the midpoint of a sheet is no longer sure to lie within its walls after
/// rounding.
const MAX_MARGIN: f64 = 0.125;

/// The lattice with rounded node planes.
#[derive(Clone, Copy, Debug)]
pub struct RoundedLattice {
    lattice: Lattice,
    precision: Precision,
    margin: f64,
}

impl RoundedLattice {
    /// Makes the rounded lattice for cells whose corners have indices of at most `extent` in size.
    ///
    /// # Errors
    /// When the coordinates there are too coarse for the voxel size.
    pub fn new(lattice: Lattice, precision: Precision, extent: u32) -> Result<RoundedLattice, LatticeError> {
        let far = lattice.voxel * f64::from(extent);
        // Two units in the last place: node planes and vertices are off by up to half a unit each.
        // Half a unit in all is the limit below which lattices fail.
        let least = 2.0 * precision.ulp(far) / lattice.voxel;
        // False for what is not a number, too.
        if least <= MAX_MARGIN && lattice.voxel > 0.0 {
            Ok(RoundedLattice { lattice, precision, margin: MARGIN.max(least) })
        } else {
            Err(LatticeError::CoarseCoordinates { far, voxel: lattice.voxel, precision })
        }
    }

    /// Returns the voxel size in model units.
    #[inline]
    pub fn voxel(&self) -> f64 {
        self.lattice.voxel
    }

    /// Returns the least distance of a vertex from its cell's walls, in voxels.
    #[inline]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// Returns the rounded coordinate of node plane `i`.
    #[inline]
    pub fn plane(&self, i: i32) -> f64 {
        self.precision.round(self.lattice.plane(i))
    }

    /// Returns the rounded position of a node.
    #[inline]
    pub fn node(&self, ijk: Ijk) -> [f64; 3] {
        ijk.0.map(|i| self.plane(i))
    }

    /// Returns the rounded world position of the point `local` of a cell, in voxels from its lowest
    /// corner on the lattice before rounding.
    #[inline]
    pub fn round_in_cell(&self, cell: Ijk, local: DVec3) -> [f64; 3] {
        self.round(self.unrounded(cell, local))
    }

    /// Returns the world position of the point `local` of a cell, in voxels from its lowest corner,
    /// unrounded.
    #[inline]
    pub fn unrounded(&self, cell: Ijk, local: DVec3) -> DVec3 {
        self.voxel() * (DVec3::from(cell.0.map(f64::from)) + local)
    }

    /// Returns the rounded world position of the point of a cell whose coordinates between its
    /// rounded walls are `local`, 0 to 1 each.
    #[inline]
    pub fn between_walls(&self, cell: Ijk, local: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let (low, high) = (self.plane(cell.0[a]), self.plane(cell.0[a] + 1));
            if local[a] == 1.0 { high } else { self.precision.round(low + local[a] * (high - low)) }
        })
    }

    /// Inverts [`between_walls`](Self::between_walls), exact to a few units in the last place of
    /// the *result*, however far from the origin the cell is.
    #[inline]
    pub fn local(&self, cell: Ijk, position: [f64; 3]) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|a| {
            let (low, high) = (self.plane(cell.0[a]), self.plane(cell.0[a] + 1));
            (position[a] - low) / (high - low)
        }))
    }

    /// Rounds a world position.
    #[inline]
    pub fn round(&self, position: DVec3) -> [f64; 3] {
        position.to_array().map(|x| self.precision.round(x))
    }

    /// Returns a position along an edge, in voxels, kept the margin away from the ends. What is not
    /// a number becomes the lower end.
    #[inline]
    pub fn clamp_to_edge(&self, t: f64) -> f64 {
        if t >= self.margin { t.min(1.0 - self.margin) } else { self.margin }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_grow_with_the_distance() {
        let lattice = Lattice { voxel: 0.1 };
        assert_eq!(RoundedLattice::new(lattice, Precision::F32, 100).unwrap().margin(), MARGIN);
        let far = RoundedLattice::new(lattice, Precision::F32, 600_000).unwrap();
        assert!(far.margin() > 0.05 && far.margin() < MAX_MARGIN);
        assert!(RoundedLattice::new(lattice, Precision::F32, 1_000_000).is_err());
        assert_eq!(RoundedLattice::new(lattice, Precision::F64, 10_000_000).unwrap().margin(), MARGIN);
        for voxel in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-60, 1e60] {
            assert!(RoundedLattice::new(Lattice { voxel }, Precision::F32, 10).is_err(), "{voxel}");
        }
    }

    #[test]
    fn local_coordinates_go_back_and_forth() {
        let lattice = RoundedLattice::new(Lattice { voxel: 0.1 }, Precision::F32, 20_000).unwrap();
        let cell = Ijk::new(20_000 - 1, -7, 0);
        let local = lattice.local(cell, lattice.between_walls(cell, [0.0, 1.0, 0.5]));
        assert_eq!((local.x, local.y), (0.0, 1.0));
        assert!((local.z - 0.5).abs() < 1e-6);
    }
}
