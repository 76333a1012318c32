//! The band as the edges and the contour need it, in plain arrays; and into a store, where it is to be kept.

use super::{
    BOXES_PER_BATCH, BandSettings, InsideBlocks, LeafBatch, LoneNodes, NearTriangles, NodeTriangles,
    PartTriangles, SignField, build_kept, join_lone_nodes, leaves_at_jumps,
};
use crate::candidates::{BlockLists, CandidateLists};
use crate::distance::SignedDistance;
use crate::filter::FilterStatistics;
use crate::lattice::{Ijk, LeafMask, Slab};
use crate::run::{Cancelled, RunSettings};

/// What a store keeps of a batch of leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StoredPart {
    /// Nothing.
    Nothing,
    /// The level set.
    LevelSet,
    /// The level set and the closest triangles.
    WithClosest,
}

impl StoredPart {
    /// Copies what is stored of a batch.
    fn of(self, batch: &LeafBatch) -> Option<LeafBatch> {
        match self {
            StoredPart::Nothing => None,
            StoredPart::LevelSet => Some(batch.level_set()),
            StoredPart::WithClosest => {
                Some(LeafBatch { closest: batch.closest.clone(), ..batch.level_set() })
            }
        }
    }
}

/// A place outside of the band's own arrays where its leaves are kept, as an OpenVDB tree.
pub(crate) trait BandStore<E> {
    /// What the store keeps of each batch.
    fn stored_part(&self) -> StoredPart;

    /// Adds the leaves and the inside blocks of `batch` that `slab` owns.
    ///
    /// # Errors
    /// Whatever keeps the store from taking them.
    fn insert(&mut self, batch: &LeafBatch, slab: Slab) -> Result<(), E>;
}

/// The band around the offset surface.
pub(crate) struct NarrowBand {
    /// Which nodes are inside.
    pub(crate) signs: SignField,
    /// The closest triangles of its nodes, and those near its edges.
    pub(crate) near: NearTriangles,
    /// What making it took.
    pub(crate) counts: BandCounts,
}

/// The work of the filters, and the size of what the slab owns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BandCounts {
    pub(crate) filter: FilterStatistics,
    pub(crate) active_voxels: u64,
    pub(crate) leaves: u64,
    /// Of a band that is contoured.
    pub(crate) lone_nodes: LoneNodes,
}

/// What is asked of the leaves once they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// Edges and a contour.
    Contour,
    /// Nothing: they are only stored.
    Nothing,
}

/// Builds the band, and adds what the slab owns to `store`.
pub(crate) fn build<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    store: Option<&mut (dyn BandStore<E> + Send)>,
    run: &RunSettings,
) -> Result<NarrowBand, E> {
    let (parts, counts) = Parts::collect(distance, settings, Next::Contour, store, run)?;
    run.install(|| {
        let ring = |nodes: &[Ijk]| Ok::<_, E>(parts.blocks.contain(nodes));
        let mut signs = SignField::new(&parts.origins, &parts.inside, settings.slab, ring)?;
        let BandSettings { lattice, r, slab, .. } = *settings;
        let lone_nodes = join_lone_nodes(&mut signs, distance, r, lattice, slab);
        let counts = BandCounts { lone_nodes, ..counts };
        let nodes = NodeTriangles::new(&signs, &parts.origins, parts.closest);
        let lists = CandidateLists::new(settings.lattice, parts.lists);
        Ok(NarrowBand { signs, near: NearTriangles { nodes, lists: Some(lists) }, counts })
    })
}

/// Builds the band into `store` only.
pub(crate) fn store<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    store: &mut (dyn BandStore<E> + Send),
    run: &RunSettings,
) -> Result<BandCounts, E> {
    Ok(Parts::collect(distance, settings, Next::Nothing, Some(store), run)?.1)
}

/// What is kept of a batch of leaves.
struct Kept {
    origins: Vec<Ijk>,
    inside_blocks: Vec<(Ijk, i32)>,
    /// Leaves and active nodes that the slab owns.
    owned: [u64; 2],
    /// For edges and a contour: which nodes are inside, their closest triangles, and those near the edges.
    near: Option<(Vec<LeafMask>, PartTriangles, BlockLists)>,
    /// For the store.
    stored: Option<LeafBatch>,
}

impl Kept {
    fn new(batch: &LeafBatch, slab: Slab, next: Next, part: StoredPart) -> Kept {
        let own = batch.origins.iter().zip(&batch.active).filter(|leaf| slab.owns(*leaf.0));
        let owned = own.fold([0; 2], |[leaves, nodes], (_, active)| {
            [leaves + 1, nodes + active.iter().map(|word| u64::from(word.count_ones())).sum::<u64>()]
        });
        let near = || (batch.inside.clone(), PartTriangles::new(&batch.closest), batch.lists.clone());
        Kept {
            origins: batch.origins.clone(),
            inside_blocks: batch.inside_blocks.clone(),
            owned,
            near: (next == Next::Contour).then(near),
            stored: part.of(batch),
        }
    }
}

/// Leaves as they come out of the filters.
#[derive(Default)]
struct Parts {
    origins: Vec<Ijk>,
    inside: Vec<LeafMask>,
    closest: Vec<PartTriangles>,
    lists: Vec<(Vec<Ijk>, BlockLists)>,
    blocks: InsideBlocks,
}

impl Parts {
    fn collect<E: From<Cancelled> + Send>(
        distance: &SignedDistance,
        settings: &BandSettings,
        next: Next,
        mut store: Option<&mut (dyn BandStore<E> + Send)>,
        run: &RunSettings,
    ) -> Result<(Parts, BandCounts), E> {
        let slab = settings.slab;
        let mut parts = Parts::default();
        let mut counts = BandCounts::default();
        let mut inside_blocks = Vec::new();
        let part = store.as_ref().map_or(StoredPart::Nothing, |store| store.stored_part());
        let keep = |batch: &LeafBatch| Kept::new(batch, slab, next, part);
        let mut take = |kept: Kept, parts: &mut Parts| -> Result<(), E> {
            if let (Some(store), Some(batch)) = (&mut store, &kept.stored) {
                store.insert(batch, slab)?;
            }
            counts.leaves += kept.owned[0];
            counts.active_voxels += kept.owned[1];
            parts.take(kept);
            Ok(())
        };
        // What only stays here need not be handed on in between.
        let at_a_time = if part == StoredPart::Nothing { usize::MAX } else { BOXES_PER_BATCH };
        let filter = build_kept(distance, settings, at_a_time, run, keep, |kept| {
            inside_blocks.extend_from_slice(&kept.inside_blocks);
            take(kept, &mut parts)
        })?;
        let jumps = run.install(|| {
            parts.blocks = InsideBlocks::new(&inside_blocks);
            let is_inside = |node| parts.blocks.contains(node);
            leaves_at_jumps(&parts.origins, &inside_blocks, settings, is_inside)
        });
        if !jumps.is_empty() {
            take(keep(&jumps), &mut parts)?;
        }
        counts.filter = filter;
        Ok((parts, counts))
    }

    fn take(&mut self, kept: Kept) {
        self.origins.extend_from_slice(&kept.origins);
        let Some((inside, closest, lists)) = kept.near else { return };
        self.inside.extend(inside);
        self.closest.push(closest);
        // Leaves that were added where the sign jumps have no lists: edges there ask the hierarchy.
        if !lists.is_empty() {
            self.lists.push((kept.origins, lists));
        }
    }
}
