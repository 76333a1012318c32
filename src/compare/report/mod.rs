//! The report: one HTML page with everything in it, that opens without a network and prints well.

mod charts;
mod outline;
mod plane;
mod raster;
mod sections;
mod shade;
mod spots;
mod svg;
#[cfg(test)]
mod tests;

pub use outline::{Outline, outline};
pub use plane::{Plane, Segment, section};
pub use raster::{Camera, Frame, Hit, raster};
pub use shade::{RAMP_ENDS, Truth, Wires, ramp, shaded};
pub use spots::{Kind, Spot, spots};

use super::CompareError;
use super::table::{Column, rows};
use super::{Comparison, MethodResult};
use crate::distance::SignedDistance;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use glam::DVec3;
use std::fmt::Write;
use svg::escaped;

const STYLE: &str = include_str!("style.css");

/// Pixels of a rendering's side: two beside each other on a page, and small enough to send around.
const RENDERED: usize = 420;

/// Half the width of a close-up in voxels: the triangles can be counted.
const CLOSE: f64 = 14.0;

/// The page for `comparison` of offsets of `mesh`; `title` is the name of the input.
///
/// # Errors
/// [`CompareError::Cancelled`]; [`CompareError::Picture`] when a picture cannot be encoded.
pub fn page(
    comparison: &Comparison,
    mesh: &TriMesh,
    title: &str,
    run: &RunSettings,
) -> Result<String, CompareError> {
    let topology = run.install(|| Topology::new(mesh));
    let distance = run.install(|| SignedDistance::new(mesh, &topology));
    let spots = spots(comparison, &distance, run);
    let mut body = head(comparison, title);
    body += &table(comparison);
    body += &figure(
        "time",
        "Time",
        "Wall time from the mesh in memory to the offset surface in memory, by phase. Shorter is better; files \
         are not read or written in it.",
        &charts::times(comparison),
    );
    body += &figure(
        "memory",
        "Memory",
        "The most memory that each process had resident. The paler part was there before the method began: the \
         program, its libraries, the input (and for MeshLib the Python interpreter).",
        &charts::memory(comparison),
    );
    body += &figure(
        "errors",
        "Errors",
        "How much of each surface is how far from the true offset: further left is better. Both axes are \
         logarithmic; the height goes from one part in a million of the surface to all of it. The dashed line is \
         the mean, the short black one the largest error anywhere.",
        &charts::errors(comparison),
    );
    for (k, spot) in spots.iter().enumerate() {
        run.check()?;
        let panels = sections::panels(spot, comparison, &distance, run).concat();
        let caption = "The true offset curve (thin, black) and each method's outline (wide, in colour, its \
                       corners as dots) on the same plane, at the same scale; the true solid is grey. Where black leaves \
                       the colour, the surface is wrong.";
        let panels = grid(comparison, &panels);
        body += &figure(&format!("section-{}", k + 1), &spot.title(), caption, &panels);
    }
    body += &renderings(comparison, &distance, &spots, run)?;
    let title = escaped(title);
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{title}: offsets compared</title>\
         <style>{STYLE}</style></head>\n<body><main>{body}</main></body></html>\n"
    ))
}

