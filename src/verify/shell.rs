//! The wall between the two sheets of a shell.

use super::case::{Case, weight};
use super::report::{ShellReport, Thickness};
use super::sampling::{Draw, each, largest};
use super::settings::Subject;
use crate::mesh::{TriMesh, weld};
use crate::run::Cancelled;
use crate::ssvh::Ssvh;
use glam::DVec3;

/// The part of a shell that a triangle belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Surface,
    Offset,
    Wall,
}

/// Measures the wall, if OUTPUT is a shell.
pub(super) fn shell(case: &Case) -> Result<Option<ShellReport>, Cancelled> {
    let Subject::Shell { thickness } = case.settings.subject else { return Ok(None) };
    let mesh = &case.output.mesh;
    let is_far: Vec<bool> = each(mesh.vertices.len(), case.run, |v, guess| {
        case.to_input(DVec3::from(mesh.vertices[v]), guess) > 0.5 * case.r.abs()
    })?;
    let part = |t: u32| match mesh.triangles[t as usize].map(|v| is_far[v as usize]) {
        [true, true, true] => Part::Offset,
        [false, false, false] => Part::Surface,
        _ => Part::Wall,
    };
    let of =
        |wanted| -> Vec<u32> { case.tree.order().iter().copied().filter(|&t| part(t) == wanted).collect() };
    let (surface, offset, wall) = (of(Part::Surface), of(Part::Offset), of(Part::Wall));
    Ok(Some(ShellReport {
        wanted: thickness.unwrap_or(case.r.abs()),
        surface_triangles: surface.len(),
        offset_triangles: offset.len(),
        wall_triangles: wall.len(),
        thickness: measure(case, &surface, &offset)?,
    }))
}

/// Measures the distances from the offset sheet to the sheet at the surface.
fn measure(case: &Case, surface: &[u32], offset: &[u32]) -> Result<Option<Thickness>, Cancelled> {
    if surface.is_empty() || offset.is_empty() {
        return Ok(None);
    }
    let mesh = &case.output.mesh;
    let triangles = surface.iter().map(|&t| mesh.triangles[t as usize]).collect();
    let (sheet, _) = weld(TriMesh { vertices: mesh.vertices.clone(), triangles });
    let ssvh = Ssvh::new(&sheet);
    let draw = Draw::new(offset.iter().map(|&t| weight(case.corners(t))));
    let drawn = draw.available(case.settings.samples);
    // Samples over the area, then every corner of every triangle.
    let count = drawn + 3 * offset.len();
    let at = |i: usize| match i.checked_sub(drawn) {
        None => case.random.on_triangle(i, case.corners(offset[draw.item(i, drawn, case.random)])),
        Some(corner) => case.corners(offset[corner / 3])[corner % 3],
    };
    let thickness = each(count, case.run, |i, guess| {
        let hit = ssvh.closest_from(at(i), *guess);
        *guess = hit.triangle;
        hit.distance_squared.sqrt()
    })?;
    let negative: Vec<f64> = thickness.iter().map(|t| -t).collect();
    let (Some((thinnest, min)), Some((thickest, max))) = (largest(&negative), largest(&thickness)) else {
        return Ok(None);
    };
    // Corners are denser where triangles are small, so the mean is that of the samples alone.
    let mean = thickness[..drawn].iter().sum::<f64>() / drawn.max(1) as f64;
    Ok(Some(Thickness {
        samples: count,
        min: case.scale.length(-min),
        mean: case.scale.length(mean),
        max: case.scale.length(max),
        min_at: at(thinnest).to_array(),
        max_at: at(thickest).to_array(),
    }))
}
