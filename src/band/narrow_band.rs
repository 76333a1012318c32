//! The band as the edges and the contour need it, in plain arrays, and its copy in a store.

use super::{
    BOXES_PER_BATCH, BandSettings, InsideBlocks, LeafBatch, LoneNodes, NearTriangles, NodeTriangles,
    PartTriangles, SignField, build_map, join_lone_nodes, leaves_at_jumps,
};
use crate::candidates::{BlockLists, CandidateLists};
use crate::distance::SignedDistance;
use crate::filter::FilterStatistics;
use crate::lattice::{Ijk, LeafMask, Slab};
use crate::run::{Cancelled, RunSettings};

/// The part of a batch of leaves that a store keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StoredPart {
    /// Nothing.
    Nothing,
    /// The level set.
    #[cfg(feature = "openvdb")]
    LevelSet,
    /// The level set and the closest triangles.
    #[cfg(feature = "openvdb")]
    WithClosest,
}

impl StoredPart {
    /// Copies the stored part of a batch.
    #[cfg(feature = "openvdb")]
    fn of(self, batch: &LeafBatch) -> Option<LeafBatch> {
        match self {
            StoredPart::Nothing => None,
            StoredPart::LevelSet => Some(batch.level_set()),
            StoredPart::WithClosest => {
                Some(LeafBatch { closest: batch.closest.clone(), ..batch.level_set() })
            }
        }
    }

    /// Copies nothing.
    #[cfg(not(feature = "openvdb"))]
    fn of(self, _: &LeafBatch) -> Option<LeafBatch> {
        None
    }
}

/// A store for the leaves of a band outside of its own arrays, as an OpenVDB tree.
pub(crate) trait BandStore<E> {
    /// Returns the part of each batch that the store keeps.
    fn stored_part(&self) -> StoredPart;

    /// Adds the leaves and the inside blocks of `batch` that `slab` owns.
    ///
    /// # Errors
    /// Whatever keeps the store from taking them.
    fn insert(&mut self, batch: &LeafBatch, slab: Slab) -> Result<(), E>;
}

/// The band around the offset surface.
pub(crate) struct NarrowBand {
    /// Signs of the nodes.
    pub(crate) signs: SignField,
    /// Closest triangles of the nodes, and the triangles near the edges.
    pub(crate) near: NearTriangles,
    /// Work and size of the band.
    pub(crate) counts: BandCounts,
}

/// The work of the filters, and the size of what the slab owns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BandCounts {
    /// Work of the filters.
    pub(crate) filter: FilterStatistics,
    /// Number of active nodes that the slab owns.
    pub(crate) active_voxels: u64,
    /// Number of leaves that the slab owns.
    pub(crate) leaves: u64,
    /// Lone nodes, of a band that is contoured.
    pub(crate) lone_nodes: LoneNodes,
}

/// The use of the leaves once they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BandUse {
    /// Edges and a contour.
    Contour,
    /// Nothing: they are only stored.
    #[cfg(feature = "openvdb")]
    Nothing,
}

/// Builds the band, and adds what the slab owns to `store`.
pub(crate) fn build<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    store: Option<&mut (dyn BandStore<E> + Send)>,
    run: &RunSettings,
) -> Result<NarrowBand, E> {
    let (builder, counts) = BandBuilder::collect(distance, settings, BandUse::Contour, store, run)?;
    run.install(|| {
        let ring = |nodes: &[Ijk]| Ok::<_, E>(builder.blocks.contain(nodes));
        let mut signs = SignField::new(&builder.origins, &builder.inside, settings.slab, ring)?;
        let BandSettings { lattice, r, slab, .. } = *settings;
        let lone_nodes = join_lone_nodes(&mut signs, distance, r, lattice, slab);
        let counts = BandCounts { lone_nodes, ..counts };
        let nodes = NodeTriangles::new(&signs, &builder.origins, builder.closest);
        let lists = CandidateLists::new(settings.lattice, builder.lists);
        Ok(NarrowBand { signs, near: NearTriangles { nodes, lists: Some(lists) }, counts })
    })
}

/// Builds the band into `store` only.
#[cfg(feature = "openvdb")]
pub(crate) fn store<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    store: &mut (dyn BandStore<E> + Send),
    run: &RunSettings,
) -> Result<BandCounts, E> {
    Ok(BandBuilder::collect(distance, settings, BandUse::Nothing, Some(store), run)?.1)
}

