//! The minimisers of cells that see one smooth face of the surface, eight at a time. Most cells do.
//!
//! Normals n_i that differ little have their error function's matrix nearly in the frame of their
//! mean v:
//!
//! ```text
//!          v   t        n_i = c_i v + t_i,  sum of t_i = 0
//!     v  [ a   k ]      a = sum of c_i^2, near the number of crossings
//!     t  [ k   T ]      T: two by two, the spread of the normals;  k: of third order in it
//! ```
//!
//! so the least point follows without an eigen decomposition: along v by a quotient, and in the
//! plane across v by the two by two matrix, where its eigenvalues are above the [`CUTOFF`] of the
//! [`Qef`](crate::geom::quadric::Qef). Cells that are not smooth are left to
//! [`cell_vertex`](super::cell_vertex).

use super::cell_vertex::MAX_DISAGREEMENT;
use crate::contour::feature::MIN_SPREAD;
use crate::geom::quadric::CUTOFF;
use crate::geom::simd::{F64s, Mask64s, Vec3F64s, dispatch};
use glam::DVec3;
use pulp::{Simd, WithSimd};

/// The number of cells that are solved together.
pub const LANES: usize = 8;

/// The most crossings of a cell.
const MAX_CROSSINGS: usize = 12;

/// The largest sum of the differences of a cell's squared normals from one. What is not a number
/// differs.
const UNIT_TOLERANCE: f64 = 1e-3;

/// The crossings with one number of several cells: points in coordinates 0 to 1 of their cells, and
/// unit normals. Zero beyond the last crossing of a cell, which adds nothing anywhere.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    points: [[f64; LANES]; 3],
    normals: [[f64; LANES]; 3],
}

/// The error functions of cells that are solved together.
#[derive(Debug, Default)]
pub struct QefBatch {
    slots: [Slot; MAX_CROSSINGS],
    /// The number of slots in use.
    used: usize,
    /// The number of crossings of each cell, at least one.
    counts: [f64; LANES],
    len: usize,
}

/// The least points of a batch's cells.
#[derive(Debug, Default)]
pub struct Solved {
    points: [[f64; LANES]; 3],
    /// 1 for each cell in which the surface is smooth, else 0.
    is_smooth: [f64; LANES],
}

impl Solved {
    /// Returns the minimiser of cell `n`, where the cell sees one smooth face and its planes agree.
    #[inline]
    pub fn smooth(&self, n: usize) -> Option<DVec3> {
        (self.is_smooth[n] == 1.0).then(|| self.points.map(|x| x[n]).into())
    }
}

impl QefBatch {
    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Adds a cell with at most twelve crossings.
    #[inline]
    pub fn push(&mut self, crossings: impl Iterator<Item = (DVec3, DVec3)>) {
        let lane = self.len;
        let mut count = 0;
        for (point, normal) in crossings {
            let (point, normal) = (point.to_array(), normal.to_array());
            if count == self.used {
                self.slots[count] = Slot::default();
                self.used += 1;
            }
            let slot = &mut self.slots[count];
            for a in 0..3 {
                slot.points[a][lane] = point[a];
                slot.normals[a][lane] = normal[a];
            }
            count += 1;
        }
        for slot in &mut self.slots[count..self.used] {
            for a in 0..3 {
                slot.points[a][lane] = 0.0;
                slot.normals[a][lane] = 0.0;
            }
        }
        self.counts[lane] = count as f64;
        self.len += 1;
    }

    /// Solves all cells, and empties the batch.
    pub fn solve(&mut self) -> Solved {
        let solved = dispatch(Solve { slots: &self.slots[..self.used], counts: &self.counts });
        self.len = 0;
        self.used = 0;
        solved
    }
}

#[derive(Clone, Copy)]
struct Solve<'a> {
    slots: &'a [Slot],
    counts: &'a [f64; LANES],
}

impl WithSimd for Solve<'_> {
    type Output = Solved;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Solved {
        let mut solved = Solved::default();
        for vector in 0..LANES / F64s::<S>::COUNT {
            solve(simd, self, vector, &mut solved);
        }
        solved
    }
}

