//! The arguments, their units and their help.

use super::examples;
use super::format::{bytes, resolution, threads, voxel};
use clap::{Args, Parser, Subcommand, ValueEnum};
use exocarp::internals::compare::Method;
use exocarp::{Length, OpenInput, PatchSide, SectionNormals, ThickenSettings, TileIndex, Tolerance};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Offset surfaces of triangle meshes: closed, free of self-intersections, with sharp features, and
/// their narrow band as OpenVDB.
#[derive(Debug, Parser)]
#[command(name = "exocarp", version, after_help = examples::ALL, arg_required_else_help = true)]
#[command(disable_help_subcommand = true)]
pub(super) struct Arguments {
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Command,
}

/// Options of every command.
#[derive(Args, Debug)]
pub(super) struct Common {
    /// Number of worker threads, up to 512 or the number of cores [default: all cores]
    #[arg(long, global = true, help_heading = "Everywhere", value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
    /// Print nothing but errors
    #[arg(long, short, global = true, help_heading = "Everywhere", conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print phases and counts as well
    #[arg(long, short, global = true, help_heading = "Everywhere")]
    pub verbose: bool,
    /// Refuse to start what would need more memory, in bytes or with K, M or G (powers of 1024)
    /// [default: what the system has available]
    #[arg(long, global = true, help_heading = "Everywhere", value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Offset a mesh: the closed surface at a signed distance from it
    Offset(OffsetArguments),
    /// Join the tiles of an offset, made with --tile, to the whole
    Merge(MergeArguments),
    /// Thicken an open surface patch into a solid on one side of it, or hollow a closed mesh
    Thicken(ThickenArguments),
    /// Make the same offset with OpenVDB and MeshLib, and compare times, memory and errors
    Compare(CompareArguments),
    /// One run of one method, for `compare`
    #[command(hide = true, name = exocarp::internals::compare::WORKER)]
    Worker(WorkerArguments),
    /// Write a generated model; without a name, list them
    Model(ModelArguments),
    /// Print what a mesh or a .vdb file holds
    Info(InfoArguments),
    /// Judge a mesh as the offset surface of another: topology, intersections, errors, what is
    /// missing
    Verify(VerifyArguments),
    /// Print the tables of the method's paper, measured here, beside the published figures
    Paper(PaperArguments),
    /// Print a completion script for a shell
    #[command(hide = true)]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

/// `exocarp offset`.
#[derive(Args, Debug)]
#[command(after_help = examples::OFFSET)]
pub(super) struct OffsetArguments {
    /// The mesh to offset
    pub input: PathBuf,
    /// Signed distance in model units, or in percent of the input's diagonal: positive grows,
    /// negative shrinks, 0 remeshes
    #[arg(long, short, value_name = "D", allow_hyphen_values = true)]
    pub distance: Length,
    /// Where to write the offset surface; may be left out with --vdb
    #[arg(long, short, value_name = "OUTPUT", required_unless_present = "vdb")]
    pub output: Option<PathBuf>,
    /// Voxel size in model units
    #[arg(long, value_name = "H", value_parser = voxel, allow_negative_numbers = true)]
    #[arg(conflicts_with = "resolution")]
    pub voxel: Option<f64>,
    /// Voxels along the longest side of the result's bounding box [default: 256]
    #[arg(long, value_name = "N", value_parser = resolution, allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// Where inside and outside come from
    #[arg(long, value_enum, default_value_t = Sign::Closed)]
    pub sign: Sign,
    /// Refine the mesh until it is this near to the true offset surface: in model units, or in
    /// voxels as 0.05h
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
    /// Halve the voxel size up to N times while parts, sheets or gaps thinner than a voxel are
    /// missing
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_value_t = 0, default_missing_value = "3")]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=10), hide_default_value = true)]
    pub resolve: u32,
    /// Work slab by slab and write triangles as they come (PLY, STL), within --max-memory [default
    /// there: 1G]; on by itself when the whole would not fit
    #[arg(long, conflicts_with = "tile")]
    pub stream: bool,
    /// Make tile I of N only, for `exocarp merge` to join: several machines share one offset
    #[arg(long, value_name = "I/N", conflicts_with = "resolve")]
    pub tile: Option<TileIndex>,
    /// Write the closest triangle of each voxel into the .vdb file, too, as a second grid; many
    /// programs cannot read that
    #[arg(long, requires = "vdb")]
    pub closest: bool,
    #[command(flatten)]
    pub more: OutputArguments,
}

