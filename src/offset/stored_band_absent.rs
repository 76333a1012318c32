//! Stands in for the stored band in a build without OpenVDB: nothing is stored.

use super::{OffsetError, OffsetSettings};
use crate::band::narrow_band::{BandStore, StoredPart};
use crate::band::{BandSettings, LeafBatch};
use crate::lattice::Slab;

impl StoredPart {
    /// Returns the part that is stored by these settings.
    pub(super) fn by(_: &OffsetSettings) -> StoredPart {
        StoredPart::Nothing
    }
}

/// A finished band, of which there is none.
#[derive(Debug)]
pub(crate) enum Band {}

impl Band {
    /// Returns the memory of the grids, in bytes.
    pub(crate) fn memory(&self) -> u64 {
        match *self {}
    }
}

/// A band that is being filled, of which there is none.
#[derive(Debug)]
pub(crate) enum StoredBand {}

impl StoredBand {
    /// Returns the empty band that the settings ask for.
    pub(crate) fn wanted(_: &BandSettings, _: &OffsetSettings) -> Result<Option<StoredBand>, OffsetError> {
        Ok(None)
    }

    /// Returns the finished band.
    pub(crate) fn finish(self) -> Band {
        match self {}
    }
}

impl<E> BandStore<E> for StoredBand {
    fn stored_part(&self) -> StoredPart {
        match *self {}
    }

    fn insert(&mut self, _: &LeafBatch, _: Slab) -> Result<(), E> {
        match *self {}
    }
}
