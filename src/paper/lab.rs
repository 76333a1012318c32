//! Common parts of the tables: models, offsets, and the stages before contouring.

use super::PaperError;
use super::PaperSettings;
use super::models::{Model, PaperModel};
use crate::band::narrow_band::{self, NarrowBand};
use crate::band::{BandSettings, NearTriangles, SignField};
use crate::distance::SignedDistance;
use crate::edge::EdgeNumbers;
use crate::offset::{OffsetError, OffsetResult, OffsetSettings, offset};
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;

/// The settings and the run of a measurement.
pub(super) struct Lab<'a> {
    pub settings: &'a PaperSettings,
    pub run: &'a RunSettings,
}

/// A band as the solver takes it.
pub(super) struct Field {
    pub settings: BandSettings,
    pub signs: SignField,
    pub numbers: EdgeNumbers,
    pub near: NearTriangles,
}

impl Lab<'_> {
    /// Loads the stand-in for a model of the paper.
    pub fn model(&self, of: PaperModel) -> Result<Model, PaperError> {
        self.refined_model(of, 1)
    }

    /// Loads a model with the sides of its triangles divided by `cuts`.
    pub fn refined_model(&self, of: PaperModel, cuts: u32) -> Result<Model, PaperError> {
        Model::load(of, &self.settings.files, cuts, self.run)
    }

    /// The settings of an offset by a part of the diagonal.
    pub fn offset_settings(&self, model: &Model, fraction: f64, voxel: VoxelSize) -> OffsetSettings {
        OffsetSettings {
            distance: Length::DiagonalFraction(fraction),
            voxel,
            open_input: model.open_input,
            max_memory: self.settings.max_memory,
            ..OffsetSettings::default()
        }
    }

    /// The voxel size of a grid of `resolution` cells that is fitted to the model and its offset by
    /// `largest`, for tables whose rows share a grid: in the paper the intersected edges of the
    /// warrior grow from 85,032 at 0.02 to 463,838 at 0.32, and on a grid fitted to each offset
    /// they would hardly change.
    pub fn shared_grid(&self, model: &Model, largest: f64, resolution: u32) -> Result<VoxelSize, PaperError> {
        let fitted = self.offset_settings(model, largest, VoxelSize::Resolution(resolution));
        Ok(VoxelSize::Units(fitted.in_model_units(&model.mesh)?.lattice.voxel))
    }

    /// The grid fitted to each offset.
    pub fn fitted_grid(&self) -> VoxelSize {
        VoxelSize::Resolution(self.settings.resolution)
    }

    /// Offsets a model; `None` when nothing is left.
    pub fn offset(
        &self,
        model: &Model,
        fraction: f64,
        voxel: VoxelSize,
    ) -> Result<Option<OffsetResult>, PaperError> {
        match offset(&model.mesh, &self.offset_settings(model, fraction, voxel), self.run) {
            Ok(result) => Ok(Some(result)),
            Err(OffsetError::Empty(_)) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// The distance field of a model.
    pub fn distance<'m>(&self, model: &'m Model) -> SignedDistance<'m> {
        self.run.install(|| SignedDistance::new(&model.mesh, &model.topology))
    }

    /// The stages up to the numbered edges; `None` when no edge is intersected.
    pub fn field(
        &self,
        model: &Model,
        distance: &SignedDistance,
        fraction: f64,
        voxel: VoxelSize,
    ) -> Result<Option<Field>, PaperError> {
        let settings = self.offset_settings(model, fraction, voxel).in_model_units(&model.mesh)?;
        let NarrowBand { signs, near, .. } =
            narrow_band::build::<PaperError>(distance, &settings, None, self.run)?;
        let numbers = self.run.install(|| EdgeNumbers::new(&signs))?;
        Ok((!numbers.is_empty()).then_some(Field { settings, signs, numbers, near }))
    }

    /// Returns the conditions of the run, for the foot of a table.
    pub fn conditions(&self) -> String {
        let nodes = u64::from(self.settings.resolution) + 1;
        let threads = self.run.threads();
        let coarser = if self.settings.resolution == super::PUBLISHED_RESOLUTION {
            "as published"
        } else {
            "not the published 513^3: hold no counts against it"
        };
        format!("here: {nodes} nodes along the longest side ({coarser}), {threads} threads")
    }
}

/// The note on the published times.
pub(super) const PUBLISHED_MACHINE: &str =
    "paper: 513^3 nodes, two Intel Xeon E5440 at 2.83 GHz (2007), eight cores";
