//! Statistics of an offset: the parts of the statistics file that the engine knows.

use super::stored_band::Band;
use crate::band::narrow_band::BandCounts;
use crate::band::{BandSettings, LoneNodes};
use crate::contour::ContourStatistics;
use crate::edge::EdgeStatistics;
use crate::filter::FilterStatistics;
use crate::subvoxel::MissedFeatures;

/// Counts and times of one offset.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct OffsetStatistics {
    /// The signed distance r in model units.
    pub distance: f64,
    /// The voxel size h in model units.
    pub voxel: f64,
    /// Seconds per stage.
    pub times: EngineTimes,
    /// Distance computations by filter (\[LW11\] Table IV).
    pub filter: FilterStatistics,
    /// Edge intersections by method (\[LW11\] Table V).
    pub edges: EdgeStatistics,
    /// Cells, polygons, vertices.
    pub contour: ContourStatistics,
    /// Nodes without a neighbour on their side of the surface.
    pub lone_nodes: LoneNodes,
    /// Features of the offset solid that the lattice is too coarse for.
    #[cfg_attr(feature = "serde", serde(rename = "unseen"))]
    pub missed: MissedFeatures,
    /// Slabs that were worked off one after the other.
    pub slabs: usize,
    /// Number of times that the voxel size was halved to see more.
    pub halvings: u32,
    /// The band's size.
    pub vdb: VdbStatistics,
}

impl OffsetStatistics {
    /// Of a lattice on which nothing happened yet. `times` is what was spent before.
    pub(super) fn new(settings: &BandSettings, times: EngineTimes) -> OffsetStatistics {
        OffsetStatistics { distance: settings.r, voxel: settings.lattice.voxel, times, ..Default::default() }
    }

    /// Adds what a slab owns of the band.
    pub(super) fn add_band(&mut self, counts: &BandCounts) {
        // The nodes are those of the whole grid, in every slab.
        let nodes_total = counts.filter.nodes_total;
        self.filter += FilterStatistics { nodes_total: 0, ..counts.filter };
        self.filter.nodes_total = nodes_total;
        self.vdb.active_voxels += counts.active_voxels;
        self.vdb.leaves += counts.leaves;
        self.lone_nodes += counts.lone_nodes;
    }

    /// The memory of the band, where it is kept.
    pub(super) fn set_memory(&mut self, band: Option<&Band>) {
        self.vdb.memory = band.map_or(0, Band::memory);
    }
}

/// Seconds per stage of the engine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EngineTimes {
    /// Building the hierarchy.
    pub hierarchy: f64,
    /// Filters and band.
    pub band: f64,
    /// Edge intersections.
    pub edges: f64,
    /// Contouring.
    pub contour: f64,
}

impl EngineTimes {
    /// The engine's time, the one that comparisons use.
    pub fn total(&self) -> f64 {
        self.hierarchy + self.band + self.edges + self.contour
    }
}

/// The size of the band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VdbStatistics {
    /// Active voxels of the grid `surface`.
    pub active_voxels: u64,
    /// Number of leaves of the band.
    pub leaves: u64,
    /// Bytes in memory, of both grids where there are two; 0 where the band is not kept.
    pub memory: u64,
}
