//! Tiles of meshes: PLY and STL files that any program reads.
//!
//! What a file is a tile of stands in a comment (PLY) or in the title (STL). Its own vertices come
//! first, in the order of the whole; after them those vertices of other tiles that its triangles
//! need. No two vertices of the whole are at one position, so a vertex is known by that.

use super::error::{LoadErrorKind, SaveError, SaveErrorKind};
use super::tile::{MergeError, MergeErrorKind, Tile, check_complete};
use super::{Format, ply, stl};
use crate::mesh::MeshChunk;
use crate::quantity::Precision;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Saves a chunk of a mesh as a tile, in place: not atomically. The chunk may have no triangles.
///
/// # Errors
/// When the extension is not that of PLY or STL, or writing fails.
pub fn save_tile(
    path: &Path,
    chunk: &MeshChunk,
    tile: Tile,
    coordinates: Precision,
) -> Result<(), SaveError> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let format = Format::of(path).map_err(|e| at(SaveErrorKind::Extension(e)))?;
    let write = || -> io::Result<Option<()>> {
        let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
        match format {
            Format::Ply => {
                let own = chunk.vertices().len() as u64;
                let (all, numbered) = with_others(chunk);
                let comments = [tile.text(&own_vertices(own))];
                let header = ply::header(all.len() as u64, numbered.len() as u64, coordinates, &comments);
                file.write_all(&header)?;
                ply::write_vertices(&all, coordinates, &mut file)?;
                ply::write_faces(numbered, &mut file)?;
            }
            Format::Stl => {
                let title = tile.text(&own_vertices(chunk.vertices().len() as u64));
                file.write_all(&stl::titled_head(&title, chunk.triangle_count() as u32))?;
                stl::write_triangles(chunk.corners(), &mut file)?;
            }
            Format::Obj | Format::Off => return Ok(None),
        }
        file.flush().map(Some)
    };
    write().map_err(|e| at(SaveErrorKind::Write(e)))?.ok_or_else(|| at(SaveErrorKind::NotInPieces(format)))
}

/// The note on how many vertices of a file are its own.
fn own_vertices(count: u64) -> String {
    format!("{count} own vertices")
}

/// A tile, and how many vertices are its own.
fn parse(text: &str) -> Option<(Tile, u64)> {
    let (tile, note) = Tile::parse(text)?;
    Some((tile, note.strip_suffix(" own vertices")?.parse().ok()?))
}

/// Returns the vertices of a chunk and after them the others that its triangles need; and the
/// triangles with their numbers among these.
fn with_others(chunk: &MeshChunk) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mesh, vertices, used) = (chunk.around(), chunk.local_vertices(), chunk.local_triangles());
    let is_own = |v: u32| vertices.contains(&(v as usize));
    let mut others: Vec<u32> = used.as_flattened().iter().copied().filter(|&v| !is_own(v)).collect();
    others.sort_unstable();
    others.dedup();
    let mut all = mesh.vertices[vertices.clone()].to_vec();
    all.extend(others.iter().map(|&v| mesh.vertices[v as usize]));
    let number = |v: u32| {
        let place = match others.binary_search(&v) {
            Ok(n) => vertices.len() + n,
            Err(_) => v as usize - vertices.start,
        };
        place as u32
    };
    (all, used.iter().map(|t| t.map(number)).collect())
}

/// A tile's file.
struct TileFile {
    path: PathBuf,
    format: Format,
    tile: Tile,
    own: u64,
    vertices: u64,
    triangles: u64,
    coordinates: Precision,
    /// First byte of the vertices, or of the triangles of STL.
    body: u64,
}

impl TileFile {
    fn open(path: &Path) -> Result<TileFile, MergeError> {
        let at = |kind| MergeError { path: path.to_path_buf(), kind };
        let format = Format::of(path).map_err(|_| at(MergeErrorKind::NotATile))?;
        let file = super::load::open(path).map_err(|kind| match kind {
            LoadErrorKind::Open(e) => at(MergeErrorKind::Read(e)),
            _ => at(MergeErrorKind::NotATile),
        })?;
        let mut file = BufReader::new(file);
        let opened = match format {
            Format::Ply => Self::ply(path, &mut file),
            Format::Stl => Self::stl(path, &mut file),
            Format::Obj | Format::Off => Ok(None),
        };
        let opened =
            opened.map_err(|e| at(MergeErrorKind::Read(e)))?.ok_or_else(|| at(MergeErrorKind::NotATile))?;
        let length = file.get_ref().metadata().map_err(|e| at(MergeErrorKind::Read(e)))?.len();
        if length != opened.length() {
            let cut = io::Error::new(io::ErrorKind::UnexpectedEof, "it was cut off, or something was added");
            return Err(at(MergeErrorKind::Read(cut)));
        }
        Ok(opened)
    }

