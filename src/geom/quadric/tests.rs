use super::*;

fn unit_box() -> Vec<HalfSpace> {
    (0..3)
        .flat_map(|a| {
            let normal = DVec3::AXES[a];
            [HalfSpace { normal, offset: 0.0 }, HalfSpace { normal: -normal, offset: -1.0 }]
        })
        .collect()
}

fn qef(planes: &[([f64; 3], [f64; 3])]) -> Qef {
    let mut qef = Qef::default();
    for &(point, normal) in planes {
        let normal = DVec3::from(normal);
        qef.add(point.into(), normal / normal.length());
    }
    qef
}

fn close(a: DVec3, b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9)
}

#[test]
fn three_planes_give_their_corner() {
    let corner = [0.3, 0.6, 0.2];
    let q = qef(&[
        ([0.3, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ([1.0, 0.6, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 1.0, 0.2], [0.0, 0.0, 1.0]),
    ]);
    assert!(close(q.minimiser().point, corner));
}

#[test]
fn what_the_planes_leave_open_stays_at_the_mean() {
    let flat = qef(&[([0.0, 0.0, 0.5], [0.0, 0.0, 1.0]), ([1.0, 0.0, 0.5], [0.0, 0.0, 1.0])]);
    assert!(close(flat.minimiser().point, [0.5, 0.0, 0.5]));
    let crease = qef(&[([0.2, 0.4, 0.0], [1.0, 0.0, 1.0]), ([0.6, 0.8, 0.0], [-1.0, 0.0, 1.0])]);
    assert!(close(crease.minimiser().point, [0.4, 0.6, -0.2]));
    let mut no_normals = Qef::default();
    no_normals.add(DVec3::splat(0.25), DVec3::new(f64::NAN, 0.0, 0.0));
    no_normals.add(DVec3::splat(0.75), DVec3::ZERO);
    assert!(close(no_normals.minimiser().point, [0.5; 3]));
}

/// The constrained minimum against a search over a fine grid.
#[test]
fn no_point_of_the_region_is_better() {
    let mut state = 9u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut outside = 0;
    for round in 0..300 {
        let mut planes = Vec::new();
        for _ in 0..3 + round % 4 {
            planes.push((std::array::from_fn(|_| random()), std::array::from_fn(|_| 2.0 * random() - 1.0)));
        }
        let minimiser = qef(&planes).minimiser();
        let mut region = unit_box();
        if round % 2 == 0 {
            region.push(HalfSpace { normal: -DVec3::ONE, offset: -1.0 });
        }
        let best = minimiser.within(&region).unwrap();
        assert!(region.iter().all(|half| half.depth(best) >= -TOLERANCE));
        outside += usize::from(best != minimiser.point);
        let error = |w: DVec3| {
            let d = w - minimiser.point;
            let parts = minimiser.vectors.iter().zip(minimiser.weights);
            parts.map(|(v, weight)| weight * v.dot(d).powi(2)).sum::<f64>()
        };
        let steps = 12;
        for n in 0..(steps + 1) * (steps + 1) * (steps + 1) {
            let w = DVec3::from([n / 169, n / 13 % 13, n % 13].map(|i| f64::from(i) / f64::from(steps)));
            if region.iter().all(|half| half.depth(w) >= 0.0) {
                assert!(error(w) >= error(best) - 1e-9, "round {round}: {w:?} is better than {best:?}");
            }
        }
    }
    assert!(outside > 100, "{outside}");
}
