//! Eigenvalues and eigenvectors of symmetric 3x3 matrices.

use glam::DVec3;

/// A symmetric 3x3 matrix by its upper triangle: xx, xy, xz, yy, yz, zz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym3(pub [f64; 6]);

impl Sym3 {
    /// Adds w v v^T.
    pub fn add_outer(&mut self, v: DVec3, w: f64) {
        let m = &mut self.0;
        m[0] += w * v.x * v.x;
        m[1] += w * v.x * v.y;
        m[2] += w * v.x * v.z;
        m[3] += w * v.y * v.y;
        m[4] += w * v.y * v.z;
        m[5] += w * v.z * v.z;
    }

    /// Eigenvalues in descending order with orthonormal eigenvectors, by cyclic Jacobi rotations.
    pub fn eigen(&self) -> ([f64; 3], [DVec3; 3]) {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        // Jacobi converges quadratically: three to five sweeps reach rounding for 3x3.
        for _ in 0..8 {
            let off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
            let scale = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
            if off <= 1e-32 * scale {
                break;
            }
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                rotate(&mut a, &mut v, p, q);
            }
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
        (order.map(|i| a[i][i]), order.map(|i| DVec3::new(v[0][i], v[1][i], v[2][i])))
    }
}

/// One Jacobi rotation that zeroes a[p][q].
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let r = 3 - p - q;
    let (app, aqq, apq) = (a[p][p], a[q][q], a[p][q]);
    a[p][p] = app - t * apq;
    a[q][q] = aqq + t * apq;
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    let (arp, arq) = (a[r][p], a[r][q]);
    a[r][p] = c * arp - s * arq;
    a[p][r] = a[r][p];
    a[r][q] = s * arp + c * arq;
    a[q][r] = a[r][q];
    for row in v.iter_mut() {
        let (vp, vq) = (row[p], row[q]);
        row[p] = c * vp - s * vq;
        row[q] = s * vp + c * vq;
    }
}
