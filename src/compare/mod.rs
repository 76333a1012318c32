//! Comparison of offsets: one surface, on one lattice, made by exocarp, by OpenVDB and by MeshLib.
//!
//! ```text
//!  INPUT -> clean -> a process per run and method -> PLY and a line of JSON -> medians
//!                                                 -> verify                 -> table, report
//! ```
//!
//! Every method gets the same cleaned mesh, the same distance, the same voxel size and the same
//! number of threads. Each run has a process of its own, so that its memory is its own; the methods
//! take turns, so that a slow minute of the machine hits all of them; times are medians. `engine`
//! is wall time from the mesh in memory to the offset surface in memory: reading and writing files
//! is not compared, nor is starting up.
//!
//! Promised: a method that crashes, fails or runs out of time is said to have done so, and the
//! others go on; all outputs are judged by the same [`verify`](crate::verify), which knows nothing
//! of who made them. Not promised: that the peers' memory is all theirs; a Python interpreter is in
//! MeshLib's. What a process held before the method began is measured, too.

mod error;
mod measurement;
mod method;
mod process;
pub mod report;
mod table;
mod worker;

pub use error::CompareError;
pub use measurement::{Measurement, PhaseTime, median};
pub use method::{Method, Needs};
pub use process::{Lost, Programs, WORKER, measure, probe_meshlib, worker_arguments};
pub use table::{Column, Row, grouped, rows, text};
pub use worker::{Job, work};

use crate::io::{self, SaveOptions};
use crate::mesh::{Topology, TriMesh};
use crate::offset::{InputError, OffsetSettings};
use crate::quantity::Precision;
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;
use crate::system::machine;
use crate::verify::{VerifyReport, VerifySettings, verify};
use serde::Serialize;
use std::time::Duration;

/// Settings of a comparison.
#[derive(Clone, Debug)]
pub struct CompareSettings {
    /// Signed distance: positive grows.
    pub distance: Length,
    /// Voxel size, for all methods.
    pub voxel: VoxelSize,
    /// The methods, in the order of the table.
    pub methods: Vec<Method>,
    /// Runs per method, at least 1.
    pub runs: u32,
    /// The time that a run may take.
    pub limit: Duration,
    /// A method whose first run took longer than this is not run again: the scatter of long runs is
    /// small beside what tells the methods apart.
    pub once_above: Duration,
}

impl Default for CompareSettings {
    fn default() -> Self {
        CompareSettings {
            distance: Length::DiagonalFraction(0.02),
            voxel: VoxelSize::Resolution(256),
            methods: Method::ALL.into(),
            // The least that has a median which one slow run does not move.
            runs: 3,
            // Ten times what the slowest peer takes at resolution 512.
            limit: Duration::from_secs(600),
            once_above: Duration::MAX,
        }
    }
}

/// Result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Triangles of the cleaned input.
    pub input_triangles: usize,
    /// Diagonal of its bounding box.
    pub diagonal: f64,
    /// Signed distance in model units.
    pub distance: f64,
    /// Voxel size in model units.
    pub voxel: f64,
    /// Threads of every method.
    pub threads: usize,
    /// Runs per method.
    pub runs: u32,
    /// The machine: cores and family of the processor.
    pub machine: String,
    /// Results of the methods, in the order of the settings.
    pub results: Vec<MethodResult>,
    /// Sentences about what was left out.
    pub notes: Vec<String>,
}

/// Result of one method.
#[derive(Clone, Debug, Serialize)]
pub struct MethodResult {
    /// The method.
    pub method: Method,
    /// The medians of its runs; `None` when none succeeded.
    pub median: Option<Measurement>,
    /// All runs that succeeded.
    pub runs: Vec<Measurement>,
    /// Why a run failed, after which there were no more.
    pub lost: Option<Lost>,
    /// Quality of the last output.
    pub quality: Option<VerifyReport>,
    /// The method's last output.
    #[serde(skip)]
    pub mesh: Option<TriMesh>,
}

