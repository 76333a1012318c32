//! The hierarchy's own order of triangles.

/// The place of a triangle in the hierarchy's own order, as opposed to its number in the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct TriangleSlot(pub(crate) u32);

impl TriangleSlot {
    /// Returns the slot as an index.
    #[inline(always)]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}
