//! The rooms' order: `src/lib.rs` lists the modules so that each imports only from those above it.
//!
//! Nothing is exempt: the umbrella over all errors comes last, so that no room can import it, and
//! so does the door through which the program, benches and tests reach the rooms. Tests beside the
//! code may import from anywhere.

use std::fs;
use std::path::{Path, PathBuf};

/// Crates that only the program needs.
const OF_THE_PROGRAM: [&str; 4] = ["clap", "clap_complete", "ctrlc", "indicatif"];

/// Files `mod.rs` that hold code, which may not grow in number: the others are faces, of
/// documentation, modules and what is exported.
const NOT_FACES: usize = 6;

#[test]
fn no_arrow_runs_back() {
    let order = modules();
    assert!(order.len() > 10, "too few modules were found in lib.rs: {order:?}");
    let (mut arrows, mut wrong) = (0, Vec::new());
    for path in sources(Path::new("src")) {
        let Some(room) = room(&path) else { continue };
        let text = fs::read_to_string(&path).unwrap();
        let (count, faults) = backward(&order, &room, &text);
        arrows += count;
        wrong.extend(faults.into_iter().map(|fault| format!("{}:{fault}", path.display())));
    }
    assert!(arrows > 20, "only {arrows} imports were found");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn arrows_that_run_back_are_found() {
    let order: Vec<String> = ["mesh", "band", "error"].map(String::from).into();
    let faults = |room: &str, text: &str| backward(&order, room, text).1.len();
    assert_eq!(faults("band", "use crate::mesh::TriMesh;\nuse crate::band::Ijk;"), 0);
    assert_eq!(faults("mesh", "use crate::band::Ijk;\nuse crate::{error::Error, mesh};"), 2);
    assert_eq!(faults("band", "use crate::error::Error;"), 1);
    // The root's names are for users.
    assert_eq!(faults("band", "use crate::Precision;"), 1);
    assert_eq!(faults("unlisted", "use crate::mesh::TriMesh;"), 1);
}

#[test]
fn examples_need_public_names_only() {
    let examples = sources(Path::new("examples"));
    assert!(!examples.is_empty());
    for path in examples.iter().map(PathBuf::as_path).chain([Path::new("README.md"), Path::new("src/lib.rs")])
    {
        let text = fs::read_to_string(path).unwrap();
        assert!(!text.contains("exocarp::internals"), "{} uses what users cannot rely on", path.display());
    }
}

#[test]
fn sentences_of_the_library_name_no_option() {
    let is_option = |text: &str| {
        text.split_once("--").is_some_and(|(_, after)| after.starts_with(|c: char| c.is_ascii_lowercase()))
    };
    assert!(is_option("or raise --max-memory") && !is_option("a -- b") && !is_option("--"));
    for path in sources(Path::new("src")) {
        // Comparisons start the program, with its options.
        let Some(room) = room(&path).filter(|room| room != "compare") else { continue };
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or_default();
            assert!(!is_option(code), "{}:{}: {room} names an option", path.display(), number + 1);
        }
    }
}

#[test]
fn the_library_needs_no_crate_of_the_program() {
    let (mut program, mut wrong) = (0, Vec::new());
    for path in sources(Path::new("src")) {
        let is_program = path.starts_with("src/cli") || path == Path::new("src/main.rs");
        let text = fs::read_to_string(&path).unwrap();
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        let named = code.flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_'));
        let used = named.filter(|word| OF_THE_PROGRAM.contains(word)).count();
        if is_program {
            program += used;
        } else if used > 0 {
            wrong.push(path.display().to_string());
        }
    }
    assert!(program > 5, "only {program} uses were found in the program");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn files_named_mod_are_faces() {
    let holds_code = |path: &PathBuf| defines_something(&fs::read_to_string(path).unwrap());
    let all = sources(Path::new("src")).into_iter().filter(|path| path.ends_with("mod.rs"));
    let (with_code, faces): (Vec<PathBuf>, Vec<PathBuf>) = all.partition(holds_code);
    assert!(faces.len() > 10, "only {} faces were found", faces.len());
    assert!(with_code.len() <= NOT_FACES, "{with_code:?}");
}

/// Whether a file defines a function, a type or a value.
fn defines_something(text: &str) -> bool {
    const DEFINITIONS: [&str; 7] = ["fn ", "struct ", "enum ", "trait ", "impl", "const ", "static "];
    text.lines().any(|line| {
        let line = line.strip_prefix("pub").unwrap_or(line);
        let line = line.strip_prefix("(crate)").or(line.strip_prefix("(super)")).unwrap_or(line);
        DEFINITIONS.iter().any(|word| line.trim_start_matches(' ').starts_with(word))
    })
}

#[test]
fn ignored_tests_say_what_they_need() {
    let mut ignored = 0;
    for path in sources(Path::new("src")).into_iter().chain(sources(Path::new("tests"))) {
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let Some(attribute) = line.trim().strip_prefix("#[ignore") else { continue };
            ignored += 1;
            let reason = attribute.strip_prefix(" = \"").unwrap_or_default();
            let says = reason.starts_with("needs ") || reason.starts_with("takes minutes");
            assert!(says, "{}:{}: {line}", path.display(), number + 1);
        }
    }
    assert!(ignored > 5, "only {ignored} were found");
}

