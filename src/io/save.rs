//! Saving: checks that a format can hold a mesh, and writes it whole or not at all.

use super::error::{SaveError, SaveErrorKind};
use super::{Format, atomic, obj, off, ply, stl};
use crate::mesh::TriMesh;
use crate::quantity::Precision;
use std::path::Path;

/// Options for writing a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SaveOptions {
    /// The number type of coordinates. STL holds 32-bit coordinates only. In text (OBJ, OFF) there
    /// are as many digits as a reader of 64 bits needs to get exactly that number.
    pub precision: Precision,
}

/// Saves `mesh` in the file `path`, in the format that belongs to the extension. An existing file
/// is replaced when the new one is complete, and left as it is when something fails.
///
/// # Errors
/// When the extension is unknown, the file cannot be written, or the format cannot hold the mesh.
pub fn save(mesh: &TriMesh, path: &Path, options: &SaveOptions) -> Result<(), SaveError> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let format = Format::of(path).map_err(|e| at(SaveErrorKind::Extension(e)))?;
    check_writable(mesh, format, options).map_err(at)?;
    atomic::write_atomically(path, |writer| match format {
        Format::Obj => obj::write(mesh, options.precision, writer),
        Format::Ply => ply::write(mesh, options.precision, writer),
        Format::Stl => stl::write(mesh, writer),
        Format::Off => off::write(mesh, options.precision, writer),
    })
}

impl TriMesh {
    /// Saves the mesh as it is, see [`save`]: with 32-bit coordinates where all of them are such
    /// numbers, and else with 64-bit ones. STL holds 32 bits only, and gets the nearest.
    ///
    /// # Errors
    /// See [`save`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        let path = path.as_ref();
        let is_single = |x: &f64| f64::from(*x as f32) == *x;
        let precision = match Format::of(path) {
            Ok(Format::Stl) => Precision::F32,
            _ if self.vertices.as_flattened().iter().all(is_single) => Precision::F32,
            _ => Precision::F64,
        };
        save(self, path, &SaveOptions { precision })
    }
}

/// Refuses, before the first byte is written, what would make a file that no one can read.
fn check_writable(mesh: &TriMesh, format: Format, options: &SaveOptions) -> Result<(), SaveErrorKind> {
    if format == Format::Stl && options.precision == Precision::F64 {
        return Err(SaveErrorKind::NoF64(format));
    }
    let single = options.precision == Precision::F32;
    let fits = |x: f64| if single { (x as f32).is_finite() } else { x.is_finite() };
    if let Some(vertex) = mesh.vertices.iter().position(|v| !v.iter().all(|&x| fits(x))) {
        return Err(SaveErrorKind::Coordinate { vertex, position: mesh.vertices[vertex] });
    }
    let in_range = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < mesh.vertices.len());
    if let Some(triangle) = mesh.triangles.iter().position(|t| !in_range(t)) {
        return Err(SaveErrorKind::VertexNumber { triangle });
    }
    // STL counts its triangles in 32 bits.
    if format == Format::Stl && u32::try_from(mesh.triangles.len()).is_err() {
        return Err(SaveErrorKind::TooManyTriangles);
    }
    Ok(())
}
