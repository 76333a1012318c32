//! `exocarp verify`: judge a mesh as the offset surface of another.

use super::args::{Sign, VerifyArguments};
use super::exit::{Exit, Failure};
use super::files::{load_as_it_stands, load_mesh, save_json};
use super::format::{grouped, short};
use super::outputs;
use super::session::Session;
use exocarp::internals::mesh::Topology;
use exocarp::internals::verify::{ReportedLength, Statistics};
use exocarp::verify::{
    IntersectionReport, ShellReport, Subject, TopologyReport, VerifyReport, VerifySettings, verify,
};
use exocarp::{Length, TriMesh};
use serde::Serialize;

pub(super) fn run(arguments: &VerifyArguments, session: &Session) -> Result<(), Failure> {
    outputs::check(arguments.json.as_deref())?;
    let (input, _) = load_mesh(&arguments.input, session)?;
    if arguments.sign == Sign::Closed {
        refuse_open(arguments, &input.mesh, session)?;
    }
    let (output, _) = load_as_it_stands(&arguments.output, session)?;
    let settings = settings(arguments, &input.mesh);
    let report = verify(&input.mesh, &output, &settings, &session.run)?;
    if let Some(path) = &arguments.json {
        save(path, arguments, &report, session)?;
    }
    session.staging.commit()?;
    session.print_result(&table(&report, session.wall()))?;
    if report.is_kept() {
        return Ok(());
    }
    let how: Vec<&str> = report.broken.iter().map(|b| b.how.as_str()).collect();
    Err(Failure::new(
        Exit::Broken,
        format!("{} breaks a promise: {}", arguments.output.display(), how.join(", ")),
    ))
}

fn refuse_open(arguments: &VerifyArguments, mesh: &TriMesh, session: &Session) -> Result<(), Failure> {
    let topology = session.run.install(|| Topology::new(mesh));
    if topology.defects().is_closed() {
        return Ok(());
    }
    let shown = arguments.input.display();
    Err(Failure::new(
        Exit::Input,
        format!("{shown} is not the boundary of a solid; go ahead all the same with --sign pseudonormal"),
    ))
}

fn settings(arguments: &VerifyArguments, input: &TriMesh) -> VerifySettings {
    let [lo, hi] = input.bounding_box().unwrap_or_default();
    let diagonal = (0..3).map(|a| (hi[a] - lo[a]).powi(2)).sum::<f64>().sqrt();
    VerifySettings {
        distance: arguments.distance,
        voxel: arguments.voxel,
        tolerance: arguments.tolerance.map(|tolerance| match tolerance {
            Length::Units(e) => e,
            Length::DiagonalFraction(fraction) => fraction * diagonal,
        }),
        samples: arguments.samples,
        seed: arguments.seed,
        subject: arguments.shell.map_or(Subject::Offset, |thickness| Subject::Shell { thickness }),
        ..VerifySettings::default()
    }
}

/// The JSON file.
#[derive(Serialize)]
struct VerifyFile<'a> {
    exocarp: &'static str,
    command: &'static str,
    input: String,
    output: String,
    kept: bool,
    #[serde(flatten)]
    report: &'a VerifyReport,
    wall: f64,
}

fn save(
    path: &std::path::Path,
    arguments: &VerifyArguments,
    report: &VerifyReport,
    session: &Session,
) -> Result<(), Failure> {
    let file = VerifyFile {
        exocarp: env!("CARGO_PKG_VERSION"),
        command: "verify",
        input: arguments.input.display().to_string(),
        output: arguments.output.display().to_string(),
        kept: report.is_kept(),
        report,
        wall: session.wall(),
    };
    save_json(path, &file, session)
}

/// The report for people.
fn table(report: &VerifyReport, wall: f64) -> String {
    let judged = &report.judged;
    let mut text = format!(
        "distance {}, diagonal {}, voxel {}, {} samples, seed {}\n",
        short(judged.distance),
        short(judged.diagonal),
        judged.voxel.map_or("not given".into(), short),
        grouped(judged.samples as u64),
        judged.seed
    );
    text += &topology_rows(&report.soundness.topology);
    text += &intersection_rows(&report.soundness.intersections);
    text += &distance_rows(report);
    text += &crease_rows(report);
    text += &report.shell.as_ref().map_or(String::new(), shell_rows);
    let verdict = if report.is_kept() {
        "keeps all promises".into()
    } else {
        let lines: Vec<String> = report.broken.iter().map(|b| format!("\n  {}", b.how)).collect();
        format!("breaks promises:{}", lines.concat())
    };
    text + &format!("{verdict}\n{wall:.2} s")
}

fn row(name: &str, value: &str) -> String {
    format!("  {name:<24} {value}\n")
}

fn point(p: [f64; 3]) -> String {
    format!("({}, {}, {})", short(p[0]), short(p[1]), short(p[2]))
}

/// A count, and where the first one is.
fn count(name: &str, count: usize, first: Option<String>) -> String {
    let first = first.map_or(String::new(), |first| format!("   first: {first}"));
    row(name, &format!("{:>12}{first}", grouped(count as u64)))
}

