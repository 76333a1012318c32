//! The exact test of a change: whether the mesh stays embedded.

use super::bounds::Bounds;
use super::patch_mesh::Patch;
use super::triangle::PatchTriangle;

impl Patch {
    /// Whether the mesh stays embedded when some triangles change and others are removed.
    ///
    /// Changed triangles must have area, stay within the bounds and near their leaves, and meet
    /// neither each other nor any other triangle but in the vertices and edges that they share.
    pub(super) fn accepts(&self, changed: &[(usize, PatchTriangle)], removed: &[usize]) -> bool {
        let Some(&(_, first)) = changed.first() else { return false };
        let boxes: Vec<Bounds> = changed.iter().map(|(_, t)| t.bounds()).collect();
        let around = boxes.iter().fold(first.bounds(), |all, b| all.with(b));
        if !self.bounds.contains(&around) || !changed.iter().all(|(_, t)| t.has_area()) {
            return false;
        }
        let is_near_leaf =
            |((_, t), b): (&(usize, PatchTriangle), &Bounds)| self.homes[usize::from(t.home)].contains(b);
        if !changed.iter().zip(&boxes).all(is_near_leaf) {
            return false;
        }
        for (i, (_, t)) in changed.iter().enumerate() {
            if changed[..i].iter().any(|(_, other)| t.meets(other)) {
                return false;
            }
        }
        for n in self.boxes.near(&around) {
            if changed.iter().any(|&(m, _)| m == n) || removed.contains(&n) {
                continue;
            }
            let (other, other_box) = (&self.triangles[n], self.boxes.of(n));
            let meets =
                |((_, t), b): (&(usize, PatchTriangle), &Bounds)| b.meets(other_box) && t.meets(other);
            if changed.iter().zip(&boxes).any(meets) {
                return false;
            }
        }
        true
    }
}
