//! `exocarp model`: generated models.

use super::args::ModelArguments;
use super::exit::Failure;
use super::files::{check_mesh_output, precision, save_mesh};
use super::format::{counted, short};
use super::outputs;
use super::session::{Session, print};
use exocarp::Phase;
use exocarp::shapes::{self, Shape};

pub(super) fn run(arguments: &ModelArguments, session: &Session) -> Result<(), Failure> {
    let (Some(name), Some(output)) = (&arguments.name, &arguments.output) else {
        return print(&list());
    };
    let Some(shape) = shapes::by_name(name) else {
        return Err(Failure::usage(format!("there is no model {name:?}; exocarp model lists them")));
    };
    check_mesh_output(output, arguments.f64)?;
    outputs::check([output.as_path()])?;
    let mesh = (shape.make)(arguments.detail);
    session.phase(Phase::Write, || save_mesh(&mesh, output, precision(arguments.f64), session))?;
    session.staging.commit()?;
    session.print_result(&format!(
        "{}: {}, {}",
        output.display(),
        counted(mesh.triangles.len(), "triangle", "triangles"),
        counted(mesh.vertices.len(), "vertex", "vertices"),
    ))
}

fn list() -> String {
    let width = |of: fn(&Shape) -> usize| shapes::ALL.iter().map(of).max().unwrap_or(0);
    let (name, about) = (width(|s| s.name.len()), width(|s| s.about.len()));
    let mut text = format!("{:name$}  {:about$}  volume\n", "model", "what it is");
    for shape in shapes::ALL {
        let volume = shape.volume.map_or("open".into(), |v| short(v.value()));
        text += &format!("{:name$}  {:about$}  {volume}\n", shape.name, shape.about);
    }
    text + "\nexocarp model NAME -o FILE writes one."
}
