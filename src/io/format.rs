//! The formats of mesh files.

use super::error::UnknownFormat;
use std::path::Path;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format (Stanford).
    Ply,
    /// Stereolithography.
    Stl,
    /// Object file format (Geomview).
    Off,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 4] = [Format::Obj, Format::Ply, Format::Stl, Format::Off];

    /// The format that belongs to the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// When there is none; the message lists the known extensions.
    pub fn of(path: &Path) -> Result<Format, UnknownFormat> {
        let found = path.extension().unwrap_or_default().to_string_lossy();
        let format = Format::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(&found));
        format.ok_or_else(|| UnknownFormat { found: found.into_owned() })
    }

    /// The extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Off => "off",
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Off => "OFF",
        })
    }
}
