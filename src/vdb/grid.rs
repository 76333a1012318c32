//! The two grids of a band, held by OpenVDB.

use super::VdbError;
use super::bridge::ffi;
use super::leaves::{check_block, check_lengths, flat, level_set_fault, nodes};
use crate::lattice::{Ijk, LEAF_DIM, Lattice, LeafMask};
use crate::run::RunSettings;
use cxx::UniquePtr;

/// The name of the grid of closest triangles. After `surface` in the alphabet: OpenVDB lists the
/// grids of a file by their names, whatever their order in it, and many programs take the first
/// one.
pub(super) const CLOSEST: &str = "surface_closest";

/// Creator of a grid, as other programs show it.
pub(super) const CREATOR: &str = concat!("exocarp ", env!("CARGO_PKG_VERSION"));

/// OpenVDB refuses scales whose cube is below 3e-15.
const SMALLEST_VOXEL: f64 = 1.5e-5;

/// phi around the offset surface, as a level set (see [`vdb`](super)).
pub struct SurfaceGrid {
    pub(super) grid: UniquePtr<ffi::FloatGrid>,
    lattice: Lattice,
    translation: [f64; 3],
    background: f32,
    /// Known exactly where the grid was made here, background / h where it was read.
    half_width: f64,
}

/// Ids of the closest triangles of the nodes of a [`SurfaceGrid`], -1 elsewhere: an `Int32Grid`
/// named `surface_closest`, which comes after `surface` in lists of a file's grids.
pub struct ClosestGrid {
    pub(super) grid: UniquePtr<ffi::Int32Grid>,
}

/// The narrow band around an offset surface.
pub struct Band {
    /// The level set.
    pub surface: SurfaceGrid,
    /// The closest triangles, leaf by leaf those of the surface, where they were asked for. A file
    /// from another program has none.
    pub closest: Option<ClosestGrid>,
}

impl Band {
    /// Returns the memory of all grids, in bytes.
    pub fn memory(&self) -> u64 {
        self.surface.memory() + self.closest.as_ref().map_or(0, ClosestGrid::memory)
    }
}

impl SurfaceGrid {
    /// An empty level set: everything outside.
    ///
    /// `half_width` is in voxels; other programs expect 3 or more, contouring needs 1.
    ///
    /// OpenVDB has no transforms for voxels below 1.5e-5 model units. Such a grid can be used in
    /// memory, and neither checked nor written.
    ///
    /// # Errors
    /// If the voxel size is not positive, the half width less than 1, or their product no normal
    /// f32.
    pub fn new(lattice: Lattice, half_width: f64) -> Result<Self, VdbError> {
        let voxel = lattice.voxel;
        let wrong = |reason| Err(VdbError::Size { voxel, half_width, reason });
        // Written so that NaN fails.
        if !(voxel > 0.0 && voxel.is_finite()) {
            return wrong("the voxel size must be positive");
        }
        if !(half_width >= 1.0 && half_width.is_finite()) {
            return wrong("the half width must be at least 1");
        }
        let background = lattice.background(half_width);
        if !background.is_normal() {
            return wrong("the background value is beyond the range of 32-bit floats");
        }
        let grid = ffi::new_float_grid(transform_scale(voxel), background, CREATOR)?;
        Ok(SurfaceGrid { grid, lattice, translation: [0.0; 3], background, half_width })
    }

    /// A grid from a file; voxel size and translation are in model units.
    pub(super) fn opened(grid: UniquePtr<ffi::FloatGrid>, voxel: f64, translation: [f64; 3]) -> Self {
        let background = grid.background();
        let half_width = f64::from(background) / voxel;
        SurfaceGrid { grid, lattice: Lattice { voxel }, translation, background, half_width }
    }

    /// The lattice of the grid's nodes.
    pub fn lattice(&self) -> Lattice {
        self.lattice
    }

    /// World position of node (0, 0, 0): the origin, unless another program placed the grid
    /// elsewhere. To be added to what [`Lattice::world_from_index`] returns.
    pub fn translation(&self) -> [f64; 3] {
        self.translation
    }

    /// The value far outside, in model units; far inside it is the negative of that. Values are to
    /// be clamped to exactly this number.
    pub fn background(&self) -> f32 {
        self.background
    }