/// The number of imports in a file of `room`, and those from rooms that come after it.
fn backward(order: &[String], room: &str, text: &str) -> (usize, Vec<String>) {
    let rank = |module: &str| order.iter().position(|m| m == module);
    let Some(own) = rank(room) else { return (0, vec![format!("1: lib.rs does not list {room}")]) };
    let used = used_modules(text);
    let fault = |(line, used): &(usize, String)| match rank(used) {
        None => Some(format!("{line}: lib.rs does not list {used}")),
        Some(other) if other > own => Some(format!("{line}: {room} uses {used}, which comes after it")),
        Some(_) => None,
    };
    (used.len(), used.iter().filter_map(fault).collect())
}

/// The modules of the library in the order of lib.rs.
fn modules() -> Vec<String> {
    let text = fs::read_to_string("src/lib.rs").unwrap();
    let module = |line: &str| {
        let line = line.strip_prefix("pub ").unwrap_or(line);
        Some(line.strip_prefix("mod ")?.strip_suffix(';')?.to_string())
    };
    text.lines().filter_map(module).collect()
}

/// The top-level module that a file belongs to; none for lib.rs, the program, the tests, and what
/// stands above all rooms.
fn room(path: &Path) -> Option<String> {
    let inside = path.strip_prefix("src").unwrap();
    let parts: Vec<&str> = inside.iter().map(|p| p.to_str().unwrap()).collect();
    let first = parts[0].trim_end_matches(".rs");
    let is_test = parts.iter().any(|p| matches!(*p, "tests" | "tests.rs"));
    (!is_test && !["lib", "main", "cli", "internals"].contains(&first)).then(|| first.to_string())
}

/// Each `crate::module` outside of comments and before the tests at the end, with its line.
fn used_modules(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut lines = text.lines().enumerate().peekable();
    while let Some((number, line)) = lines.next() {
        let inline_tests = line.trim() == "#[cfg(test)]"
            && lines.peek().is_some_and(|(_, next)| next.starts_with("mod ") && next.ends_with('{'));
        if inline_tests {
            break;
        }
        let code = line.split("//").next().unwrap_or_default();
        for after in code.split("crate::").skip(1) {
            // A list begins with braces; none of its parts may hide.
            let list = after.strip_prefix('{').map_or(after, |l| l.split('}').next().unwrap_or(l));
            let parts: Vec<&str> =
                if list.len() == after.len() { vec![after] } else { list.split(',').collect() };
            for part in parts {
                let name: String =
                    part.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                if !name.is_empty() {
                    found.push((number + 1, name));
                }
            }
        }
    }
    found
}

/// All Rust files under a directory, sorted.
fn sources(directory: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in fs::read_dir(directory).unwrap().map(|e| e.unwrap().path()) {
        if entry.is_dir() {
            all.extend(sources(&entry));
        } else if entry.extension().is_some_and(|e| e == "rs") {
            all.push(entry);
        }
    }
    all.sort();
    all
}

#[test]
fn imports_are_recognised() {
    let text = "use crate::mesh::TriMesh;\nuse crate::{band::build, run};\n// crate::offset\nlet x = crate::io::load;\n\
                #[cfg(test)]\nmod tests;\n#[cfg(test)]\nmod more {\nuse crate::offset::x;\n}";
    let names: Vec<String> = used_modules(text).into_iter().map(|(_, name)| name).collect();
    assert_eq!(names, ["mesh", "band", "run", "io"]);
}

#[test]
fn definitions_are_recognised() {
    assert!(!defines_something("//! Docs of fn.\nmod a;\npub use a::{b, c};\n"));
    for code in ["pub fn a() {}", "    fn a(&self)", "pub(crate) struct A;", "impl A {", "const A: u8 = 1;"] {
        assert!(defines_something(code), "{code}");
    }
}
