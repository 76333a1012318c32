//! Checks that the volumes of a hierarchy enclose the triangles below them.

use super::Ssvh;
use super::node::Level;
use crate::geom::swept::Swept;
use glam::DVec3;

/// A volume that does not enclose a triangle below it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the volume of lane {lane} of node {node} misses triangle {triangle} by {by}")]
pub struct InvalidSsvh {
    /// Number of the node.
    pub node: usize,
    /// Lane of the volume in the node.
    pub lane: usize,
    /// Number of the triangle in the mesh.
    pub triangle: u32,
    /// Distance of the triangle's corner from the volume, in model units.
    pub by: f64,
}

impl Ssvh {
    /// Checks every volume against every triangle below it, and that each triangle is in exactly
    /// one leaf.
    ///
    /// # Errors
    /// The first volume that misses a triangle by more than the rounding that queries allow for.
    ///
    /// # Panics
    /// When a triangle is not in exactly one leaf, or the axes of a volume are not orthonormal.
    pub fn validate(&self) -> Result<(), InvalidSsvh> {
        let mut seen = vec![false; self.len()];
        self.validate_below(0, &mut Vec::new(), &mut seen)?;
        assert!(seen.iter().all(|&s| s), "a triangle is in no leaf");
        Ok(())
    }

    fn validate_below(
        &self,
        node: usize,
        above: &mut Vec<(usize, usize, Swept)>,
        seen: &mut [bool],
    ) -> Result<(), InvalidSsvh> {
        let n = &self.nodes[node];
        for lane in 0..n.count as usize {
            let child = n.children[lane] as usize;
            let swept = n.swept(lane);
            // Distances from a volume are distances only with orthonormal axes.
            let skew = swept.u.dot(swept.v).abs().max((swept.u.cross(swept.v).length() - 1.0).abs());
            assert!(skew < 1e-6, "the axes of lane {lane} of node {node} are not orthonormal: {skew}");
            above.push((node, lane, swept));
            match n.level {
                Level::Inner => self.validate_below(child, above, seen)?,
                Level::Leaf => {
                    assert!(!std::mem::replace(&mut seen[child], true), "a triangle is in two leaves");
                    for corner in self.triangles[child].corners {
                        self.validate_corner(corner - self.centre, self.ids[child], above)?;
                    }
                }
            }
            above.pop();
        }
        Ok(())
    }

    fn validate_corner(
        &self,
        corner: DVec3,
        triangle: u32,
        above: &[(usize, usize, Swept)],
    ) -> Result<(), InvalidSsvh> {
        let allowed = 1e-6 * self.extent;
        for &(node, lane, swept) in above {
            let by = swept.core_distance(corner) - swept.radius;
            if by > allowed {
                return Err(InvalidSsvh { node, lane, triangle, by });
            }
        }
        Ok(())
    }
}
