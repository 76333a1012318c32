//! Pictures of cross-sections: the true curve, and each method's outline over it.

use super::outline::outline;
use super::plane::{Segment, section};
use super::spots::Spot;
use super::svg::{Anchor, Svg};
use crate::compare::Comparison;
use crate::compare::table::error;
use crate::distance::SignedDistance;
use crate::run::RunSettings;
use glam::DVec2;
use std::fmt::Write;

/// Half the width of a picture in voxels: so near that a tenth of a voxel is four pixels.
const HALF: f64 = 3.5;

/// Pixels of a picture's width.
const SIDE: f64 = 340.0;

/// Pixels from the top of the square to the picture's upper and lower border: spots lie in the
/// middle and little happens far above and below.
const VISIBLE: [f64; 2] = [28.0, 312.0];

/// One picture per method: its outline over the true curve at the spot. The plane is the same, and
/// so is the scale.
pub fn panels(
    spot: &Spot,
    comparison: &Comparison,
    distance: &SignedDistance,
    run: &RunSettings,
) -> Vec<String> {
    let h = comparison.voxel;
    let half = HALF * h;
    let truth = outline(distance, comparison.distance, &spot.plane, half, run);
    let measured = comparison.results.iter().filter_map(|r| Some((r.method, r.mesh.as_ref()?)));
    measured
        .map(|(method, mesh)| {
            let cut = section(mesh, &spot.plane, half);
            let worst = worst(&cut, |p| (distance.at(spot.plane.at(p), 0).distance - comparison.distance).abs());
            let mut svg = Svg::new(SIDE, VISIBLE[1] - VISIBLE[0]);
            svg.bar([0.0, 0.0, SIDE, VISIBLE[1] - VISIBLE[0]], "#ffffff", 1.0);
            let colour = method.colour();
            let own = format!(
                r#"fill="none" stroke="{colour}" stroke-width="5" stroke-linecap="round" stroke-opacity="0.75""#
            );
            let solid = format!(r##"stroke="#e9edf1" stroke-width="{:.2}""##, 1.3 * truth.pitch * SIDE / (2.0 * half));
            svg.path(&path(&truth.inside, half), &solid);
            svg.path(&path(&cut, half), &own);
            svg.path(&path(&truth.curve, half), r##"fill="none" stroke="#111" stroke-width="1.5""##);
            for corner in cut.iter().map(|s| pixels(s[0], half)) {
                let dot = format!("M{:.1} {:.1}h0", corner.x, corner.y);
                svg.path(&dot, &format!(r#"stroke="{colour}" stroke-width="7" stroke-linecap="round""#));
            }
            scale_bar(&mut svg);
            let caption = match worst {
                Some(e) => format!("off by up to {} voxels here", error(e / h)),
                None => "nothing here".into(),
            };
            let label = format!("{} at: {}", method.title(), spot.title());
            let chip = format!(r#"<span class="chip" style="background:{colour}"></span>"#);
            let picture = svg.finish(&label);
            format!(
                r#"<div class="panel">{picture}<p>{chip}<b>{}</b><br><span class="faint">{caption}</span></p></div>"#,
                method.title()
            )
        })
        .collect()
}

/// The largest error along an outline: at the ends of its segments and between.
fn worst(segments: &[Segment], error: impl Fn(DVec2) -> f64) -> Option<f64> {
    // Between the ends a straight segment may cut a corner of the truth: a few points find it.
    const POINTS: u32 = 8;
    let along = |s: &Segment, k: u32| s[0].lerp(s[1], f64::from(k) / f64::from(POINTS));
    let all = segments.iter().flat_map(|s| (0..=POINTS).map(move |k| along(s, k)));
    all.map(error).reduce(f64::max)
}

fn pixels(p: DVec2, half: f64) -> DVec2 {
    DVec2::new(p.x + half, half - p.y) * (SIDE / (2.0 * half)) - DVec2::new(0.0, VISIBLE[0])
}

fn path(segments: &[Segment], half: f64) -> String {
    let mut d = String::new();
    for [a, b] in segments.iter().map(|s| s.map(|p| pixels(p, half))) {
        let _ = write!(d, "M{:.1} {:.1}L{:.1} {:.1}", a.x, a.y, b.x, b.y);
    }
    d
}

fn scale_bar(svg: &mut Svg) {
    let voxel = SIDE / (2.0 * HALF);
    // Below the middle, within the solid: the curve passes through the middle and leaves at the
    // borders.
    let (x, y) = (0.5 * (SIDE - voxel), VISIBLE[1] - VISIBLE[0] - 14.0);
    svg.line([x, y, x + voxel, y], "scale");
    svg.text([x + 0.5 * voxel, y - 6.0], Anchor::Middle, "tick", "1 voxel");
}
