//! The vertex of a sheet: as close to the minimiser of its quadratic error function as its cell and its
//! walls allow.

use super::feasible_region::Region;
use crate::contour::cell::{Case, Edge, EdgeSet};
use crate::contour::feature::{Asker, Feature, Normals, SPREAD, Samples, feature, nearest};
use crate::contour::implicit_surface::Surface;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::edge::Crossing;
use crate::geom::quadric::{Minimiser, Qef, along};
use crate::lattice::Ijk;

/// After rounding, a vertex keeps at least this share of the margin. The margin is 2 units in the last place
/// or more, and rounding of the vertex and of the cell's walls takes half a unit each.
const KEPT: f64 = 0.25;

/// After rounding, a vertex keeps at least this share of the margin from its walls, where three coordinates
/// are rounded.
const KEPT_AT_WALLS: f64 = 1.0 / 16.0;

/// Halvings of the step from the start to the target before the start itself is taken.
const HALVINGS: i32 = 12;

/// Steps from the mean of the crossings to the mean of the midpoints of their edges.
const STEPS_TO_MIDDLE: i32 = 8;

/// Planes that miss the minimiser by more than this, in voxels, do not meet: a side of the surface ends before.
/// Spheres with a radius of 4 voxels have 0.04.
pub const UNSURE: f64 = 0.035;

/// Tangent planes of a sphere meet above it, by 1 / (6 r) voxels at a radius of r voxels and more in corners of
/// cells. That is where the faces between the vertices, which cut through the sphere, are off the least on average:
/// on the sphere itself their mean error would be 2.4 times as large. Higher than this, in voxels, is taken down.
const HIGHEST: f64 = 0.03;

/// Whether a vertex lies at the minimiser of its error function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// At the minimiser.
    Free,
    /// At the least point that its cell and its walls allow.
    Clamped,
}

/// Stands for the position of a vertex that is not made: its cell lacks crossings ([`EdgeNumbers::is_partial`]). Nothing of the
/// cell gets into the mesh.
///
/// [`EdgeNumbers::is_partial`]: crate::edge::EdgeNumbers::is_partial
pub const MISSING: [f64; 3] = [f64::NAN; 3];

/// Whether a position is [`MISSING`].
#[inline]
pub fn is_missing(position: [f64; 3]) -> bool {
    position[0].is_nan()
}

/// A vertex in its cell, and where it ought to be.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The position, rounded.
    pub position: [f64; 3],
    /// Whether that is where the error function is least.
    pub placement: Placement,
    /// The feature that it stands for, if there is one: the point, rounded, and the sides that meet there.
    pub feature: Option<Feature>,
    /// Whether the sign jumps at one of its crossings.
    pub is_jump: bool,
}

/// The position of the vertex of sheet number `sheet` of a cell. `crossing` gives the sample of each of the
/// sheet's edges.
pub fn place<'a>(
    lattice: &RoundedLattice,
    cell: Ijk,
    case: &Case,
    sheet: usize,
    crossing: impl Fn(Edge) -> &'a Crossing,
    surface: Option<&dyn Surface>,
) -> Placed {
    let edges = case.sheets()[sheet].edges;
    let mut qef = Qef::default();
    let mut samples = Samples::default();
    let (mut piece, mut is_jump) = (0, false);
    for edge in edges.iter() {
        let crossing = crossing(edge);
        let (point, normal) = sample(edge, crossing);
        qef.add(point, normal);
        samples.push(point, normal, crossing.triangle);
        piece = crossing.triangle;
        is_jump |= crossing.is_jump();
    }
    // Where the sign jumps, the surface is far away and has nothing to say.
    let surface = surface.filter(|_| !is_jump);
    let mut minimiser = qef.minimiser();
    let mut found = None;
    if let Some(surface) = surface {
        let is_feature = minimiser.spread() > SPREAD;
        let is_unsure = samples.disagreement(minimiser.point) > UNSURE;
        if is_feature || is_unsure {
            let origin = lattice.unrounded(cell, [0.0; 3]);
            let mut ask = Asker { surface, origin, voxel: lattice.voxel(), piece };
            if is_feature {
                found = feature(&mut ask, &samples, minimiser.point, qef.mean());
            }
            if found.is_none() && (is_unsure || samples.see_several_sides()) {
                // Not where the planes meet, but at least on the surface.
                let (position, _) = in_cell(lattice, cell, case, sheet, &crossing, &minimiser);
                let point = nearest(&mut ask, lattice.local(cell, position));
                found = point.map(|point| Feature { point, normals: Normals::default() });
            }
        }
    }
    match found {
        Some(feature) => minimiser.point = feature.point,
        None if surface.is_some() && minimiser.spread() > SPREAD => {
            let (height, normal) = samples.height(minimiser.point);
            let excess = height - height.clamp(-HIGHEST, HIGHEST);
            minimiser.point = along(minimiser.point, -excess, normal);
        }
        None => {}
    }
    let (position, placement) = in_cell(lattice, cell, case, sheet, crossing, &minimiser);
    let feature = found.map(|f| Feature { point: lattice.round_in_cell(cell, f.point), ..f });
    Placed { position, placement, feature, is_jump }
}