    /// The half width of the band in voxels.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Adds leaves: 512 values each in model units, and the mask of active nodes. A leaf that
    /// exists at an origin is replaced.
    ///
    /// # Errors
    /// If the lengths do not fit each other, or an origin is not that of a leaf.
    ///
    /// # Panics
    /// With debug assertions, if the values are not those of a level set (see [`vdb`](super)).
    pub fn insert_leaves(
        &mut self,
        origins: &[Ijk],
        values: &[f32],
        active: &[LeafMask],
    ) -> Result<(), VdbError> {
        check_lengths(origins.len(), values.len(), active.len())?;
        origins.iter().try_for_each(|&o| check_block(o, LEAF_DIM as u32))?;
        if cfg!(debug_assertions) {
            let fault = level_set_fault(origins, values, active, self.background);
            assert_eq!(fault, None, "a leaf breaks the level set");
        }
        Ok(self.grid.pin_mut().insert(&flat(origins), values, active.as_flattened())?)
    }

    /// Makes cubes of nodes inside: inactive tiles of value -background, whatever was there before.
    /// Each cube is given by its lowest node and its side, both multiples of 8.
    ///
    /// Tiles of 8, 128 and 4096 nodes are used as they fit, and no leaf is made. Leaves in a cube
    /// are dropped.
    ///
    /// # Errors
    /// If the lengths differ, or a cube is not made of whole leaves.
    pub fn fill_inside(&mut self, origins: &[Ijk], sides: &[u32]) -> Result<(), VdbError> {
        let count = origins.len();
        if sides.len() != count {
            return Err(VdbError::Length { count, what: "sides", expected: count, found: sides.len() });
        }
        origins.iter().zip(sides).try_for_each(|(&o, &s)| check_block(o, s))?;
        Ok(self.grid.pin_mut().fill(&flat(origins), sides, -self.background)?)
    }

    /// Merges tiles of the same value into larger ones, and drops those of the background. Leaves
    /// stay.
    pub fn prune(&mut self) {
        in_memory(self.grid.pin_mut().prune());
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        in_memory(self.grid.leaf_count())
    }

    /// Number of active voxels.
    pub fn active_voxels(&self) -> u64 {
        in_memory(self.grid.counts()).active_voxels
    }

    /// Bytes of the tree in memory.
    pub fn memory(&self) -> u64 {
        in_memory(self.grid.counts()).memory
    }

    /// Origins of the leaves in the order of the tree, which depends on the set of leaves only.
    pub fn leaf_origins(&self) -> Vec<Ijk> {
        nodes(&in_memory(self.grid.leaf_origins()))
    }

    /// Copies leaves out, as many as there are masks, starting with leaf `first` in the order of
    /// [`leaf_origins`](Self::leaf_origins). May be called from several threads at once.
    ///
    /// # Errors
    /// If the lengths do not fit each other, or there are not so many leaves.
    pub fn read_leaves(
        &self,
        first: usize,
        values: &mut [f32],
        active: &mut [LeafMask],
    ) -> Result<(), VdbError> {
        check_lengths(active.len(), values.len(), active.len())?;
        check_range(first, active.len(), self.leaf_count())?;
        Ok(self.grid.read(first, values, active.as_flattened_mut())?)
    }

    /// Whether each of `nodes` is inside (phi < 0), in leaves, tiles and the background alike.
    pub fn inside_at(&self, nodes: &[Ijk]) -> Vec<bool> {
        let mut inside = vec![false; nodes.len()];
        in_memory(self.grid.inside(&flat(nodes), &mut inside));
        inside
    }

