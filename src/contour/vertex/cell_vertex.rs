//! The vertex of a sheet: as near to the minimiser of its quadratic error function as its cell and
//! its walls allow.

use super::feasible_region::Region;
use crate::contour::cell::{Case, Edge, EdgeSet};
use crate::contour::feature::{
    Feature, HermiteSamples, MIN_SPREAD, Normals, SurfaceProbe, locate_feature, project_to_surface,
};
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::edge::Crossing;
use crate::geom::quadric::{Minimiser, Qef};
use crate::lattice::Ijk;
use glam::DVec3;

/// The share of the margin that a vertex keeps after rounding.
///
/// The margin is 2 units in the last place or more, and rounding of the vertex and of the cell's
/// walls takes half a unit each.
const KEPT: f64 = 0.25;

/// The share of the margin from its walls that a vertex keeps after rounding. Three coordinates are
/// rounded there.
const KEPT_AT_WALLS: f64 = 1.0 / 16.0;

/// The number of halvings of the step from the start to the target before the start itself is
/// taken.
const HALVINGS: i32 = 12;

/// The number of steps from the mean of the crossings to the mean of the midpoints of their edges.
const STEPS_TO_MIDDLE: i32 = 8;

/// The distance from the minimiser to a tangent plane above which the planes do not meet: a smooth
/// face ends before. In voxels; spheres with a radius of 4 voxels have 0.04.
pub const MAX_DISAGREEMENT: f64 = 0.035;

/// The greatest height of a vertex above a smooth surface, in voxels. Higher vertices are taken
/// down.
///
/// Tangent planes of a sphere meet above it, by 1 / (6 r) voxels at a radius of r voxels and more
/// in corners of cells. That is where the triangles between the vertices, which cut through the
/// sphere, are off the least on average. On the sphere itself their mean error would be 2.4 times
/// as large.
const MAX_HEIGHT: f64 = 0.03;

/// Whether a vertex lies at the minimiser of its error function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// At the minimiser.
    Free,
    /// At the least point that its cell and its walls allow.
    Clamped,
}

/// The position of a vertex that is not made, because its cell lacks crossings
/// ([`EdgeNumbers::is_partial`]). Nothing of the cell gets into the mesh.
///
/// [`EdgeNumbers::is_partial`]: crate::edge::EdgeNumbers::is_partial
pub const MISSING: [f64; 3] = [f64::NAN; 3];

/// Whether a position is [`MISSING`].
#[inline]
pub fn is_missing(position: [f64; 3]) -> bool {
    position[0].is_nan()
}

/// A vertex in its cell, and the feature that it stands for.
#[derive(Clone, Copy, Debug)]
pub struct CellVertex {
    /// The position, rounded.
    pub position: [f64; 3],
    /// Whether that is the minimiser of the error function.
    pub placement: Placement,
    /// The feature, if there is one, with its point rounded.
    pub feature: Option<Feature>,
    /// Whether the sign jumps at one of the crossings.
    pub is_jump: bool,
}

/// Places the vertex of sheet number `sheet` of a cell. `crossing` returns the crossing of each of
/// the sheet's edges.
pub fn place_vertex<'a>(
    lattice: &RoundedLattice,
    cell: Ijk,
    case: &Case,
    sheet: usize,
    crossing: impl Fn(Edge) -> &'a Crossing,
    surface: Option<&dyn ImplicitSurface>,
) -> CellVertex {
    let edges = case.sheets()[sheet].edges;
    let mut qef = Qef::default();
    let mut samples = HermiteSamples::default();
    let (mut triangle, mut is_jump) = (0, false);
    for edge in edges.iter() {
        let crossing = crossing(edge);
        let (point, normal) = sample(edge, crossing);
        qef.add(point, normal);
        samples.push(point, normal, crossing.triangle);
        triangle = crossing.triangle;
        is_jump |= crossing.is_jump();
    }
    // Where the sign jumps, the surface is far away and its samples mean nothing.
    let surface = surface.filter(|_| !is_jump);
    let mut minimiser = qef.minimiser();
    let mut found = None;
    if let Some(surface) = surface {
        let is_feature = minimiser.spread() > MIN_SPREAD;
        let is_unsure = samples.disagreement(minimiser.point) > MAX_DISAGREEMENT;
        if is_feature || is_unsure {
            let origin = lattice.unrounded(cell, DVec3::ZERO);
            let mut probe = SurfaceProbe { surface, origin, voxel: lattice.voxel(), triangle };
            if is_feature {
                found = locate_feature(&mut probe, &samples, minimiser.point, qef.mean());
            }
            if found.is_none() && (is_unsure || samples.see_several_faces()) {
                // Not where the planes meet, but at least on the surface.
                let (position, _) = in_cell(lattice, cell, case, sheet, &crossing, &minimiser);
                let point = project_to_surface(&mut probe, lattice.local(cell, position));
                found = point.map(|point| Feature { point, normals: Normals::default() });
            }
        }
    }
    match found {
        Some(feature) => minimiser.point = feature.point,
        None if surface.is_some() && minimiser.spread() > MIN_SPREAD => {
            let (height, normal) = samples.height(minimiser.point);
            let excess = height - height.clamp(-MAX_HEIGHT, MAX_HEIGHT);
            minimiser.point += -excess * normal;
        }
        None => {}
    }
    let (position, placement) = in_cell(lattice, cell, case, sheet, crossing, &minimiser);
    let feature = found.map(|f| Feature { point: lattice.round_in_cell(cell, f.point).into(), ..f });
    CellVertex { position, placement, feature, is_jump }
}