/// Solves one vector of cells.
#[inline(always)]
fn solve<S: Simd>(simd: S, Solve { slots, counts }: Solve<'_>, vector: usize, solved: &mut Solved) {
    let number = F64s::splat;
    let zero = number(simd, 0.0);
    let count = F64s::load(simd, counts, vector);
    let mut mean = Vec3F64s::splat(simd, [0.0; 3]);
    let mut sum = mean;
    for slot in slots {
        mean = mean + Vec3F64s::load(simd, &slot.points, vector);
        sum = sum + Vec3F64s::load(simd, &slot.normals, vector);
    }
    mean = mean.times(number(simd, 1.0) / count);
    let v = sum.times(number(simd, 1.0) / sum.dot(sum).sqrt());
    let (e, f) = across(simd, v);

    // The matrix in the frame (v, e, f), and its product with the least point less the mean.
    let [mut a, mut ke, mut kf, mut ee, mut ef, mut ff] = [zero; 6];
    let [mut rv, mut re, mut rf] = [zero; 3];
    for slot in slots {
        let n = Vec3F64s::load(simd, &slot.normals, vector);
        let height = n.dot(Vec3F64s::load(simd, &slot.points, vector) - mean);
        let (nv, ne, nf) = (n.dot(v), n.dot(e), n.dot(f));
        a = a + nv * nv;
        ke = ke + nv * ne;
        kf = kf + nv * nf;
        ee = ee + ne * ne;
        ef = ef + ne * nf;
        ff = ff + nf * nf;
        rv = rv + nv * height;
        re = re + ne * height;
        rf = rf + nf * height;
    }
    let along = rv / a;
    let within = PlaneEquations { ee, ef, ff, re: re - ke * along, rf: rf - kf * along };
    let (largest, x, y) = within.least(simd, number(simd, CUTOFF) * a);
    let point = mean + v.times(along) + e.times(x) + f.times(y);

    let mut disagreement = zero;
    for slot in slots {
        let n = Vec3F64s::load(simd, &slot.normals, vector);
        let height = n.dot(Vec3F64s::load(simd, &slot.points, vector) - point);
        disagreement = disagreement.max(height.max(zero - height));
    }
    let lengths = a + ee + ff - count;
    let is_smooth = largest.at_most(number(simd, MIN_SPREAD) * a)
        & disagreement.at_most(number(simd, MAX_DISAGREEMENT))
        & lengths.max(zero - lengths).at_most(number(simd, UNIT_TOLERANCE));
    point.store(&mut solved.points, vector);
    is_smooth.select(number(simd, 1.0), zero).store(&mut solved.is_smooth, vector);
}

/// Returns two unit vectors perpendicular to `v` and to each other (Duff et al. 2017).
#[inline(always)]
fn across<S: Simd>(simd: S, v: Vec3F64s<S>) -> (Vec3F64s<S>, Vec3F64s<S>) {
    let [zero, one] = [0.0, 1.0].map(|x| F64s::splat(simd, x));
    let sign = v.z.less(zero).select(zero - one, one);
    let a = (zero - one) / (sign + v.z);
    let b = v.x * v.y * a;
    let e = Vec3F64s { x: one + sign * v.x * v.x * a, y: sign * b, z: zero - sign * v.x };
    let f = Vec3F64s { x: b, y: sign + v.y * v.y * a, z: zero - v.y };
    (e, f)
}

/// The equations in the plane across the mean normal.
#[derive(Clone, Copy)]
struct PlaneEquations<S: Simd> {
    ee: F64s<S>,
    ef: F64s<S>,
    ff: F64s<S>,
    re: F64s<S>,
    rf: F64s<S>,
}

