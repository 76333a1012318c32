//! The program `exocarp`: offset surfaces of triangle meshes from the command line.
//!
//! It uses nothing but the library's public API.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