    fn ply(path: &Path, file: &mut impl BufRead) -> io::Result<Option<TileFile>> {
        /// More than any header that is written here.
        const LONGEST: u64 = 4096;
        let mut text = String::new();
        let mut lines = file.take(LONGEST);
        while !text.ends_with("end_header\n") {
            // Text only, until then.
            if !matches!(lines.read_line(&mut text), Ok(n) if n > 0) {
                return Ok(None);
            }
        }
        let find = |start: &str| text.lines().find_map(|line| line.strip_prefix(start));
        let count = |start: &str| find(start)?.parse::<u64>().ok();
        let tile = text.lines().filter_map(|l| l.strip_prefix("comment ")).find_map(parse);
        let (Some((tile, own)), Some(vertices), Some(triangles)) =
            (tile, count("element vertex "), count("element face "))
        else {
            return Ok(None);
        };
        let coordinates = if find("property double ").is_some() { Precision::F64 } else { Precision::F32 };
        let comments = [tile.text(&own_vertices(own))];
        let is_ours = ply::header(vertices, triangles, coordinates, &comments) == text.as_bytes();
        let body = text.len() as u64;
        let path = path.to_path_buf();
        Ok((is_ours && own <= vertices).then_some(TileFile {
            path,
            format: Format::Ply,
            tile,
            own,
            vertices,
            triangles,
            coordinates,
            body,
        }))
    }

    fn stl(path: &Path, file: &mut impl Read) -> io::Result<Option<TileFile>> {
        let mut head = [0; stl::HEAD];
        if let Err(error) = file.read_exact(&mut head) {
            return if error.kind() == io::ErrorKind::UnexpectedEof { Ok(None) } else { Err(error) };
        }
        let title = std::str::from_utf8(&head[..80]).ok().and_then(parse);
        let triangles = u64::from(u32::from_le_bytes([head[80], head[81], head[82], head[83]]));
        Ok(title.map(|(tile, own)| TileFile {
            path: path.to_path_buf(),
            format: Format::Stl,
            tile,
            own,
            vertices: 0,
            triangles,
            coordinates: Precision::F32,
            body: stl::HEAD as u64,
        }))
    }

    /// Bytes of a vertex.
    fn vertex(&self) -> usize {
        match self.coordinates {
            Precision::F32 => 12,
            Precision::F64 => 24,
        }
    }

    fn length(&self) -> u64 {
        match self.format {
            Format::Stl => self.body + self.triangles * stl::RECORD as u64,
            _ => self.faces() + self.triangles * ply::FACE as u64,
        }
    }

    /// Returns the first byte of the faces.
    fn faces(&self) -> u64 {
        self.body + self.vertices * self.vertex() as u64
    }

    fn at(&self, start: u64) -> Result<BufReader<File>, MergeError> {
        let open = || {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(start))?;
            Ok(BufReader::with_capacity(1 << 20, file))
        };
        open().map_err(|e| self.failed(MergeErrorKind::Read(e)))
    }

    /// Hands `count` records of `size` bytes from `start` on to `visit`.
    fn records(
        &self,
        start: u64,
        count: u64,
        size: usize,
        mut visit: impl FnMut(&[u8]) -> Result<(), MergeError>,
    ) -> Result<(), MergeError> {
        let mut file = self.at(start)?;
        let mut record = vec![0; size];
        for _ in 0..count {
            file.read_exact(&mut record).map_err(|e| self.failed(MergeErrorKind::Read(e)))?;
            visit(&record)?;
        }
        Ok(())
    }

    fn failed(&self, kind: MergeErrorKind) -> MergeError {
        MergeError { path: self.path.clone(), kind }
    }
}

