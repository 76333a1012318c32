//! The region in which the vertex of a sheet may lie: its cell, between the walls of several
//! sheets.

use crate::contour::cell::{Case, Corner, Edge, MAX_SHEETS, SheetKind};
use crate::geom::quadric::HalfSpace;
use crate::lattice::Axis;
use glam::DVec3;

/// The most half-spaces of a region: one for each face of the cell, and a wall per sheet.
const MAX_HALF_SPACES: usize = 6 + MAX_SHEETS;

/// An intersection of half-spaces, in coordinates 0 to 1 of the cell.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    half_spaces: [HalfSpace; MAX_HALF_SPACES],
    len: usize,
}

impl Region {
    /// Returns the cell, shrunk by `margin` voxels.
    pub fn cell(margin: f64) -> Region {
        let mut region = Region { half_spaces: [NOTHING; MAX_HALF_SPACES], len: 0 };
        for axis in Axis::ALL {
            let normal = DVec3::AXES[axis as usize];
            region.push(HalfSpace { normal, offset: margin });
            region.push(HalfSpace { normal: -normal, offset: margin - 1.0 });
        }
        region
    }

    /// Returns the region of sheet number `sheet` of `case`.
    ///
    /// That is the cell shrunk by `margin` voxels, on the inner side of the sheet's own wall and on
    /// the outer side of the others, `wall_margin` away from them.
    pub fn of_sheet(case: &Case, sheet: usize, margin: f64, wall_margin: f64) -> Region {
        let mut region = Region::cell(margin);
        if case.has_several_sheets() {
            for (number, other) in case.sheets().iter().enumerate() {
                let Some(mut wall) = wall(other.kind) else { continue };
                if number != sheet {
                    wall = HalfSpace { normal: -wall.normal, offset: -wall.offset };
                }
                wall.offset += wall_margin;
                region.push(wall);
            }
        }
        region
    }

    fn push(&mut self, half_space: HalfSpace) {
        self.half_spaces[self.len] = half_space;
        self.len += 1;
    }

    /// Returns the half-spaces.
    #[inline]
    pub fn half_spaces(&self) -> &[HalfSpace] {
        &self.half_spaces[..self.len]
    }

    /// Whether `local` is inside all half-spaces.
    #[inline]
    pub fn contains(&self, local: DVec3) -> bool {
        self.half_spaces().iter().all(|half| half.depth(local) >= 0.0)
    }
}

const NOTHING: HalfSpace = HalfSpace { normal: DVec3::ZERO, offset: 0.0 };

/// Returns the half-space of a cap's wall in which the cap lies.
fn wall(kind: SheetKind) -> Option<HalfSpace> {
    match kind {
        SheetKind::Main => None,
        SheetKind::CornerCap(corner) => Some(beyond_wall(corner, &Axis::ALL)),
        SheetKind::EdgeCap(edge) => Some(edge_wall(edge)),
    }
}

fn edge_wall(edge: Edge) -> HalfSpace {
    let (u, v) = edge.axis().others();
    beyond_wall(edge.low(), &[u, v])
}

/// Returns the points whose distances from the cell's faces at `corner`, added up over `axes`, are
/// at most one voxel.
fn beyond_wall(corner: Corner, axes: &[Axis]) -> HalfSpace {
    let mut half = HalfSpace { normal: DVec3::ZERO, offset: -1.0 };
    for &axis in axes {
        if corner.position(axis) == 0 {
            half.normal[axis as usize] = -1.0;
        } else {
            // The distance from the upper face is 1 - w.
            half.normal[axis as usize] = 1.0;
            half.offset += 1.0;
        }
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::cell::{CaseTable, FaceChoice};

    #[test]
    fn walls_pass_through_the_neighbours() {
        let local = |c: Corner| DVec3::from(c.offset().map(f64::from));
        for corner in Corner::all() {
            let wall = wall(SheetKind::CornerCap(corner)).unwrap();
            assert!(wall.depth(local(corner)) > 0.0);
            assert!(Axis::ALL.iter().all(|&a| wall.depth(local(corner.across(a))) == 0.0));
        }
        for edge in Edge::all() {
            let wall = wall(SheetKind::EdgeCap(edge)).unwrap();
            let (u, v) = edge.axis().others();
            for end in [edge.low(), edge.high()] {
                assert!(wall.depth(local(end)) > 0.0);
                assert!([u, v].iter().all(|&a| wall.depth(local(end.across(a))) == 0.0));
            }
        }
    }

    #[test]
    fn middles_of_sheets_are_deep_inside_their_regions() {
        let table = CaseTable::get();
        for bits in 0..64 {
            for mask in 1..255u8 {
                let case = table.case(table.id(mask, FaceChoice::from_bits(bits)));
                for (number, sheet) in case.sheets().iter().enumerate() {
                    let n = sheet.edges.len() as f64;
                    let middle = sheet.edges.iter().fold([0.0; 3], |sum: [f64; 3], edge| {
                        let (a, b) = (edge.low().offset(), edge.high().offset());
                        std::array::from_fn(|i| sum[i] + f64::from(a[i] + b[i]) / 2.0 / n)
                    });
                    let region = Region::of_sheet(case, number, 0.125, 0.125);
                    assert!(region.contains(middle.into()), "{mask:#x} {bits:#x} {middle:?}");
                }
            }
        }
    }
}