/// An event of a comparison that runs.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// A run begins: its number, from 1, and the method.
    Begin(u32, Method),
    /// A run ended.
    Measured(&'a Measurement),
    /// A run was lost.
    Lost(Method, &'a Lost),
    /// The output of a method is being judged.
    Judging(Method),
}

/// Compares the methods on `mesh`, which has been cleaned. `watch` is told what happens.
///
/// # Errors
/// - [`CompareError::Offset`]: as for an offset; the mesh must be closed.
/// - [`CompareError::Start`], [`CompareError::Temporary`]: processes cannot be started, no
///   temporary files.
/// - [`CompareError::Cancelled`].
///
/// A method that fails is no error: its [`MethodResult::lost`] says why.
pub fn compare(
    mesh: &TriMesh,
    settings: &CompareSettings,
    programs: &Programs,
    run: &RunSettings,
    watch: &mut dyn FnMut(Event),
) -> Result<Comparison, CompareError> {
    let mut comparison = prepare(mesh, settings, run)?;
    let methods = available(&settings.methods, programs, run, &mut comparison.notes)?;
    let directory = tempfile::tempdir().map_err(CompareError::Temporary)?;
    let input = directory.path().join("input.ply");
    io::save(mesh, &input, &SaveOptions { precision: Precision::F64 })?;
    let output = |method: Method| directory.path().join(format!("{}.ply", method.name()));
    comparison.results = methods.into_iter().map(MethodResult::new).collect();

    for number in 1..=settings.runs {
        let again =
            |r: &MethodResult| r.runs.first().is_none_or(|m| m.engine <= settings.once_above.as_secs_f64());
        for result in comparison.results.iter_mut().filter(|r| r.lost.is_none() && again(r)) {
            let method = result.method;
            watch(Event::Begin(number, method));
            let (distance, voxel) = (comparison.distance, comparison.voxel);
            let job = Job { method, input: input.clone(), distance, voxel, output: output(method) };
            match measure(&job, programs, settings.limit, run)? {
                Ok(measurement) => {
                    watch(Event::Measured(&measurement));
                    result.runs.push(measurement);
                }
                Err(lost) => {
                    watch(Event::Lost(method, &lost));
                    result.lost = Some(lost);
                }
            }
        }
    }
    for result in &comparison.results {
        if result.lost.is_none() && result.runs.len() < settings.runs as usize {
            let (title, seconds) = (result.method.title(), settings.once_above.as_secs());
            comparison.notes.push(format!("{title}: run once only, because it took longer than {seconds} s"));
        }
    }
    for result in &mut comparison.results {
        result.median = Measurement::median(&result.runs);
        if result.median.is_none() {
            continue;
        }
        watch(Event::Judging(result.method));
        match io::load::load(&output(result.method)) {
            Ok(mesh) => result.mesh = Some(mesh),
            Err(error) => result.lost = Some(Lost::Failed(error.kind.to_string())),
        }
        if let Some(output) = &result.mesh {
            let voxel = Some(comparison.voxel);
            let distance = Length::Units(comparison.distance);
            let settings = VerifySettings { distance, voxel, ..VerifySettings::default() };
            result.quality = Some(verify(mesh, output, &settings, run)?);
        }
    }
    Ok(comparison)
}

impl MethodResult {
    fn new(method: Method) -> Self {
        MethodResult { method, median: None, runs: Vec::new(), lost: None, quality: None, mesh: None }
    }
}

/// Checks what can be checked, and the numbers that hold for all methods.
fn prepare(
    mesh: &TriMesh,
    settings: &CompareSettings,
    run: &RunSettings,
) -> Result<Comparison, CompareError> {
    if settings.runs == 0 || settings.methods.is_empty() {
        return Err(CompareError::Setting("there is nothing to compare: name a method and a run"));
    }
    if mesh.triangles.is_empty() {
        return Err(InputError::NoTriangles.into());
    }
    let defects = *run.install(|| Topology::new(mesh)).defects();
    let ends = |edge: [u32; 2]| edge.map(|v| mesh.vertices[v as usize]);
    if let Some(first) = defects.first_boundary {
        return Err(InputError::Open { count: defects.boundary_edges, first: ends(first) }.into());
    }
    if let Some(first) = defects.first_misoriented {
        return Err(InputError::Misoriented { count: defects.misoriented_edges, first: ends(first) }.into());
    }
    let offset = OffsetSettings { distance: settings.distance, voxel: settings.voxel, ..Default::default() };
    let resolved = offset.in_model_units(mesh)?;
    let [lo, hi] = mesh.bounding_box().unwrap_or_default();
    Ok(Comparison {
        input_triangles: mesh.triangles.len(),
        diagonal: glam::DVec3::from(lo).distance(hi.into()),
        distance: resolved.r,
        voxel: resolved.lattice.voxel,
        threads: run.threads(),
        runs: settings.runs,
        machine: machine(),
        results: Vec::new(),
        notes: Vec::new(),
    })
}

/// The methods that can run here; a note says what cannot.
fn available(
    methods: &[Method],
    programs: &Programs,
    run: &RunSettings,
    notes: &mut Vec<String>,
) -> Result<Vec<Method>, CompareError> {
    let mut methods = methods.to_vec();
    if methods.iter().any(|m| m.needs() == Needs::Meshlib)
        && let Err(sentence) = probe_meshlib(&programs.python, run)?
    {
        notes.push(sentence);
        methods.retain(|m| m.needs() != Needs::Meshlib);
    }
    match methods.is_empty() {
        true => Err(CompareError::Setting("there is nothing to compare: the package meshlib is not there")),
        false => Ok(methods),
    }
}