fn head(comparison: &Comparison, title: &str) -> String {
    let c = comparison;
    let mut text = format!("<h1>{}: offsets compared</h1>", escaped(title));
    let threads = if c.threads == 1 { "1 thread".into() } else { format!("{} threads", c.threads) };
    let runs = if c.runs == 1 { "one run".into() } else { format!("medians of {} runs", c.runs) };
    let _ = write!(
        text,
        r#"<p class="facts">{} triangles, offset by {:+.3}% of the diagonal ({:+.1} voxels), voxel size {:.4}% of
        the diagonal. {threads} on a machine with {}; {runs}, in turn, each in a process of its own.</p>"#,
        super::table::count(c.input_triangles as f64),
        100.0 * c.distance / c.diagonal,
        c.distance / c.voxel,
        100.0 * c.voxel / c.diagonal,
        escaped(&c.machine),
    );
    for note in &c.notes {
        let _ = write!(text, r#"<p class="note">{}</p>"#, escaped(note));
    }
    text
}

fn table(comparison: &Comparison) -> String {
    let mut html = String::from(r#"<table id="table"><thead><tr><th></th>"#);
    for column in &Column::ALL {
        let unit = if column.unit.is_empty() { "&nbsp;" } else { column.unit };
        let _ = write!(
            html,
            r#"<th title="{}">{}<small>{unit}</small></th>"#,
            escaped(column.about),
            column.name
        );
    }
    html += "</tr></thead><tbody>";
    for row in rows(comparison) {
        let method = row.result.method;
        let _ = write!(
            html,
            r#"<tr id="row-{}"><th title="{}"><span class="chip" style="background:{}"></span>{}</th>"#,
            method.name(),
            escaped(method.recipe()),
            method.colour(),
            method.title()
        );
        for (text, best) in &row.cells {
            let class = if *best { r#" class="best""# } else { "" };
            let _ = write!(html, "<td{class}>{text}</td>");
        }
        if let Some(lost) = &row.result.lost {
            let width = Column::ALL.len();
            let lost = escaped(&lost.to_string());
            match row.cells.is_empty() {
                true => {
                    let _ = write!(html, r#"<td class="lost" colspan="{width}">{lost}</td>"#);
                }
                false => {
                    let _ =
                        write!(html, r#"</tr><tr><th></th><td class="lost" colspan="{width}">{lost}</td>"#);
                }
            }
        }
        html += "</tr>";
    }
    html += "</tbody></table>";
    let about: Vec<String> =
        Column::ALL.iter().map(|c| format!("<b>{}</b>: {}", c.name, escaped(c.about))).collect();
    format!(r#"{html}<p class="about">Bold is the best of a column. {}.</p>"#, about.join("; "))
}

fn figure(id: &str, title: &str, caption: &str, content: &str) -> String {
    format!(
        "<figure id=\"fig-{id}\"><h2>{}</h2><figcaption>{caption}</figcaption>{content}</figure>\n",
        escaped(title)
    )
}

/// The rendered pictures: the whole of each surface, and the surroundings of the first spot.
fn renderings(
    comparison: &Comparison,
    distance: &SignedDistance,
    spots: &[Spot],
    run: &RunSettings,
) -> Result<String, CompareError> {
    let truth = Truth { distance, r: comparison.distance, voxel: comparison.voxel };
    let drawn = |camera: &Camera, wires: Wires| -> Result<String, CompareError> {
        let mut panels = String::new();
        for (result, mesh) in with_mesh(comparison) {
            run.check()?;
            let png = shaded(mesh, &truth, camera, RENDERED, wires, run)?;
            panels += &rendering(result, &png);
        }
        Ok(legend() + &grid(comparison, &panels))
    };
    let mut html = String::new();
    if let Some((_, mesh)) = with_mesh(comparison).next() {
        // Three quarters from above: most models stand along y.
        let camera = Camera::around(mesh, DVec3::new(0.55, 0.4, 0.75), DVec3::Y);
        html += &figure(
            "whole",
            "The surfaces, coloured by their error",
            "Pale is right to a thousandth of a voxel, dark is wrong by a voxel. The error is measured at the point \
             that each pixel shows.",
            &drawn(&camera, Wires::Hidden)?,
        );
    }
    if let Some(spot) = spots.first() {
        let section = spot.plane;
        // From above the surface, a little along the crease, so that its edge is seen against the
        // light.
        let towards = section.up * 0.8 + section.normal() * 0.55 + section.right * 0.25;
        let camera = Camera::at(section.origin, CLOSE * comparison.voxel, towards, section.up);
        html += &figure(
            "close",
            "Close up",
            "The same spot as in the first cross-section, with the triangles' edges. A crease that is kept is a \
             clean line; one that is lost is a dark band.",
            &drawn(&camera, Wires::Drawn)?,
        );
    }
    Ok(html)
}

/// Pictures beside each other, one per method: in rows of three, or all in one row of up to four.
fn grid(comparison: &Comparison, panels: &str) -> String {
    let columns = match with_mesh(comparison).count() {
        n @ 2..=4 => n,
        _ => 3,
    };
    format!(r#"<div class="panels of{columns}">{panels}</div>"#)
}

fn with_mesh(comparison: &Comparison) -> impl Iterator<Item = (&MethodResult, &TriMesh)> {
    comparison.results.iter().filter_map(|r| Some((r, r.mesh.as_ref()?)))
}

fn rendering(result: &MethodResult, png: &[u8]) -> String {
    let title = result.method.title();
    format!(
        r#"<div class="panel"><img width="{RENDERED}" height="{RENDERED}" alt="{title}" src="{}"><p><span class="chip" style="background:{}"></span><b>{title}</b></p></div>"#,
        shade::data_uri(png),
        result.method.colour(),
    )
}

/// The colour ramp with its numbers.
fn legend() -> String {
    let [low, high] = RAMP_ENDS.map(f64::log10);
    let stops: Vec<String> = (0..=12)
        .map(|k| {
            let [r, g, b] = ramp(10f64.powf(low + (high - low) * f64::from(k) / 12.0));
            format!("rgb({r},{g},{b})")
        })
        .collect();
    format!(
        r#"<div class="legend"><div class="ramp" style="background:linear-gradient(to right,{})"></div><div class="ticks"><span>0.001 or less</span><span>0.01</span><span>0.1 voxels</span><span>1 or more</span></div></div>"#,
        stops.join(",")
    )
}
