//! The rooms' order: `src/lib.rs` lists the modules so that each imports only from those above it.
//!
//! `error`, `run` and `geom` lie under all. One arrow runs back by intention: `error` names the
//! error of every stage. Tests beside the code may import from anywhere; the program in `src/cli`
//! uses the public API only.

use std::fs;
use std::path::{Path, PathBuf};

/// Lie under all others, and import from one another only.
const BASE: [&str; 4] = ["error", "geom", "quantity", "run"];

#[test]
fn no_arrow_runs_back() {
    let order = modules();
    assert!(order.len() > 10, "too few modules were found in lib.rs: {order:?}");
    let rank = |module: &str| order.iter().position(|m| m == module);
    let (mut arrows, mut wrong) = (0, Vec::new());
    for path in sources(Path::new("src")) {
        let Some(room) = room(&path) else { continue };
        let Some(own) = rank(&room) else {
            wrong.push(format!("{}: lib.rs does not list {room}", path.display()));
            continue;
        };
        for (line, used) in used_modules(&fs::read_to_string(&path).unwrap()) {
            arrows += 1;
            let place = format!("{}:{line}", path.display());
            match rank(&used) {
                None => wrong.push(format!("{place}: lib.rs does not list {used}")),
                Some(_) if BASE.contains(&used.as_str()) => {}
                Some(other) if other > own => {
                    wrong.push(format!("{place}: {room} uses {used}, which comes after it"));
                }
                Some(_) => {}
            }
        }
    }
    assert!(arrows > 20, "only {arrows} imports were found");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn the_program_uses_the_public_api_only() {
    for path in sources(Path::new("src/cli")) {
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            used_modules(&text).is_empty(),
            "{} uses crate::, which is the program there",
            path.display()
        );
    }
}

/// The modules of the library in the order of lib.rs, those of the base first.
fn modules() -> Vec<String> {
    let text = fs::read_to_string("src/lib.rs").unwrap();
    let listed =
        text.lines().filter_map(|l| Some(l.strip_prefix("pub mod ")?.strip_suffix(';')?.to_string()));
    let mut order: Vec<String> = listed.collect();
    order.sort_by_key(|m| !BASE.contains(&m.as_str()));
    order
}

/// The top-level module that a file belongs to; none for lib.rs, the program, the tests, and
/// `error`.
fn room(path: &Path) -> Option<String> {
    let inside = path.strip_prefix("src").unwrap();
    let parts: Vec<&str> = inside.iter().map(|p| p.to_str().unwrap()).collect();
    let first = parts[0].trim_end_matches(".rs");
    let is_test = parts.iter().any(|p| matches!(*p, "tests" | "tests.rs"));
    (!is_test && !["lib", "main", "cli", "error", "internals"].contains(&first)).then(|| first.to_string())
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
