//! Missed features: confirmed candidates of neighbouring cells, gathered.

use super::search::{Found, Missed, MissedCandidate, MissedCandidates};
use crate::geom::union_find::UnionFind;
use crate::lattice::Ijk;

/// The kind of a missed feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum MissedKind {
    /// A part of the offset solid that is thinner than a voxel.
    Sheet,
    /// A gap in the offset solid that is narrower than a voxel.
    Gap,
    /// A part of the offset solid that is smaller than a cell.
    Part,
}

/// A feature of the offset solid that the result lacks.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MissedFeature {
    /// Sheet, gap or part.
    pub kind: MissedKind,
    /// The deepest point of the feature that was found, in model units.
    pub at: [f64; 3],
    /// Distance of that point from the true surface, in voxels: about half of the feature's
    /// thickness.
    pub depth: f64,
    /// Number of points that were found.
    pub points: usize,
    /// Lowest and highest coordinates of these points, in model units.
    pub bbox: [[f64; 3]; 2],
}

/// All features that the lattice is too coarse for.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MissedFeatures {
    /// Number of sheets thinner than a voxel.
    pub sheets: usize,
    /// Number of gaps narrower than a voxel.
    pub gaps: usize,
    /// Number of parts smaller than a cell.
    pub parts: usize,
    /// Features with the most points first, at most a hundred.
    #[cfg_attr(feature = "serde", serde(rename = "places"))]
    pub features: Vec<MissedFeature>,
}

/// The most features that are listed. The numbers count all of them.
pub const MAX_LISTED: usize = 100;

impl MissedFeatures {
    /// Returns the number of features, listed or not.
    pub fn count(&self) -> usize {
        self.sheets + self.gaps + self.parts
    }

    /// Gathers confirmed candidates into features.
    pub fn new(missed: MissedCandidates) -> MissedFeatures {
        let mut missed = missed.all;
        missed.sort_by_key(|c| (c.missed, c.cell, c.found));
        let groups = groups(&missed);
        let mut features: Vec<MissedFeature> =
            groups.into_iter().map(|group| MissedFeature::of(&missed, &group)).collect();
        let count = |kind| features.iter().filter(|p| p.kind == kind).count();
        let [sheets, gaps, parts] = [MissedKind::Sheet, MissedKind::Gap, MissedKind::Part].map(count);
        // Stable: features of a size stay in the order of their cells.
        features.sort_by_key(|feature| std::cmp::Reverse(feature.points));
        features.truncate(MAX_LISTED);
        MissedFeatures { sheets, gaps, parts, features }
    }
}

impl MissedFeature {
    fn of(missed: &[MissedCandidate], group: &[usize]) -> MissedFeature {
        let members = || group.iter().map(|&n| &missed[n]);
        let first = &missed[group[0]];
        let deepest =
            members().fold(first, |best, other| if other.depth > best.depth { other } else { best });
        let (lo, hi) = members().fold((first.at, first.at), |(lo, hi), s| (lo.min(s.at), hi.max(s.at)));
        let kind = match first.missed {
            Missed::Void => MissedKind::Gap,
            Missed::Solid if members().any(|s| s.found == Found::OnEdge) => MissedKind::Sheet,
            Missed::Solid => MissedKind::Part,
        };
        MissedFeature {
            kind,
            at: deepest.at.to_array(),
            depth: deepest.depth,
            points: group.len(),
            bbox: [lo.to_array(), hi.to_array()],
        }
    }
}

/// Returns the groups of candidates of one kind in cells that touch each other. `missed` is sorted
/// by kind and cell. Each group holds ascending numbers, and groups come in the order of their
/// first ones.
fn groups(missed: &[MissedCandidate]) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::new(missed.len() as u32);
    let key = |candidate: &MissedCandidate| (candidate.missed, candidate.cell);
    for (n, candidate) in (0..).zip(missed) {
        // The cell itself and the half of its neighbours that come later.
        for delta in (13..27).map(|d: i32| Ijk([d / 9 - 1, d / 3 % 3 - 1, d % 3 - 1])) {
            let other = (candidate.missed, candidate.cell + delta);
            let first = missed.partition_point(|candidate| key(candidate) < other);
            let same = missed[first..].iter().take_while(|candidate| key(candidate) == other).count();
            for m in first..first + same {
                sets.join(n, m as u32);
            }
        }
    }
    let mut by_root: Vec<Vec<usize>> = vec![Vec::new(); missed.len()];
    for n in 0..missed.len() {
        by_root[sets.root(n as u32) as usize].push(n);
    }
    by_root.retain(|group| !group.is_empty());
    by_root
}