/// `exocarp merge`.
#[derive(Args, Debug)]
#[command(after_help = examples::MERGE)]
pub(super) struct MergeArguments {
    /// All tiles of one offset, in any order
    #[arg(required = true)]
    pub tiles: Vec<PathBuf>,
    /// Where to write the whole, in the tiles' format
    #[arg(long, short, value_name = "OUTPUT")]
    pub output: PathBuf,
}

/// `exocarp thicken`.
#[derive(Args, Debug)]
#[command(after_help = examples::THICKEN)]
pub(super) struct ThickenArguments {
    /// The patch to thicken
    #[arg(value_name = "PATCH")]
    pub input: PathBuf,
    /// Thickness of the solid in model units, or in percent of the patch's diagonal
    #[arg(long, short, value_name = "T", allow_hyphen_values = true)]
    #[arg(required_unless_present = "thickness_map")]
    pub thickness: Option<Length>,
    /// The thickness at each vertex of PATCH, in the order of the file, in model units: text, or a
    /// PLY file whose vertices have the property `thickness`
    #[arg(long, value_name = "FILE", conflicts_with = "thickness")]
    pub thickness_map: Option<PathBuf>,
    /// The side of the patch on which the solid lies: behind it, or where its normals point
    #[arg(long, value_enum, default_value_t = SideArgument::Inner)]
    pub side: SideArgument,
    /// Where to write the solid
    #[arg(long, short, value_name = "SOLID")]
    pub output: PathBuf,
    /// Voxel size in model units, less than half of the thickness [default: a quarter of it]
    #[arg(long, value_name = "H", value_parser = voxel, allow_negative_numbers = true)]
    #[arg(conflicts_with = "resolution")]
    pub voxel: Option<f64>,
    /// Voxels along the longest side of the patch's bounding box, grown by the thickness
    #[arg(long, value_name = "N", value_parser = resolution, allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// Halve the voxel size up to N times where the lattice is too coarse for the patch
    #[arg(long, value_name = "N", default_value_t = ThickenSettings::default().max_halvings)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=10))]
    pub resolve: u32,
    /// Rounds of shape processing at most: flatter sections with sharper edges, and a shell nearer
    /// to its distance
    #[arg(long, value_name = "N", default_value_t = ThickenSettings::default().rounds)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub rounds: u32,
    /// The normals of the section in these rounds: of the walls on the boundary's edges, or of its
    /// faces, smoothed
    #[arg(long, value_enum, default_value_t = Normals::Exact)]
    pub section_normals: Normals,
    #[command(flatten)]
    pub more: OutputArguments,
}

/// Options of the files that are written.
#[derive(Args, Debug)]
pub(super) struct OutputArguments {
    /// Write 64-bit coordinates instead of 32-bit ones (PLY, OBJ, OFF)
    #[arg(long)]
    pub f64: bool,
    /// Write the narrow band around the result as an OpenVDB level set, too
    #[arg(long, value_name = "FILE.vdb")]
    pub vdb: Option<PathBuf>,
    /// Compression of the .vdb file
    #[arg(long, value_enum, default_value_t = Codec::Blosc, requires = "vdb")]
    pub vdb_compression: Codec,
    /// Store the .vdb file's distances as 16-bit floats
    #[arg(long, requires = "vdb")]
    pub half: bool,
    /// The model's unit, written into the .vdb file's metadata (mm, cm, in, ...)
    #[arg(long, requires = "vdb", value_name = "UNIT")]
    pub unit: Option<String>,
    /// Write settings, times and counts as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
}

