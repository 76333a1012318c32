//! `--thickness-map`: a thickness for each vertex of the input file.

use super::exit::{Exit, Failure};
use super::files::check_input;
use exocarp::internals::io::vertex_property;
use exocarp::{TriMesh, io};
use std::collections::HashMap;
use std::path::Path;

/// The vertices' property that a map in a PLY file is.
const PROPERTY: &str = "thickness";

/// The values of the map in `path` for the vertices of `mesh`, which is what cleaning made of
/// `input`.
///
/// The map is the property `thickness` of the vertices of a PLY file, or text: numbers in the order
/// of the file's vertices, separated by blanks or line ends; `#` begins a comment.
pub(super) fn load(path: &Path, input: &Path, mesh: &TriMesh) -> Result<Vec<f64>, Failure> {
    check_input(path)?;
    let shown = path.display();
    let is_ply = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"));
    let values = if is_ply { property(path)? } else { text(path)? };
    let io::Loaded { mesh: raw, left_out, .. } = io::load_with_notes(input)?;
    let of_file = raw.vertices.len() + left_out.len();
    if of_file != values.len() {
        return Err(Failure::new(
            Exit::Input,
            format!(
                "{shown} has {} values, and {} has {of_file} vertices: the map needs one for each",
                values.len(),
                input.display(),
            ),
        ));
    }
    let mut left_out = left_out.into_iter().peekable();
    let kept = (0..).zip(values).filter(|(v, _)| left_out.next_if_eq(v).is_none()).map(|(_, value)| value);
    // Cleaning drops and joins vertices, and moves none.
    let of_point: HashMap<[u64; 3], f64> = raw.vertices.iter().map(key).zip(kept).collect();
    Ok(mesh.vertices.iter().map(|v| of_point.get(&key(v)).copied().unwrap_or(f64::NAN)).collect())
}

/// Precision as bits; both zeros are one.
fn key(v: &[f64; 3]) -> [u64; 3] {
    v.map(|x| (x + 0.0).to_bits())
}

fn property(path: &Path) -> Result<Vec<f64>, Failure> {
    let bad = |reason: String| Failure::new(Exit::Input, format!("{}: {reason}", path.display()));
    let values = vertex_property(path, PROPERTY)?
        .ok_or_else(|| bad(format!("the vertices have no property {PROPERTY}; name it so, or give text")))?;
    match values.iter().position(|value| !is_thickness(*value)) {
        Some(n) => {
            Err(bad(format!("a thickness must be a positive number, and vertex {n} has {}", values[n])))
        }
        None => Ok(values),
    }
}

fn text(path: &Path) -> Result<Vec<f64>, Failure> {
    let shown = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| {
        Failure::new(
            Exit::Input,
            format!("{shown} cannot be read ({error}); check the path and the permissions"),
        )
    })?;
    let mut values = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        for word in line.split('#').next().unwrap_or_default().split_whitespace() {
            let value = word.parse::<f64>().ok().filter(|value| is_thickness(*value));
            values.push(value.ok_or_else(|| {
                Failure::new(
                    Exit::Input,
                    format!("{shown}, line {number}: a thickness must be a positive number, not {word}"),
                )
            })?);
        }
    }
    Ok(values)
}

fn is_thickness(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}