/// Joins all tiles of a work to the mesh that it gives undivided, byte for byte, in the file
/// `output`, which is written in place. Tiles may come in any order. Returns the numbers of
/// vertices and triangles; STL has no vertices.
///
/// # Errors
/// When a file is no tile, is of another work, is there twice or not at all, or when reading or
/// writing fails.
pub fn merge_tiles(tiles: &[PathBuf], output: &Path) -> Result<(u64, u64), MergeError> {
    let tiles = sorted(tiles)?;
    let at = |kind| MergeError { path: output.to_path_buf(), kind };
    let first = &tiles[0];
    if Format::of(output).ok() != Some(first.format) {
        return Err(first.failed(MergeErrorKind::OtherFormat(first.format.extension())));
    }
    let triangles: u64 = tiles.iter().map(|t| t.triangles).sum();
    let vertices: u64 = tiles.iter().map(|t| t.own).sum();
    if triangles == 0 {
        return Err(at(MergeErrorKind::Empty));
    }
    if vertices.max(triangles * u64::from(first.format == Format::Stl)) > u64::from(u32::MAX) {
        return Err(at(MergeErrorKind::TooLarge));
    }
    let file = File::create(output).map_err(|e| at(MergeErrorKind::Write(e)))?;
    let mut file = BufWriter::with_capacity(1 << 20, file);
    let mut write = |bytes: &[u8]| file.write_all(bytes).map_err(|e| at(MergeErrorKind::Write(e)));
    if first.format == Format::Stl {
        write(&stl::head(triangles as u32))?;
        for tile in &tiles {
            tile.records(tile.body, tile.triangles, stl::RECORD, &mut write)?;
        }
    } else {
        write(&ply::header(vertices, triangles, first.coordinates, &[]))?;
        merge_ply(&tiles, &mut write)?;
    }
    file.flush().map_err(|e| at(MergeErrorKind::Write(e)))?;
    Ok((vertices, triangles))
}

/// Vertices and faces.
fn merge_ply(
    tiles: &[TileFile],
    write: &mut impl FnMut(&[u8]) -> Result<(), MergeError>,
) -> Result<(), MergeError> {
    // Vertices that a tile needs of others, by position: their numbers in the whole.
    let mut wanted: HashMap<Vec<u8>, Option<u32>> = HashMap::new();
    for tile in tiles {
        let start = tile.body + tile.own * tile.vertex() as u64;
        tile.records(start, tile.vertices - tile.own, tile.vertex(), |position| {
            wanted.insert(position.to_vec(), None);
            Ok(())
        })?;
    }
    let mut number = 0u32;
    for tile in tiles {
        tile.records(tile.body, tile.own, tile.vertex(), |position| {
            if let Some(found) = wanted.get_mut(position) {
                *found = Some(number);
            }
            number += 1;
            write(position)
        })?;
    }
    let mut first = 0;
    for tile in tiles {
        let mut others = Vec::with_capacity((tile.vertices - tile.own) as usize);
        let start = tile.body + tile.own * tile.vertex() as u64;
        tile.records(start, tile.vertices - tile.own, tile.vertex(), |position| {
            let number = wanted.get(position).copied().flatten();
            others.push(number.ok_or_else(|| tile.failed(MergeErrorKind::NoFit))?);
            Ok(())
        })?;
        tile.records(tile.faces(), tile.triangles, ply::FACE, |face| {
            let mut record = [3; ply::FACE];
            for (to, from) in record[1..].chunks_exact_mut(4).zip(face[1..].as_chunks::<4>().0) {
                let v = u32::from_le_bytes(*from);
                let number = match u64::from(v).checked_sub(tile.own) {
                    None => first + v,
                    Some(n) => *others.get(n as usize).ok_or_else(|| tile.failed(MergeErrorKind::NoFit))?,
                };
                to.copy_from_slice(&number.to_le_bytes());
            }
            write(&record)
        })?;
        first += tile.own as u32;
    }
    Ok(())
}

/// The tiles by number, all of one work.
fn sorted(paths: &[PathBuf]) -> Result<Vec<TileFile>, MergeError> {
    let mut tiles: Vec<TileFile> = paths.iter().map(|path| TileFile::open(path)).collect::<Result<_, _>>()?;
    tiles.sort_by_key(|tile| tile.tile.index.index());
    check_complete(&tiles.iter().map(|t| (t.path.as_path(), t.tile)).collect::<Vec<_>>())?;
    let first = &tiles[0];
    for tile in &tiles {
        if tile.coordinates != first.coordinates {
            return Err(tile.failed(MergeErrorKind::OtherJob));
        }
        if tile.format != first.format {
            return Err(tile.failed(MergeErrorKind::OtherFormat(tile.format.extension())));
        }
    }
    Ok(tiles)
}