/// Returns the rounded position nearest to the minimiser that a cell and its walls allow.
fn in_cell<'a>(
    lattice: &RoundedLattice,
    cell: Ijk,
    case: &Case,
    sheet: usize,
    crossing: impl Fn(Edge) -> &'a Crossing,
    minimiser: &Minimiser,
) -> ([f64; 3], Placement) {
    let edges = case.sheets()[sheet].edges;
    let margin = lattice.margin();
    if !case.has_several_sheets()
        && let Some(position) = free(lattice, cell, minimiser.point)
    {
        return (position, Placement::Free);
    }
    let region = Region::of_sheet(case, sheet, margin, 0.5 * margin);
    let allowed = Region::of_sheet(case, sheet, KEPT * margin, KEPT_AT_WALLS * margin);
    let target = minimiser.within(region.half_spaces());
    let placement = if target == Some(minimiser.point) { Placement::Free } else { Placement::Clamped };
    let fits = |position: [f64; 3]| allowed.contains(lattice.local(cell, position));
    if let Some(target) = target {
        let position = lattice.round_in_cell(cell, target);
        if fits(position) {
            return (position, placement);
        }
    }
    let start = start(lattice, cell, edges, &crossing, fits);
    let from = DVec3::from(start);
    let target = lattice.unrounded(cell, target.unwrap_or(minimiser.point));
    let towards = |share: f64| lattice.round(from + share * (target - from));
    let position = (0..HALVINGS).map(|n| towards(0.5f64.powi(n))).find(|&position| fits(position));
    (position.unwrap_or(start), Placement::Clamped)
}

/// Returns a position that is allowed for sure: the mean of the crossings, or, if rounding or the
/// margin puts that on a wall, a position on the way from there to the mean of the midpoints of the
/// crossed edges.
fn start<'a>(
    lattice: &RoundedLattice,
    cell: Ijk,
    edges: EdgeSet,
    crossing: impl Fn(Edge) -> &'a Crossing,
    fits: impl Fn([f64; 3]) -> bool,
) -> [f64; 3] {
    let (mut mean, mut middle, count) = (DVec3::ZERO, DVec3::ZERO, edges.len() as f64);
    for edge in edges.iter() {
        mean += on_edge(edge, lattice.clamp_to_edge(crossing(edge).t));
        middle += on_edge(edge, 0.5);
    }
    let mean = DVec3::from((mean / count).to_array().map(|x| lattice.clamp_to_edge(x)));
    let middle = middle / count;
    let position = |step: i32| {
        let share = f64::from(step) / f64::from(STEPS_TO_MIDDLE);
        lattice.between_walls(cell, (mean + share * (middle - mean)).to_array())
    };
    let found = (0..STEPS_TO_MIDDLE).map(position).find(|&p| fits(p));
    found.unwrap_or_else(|| position(STEPS_TO_MIDDLE))
}

/// Returns a crossing as a sample of its sheet: the point in coordinates 0 to 1 of the cell, and
/// the normal.
#[inline]
pub fn sample(edge: Edge, crossing: &Crossing) -> (DVec3, DVec3) {
    (on_edge(edge, unit(crossing.t)), DVec3::from(crossing.normal.map(f64::from)))
}

/// Returns the rounded position of a point of a cell, if the point keeps the margin from the cell's
/// walls.
#[inline]
pub fn free(lattice: &RoundedLattice, cell: Ijk, point: DVec3) -> Option<[f64; 3]> {
    let margin = lattice.margin();
    let is_inside = point.to_array().iter().all(|x| (margin..=1.0 - margin).contains(x));
    is_inside.then(|| lattice.round_in_cell(cell, point))
}

/// Returns the point of an edge at position `t`, in coordinates 0 to 1 of the cell.
#[inline]
fn on_edge(edge: Edge, t: f64) -> DVec3 {
    let mut point = edge.low().offset().map(f64::from);
    point[edge.axis() as usize] = t;
    point.into()
}

/// Returns `t` kept within 0 to 1; 0 for what is not a number.
#[inline]
fn unit(t: f64) -> f64 {
    if t >= 0.0 { t.min(1.0) } else { 0.0 }
}
