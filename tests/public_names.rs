//! The library's public names: those at the root, and those of its public modules.
//!
//! `scripts/public_names.sh` lists the same from the documentation that rustdoc writes.

use std::fs;

/// More than a user can look through, and than can be kept stable.
const LIMIT: usize = 100;

/// The files that name what is public, with the prefix of what they name.
const FACES: [(&str, &str); 5] = [
    ("src/lib.rs", ""),
    ("src/io/mod.rs", "io::"),
    ("src/mesh/shapes/mod.rs", "shapes::"),
    ("src/vdb/mod.rs", "vdb::"),
    ("src/verify/mod.rs", "verify::"),
];

#[test]
fn public_names_are_few() {
    let mut names = Vec::new();
    for (path, prefix) in FACES {
        let found = public_names(&fs::read_to_string(path).unwrap());
        assert!(!found.is_empty(), "{path}");
        names.extend(found.into_iter().map(|name| format!("{prefix}{name}")));
    }
    assert!(names.len() < LIMIT, "{} public names:\n{}", names.len(), names.join("\n"));
    let modules = |text: &str| text.lines().filter(|line| line.starts_with("pub mod ")).count();
    assert_eq!(modules(&fs::read_to_string("src/lib.rs").unwrap()), 4, "io, vdb, verify and internals");
}

#[test]
fn names_are_recognised() {
    let text = "pub use a::{B, c};\npub use d::{\n    E, F,\n    g,\n};\n#[doc(hidden)]\npub use h::I;\n\
                /// Text.\npub fn j<T>() {}\npub(crate) fn k() {}\n#[derive(Debug)]\npub enum L {\n
                /// M,\n}\n\
                impl L {\n    pub fn n() {}\n}\n#[cfg(x)]\npub use o::P as Q;\npub static R: u8 = 0;\n";
    assert_eq!(public_names(text), ["B", "c", "E", "F", "g", "j", "L", "Q", "R"]);
}

/// The names that a file makes public at its top level.
fn public_names(text: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut hidden = false;
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.starts_with("#[") || line.starts_with("//") {
            hidden |= line == "#[doc(hidden)]";
            continue;
        }
        let mut item = line.to_string();
        while item.starts_with("pub use") && !item.contains(';') {
            item += lines.next().unwrap_or(";");
        }
        if let Some(item) = item.strip_prefix("pub ")
            && !hidden
        {
            names.extend(named(item));
        }
        hidden = false;
    }
    names
}

/// The names that an item declares.
fn named(item: &str) -> Vec<String> {
    if let Some(path) = item.strip_prefix("use ") {
        let list = path.trim_end_matches(';').rsplit_once('{').map_or(path, |(_, list)| list);
        let last =
            |name: &str| name.split([':', ' ', ';', '}']).rfind(|word| !word.is_empty()).map(String::from);
        return list.split(',').filter_map(last).collect();
    }
    let mut words = item.split([' ', '(', '<', ':', ';', '{']).filter(|word| !word.is_empty());
    match words.next() {
        Some("fn" | "struct" | "enum" | "trait" | "type" | "static" | "union") => {
            words.next().map(String::from).into_iter().collect()
        }
        Some("const") => words.find(|word| *word != "fn").map(String::from).into_iter().collect(),
        _ => Vec::new(),
    }
}