    /// Returns the findings of OpenVDB's `tools::checkLevelSet`, one message for each of its nine
    /// tests that fails; empty if the level set is clean.
    ///
    /// ```text
    ///  1 value type  2 class  3 uniform transform  4 background at least 3 h  5 no active tiles
    ///  6 finite  7 active in [-background, background]  8 inactive exactly +-background
    ///  9 squared norm of the gradient (WENO5, Godunov) in [0.5, 1.5] at active nodes with a
    ///    neighbour of different sign
    /// ```
    ///
    /// A band of half width below 3 fails test 4 by intent, and a surface with creases fails 9
    /// where phi truly has no gradient.
    ///
    /// # Errors
    /// When the run is cancelled, between two tests, and if the voxel size is below 1.5e-5.
    pub fn check_level_set(&self, run: &RunSettings) -> Result<Vec<String>, VdbError> {
        const TESTS: u8 = 9;
        self.check_transform()?;
        let threads = i32::try_from(run.threads()).unwrap_or(1);
        let mut messages = Vec::new();
        for test in 1..=TESTS {
            run.check()?;
            let message = self.grid.check(test, threads)?;
            if !message.is_empty() {
                messages.push(format!("test {test}: {}", message.trim_end().replace('\n', "; ")));
            }
        }
        Ok(messages)
    }

    /// Fails if OpenVDB's transform is not that of the lattice.
    pub(super) fn check_transform(&self) -> Result<(), VdbError> {
        if self.lattice.voxel >= SMALLEST_VOXEL {
            return Ok(());
        }
        let reason = "OpenVDB needs a voxel size of at least 1.5e-5; scale the model up";
        Err(VdbError::Size { voxel: self.lattice.voxel, half_width: self.half_width, reason })
    }
}

impl ClosestGrid {
    /// An empty grid on `lattice`.
    ///
    /// # Errors
    /// If the voxel size is not positive.
    pub fn new(lattice: Lattice) -> Result<Self, VdbError> {
        let voxel = lattice.voxel;
        if !(voxel > 0.0 && voxel.is_finite()) {
            let reason = "the voxel size must be positive";
            return Err(VdbError::Size { voxel, half_width: 1.0, reason });
        }
        Ok(ClosestGrid { grid: ffi::new_int32_grid(transform_scale(voxel), CLOSEST, CREATOR)? })
    }

    /// Adds leaves: 512 triangle ids each, and the mask of active nodes. A leaf that exists at an
    /// origin is replaced.
    ///
    /// # Errors
    /// If the lengths do not fit each other, or an origin is not that of a leaf.
    pub fn insert_leaves(
        &mut self,
        origins: &[Ijk],
        ids: &[i32],
        active: &[LeafMask],
    ) -> Result<(), VdbError> {
        check_lengths(origins.len(), ids.len(), active.len())?;
        origins.iter().try_for_each(|&o| check_block(o, LEAF_DIM as u32))?;
        Ok(self.grid.pin_mut().insert(&flat(origins), ids, active.as_flattened())?)
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        in_memory(self.grid.leaf_count())
    }

    /// Bytes of the tree in memory.
    pub fn memory(&self) -> u64 {
        in_memory(self.grid.counts()).memory
    }

    /// Origins of the leaves in the order of the tree: that of the [`SurfaceGrid`] with the same
    /// leaves.
    pub fn leaf_origins(&self) -> Vec<Ijk> {
        nodes(&in_memory(self.grid.leaf_origins()))
    }

    /// Copies leaves out, as [`SurfaceGrid::read_leaves`] does.
    ///
    /// # Errors
    /// If the lengths do not fit each other, or there are not so many leaves.
    pub fn read_leaves(
        &self,
        first: usize,
        ids: &mut [i32],
        active: &mut [LeafMask],
    ) -> Result<(), VdbError> {
        check_lengths(active.len(), ids.len(), active.len())?;
        check_range(first, active.len(), self.leaf_count())?;
        Ok(self.grid.read(first, ids, active.as_flattened_mut())?)
    }
}

impl std::fmt::Debug for SurfaceGrid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SurfaceGrid")
            .field("voxel", &self.lattice.voxel)
            .field("background", &self.background)
            .field("leaves", &self.leaf_count())
            .finish()
    }
}

impl std::fmt::Debug for ClosestGrid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ClosestGrid").field("leaves", &self.leaf_count()).finish()
    }
}

impl std::fmt::Debug for Band {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Band").field("surface", &self.surface).field("closest", &self.closest).finish()
    }
}

/// The scale of the grid's transform: 1 for voxels that OpenVDB cannot place.
fn transform_scale(voxel: f64) -> f64 {
    if voxel < SMALLEST_VOXEL { 1.0 } else { voxel }
}

