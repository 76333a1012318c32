//! Writing and reading `.vdb` files.
//!
//! Files are archives with grid offsets and statistics in the header (`file_bbox_min`,
//! `file_voxel_count`, ...), which viewers show without reading the grids. Reading never maps the
//! file (no delayed loading), so that it may be replaced while its grids are in use.

use super::VdbError;
use super::bridge::ffi;
use super::content_id;
use super::grid::{Band, CLOSEST, CREATOR, ClosestGrid, SurfaceGrid};
use crate::io::atomic::Replacement;
use cxx::UniquePtr;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Compression of the values in a file. In all cases inactive values are left out, since a level
/// set has two of them only. Bands of 2% at 256 voxels, in MB, without compression, with Zip and
/// with Blosc: fandisk 4.28, 3.01, 2.86; armadillo 3.99, 3.95, 3.81. Values are distances, whose
/// last digits are noise unless surfaces are plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Blosc: small and quick. Few readers lack it.
    #[default]
    Blosc,
    /// Zip: for readers that lack Blosc, and smaller than Blosc with half floats.
    Zip,
    /// Not compressed.
    None,
}

/// Number type of the surface's values in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VdbPrecision {
    /// 32-bit floats: what is in memory, bit for bit.
    #[default]
    Full,
    /// 16-bit floats: 11 significant bits, half the size. Signs are kept, and the background is
    /// rounded up to the next 16-bit float.
    Half,
}

/// A value of a file's metadata.
#[derive(Clone, Debug, PartialEq)]
pub enum MetaValue {
    /// Text.
    Text(String),
    /// A number.
    Real(f64),
    /// A whole number.
    Integer(i64),
}

/// Options for writing a file, and its metadata.
///
/// Besides what is given here, a file's metadata hold `creator` (program and version), `voxel_size`
/// (model units) and `half_width` (voxels).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VdbOptions {
    /// Compression of the values.
    pub compression: Compression,
    /// Precision of the surface's values.
    pub precision: VdbPrecision,
    /// The offset distance in model units, written as `offset_distance`.
    pub distance: Option<f64>,
    /// The model's unit, e.g. `mm`, written as `unit`: a `.vdb` has none of its own.
    pub unit: Option<String>,
    /// Further metadata. An entry with the name of one above replaces it.
    pub metadata: Vec<(String, MetaValue)>,
}

/// Writes a level set to the file `path`, whatever its extension: one grid, which every OpenVDB
/// program reads. With the closest triangles there are two, and programs that know no grids of
/// integers refuse the file (some builds of OpenVDB's Python module) or the second grid.
///
/// An existing file is replaced when the new one is complete, and left as it was when something
/// fails.
///
/// # Errors
/// If the file cannot be written whole, or the voxel size is below 1.5e-5 model units or beyond
/// what half floats can hold.
pub fn write(
    path: &Path,
    surface: &SurfaceGrid,
    closest: Option<&ClosestGrid>,
    options: &VdbOptions,
) -> Result<(), VdbError> {
    surface.check_transform()?;
    let half = match options.precision {
        VdbPrecision::Full => None,
        VdbPrecision::Half => Some(surface.grid.half_copy(half_background(surface)?)?),
    };
    let grid = half.as_ref().unwrap_or(&surface.grid);
    write_grids(path, grid, closest, options.compression, &metadata(surface, options))
}

/// Writes grids as they are into a file that appears whole or not at all.
pub(super) fn write_grids(
    path: &Path,
    surface: &UniquePtr<ffi::FloatGrid>,
    closest: Option<&ClosestGrid>,
    compression: Compression,
    metadata: &Vec<ffi::MetaItem>,
) -> Result<(), VdbError> {
    let none = UniquePtr::null();
    let closest = closest.map_or(&none, |c| &c.grid);
    let codec = match compression {
        Compression::Blosc => ffi::Codec::Blosc,
        Compression::Zip => ffi::Codec::Zip,
        Compression::None => ffi::Codec::None,
    };
    let by_system = |e| VdbError::write_by_system(path, e);
    let replacement = Replacement::create(path).map_err(by_system)?;
    let temporary = replacement.path();
    ffi::write_file(bytes(temporary), surface, closest, codec, metadata)
        .map_err(|e| VdbError::write(path, e))?;
    content_id::stamp(temporary).map_err(by_system)?;
    replacement.commit().map_err(by_system)
}