fn topology_rows(t: &TopologyReport) -> String {
    let edge = |ends: Option<[[f64; 3]; 2]>| ends.map(|[a, b]| format!("{} to {}", point(a), point(b)));
    let triangle = |number: Option<u32>| number.map(|n| format!("triangle {n}"));
    let mut text = "topology\n".to_string();
    text += &count("vertices", t.vertices, None);
    text += &count("triangles", t.triangles, None);
    text += &count("components", t.components, None);
    text += &row("Euler number", &format!("{:>12}", t.euler));
    text += &row("genus", &format!("{:>12}", t.genus.map_or("none".into(), |g| g.to_string())));
    text += &count("border edges", t.border_edges, edge(t.first_border));
    text += &count("non-manifold edges", t.non_manifold_edges, edge(t.first_non_manifold_edge));
    text += &count("non-manifold vertices", t.non_manifold_vertices, t.first_non_manifold_vertex.map(point));
    text += &count("misoriented edges", t.misoriented_edges, edge(t.first_misoriented));
    text += &count("degenerate triangles", t.degenerate_triangles, triangle(t.first_degenerate));
    text += &count("duplicate triangles", t.duplicate_triangles, triangle(t.first_duplicate));
    let smallest = t.smallest_angle.zip(t.smallest_angle_triangle);
    let smallest = smallest.map(|(angle, n)| format!("{angle:.3} degrees in triangle {n}"));
    text += &row(
        "angles below 1 degree",
        &format!(
            "{:>12}{}",
            grouped(t.slivers as u64),
            smallest.map_or(String::new(), |s| format!("   smallest: {s}"))
        ),
    );
    text
}

fn intersection_rows(found: &IntersectionReport) -> String {
    let mut text = row("intersecting pairs", &format!("{:>12}", grouped(found.pairs)));
    for pair in &found.first {
        let [a, b] = pair.triangles;
        text += &row("", &format!("{:>12}   triangles {a} and {b} at {}", "", point(pair.point)));
    }
    text
}

fn distance_rows(report: &VerifyReport) -> String {
    let (d, m) = (&report.distance, &report.missing);
    let mut text = heading("error of OUTPUT");
    text +=
        &sizes(&[("surface", &d.surface), ("vertices", &d.vertices), ("edge midpoints", &d.edge_midpoints)]);
    text += &place("largest", d.max, d.max_at);
    if let Some(share) = d.wrong_side {
        text += &row("on the wrong side", &format!("{:>11.4}%", 100.0 * share));
    }
    text += &heading("missing from OUTPUT");
    text += &sizes(&[
        ("offsets of faces", &m.faces),
        ("arcs of edges", &m.edges),
        ("caps of vertices", &m.vertices),
    ]);
    text += &place("largest", m.max, m.max_at);
    if let Some((limit, share)) = m.limit.zip(m.share) {
        text += &row(&format!("farther than {}", short(limit)), &format!("{:>11.4}%", 100.0 * share));
    }
    text
}

fn heading(name: &str) -> String {
    let columns = ["mean", "rms", "99.9%", "max"].map(|c| format!("{c:>12}")).concat();
    format!("{name:<22}{:>12} {columns}\n", "samples")
}

/// A line for each set of samples and unit.
fn sizes(sets: &[(&str, &Statistics)]) -> String {
    let mut text = String::new();
    for &(name, s) in sets {
        if s.samples == 0 {
            text += &format!("  {name:<20}{:>12}\n", 0);
            continue;
        }
        let sizes = [s.mean, s.rms, s.p999, s.max];
        let line = |of: fn(&ReportedLength) -> Option<f64>| -> Option<String> {
            sizes.iter().map(|size| of(size).map(|x| format!("{x:>12.3e}"))).collect()
        };
        let samples = grouped(s.samples as u64);
        let rows = [
            (name, samples.as_str(), line(|size| Some(size.units)), ""),
            ("", "", line(|size| Some(size.percent_of_diagonal)), " % of diagonal"),
            ("", "", line(|size| size.voxels), " voxels"),
        ];
        for (name, samples, numbers, unit) in rows {
            text += &numbers.map_or(String::new(), |n| format!("  {name:<20}{samples:>12} {n}{unit}\n"));
        }
    }
    text
}

fn place(name: &str, size: ReportedLength, at: Option<[f64; 3]>) -> String {
    at.map_or(String::new(), |at| row(name, &format!("{:>12.3e}   at {}", size.units, point(at))))
}

fn crease_rows(report: &VerifyReport) -> String {
    let creases = &report.creases;
    let Some(share) = creases.share else { return "creases\n".to_string() + &row("none", "") };
    let mut text = "creases\n".to_string();
    text += &row("length", &format!("{:>12}", short(creases.length)));
    text +=
        &row("with an edge along", &format!("{:>11.2}%   within {}", 100.0 * share, short(creases.within)));
    text += &creases.first_absent.map_or(String::new(), |p| row("first without", &point(p)));
    text
}

fn shell_rows(shell: &ShellReport) -> String {
    let mut text = "shell\n".to_string();
    text += &count("at INPUT's surface", shell.surface_triangles, None);
    text += &count("at the offset", shell.offset_triangles, None);
    text += &count("walls between", shell.wall_triangles, None);
    if let Some(t) = &shell.thickness {
        text += &place("thinnest", t.min, Some(t.min_at));
        text += &row("mean", &format!("{:>12.3e}   wanted {}", t.mean.units, short(shell.wanted)));
        text += &place("thickest", t.max, Some(t.max_at));
    }
    text
}
