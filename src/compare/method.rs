//! The ways to an offset surface that are compared.

use serde::{Deserialize, Serialize};

/// One way to an offset surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// exocarp itself.
    Exocarp,
    /// OpenVDB: `meshToVolume` with a band as wide as |D| + 3 voxels, then `volumeToMesh` at D.
    OpenvdbWide,
    /// OpenVDB: `meshToVolume`, `LevelSetFilter::offset` of first order, `volumeToMesh`.
    OpenvdbFirst,
    /// OpenVDB: `LevelSetFilter::offset` with WENO5 differences and TVD-RK3 steps.
    OpenvdbWeno5,
    /// MeshLib's general offset, mode "standard".
    MeshlibStandard,
    /// MeshLib's general offset, mode "sharpening".
    MeshlibSharp,
}

impl Method {
    /// All methods, in the order of tables and pictures.
    pub const ALL: [Method; 6] = [
        Method::Exocarp,
        Method::OpenvdbWide,
        Method::OpenvdbFirst,
        Method::OpenvdbWeno5,
        Method::MeshlibStandard,
        Method::MeshlibSharp,
    ];

    /// The name on the command line and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Method::Exocarp => "exocarp",
            Method::OpenvdbWide => "openvdb-wide",
            Method::OpenvdbFirst => "openvdb-first",
            Method::OpenvdbWeno5 => "openvdb-weno5",
            Method::MeshlibStandard => "meshlib-standard",
            Method::MeshlibSharp => "meshlib-sharp",
        }
    }

    /// The name for people.
    pub fn title(self) -> &'static str {
        match self {
            Method::Exocarp => "exocarp",
            Method::OpenvdbWide => "OpenVDB wide band",
            Method::OpenvdbFirst => "OpenVDB offset, 1st order",
            Method::OpenvdbWeno5 => "OpenVDB offset, WENO5",
            Method::MeshlibStandard => "MeshLib standard",
            Method::MeshlibSharp => "MeshLib sharpening",
        }
    }

    /// Returns the calls of the method, in one line.
    pub fn recipe(self) -> &'static str {
        match self {
            Method::Exocarp => "hierarchy, band, edges, contour",
            Method::OpenvdbWide => "meshToVolume with a band of |D| + 3 voxels; volumeToMesh at D",
            Method::OpenvdbFirst => {
                "meshToVolume; LevelSetFilter::offset, FIRST_BIAS and TVD_RK1; volumeToMesh"
            }
            Method::OpenvdbWeno5 => {
                "meshToVolume; LevelSetFilter::offset, HJWENO5_BIAS and TVD_RK3; volumeToMesh"
            }
            Method::MeshlibStandard => "generalOffsetMesh, OffsetMode.Standard",
            Method::MeshlibSharp => "generalOffsetMesh, OffsetMode.Sharpening",
        }
    }

    /// The method with this name.
    pub fn by_name(name: &str) -> Option<Method> {
        Method::ALL.into_iter().find(|m| m.name() == name)
    }

    /// Returns the program that the method needs beside this one.
    pub fn needs(self) -> Needs {
        match self {
            Method::MeshlibStandard | Method::MeshlibSharp => Needs::Meshlib,
            _ => Needs::Nothing,
        }
    }

    /// The colour in charts and pictures, as #rrggbb: the palette of Okabe and Ito, which people
    /// with any kind of colour vision can tell apart, and which keeps its contrast in print.
    pub fn colour(self) -> &'static str {
        match self {
            Method::Exocarp => "#0072b2",
            Method::OpenvdbWide => "#009e73",
            Method::OpenvdbFirst => "#e69f00",
            Method::OpenvdbWeno5 => "#d55e00",
            Method::MeshlibStandard => "#cc79a7",
            Method::MeshlibSharp => "#7b5ea7",
        }
    }
}

/// A program that a method needs beside this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// The Python package `meshlib`.
    Meshlib,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_json() {
        for method in Method::ALL {
            assert_eq!(Method::by_name(method.name()), Some(method));
            assert_eq!(serde_json::to_value(method).unwrap(), method.name());
        }
        assert_eq!(Method::by_name("magic"), None);
    }
}