/// Opens the level set `name` of a file; without a name the grid `surface`, or else the only float
/// grid.
///
/// Any program's file will do, as long as its transform is a uniform scale and a translation, and
/// its background positive. Fog volumes are refused.
///
/// # Errors
/// If the file cannot be read, or has no such grid, or one that is not a level set.
pub fn open_surface(path: &Path, name: Option<&str>) -> Result<SurfaceGrid, VdbError> {
    let (number, name) = find(path, name, "surface", "float")?;
    let grid = ffi::read_float_grid(bytes(path), number).map_err(|e| VdbError::read(path, e))?;
    let wrong = |reason: &str| VdbError::Unsuitable { path: path.into(), grid: name, reason: reason.into() };
    if grid.is_fog() {
        return Err(wrong("is a fog volume, not a level set"));
    }
    let background = grid.background();
    if !(background.is_normal() && background > 0.0) {
        return Err(wrong("is not a level set: its background is not positive"));
    }
    match uniform(&grid.placement()?) {
        Some((voxel, translation)) => Ok(SurfaceGrid::opened(grid, voxel, translation)),
        None => Err(wrong("has a transform that is not a uniform scale with a translation")),
    }
}

/// Opens the grid of closest triangles `name`; without a name the grid `surface_closest`, or else
/// the only grid of 32-bit integers.
///
/// # Errors
/// If the file cannot be read or has no such grid.
pub fn open_closest(path: &Path, name: Option<&str>) -> Result<ClosestGrid, VdbError> {
    let (number, _) = find(path, name, CLOSEST, "int32")?;
    let grid = ffi::read_int32_grid(bytes(path), number).map_err(|e| VdbError::read(path, e))?;
    Ok(ClosestGrid { grid })
}

/// Opens a band that [`write()`] wrote, or another program's level set: see [`open_surface`]. The
/// closest triangles are there if the file has them for exactly the leaves of the surface.
///
/// # Errors
/// Those of [`open_surface`].
pub fn open_band(path: &Path) -> Result<Band, VdbError> {
    let surface = open_surface(path, None)?;
    let closest = match open_closest(path, Some(CLOSEST)) {
        Ok(grid) => Some(grid).filter(|c| c.leaf_origins() == surface.leaf_origins()),
        Err(VdbError::MissingGrid { .. }) => None,
        Err(e) => return Err(e),
    };
    Ok(Band { surface, closest })
}

/// Number and name of the grid `name` of the type; without a name the `usual` one or else the only
/// one.
fn find(path: &Path, name: Option<&str>, usual: &str, value_type: &str) -> Result<(usize, String), VdbError> {
    let grids = contents(path, ffi::Depth::Names)?.grids;
    let of_type = || grids.iter().enumerate().filter(|(_, g)| g.value_type == value_type);
    let found = match name {
        Some(name) => of_type().find(|(_, g)| g.name == name),
        None => of_type().find(|(_, g)| g.name == usual).or_else(|| match of_type().count() {
            1 => of_type().next(),
            _ => None,
        }),
    };
    found.map(|(number, g)| (number, g.name.clone())).ok_or_else(|| VdbError::MissingGrid {
        path: path.into(),
        wanted: match name {
            Some(name) => format!("{value_type} grid named '{name}'"),
            None => format!("{value_type} grid named '{usual}' and not exactly one {value_type} grid"),
        },
        present: grids.iter().map(|g| format!("'{}' ({})", g.name, g.value_type)).collect(),
    })
}