/// The data that are kept of a batch of leaves.
struct BatchSummary {
    origins: Vec<Ijk>,
    inside_blocks: Vec<(Ijk, i32)>,
    /// Number of leaves that the slab owns.
    owned_leaves: u64,
    /// Number of active nodes that the slab owns.
    owned_nodes: u64,
    /// For edges and a contour: the nodes that are inside, the closest triangles of the nodes, and
    /// the triangles near the edges.
    near: Option<(Vec<LeafMask>, PartTriangles, BlockLists)>,
    /// Leaves for the store.
    stored: Option<LeafBatch>,
}

impl BatchSummary {
    fn new(batch: &LeafBatch, slab: Slab, band_use: BandUse, part: StoredPart) -> BatchSummary {
        let own = batch.origins.iter().zip(&batch.active).filter(|leaf| slab.owns(*leaf.0));
        let [owned_leaves, owned_nodes] = own.fold([0; 2], |[leaves, nodes], (_, active)| {
            [leaves + 1, nodes + active.iter().map(|word| u64::from(word.count_ones())).sum::<u64>()]
        });
        let near = || (batch.inside.clone(), PartTriangles::new(&batch.closest), batch.lists.clone());
        BatchSummary {
            origins: batch.origins.clone(),
            inside_blocks: batch.inside_blocks.clone(),
            owned_leaves,
            owned_nodes,
            near: (band_use == BandUse::Contour).then(near),
            stored: part.of(batch),
        }
    }
}

/// Collects leaves as they come out of the filters.
#[derive(Default)]
struct BandBuilder {
    origins: Vec<Ijk>,
    inside: Vec<LeafMask>,
    closest: Vec<PartTriangles>,
    lists: Vec<(Vec<Ijk>, BlockLists)>,
    blocks: InsideBlocks,
}

impl BandBuilder {
    fn collect<E: From<Cancelled> + Send>(
        distance: &SignedDistance,
        settings: &BandSettings,
        band_use: BandUse,
        mut store: Option<&mut (dyn BandStore<E> + Send)>,
        run: &RunSettings,
    ) -> Result<(BandBuilder, BandCounts), E> {
        let slab = settings.slab;
        let mut builder = BandBuilder::default();
        let mut counts = BandCounts::default();
        let mut inside_blocks = Vec::new();
        let part = store.as_ref().map_or(StoredPart::Nothing, |store| store.stored_part());
        let summarize = |batch: &LeafBatch| BatchSummary::new(batch, slab, band_use, part);
        let mut take = |summary: BatchSummary, builder: &mut BandBuilder| -> Result<(), E> {
            if let (Some(store), Some(batch)) = (&mut store, &summary.stored) {
                store.insert(batch, slab)?;
            }
            counts.leaves += summary.owned_leaves;
            counts.active_voxels += summary.owned_nodes;
            builder.take(summary);
            Ok(())
        };
        // Leaves that are not stored need not be handed on in between.
        let boxes_in_flight = if part == StoredPart::Nothing { usize::MAX } else { BOXES_PER_BATCH };
        let filter = build_map(distance, settings, boxes_in_flight, run, summarize, |summary| {
            inside_blocks.extend_from_slice(&summary.inside_blocks);
            take(summary, &mut builder)
        })?;
        let jumps = run.install(|| {
            builder.blocks = InsideBlocks::new(&inside_blocks);
            let is_inside = |node| builder.blocks.contains(node);
            leaves_at_jumps(&builder.origins, &inside_blocks, settings, is_inside)
        });
        if !jumps.is_empty() {
            take(summarize(&jumps), &mut builder)?;
        }
        counts.filter = filter;
        Ok((builder, counts))
    }

    fn take(&mut self, summary: BatchSummary) {
        self.origins.extend_from_slice(&summary.origins);
        let Some((inside, closest, lists)) = summary.near else { return };
        self.inside.extend(inside);
        self.closest.push(closest);
        // Leaves that were added where the sign jumps have no lists: edges there ask the hierarchy.
        if !lists.is_empty() {
            self.lists.push((summary.origins, lists));
        }
    }
}