/// The result of a call that walks the tree: it fails only where memory runs out, and Rust's own
/// allocations would end the program as well.
fn in_memory<T>(result: Result<T, cxx::Exception>) -> T {
    result.unwrap_or_else(|e| panic!("OpenVDB failed in memory: {e}"))
}

fn check_range(first: usize, count: usize, leaves: usize) -> Result<(), VdbError> {
    match first.checked_add(count) {
        Some(end) if end <= leaves => Ok(()),
        end => Err(VdbError::Range { first, end: end.unwrap_or(usize::MAX), leaves }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_background_is_never_below_the_half_width() {
        for n in 1..10_000 {
            let voxel = 1.0 / f64::from(n);
            for half_width in [1.0, 1.5, 3.0, 4.0] {
                check_background(voxel, half_width);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn nor_is_it_at_any_voxel_size(voxel in voxels(-40..40), half_width in 1.0..20.0f64) {
            check_background(voxel, 3.0);
            check_background(voxel, half_width);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn no_voxel_size_fails_the_test_of_the_background(voxel in voxels(-15..40)) {
            let run = RunSettings::with_threads(1).unwrap();
            let grid = SurfaceGrid::new(Lattice { voxel }, 3.0).unwrap();
            prop_assert_eq!(grid.check_level_set(&run).unwrap(), [""; 0]);
        }
    }

    /// Voxel sizes of all magnitudes: those that an f32 holds, and those between two of them.
    fn voxels(exponents: std::ops::Range<i32>) -> impl Strategy<Value = f64> {
        (1.0..2.0f64, exponents, any::<bool>()).prop_map(|(mantissa, exponent, single)| {
            let voxel = mantissa * 2f64.powi(exponent);
            if single { f64::from(voxel as f32) } else { voxel }
        })
    }

    /// The background counts at least `half_width` voxels, however that is computed, and hardly
    /// more.
    fn check_background(voxel: f64, half_width: f64) {
        let background = Lattice { voxel }.background(half_width);
        let what = format!("{voxel:e} {half_width}");
        // As checkLevelSet computes it, and so that a voxel size that went through a product or two
        // does no harm.
        assert!(f64::from(background) / voxel >= half_width * (1.0 + 1e-15), "{what}");
        let (single, voxel_f32) = (half_width as f32, voxel as f32);
        assert!(background / voxel_f32 >= single, "{what}");
        assert!(background >= single * voxel_f32, "{what}");
        assert!(background >= (half_width * voxel) as f32, "{what}");
        assert!(f64::from(background) < half_width * voxel * (1.0 + 5e-7), "{what}");
    }

    #[test]
    fn sizes_that_cannot_be_stored_are_refused() {
        for (voxel, half_width) in
            [(0.0, 3.0), (-1.0, 3.0), (f64::NAN, 3.0), (1.0, 0.5), (1.0, f64::NAN), (1e-40, 3.0), (1e38, 9.0)]
        {
            let error = SurfaceGrid::new(Lattice { voxel }, half_width).unwrap_err();
            assert!(matches!(error, VdbError::Size { .. }), "{error}");
        }
    }

    #[test]
    fn leaves_and_blocks_are_checked_before_they_cross() {
        let mut grid = SurfaceGrid::new(Lattice { voxel: 1.0 }, 3.0).unwrap();
        let (origin, values, mask) = (Ijk::new(8, 0, -8), vec![3.0; 512], [0; 8]);
        let length = grid.insert_leaves(&[origin], &values[1..], &[mask]).unwrap_err();
        assert_eq!(length.to_string(), "1 leaves or blocks were given with 511 values instead of 512");
        for (origin, side) in
            [(Ijk::new(1, 0, 0), 8), (origin, 12), (origin, 0), (Ijk::new(i32::MAX & !7, 0, 0), 8)]
        {
            assert!(matches!(grid.fill_inside(&[origin], &[side]), Err(VdbError::Block { .. })));
        }
        let far = grid.insert_leaves(&[Ijk::new(4, 0, 0)], &values, &[mask]).unwrap_err();
        assert!(matches!(far, VdbError::Block { .. }));
        let none = grid.read_leaves(usize::MAX, &mut vec![0.0; 512], &mut [mask]).unwrap_err();
        assert!(matches!(none, VdbError::Range { leaves: 0, .. }));
    }
}