impl OutputArguments {
    /// The files beside the mesh.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.vdb.iter().chain(&self.stats)
    }
}

/// `--side`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SideArgument {
    /// Behind the patch, opposite to its normals
    Inner,
    /// In front of it
    Outer,
}

impl SideArgument {
    /// The name in the statistics file.
    pub fn name(self) -> &'static str {
        match self {
            SideArgument::Inner => "inner",
            SideArgument::Outer => "outer",
        }
    }

    pub fn side(self) -> PatchSide {
        match self {
            SideArgument::Inner => PatchSide::Inner,
            SideArgument::Outer => PatchSide::Outer,
        }
    }
}

/// `--section-normals`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Normals {
    /// Of the walls: in the plane of the patch's triangle, across its edge
    Exact,
    /// Of the faces, smoothed in each round
    Smoothed,
}

impl Normals {
    pub fn normals(self) -> SectionNormals {
        match self {
            Normals::Exact => SectionNormals::Exact,
            Normals::Smoothed => SectionNormals::Smoothed,
        }
    }
}

/// `exocarp compare`.
#[derive(Args, Debug)]
#[command(after_help = examples::COMPARE)]
pub(super) struct CompareArguments {
    /// The mesh to offset, closed
    pub input: PathBuf,
    /// Signed distance in model units, or in percent of the input's diagonal: positive grows,
    /// negative shrinks
    #[arg(long, short, value_name = "D", allow_hyphen_values = true)]
    pub distance: Length,
    /// Voxel size in model units
    #[arg(long, value_name = "H", value_parser = voxel, allow_negative_numbers = true)]
    #[arg(conflicts_with = "resolution")]
    pub voxel: Option<f64>,
    /// Voxels along the longest side of the result's bounding box [default: 256]
    #[arg(long, value_name = "N", value_parser = resolution, allow_negative_numbers = true)]
    pub resolution: Option<u32>,
    /// Runs per method; times are medians
    #[arg(long, value_name = "R", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,
    /// Seconds after which a run is given up
    #[arg(long, value_name = "S", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=86_400))]
    pub timeout: u64,
    /// Run a method only once if its first run took longer than this
    #[arg(long, value_name = "S")]
    pub once_above: Option<u64>,
    /// The Python interpreter that can import meshlib; without the package, MeshLib is left out
    #[arg(long, value_name = "PY", default_value = "python3")]
    pub python: PathBuf,
    /// Write a page with charts and pictures into this directory, as index.html
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Write everything measured as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// The methods, with commas between them [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = method)]
    pub methods: Vec<Method>,
}

/// A method by its name.
fn method(name: &str) -> Result<Method, String> {
    Method::by_name(name).ok_or_else(|| {
        let names: Vec<&str> = Method::ALL.iter().map(|m| m.name()).collect();
        format!("the methods are {}", names.join(", "))
    })
}

/// One run of one method: what `exocarp::internals::compare::worker_arguments` makes.
#[derive(Args, Debug)]
pub(super) struct WorkerArguments {
    #[arg(value_parser = method)]
    pub method: Method,
    pub input: PathBuf,
    #[arg(allow_hyphen_values = true)]
    pub distance: f64,
    pub voxel: f64,
    pub output: PathBuf,
}

/// `--sign`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Sign {
    /// The input is closed and consistently oriented, or refused
    Closed,
    /// Take any input; where the sign jumps at its holes, the result is closed there
    Pseudonormal,
}

impl Sign {
    /// The name in the statistics file.
    pub fn name(self) -> &'static str {
        match self {
            Sign::Closed => "closed",
            Sign::Pseudonormal => "pseudonormal",
        }
    }

    /// The setting.
    pub fn open_input(self) -> OpenInput {
        match self {
            Sign::Closed => OpenInput::Refuse,
            Sign::Pseudonormal => OpenInput::Accept,
        }
    }
}

