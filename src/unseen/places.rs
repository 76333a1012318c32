//! Places: what is hidden, gathered from neighbouring cells.

use super::suspects::{Found, Hidden, Suspect, Suspects};
use crate::lattice::Ijk;
use serde::Serialize;

/// What is missing at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum UnseenKind {
    /// A piece of the offset solid that is thinner than a voxel.
    Sheet,
    /// A gap in it that is narrower than a voxel.
    Gap,
    /// A piece of it that is smaller than a cell.
    Part,
}

/// A place where the result lacks something.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// What is missing.
    pub kind: UnseenKind,
    /// A point of it, in model units: the deepest that was found.
    pub at: [f64; 3],
    /// How far that point is from the true surface, in voxels: about half of what is missing there.
    pub depth: f64,
    /// Points that were found.
    pub points: usize,
    /// The lowest and the highest coordinates of these points, in model units.
    pub bbox: [[f64; 3]; 2],
}

/// What the lattice could not see.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Unseen {
    /// Sheets thinner than a voxel.
    pub sheets: usize,
    /// Gaps narrower than a voxel.
    pub gaps: usize,
    /// Parts smaller than a cell.
    pub parts: usize,
    /// Where they are, those with the most points first; at most a hundred.
    pub places: Vec<Place>,
}

/// Places that are listed.
pub const MOST_PLACES: usize = 100;

impl Unseen {
    /// The number of places.
    pub fn count(&self) -> usize {
        self.sheets + self.gaps + self.parts
    }

    /// The places of what is lost.
    pub fn new(lost: Suspects) -> Unseen {
        let mut lost = lost.all;
        lost.sort_by_key(|s| (s.hidden, s.cell, s.found));
        let groups = Groups::of(&lost);
        let mut places: Vec<Place> = groups.into_iter().map(|group| Place::of(&lost, &group)).collect();
        let count = |kind| places.iter().filter(|p| p.kind == kind).count();
        let [sheets, gaps, parts] = [UnseenKind::Sheet, UnseenKind::Gap, UnseenKind::Part].map(count);
        // Stable: places of a size stay in the order of their cells.
        places.sort_by_key(|place| std::cmp::Reverse(place.points));
        places.truncate(MOST_PLACES);
        Unseen { sheets, gaps, parts, places }
    }
}

impl Place {
    fn of(lost: &[Suspect], group: &[usize]) -> Place {
        let members = || group.iter().map(|&n| &lost[n]);
        let first = &lost[group[0]];
        let deepest =
            members().fold(first, |best, other| if other.depth > best.depth { other } else { best });
        let (lo, hi) = members().fold((first.at, first.at), |(lo, hi), s| (lo.min(s.at), hi.max(s.at)));
        let kind = match first.hidden {
            Hidden::Air => UnseenKind::Gap,
            Hidden::Solid if members().any(|s| s.found == Found::OnEdge) => UnseenKind::Sheet,
            Hidden::Solid => UnseenKind::Part,
        };
        Place {
            kind,
            at: deepest.at.to_array(),
            depth: deepest.depth,
            points: group.len(),
            bbox: [lo.to_array(), hi.to_array()],
        }
    }
}

/// Suspects of a kind in cells that touch each other belong together.
struct Groups {
    parents: Vec<usize>,
}

impl Groups {
    /// The groups of suspects sorted by kind and cell, each by ascending number, in the order of their first ones.
    fn of(lost: &[Suspect]) -> Vec<Vec<usize>> {
        let mut groups = Groups { parents: (0..lost.len()).collect() };
        let key = |s: &Suspect| (s.hidden, s.cell);
        for (n, suspect) in lost.iter().enumerate() {
            // The cell itself and the half of its neighbours that come later.
            for delta in (13..27).map(|d: i32| Ijk([d / 9 - 1, d / 3 % 3 - 1, d % 3 - 1])) {
                let other = (suspect.hidden, suspect.cell + delta);
                let first = lost.partition_point(|s| key(s) < other);
                for (m, _) in lost.iter().enumerate().skip(first).take_while(|(_, s)| key(s) == other) {
                    groups.join(n, m);
                }
            }
        }
        let mut by_root: Vec<Vec<usize>> = vec![Vec::new(); lost.len()];
        for n in 0..lost.len() {
            by_root[groups.root(n)].push(n);
        }
        by_root.retain(|group| !group.is_empty());
        by_root
    }

    fn root(&mut self, mut n: usize) -> usize {
        while self.parents[n] != n {
            self.parents[n] = self.parents[self.parents[n]];
            n = self.parents[n];
        }
        n
    }

    /// The lower root stays.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b);
    }
}
