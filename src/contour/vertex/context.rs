//! The inputs of a contour, together.

use crate::band::{LeafId, SignField};
use crate::contour::cell::CellNumbers;
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::edge::Crossings;
use crate::lattice::Slab;

/// The inputs of a contour, and the numbers of its cells.
#[derive(Clone, Copy)]
pub struct CellContext<'a> {
    /// The signs of the nodes.
    pub signs: &'a SignField,
    /// The crossings of the grid edges.
    pub crossings: &'a Crossings,
    /// The rounded lattice.
    pub lattice: RoundedLattice,
    /// The part of the lattice whose cells are counted.
    pub slab: Slab,
    /// The numbers of the active cells.
    pub numbers: &'a CellNumbers,
    /// The surface, if there is one to sample.
    pub surface: Option<&'a dyn ImplicitSurface>,
}

impl CellContext<'_> {
    /// Whether a leaf is counted.
    pub fn owns(&self, leaf: LeafId) -> bool {
        self.slab.owns(self.signs.origin(leaf))
    }
}
