//! The only bridge to C++: whole slices in and out, no geometry on the other side.
//!
//! Origins and nodes cross as `3 n` integers, leaf values as `512 n` numbers (z fastest), masks as
//! `8 n` words. The safe types in [`grid`](super::grid) and [`file`](super::file) check lengths
//! before a call, the C++ functions check them again. Every function that can throw returns a
//! `Result` whose error holds the sentence.

#[cxx::bridge(namespace = "exocarp::vdb")]
pub(super) mod ffi {
    /// Sizes of a grid.
    struct Counts {
        active_voxels: u64,
        /// Bytes of the tree in memory.
        memory: u64,
    }

    /// Compression of the values in a file.
    enum Codec {
        Blosc,
        Zip,
        None,
    }

    enum MetaKind {
        Text,
        Real,
        Integer,
    }

    /// One entry of a file's metadata; `kind` names the field that holds it. Read ones have `text`
    /// in any case.
    struct MetaItem {
        name: String,
        kind: MetaKind,
        text: String,
        real: f64,
        integer: i64,
    }

    /// Depth to which a file is read.
    enum Depth {
        /// The grids' names and types.
        Names,
        /// Transforms, metadata and tree topology too.
        Topology,
    }

    /// A grid in a file. Below `value_type` everything is empty when only names were read.
    struct GridEntry {
        name: String,
        value_type: String,
        grid_class: String,
        background: String,
        placement: Placement,
        active_voxels: u64,
        /// The lowest and the highest active node; meaningless without active voxels.
        bbox: [i32; 6],
        metadata: Vec<MetaItem>,
    }

    /// Transform of a grid.
    struct Placement {
        /// Whether it is an affine map at all.
        linear: bool,
        /// World positions of the nodes (0,0,0), (1,0,0), (0,1,0), (0,0,1).
        frame: [f64; 12],
    }

    /// Contents of a file.
    struct Contents {
        /// Version of the file format.
        format: u32,
        /// Version of the library that wrote it.
        library: String,
        metadata: Vec<MetaItem>,
        grids: Vec<GridEntry>,
    }

    /// The schemes of OpenVDB's level-set offset.
    #[cfg(feature = "cli")]
    enum Scheme {
        /// First-order upwind differences, forward Euler.
        First,
        /// Fifth-order WENO, third-order Runge-Kutta.
        Weno5,
    }

