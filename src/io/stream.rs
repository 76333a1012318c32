//! A mesh written piece by piece, by someone who never holds all of it.
//!
//! A PLY file has all vertices before the first face, and the numbers of both before either. So
//! vertices and faces go to files without a name beside the target, and are put together at the
//! end. STL takes triangles as they come, and gets their number at the end.

use super::atomic::directory_of;
use super::error::{SaveError, SaveErrorKind};
use super::{Format, ply, stl};
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::mesh::MeshChunk;
use crate::quantity::Precision;

/// Bytes collected before they are written.
const BUFFER: usize = 1 << 20;

/// A mesh file in the making: the same bytes as [`save`](super::save) writes of the mesh as a
/// whole.
#[derive(Debug)]
pub struct MeshStream {
    path: PathBuf,
    coordinates: Precision,
    vertices: u64,
    triangles: u64,
    body: Body,
}

#[derive(Debug)]
enum Body {
    /// Vertices and faces, to be put together.
    Ply([BufWriter<File>; 2]),
    /// The file itself.
    Stl(BufWriter<File>),
}

impl MeshStream {
    /// Creates the file `path`, or empties it: PLY or STL, by its extension. Unlike
    /// [`save`](super::save) this writes in place; the file is whole only after
    /// [`finish`](Self::finish).
    ///
    /// # Errors
    /// When the extension is another one, or no file can be created there.
    pub fn create(path: &Path, coordinates: Precision) -> Result<MeshStream, SaveError> {
        let at = |kind| SaveError { path: path.to_path_buf(), kind };
        let format = Format::of(path).map_err(|e| at(SaveErrorKind::Extension(e)))?;
        let create = || -> io::Result<Option<Body>> {
            let buffered = |file| BufWriter::with_capacity(BUFFER, file);
            let directory = directory_of(path);
            Ok(match format {
                Format::Ply => {
                    let part = || tempfile::tempfile_in(directory);
                    Some(Body::Ply([buffered(part()?), buffered(part()?)]))
                }
                Format::Stl => {
                    let mut file = buffered(File::create(path)?);
                    file.write_all(&stl::head(0))?;
                    Some(Body::Stl(file))
                }
                Format::Obj | Format::Off => None,
            })
        };
        let body = create().map_err(|e| at(SaveErrorKind::Create(e)))?;
        let body = body.ok_or_else(|| at(SaveErrorKind::NotInPieces(format)))?;
        Ok(MeshStream { path: path.to_path_buf(), coordinates, vertices: 0, triangles: 0, body })
    }

    /// Adds a chunk. Chunks come in the order of the whole, the first one with vertex 0.
    ///
    /// # Errors
    /// When writing fails, or the format cannot hold the mesh.
    pub fn append(&mut self, chunk: &MeshChunk) -> Result<(), SaveError> {
        let own = chunk.vertices();
        let single = matches!(self.body, Body::Stl(_)) || self.coordinates == Precision::F32;
        let fits = |x: f64| if single { (x as f32).is_finite() } else { x.is_finite() };
        if let Some(vertex) = own.iter().position(|v| !v.iter().all(|&x| fits(x))) {
            return Err(self.failed(SaveErrorKind::Coordinate { vertex, position: own[vertex] }));
        }
        self.vertices += own.len() as u64;
        self.triangles += chunk.triangle_count() as u64;
        let limit = u64::from(u32::MAX);
        if self.vertices > limit || matches!(self.body, Body::Stl(_)) && self.triangles > limit {
            return Err(self.failed(SaveErrorKind::TooManyTriangles));
        }
        let written = match &mut self.body {
            Body::Ply([body, faces]) => ply::write_vertices(own, self.coordinates, body)
                .and_then(|()| ply::write_faces(chunk.triangles().map(|t| t.map(|v| v as u32)), faces)),
            Body::Stl(file) => stl::write_triangles(chunk.corners(), file),
        };
        written.map_err(|e| self.failed(SaveErrorKind::Write(e)))
    }

    /// Forgets all that was added.
    ///
    /// # Errors
    /// When the files cannot be emptied.
    pub fn clear(&mut self) -> Result<(), SaveError> {
        let empty = |file: &mut BufWriter<File>, keep: u64| {
            file.flush()?;
            file.get_ref().set_len(keep)?;
            file.seek(SeekFrom::Start(keep)).map(|_| ())
        };
        (self.vertices, self.triangles) = (0, 0);
        let emptied = match &mut self.body {
            Body::Ply(parts) => parts.iter_mut().try_for_each(|part| empty(part, 0)),
            Body::Stl(file) => empty(file, stl::HEAD as u64),
        };
        emptied.map_err(|e| self.failed(SaveErrorKind::Write(e)))
    }

    /// Completes the file. Returns the numbers of vertices and triangles.
    ///
    /// # Errors
    /// When writing fails.
    pub fn finish(self) -> Result<(u64, u64), SaveError> {
        let MeshStream { path, coordinates, vertices, triangles, body } = self;
        let finish = || -> io::Result<()> {
            match body {
                Body::Ply(parts) => {
                    let mut file = File::create(&path)?;
                    file.write_all(&ply::header(vertices, triangles, coordinates, &[]))?;
                    for part in parts {
                        let mut part = part.into_inner().map_err(io::IntoInnerError::into_error)?;
                        part.rewind()?;
                        io::copy(&mut part, &mut file)?;
                    }
                    Ok(())
                }
                Body::Stl(file) => {
                    let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                    file.rewind()?;
                    file.write_all(&stl::head(triangles as u32))
                }
            }
        };
        finish().map_err(|e| SaveError { path: path.clone(), kind: SaveErrorKind::Write(e) })?;
        Ok((vertices, triangles))
    }

    fn failed(&self, kind: SaveErrorKind) -> SaveError {
        SaveError { path: self.path.clone(), kind }
    }
}