/// Returns the contents of a file, after a look at its first bytes.
pub(super) fn contents(path: &Path, depth: ffi::Depth) -> Result<ffi::Contents, VdbError> {
    // The number that every file begins with: " BDV" as a little-endian 64-bit integer.
    const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";
    let mut first = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MAGIC.len() as u64).read_to_end(&mut first))
        .map_err(|e| VdbError::read_by_system(path, e))?;
    if first != MAGIC {
        return Err(VdbError::NotVdb { path: path.into() });
    }
    if !content_id::is_intact(path).map_err(|e| VdbError::read_by_system(path, e))? {
        return Err(VdbError::read(path, "the file is damaged or incomplete"));
    }
    ffi::read_contents(bytes(path), depth).map_err(|e| VdbError::read(path, e))
}

/// Voxel size and translation of a transform, if it is made of these two.
fn uniform(placement: &ffi::Placement) -> Option<(f64, [f64; 3])> {
    // Transforms are stored in f64; this leaves room for those that went through a few products.
    const TOLERANCE: f64 = 1e-9;
    let [zero, x, y, z] = placement.frame.as_chunks::<3>().0 else { return None };
    let voxel = x[0] - zero[0];
    let reach = zero.iter().fold(voxel, |m, c| m.max(c.abs()));
    let scaled = [x, y, z].iter().enumerate().all(|(axis, end)| {
        (0..3).all(|i| {
            let expected = if i == axis { voxel } else { 0.0 };
            (end[i] - zero[i] - expected).abs() <= TOLERANCE * voxel + f64::EPSILON * reach
        })
    });
    (placement.linear && voxel > 0.0 && voxel.is_finite() && scaled).then_some((voxel, *zero))
}

/// The background of a half-float copy: rounded up to 11 significant bits.
fn half_background(surface: &SurfaceGrid) -> Result<f32, VdbError> {
    // Below the smallest normal half float, precision falls off; above the largest there is
    // nothing.
    const SMALLEST_VOXEL: f64 = 6.103515625e-5;
    const LARGEST: f32 = 65504.0;
    // The bits of an f32 mantissa that a half float lacks.
    const LOST: u32 = (1 << 13) - 1;
    let background = f32::from_bits((surface.background().to_bits() + LOST) & !LOST);
    let voxel = surface.lattice().voxel;
    if voxel < SMALLEST_VOXEL || background > LARGEST {
        let reason = "half floats need a voxel size above 6e-5 and a background below 65504";
        return Err(VdbError::Size { voxel, half_width: surface.half_width(), reason });
    }
    Ok(background)
}

fn metadata(surface: &SurfaceGrid, options: &VdbOptions) -> Vec<ffi::MetaItem> {
    let mut items = vec![
        ("creator", MetaValue::Text(CREATOR.into())),
        ("voxel_size", MetaValue::Real(surface.lattice().voxel)),
        ("half_width", MetaValue::Real(surface.half_width())),
    ];
    items.extend(options.distance.map(|d| ("offset_distance", MetaValue::Real(d))));
    items.extend(options.unit.clone().map(|u| ("unit", MetaValue::Text(u))));
    let own = items.into_iter().map(|(name, value)| meta_item(name, &value));
    own.chain(options.metadata.iter().map(|(name, value)| meta_item(name, value))).collect()
}

fn meta_item(name: &str, value: &MetaValue) -> ffi::MetaItem {
    let mut item = ffi::MetaItem {
        name: name.into(),
        kind: ffi::MetaKind::Text,
        text: String::new(),
        real: 0.0,
        integer: 0,
    };
    match value {
        MetaValue::Text(text) => item.text.clone_from(text),
        MetaValue::Real(real) => (item.kind, item.real) = (ffi::MetaKind::Real, *real),
        MetaValue::Integer(integer) => (item.kind, item.integer) = (ffi::MetaKind::Integer, *integer),
    }
    item
}

fn bytes(path: &Path) -> &[u8] {
    path.as_os_str().as_encoded_bytes()
}
