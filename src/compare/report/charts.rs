//! Bars of time and memory, and the errors by size.

use super::svg::{Anchor, Svg};
use crate::compare::table::{count, error, seconds};
use crate::compare::{Comparison, Measurement, Method};
use crate::verify::VerifyReport;

const WIDTH: f64 = 1080.0;
/// Left end of the bars, in pixels: room for the longest name of a method.
const LEFT: f64 = 215.0;
/// Room for the numbers behind the longest bar.
const RIGHT: f64 = 130.0;
const BAR: f64 = 26.0;
const PITCH: f64 = 38.0;

/// Horizontal bars of the engine's time, divided by phase.
pub fn times(comparison: &Comparison) -> String {
    bars(comparison, "Time of each method by phase", [1.0, 0.62, 0.85, 0.45], |m| {
        let mut parts: Vec<(String, f64)> = m.phases.iter().map(|p| (p.name.clone(), p.seconds)).collect();
        let rest = m.engine - parts.iter().map(|p| p.1).sum::<f64>();
        let name = if parts.is_empty() { "all in one" } else { "" };
        parts.push((name.into(), rest.max(0.0)));
        Some((parts, format!("{} s", seconds(m.engine))))
    })
}

/// Horizontal bars of the peak memory: what was there before the method began, and what it added.
pub fn memory(comparison: &Comparison) -> String {
    let megabytes = |bytes: u64| bytes as f64 / 1_048_576.0;
    bars(comparison, "Peak memory of each method", [0.4, 1.0, 1.0, 1.0], |m| {
        let peak = m.peak_memory?;
        let before = m.memory_before.unwrap_or(0).min(peak);
        let parts = vec![("before".into(), megabytes(before)), ("added".into(), megabytes(peak - before))];
        Some((parts, format!("{} MB", count(megabytes(peak)))))
    })
}

type Parts = (Vec<(String, f64)>, String);

/// Bars in parts; neighbours differ in strength, not in hue: the hue is the method's.
fn bars(
    comparison: &Comparison,
    label: &str,
    strengths: [f64; 4],
    parts: impl Fn(&Measurement) -> Option<Parts>,
) -> String {
    let rows: Vec<(Method, Option<Parts>)> =
        comparison.results.iter().map(|r| (r.method, r.median.as_ref().and_then(&parts))).collect();
    let total = |parts: &Parts| parts.0.iter().map(|p| p.1).sum::<f64>();
    let largest = rows.iter().filter_map(|(_, p)| p.as_ref().map(total)).fold(0.0, f64::max);
    let scale = (WIDTH - LEFT - RIGHT) / largest.max(f64::MIN_POSITIVE);
    let mut svg = Svg::new(WIDTH, PITCH * rows.len() as f64 + 8.0);
    for (k, (method, parts)) in rows.iter().enumerate() {
        let y = PITCH * k as f64 + 6.0;
        let class = if *method == Method::Exocarp { "name own" } else { "name" };
        svg.text([LEFT - 12.0, y + 18.0], Anchor::End, class, method.title());
        let Some((parts, value)) = parts else {
            svg.text([LEFT, y + 18.0], Anchor::Start, "faint", "no measurement");
            continue;
        };
        let mut x = LEFT;
        for (n, (name, size)) in parts.iter().enumerate() {
            let width = size * scale;
            let opacity = strengths[n % 4];
            svg.bar([x, y, (width - 1.0).max(0.5), BAR], method.colour(), opacity);
            // A name needs about seven pixels per letter.
            if width > 7.5 * name.len() as f64 + 8.0 {
                let class = if opacity > 0.8 { "inside" } else { "inside dark" };
                svg.text([x + 6.0, y + 17.5], Anchor::Start, class, name);
            }
            x += width;
        }
        svg.text([x + 8.0, y + 18.0], Anchor::Start, "value", value);
    }
    svg.finish(label)
}