    // Every function takes references and slices that outlive the call and keeps none of them, and
    // the C++ side checks every length before it touches a slice.
    unsafe extern "C++" {
        include!("exocarp/cpp/vdb.h");

        /// A `FloatGrid`.
        type FloatGrid;
        /// An `Int32Grid`.
        type Int32Grid;

        /// An empty level set named `surface` with world = voxel * index.
        fn new_float_grid(voxel: f64, background: f32, creator: &str) -> Result<UniquePtr<FloatGrid>>;
        /// An empty grid with background -1.
        fn new_int32_grid(voxel: f64, name: &str, creator: &str) -> Result<UniquePtr<Int32Grid>>;

        /// Adds leaves; one that exists is replaced.
        fn insert(self: Pin<&mut FloatGrid>, origins: &[i32], values: &[f32], active: &[u64]) -> Result<()>;
        /// Adds leaves; one that exists is replaced.
        fn insert(self: Pin<&mut Int32Grid>, origins: &[i32], values: &[i32], active: &[u64]) -> Result<()>;

        /// Turns cubes of nodes into inactive tiles of `value`.
        fn fill(self: Pin<&mut FloatGrid>, origins: &[i32], sides: &[u32], value: f32) -> Result<()>;
        /// Adds the leaves of another grid, and its tiles that are not of the background.
        fn append(self: Pin<&mut FloatGrid>, other: &FloatGrid) -> Result<()>;
        /// Adds the leaves of another grid.
        fn append(self: Pin<&mut Int32Grid>, other: &Int32Grid) -> Result<()>;
        /// Merges uniform tiles.
        fn prune(self: Pin<&mut FloatGrid>) -> Result<()>;

        fn leaf_count(self: &FloatGrid) -> Result<usize>;
        fn leaf_count(self: &Int32Grid) -> Result<usize>;
        fn counts(self: &FloatGrid) -> Result<Counts>;
        fn counts(self: &Int32Grid) -> Result<Counts>;

        /// Origins of the leaves in the order of the tree.
        fn leaf_origins(self: &FloatGrid) -> Result<Vec<i32>>;
        fn leaf_origins(self: &Int32Grid) -> Result<Vec<i32>>;

        /// Copies leaves out, starting with number `first` in that order.
        fn read(self: &FloatGrid, first: usize, values: &mut [f32], active: &mut [u64]) -> Result<()>;
        fn read(self: &Int32Grid, first: usize, values: &mut [i32], active: &mut [u64]) -> Result<()>;

        /// Whether the value at each node is negative.
        fn inside(self: &FloatGrid, nodes: &[i32], inside: &mut [bool]) -> Result<()>;
        fn background(self: &FloatGrid) -> f32;
        fn is_fog(self: &FloatGrid) -> bool;
        fn placement(self: &FloatGrid) -> Result<Placement>;

        /// One of the nine tests of `tools::checkLevelSet` (1 to 9): empty if passed.
        fn check(self: &FloatGrid, test: u8, threads: i32) -> Result<String>;

        /// A copy with another background whose values survive rounding to half floats.
        fn half_copy(self: &FloatGrid, background: f32) -> Result<UniquePtr<FloatGrid>>;

        /// Polygons in world space.
        #[cfg(feature = "cli")]
        type Polygons;
        /// OpenVDB's `meshToVolume`: `points` in index space, the widths of the band in voxels.
        #[cfg(feature = "cli")]
        fn mesh_band(
            voxel: f64,
            points: &[f32],
            triangles: &[u32],
            exterior: f32,
            interior: f32,
            threads: i32,
        ) -> Result<UniquePtr<FloatGrid>>;
        /// OpenVDB's `LevelSetFilter::offset`: a positive distance, in model units, erodes.
        #[cfg(feature = "cli")]
        fn filter_offset(
            self: Pin<&mut FloatGrid>,
            distance: f32,
            scheme: Scheme,
            threads: i32,
        ) -> Result<()>;
        /// OpenVDB's `volumeToMesh` without adaptivity.
        #[cfg(feature = "cli")]
        fn contour(self: &FloatGrid, iso: f64, threads: i32) -> Result<UniquePtr<Polygons>>;
        #[cfg(feature = "cli")]
        fn point_count(self: &Polygons) -> usize;
        #[cfg(feature = "cli")]
        fn triangle_count(self: &Polygons) -> usize;
        #[cfg(feature = "cli")]
        fn quad_count(self: &Polygons) -> usize;
        /// Copies everything out.
        #[cfg(feature = "cli")]
        fn read(self: &Polygons, points: &mut [f32], triangles: &mut [u32], quads: &mut [u32]) -> Result<()>;

        /// Writes one or two grids (`closest` may be null).
        fn write_file(
            path: &[u8],
            surface: &FloatGrid,
            closest: &UniquePtr<Int32Grid>,
            codec: Codec,
            metadata: &Vec<MetaItem>,
        ) -> Result<()>;
        fn read_contents(path: &[u8], depth: Depth) -> Result<Contents>;
        /// The grid with this number in the order of [`read_contents`].
        fn read_float_grid(path: &[u8], number: usize) -> Result<UniquePtr<FloatGrid>>;
        fn read_int32_grid(path: &[u8], number: usize) -> Result<UniquePtr<Int32Grid>>;
    }
}

// SAFETY: a grid owns its tree alone, and nothing in it is bound to the thread that made it.
unsafe impl Send for ffi::FloatGrid {}
// SAFETY: as above.
unsafe impl Send for ffi::Int32Grid {}
// SAFETY: functions that take the grid by shared reference only read the tree, which holds all its
// values in memory (no delayed loading), and OpenVDB allows concurrent reading through one accessor
// per call. The list of leaves, made on first use, is guarded by a mutex.
unsafe impl Sync for ffi::FloatGrid {}
// SAFETY: as above.
unsafe impl Sync for ffi::Int32Grid {}