impl<S: Simd> PlaneEquations<S> {
    /// Returns the larger eigenvalue, and the solution along the eigenvectors whose eigenvalues are
    /// above `cutoff`, zero along the others.
    #[inline(always)]
    fn least(self, simd: S, cutoff: F64s<S>) -> (F64s<S>, F64s<S>, F64s<S>) {
        let PlaneEquations { ee, ef, ff, re, rf } = self;
        let [zero, half] = [0.0, 0.5].map(|x| F64s::splat(simd, x));
        let middle = half * (ee + ff);
        let difference = half * (ee - ff);
        let radius = (difference * difference + ef * ef).sqrt();
        let (large, small) = (middle + radius, middle - radius);
        // Both: by Cramer's rule.
        let det = ee * ff - ef * ef;
        let (bx, by) = ((re * ff - rf * ef) / det, (rf * ee - re * ef) / det);
        // One: along its eigenvector, of two forms the one without cancellation.
        let is_flat = difference.less(zero);
        let ux = is_flat.select(ef, difference + radius);
        let uy = is_flat.select(radius - difference, ef);
        let step = (ux * re + uy * rf) / ((ux * ux + uy * uy) * large);
        let has_one: Mask64s<S> = cutoff.less(large);
        let has_both = cutoff.less(small);
        let x = has_both.select(bx, has_one.select(step * ux, zero));
        let y = has_both.select(by, has_one.select(step * uy, zero));
        (large, x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::quadric::Qef;
    use crate::geom::sym3::Sym3;

    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }

    fn unit(v: [f64; 3]) -> [f64; 3] {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    }

    /// A cell whose normals are off a direction by up to `spread`.
    fn cell(state: &mut u64, spread: f64) -> Vec<(DVec3, DVec3)> {
        let direction = unit([0.0; 3].map(|_: f64| random(state) - 0.5));
        let count = 3 + (random(state) * 9.9) as usize;
        let mut sample = || {
            let normal = unit(direction.map(|x| x + spread * (random(state) - 0.5)));
            // Near a plane, as the crossings of a surface with such normals.
            let mut point = [0.0; 3].map(|_: f64| random(state) - 0.5);
            let height: f64 = (0..3).map(|a| point[a] * direction[a]).sum();
            for a in 0..3 {
                point[a] += 0.5 - (1.0 - 0.2 * spread) * height * direction[a];
            }
            (DVec3::from(point), DVec3::from(normal))
        };
        (0..count).map(|_| sample()).collect()
    }

    #[test]
    fn smooth_cells_have_the_minimiser_of_the_error_function() {
        let mut state = 5;
        let (mut smooth, mut all, mut compared) = (0, 0, 0);
        for round in 0..2_000 {
            let spread = [0.0, 1e-9, 0.02, 0.05, 0.1, 0.2][round % 6];
            let cells: Vec<_> = (0..1 + round % LANES).map(|_| cell(&mut state, spread)).collect();
            let mut batch = QefBatch::default();
            // Of what another batch leaves behind nothing may be seen.
            cells.iter().rev().for_each(|c| batch.push(c.iter().copied()));
            batch.solve();
            cells.iter().for_each(|c| batch.push(c.iter().copied()));
            assert_eq!(batch.len(), cells.len());
            let solved = batch.solve();
            for (n, samples) in cells.iter().enumerate() {
                let mut qef = Qef::default();
                samples.iter().for_each(|&(point, normal)| qef.add(point, normal));
                let minimiser = qef.minimiser();
                all += 1;
                let Some(point) = solved.smooth(n) else {
                    let farthest = samples
                        .iter()
                        .map(|(p, n)| (0..3).map(|a| n[a] * (minimiser.point[a] - p[a])).sum::<f64>().abs());
                    let farthest = farthest.fold(0.0, f64::max);
                    assert!(minimiser.spread() > 0.9 * MIN_SPREAD || farthest > 0.9 * MAX_DISAGREEMENT);
                    continue;
                };
                smooth += 1;
                assert!(minimiser.spread() < 1.1 * MIN_SPREAD);
                // At the cut-off itself either may count a direction that the other leaves out.
                let mut matrix = Sym3::default();
                samples.iter().for_each(|(_, normal)| matrix.add_outer(normal.to_array()));
                let values = matrix.eigen().values;
                let is_beside = |value: f64| (value / (CUTOFF * values[0]) - 1.0).abs() > 0.01;
                if is_beside(values[1]) && is_beside(values[2]) {
                    compared += 1;
                    let off = (0..3).map(|a| (point[a] - minimiser.point[a]).abs()).fold(0.0, f64::max);
                    assert!(off < 2e-3, "{off} {spread} {samples:?}");
                }
            }
        }
        assert!(smooth > all / 2 && smooth < all && compared > smooth / 2, "{smooth} {all} {compared}");
    }

    #[test]
    fn normals_that_are_none_are_not_smooth() {
        for bad in [[f64::NAN, 0.0, 1.0], [0.0; 3], [f64::INFINITY, 0.0, 0.0], [0.0, 0.0, 2.0]] {
            let mut batch = QefBatch::default();
            let good = DVec3::Z;
            let at = |x: f64, y: f64| DVec3::new(x, y, 0.5);
            batch.push([(at(0.0, 0.0), good), (at(1.0, 0.0), good), (at(0.0, 1.0), bad.into())].into_iter());
            batch.push([(at(0.0, 0.0), good), (at(1.0, 0.0), good)].into_iter());
            let solved = batch.solve();
            assert_eq!((solved.smooth(0), solved.smooth(1)), (None, Some(at(0.5, 0.0))), "{bad:?}");
        }
    }
}