/// `--vdb-compression`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Codec {
    /// Small and quick
    Blosc,
    /// For readers that lack Blosc
    Zip,
    /// Not compressed
    None,
}

/// `exocarp model`.
#[derive(Args, Debug)]
#[command(after_help = examples::MODEL)]
pub(super) struct ModelArguments {
    /// The model's name
    #[arg(requires = "output")]
    pub name: Option<String>,
    /// Where to write it
    #[arg(long, short, value_name = "OUTPUT", requires = "name")]
    pub output: Option<PathBuf>,
    /// Triangle sides per unit of length; the models are two to three units long
    #[arg(long, value_name = "N", default_value_t = exocarp::shapes::DEFAULT_DETAIL)]
    // More would need gigabytes for a test model.
    #[arg(value_parser = clap::value_parser!(u32).range(2..=512))]
    pub detail: u32,
    /// Write 64-bit coordinates instead of 32-bit ones (PLY, OBJ, OFF)
    #[arg(long)]
    pub f64: bool,
}

/// `exocarp paper`.
#[derive(Args, Debug)]
#[command(after_help = examples::PAPER)]
pub(super) struct PaperArguments {
    /// The table's number, 1 to 7 [default: all]
    #[arg(long, value_name = "1..7", value_parser = clap::value_parser!(u32).range(1..=7))]
    pub table: Option<u32>,
    /// A directory with the models; what is not in it is generated
    #[arg(long, value_name = "DIR")]
    pub models: Option<PathBuf>,
    /// Cells along the longest side, where the paper has 512
    #[arg(long, value_name = "N", default_value_t = exocarp::internals::paper::PUBLISHED_RESOLUTION)]
    // Finer than the paper by four is the most that a table is of use for.
    #[arg(value_parser = clap::value_parser!(u32).range(8..=2048))]
    pub resolution: u32,
    /// Write the tables as JSON, too
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
}

/// `exocarp info`.
#[derive(Args, Debug)]
#[command(after_help = examples::INFO)]
pub(super) struct InfoArguments {
    /// A mesh or a .vdb file
    pub file: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// `exocarp verify`.
#[derive(Args, Debug)]
#[command(after_help = examples::VERIFY)]
pub(super) struct VerifyArguments {
    /// The mesh that was offset
    pub input: PathBuf,
    /// The mesh to judge
    pub output: PathBuf,
    /// Signed distance that OUTPUT is said to be at, in model units, or in percent of INPUT's
    /// diagonal
    #[arg(long, short, value_name = "D", allow_hyphen_values = true)]
    pub distance: Length,
    /// Write everything that was found as JSON
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Voxel size in model units, to give errors in voxels
    #[arg(long, value_name = "H", value_parser = voxel, allow_negative_numbers = true)]
    pub voxel: Option<f64>,
    /// The largest error allowed, in model units or in percent of INPUT's diagonal: of OUTPUT from
    /// the true offset surface, and the other way round
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub tolerance: Option<Length>,
    /// Samples, uniform over the area, up to 20 million
    #[arg(long, value_name = "N", default_value_t = exocarp::internals::verify::DEFAULT_SAMPLES)]
    pub samples: usize,
    /// Seed of the samples
    #[arg(long, value_name = "S", default_value_t = exocarp::internals::verify::DEFAULT_SEED)]
    pub seed: u64,
    /// OUTPUT is a shell: INPUT's own surface and the offset surface. Measures its wall, which is
    /// to be T model units thick [default: |D|]
    #[arg(long, value_name = "T", num_args = 0..=1, value_parser = voxel)]
    pub shell: Option<Option<f64>>,
    /// INPUT's inside and outside: whether open input is accepted. Only the count of points on the
    /// wrong side depends on it, and open input has none
    #[arg(long, value_enum, default_value_t = Sign::Pseudonormal)]
    pub sign: Sign,
}