/// The position nearest to the minimiser that a cell and its walls allow, rounded.
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
    let target = lattice.unrounded(cell, target.unwrap_or(minimiser.point));
    let towards = |share: f64| lattice.round(mix(start, target, share));
    let position = (0..HALVINGS).map(|n| towards(0.5f64.powi(n))).find(|&position| fits(position));
    (position.unwrap_or(start), Placement::Clamped)
}

/// A position that is allowed for sure: the mean of the crossings, or if rounding or the margin puts that
/// on a wall, a position on the way from there to the mean of the midpoints of the crossed edges.
fn start<'a>(
    lattice: &RoundedLattice,
    cell: Ijk,
    edges: EdgeSet,
    crossing: impl Fn(Edge) -> &'a Crossing,
    fits: impl Fn([f64; 3]) -> bool,
) -> [f64; 3] {
    let (mut mean, mut middle, count) = ([0.0; 3], [0.0; 3], edges.len() as f64);
    for edge in edges.iter() {
        let (point, midpoint) = (on_edge(edge, lattice.clamp(crossing(edge).t)), on_edge(edge, 0.5));
        for a in 0..3 {
            mean[a] += point[a];
            middle[a] += midpoint[a];
        }
    }
    let mean = mean.map(|x| lattice.clamp(x / count));
    let middle = middle.map(|x| x / count);
    let position = |step: i32| {
        lattice.between_walls(cell, mix(mean, middle, f64::from(step) / f64::from(STEPS_TO_MIDDLE)))
    };
    let found = (0..STEPS_TO_MIDDLE).map(position).find(|&p| fits(p));
    found.unwrap_or_else(|| position(STEPS_TO_MIDDLE))
}

/// A crossing as a sample of its sheet: the point in coordinates 0 to 1 of the cell, and the normal.
#[inline]
pub fn sample(edge: Edge, crossing: &Crossing) -> ([f64; 3], [f64; 3]) {
    (on_edge(edge, unit(crossing.t)), crossing.normal.map(f64::from))
}

/// The position of a cell's minimiser, rounded, if that keeps the margin from the cell's walls.
#[inline]
pub fn free(lattice: &RoundedLattice, cell: Ijk, point: [f64; 3]) -> Option<[f64; 3]> {
    let margin = lattice.margin();
    let is_inside = point.iter().all(|x| (margin..=1.0 - margin).contains(x));
    is_inside.then(|| lattice.round_in_cell(cell, point))
}

/// The point of an edge at position `t`, in coordinates 0 to 1 of the cell.
#[inline]
fn on_edge(edge: Edge, t: f64) -> [f64; 3] {
    let mut point = edge.low().offset().map(f64::from);
    point[edge.axis() as usize] = t;
    point
}

/// `t` kept within 0 to 1; what is not a number becomes 0.
#[inline]
fn unit(t: f64) -> f64 {
    if t >= 0.0 { t.min(1.0) } else { 0.0 }
}

fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}