/// Powers of ten of the error axis, in voxels.
const DECADES: std::ops::RangeInclusive<i32> = -6..=1;
/// Powers of ten of a histogram's height: one part in a million of the surface is at the bottom.
const DEPTH: f64 = 6.0;
const RIDGE: f64 = 62.0;

/// The errors of each method by size, both axes logarithmic, one above the other.
pub fn errors(comparison: &Comparison) -> String {
    let judged: Vec<(Method, &VerifyReport)> =
        comparison.results.iter().filter_map(|r| Some((r.method, r.quality.as_ref()?))).collect();
    let (low, high) = (f64::from(*DECADES.start()), f64::from(*DECADES.end()));
    let right = WIDTH - RIGHT;
    let x_of = |error: f64| {
        let power = error.max(f64::MIN_POSITIVE).log10().clamp(low, high);
        LEFT + (power - low) / (high - low) * (right - LEFT)
    };
    let bottom = (RIDGE + 14.0) * judged.len() as f64 + 6.0;
    let mut svg = Svg::new(WIDTH, bottom + 44.0);
    for power in DECADES {
        let x = x_of(10f64.powi(power));
        svg.line([x, 0.0, x, bottom], "grid");
        let label = match power {
            -2..=1 => format!("{}", 10f64.powi(power)),
            _ => format!("1e{power}"),
        };
        svg.text([x, bottom + 16.0], Anchor::Middle, "tick", &label);
    }
    svg.text([0.5 * (LEFT + right), bottom + 36.0], Anchor::Middle, "tick", "error in voxels");
    for (k, (method, quality)) in judged.iter().enumerate() {
        let base = (RIDGE + 14.0) * (k + 1) as f64;
        ridge(&mut svg, *method, quality, comparison, base, x_of);
    }
    svg.finish("Errors of each method by size")
}

fn ridge(
    svg: &mut Svg,
    method: Method,
    quality: &VerifyReport,
    comparison: &Comparison,
    base: f64,
    x_of: impl Fn(f64) -> f64,
) {
    let histogram = &quality.distance.histogram;
    let all = histogram.counts.iter().sum::<u64>().max(1) as f64;
    let voxels = comparison.diagonal / comparison.voxel;
    let edge = |bin: usize| {
        let power = f64::from(histogram.first) + bin as f64 / f64::from(histogram.per_decade.max(1));
        x_of(10f64.powf(power) * voxels)
    };
    let mut d = format!("M{:.1} {base:.1}", edge(0));
    for (bin, n) in histogram.counts.iter().enumerate() {
        let share = *n as f64 / all;
        let height = if *n == 0 { 0.0 } else { ((share.log10() + DEPTH) / DEPTH).max(0.0) * RIDGE };
        let y = base - height;
        d += &format!("L{:.1} {y:.1}L{:.1} {y:.1}", edge(bin), edge(bin + 1));
    }
    d += &format!("L{:.1} {base:.1}Z", edge(histogram.counts.len()));
    let colour = method.colour();
    svg.path(&d, &format!(r#"fill="{colour}" fill-opacity="0.35" stroke="{colour}" stroke-width="1.2""#));
    svg.line([LEFT, base, WIDTH - RIGHT, base], "axis");
    let class = if method == Method::Exocarp { "name own" } else { "name" };
    svg.text([LEFT - 12.0, base - 6.0], Anchor::End, class, method.title());
    let mean = quality.distance.surface.mean.voxels.unwrap_or(0.0);
    let max = quality.distance.max.voxels.unwrap_or(0.0);
    let (x_mean, x_max) = (x_of(mean), x_of(max));
    svg.line([x_mean, base - RIDGE, x_mean, base], "mean");
    svg.line([x_max, base - 0.45 * RIDGE, x_max, base], "worst");
    svg.text([WIDTH - RIGHT + 10.0, base - 22.0], Anchor::Start, "value", &format!("mean {}", error(mean)));
    svg.text([WIDTH - RIGHT + 10.0, base - 4.0], Anchor::Start, "value", &format!("max {}", error(max)));
}
