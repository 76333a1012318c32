//! The prose of the repository: how wide it is, how doc comments begin, and that what it names
//! exists.

use std::fs;
use std::path::{Path, PathBuf};

/// The width of comments and of Markdown, in columns; `scripts/wrap.py` wraps at it.
const COLUMNS: usize = 100;

/// First words that refer to another item, which a tooltip does not show.
const ANAPHORS: [&str; 13] = [
    "The same", "Those", "These", "Their", "Theirs", "Its", "It", "They", "Them", "And", "Such", "That",
    "This",
];

/// Beginnings of names of files, in backticks.
const ROOTS: [&str; 8] = ["src/", "tests/", "docs/", "cpp/", "scripts/", "examples/", "benches/", ".ci/"];

#[test]
fn markdown_fits_its_width() {
    let mut wide = Vec::new();
    for path in markdown() {
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in prose_lines(&text) {
            let is_link = !line.trim_start_matches("- ").trim().contains(' ');
            if line.chars().count() > COLUMNS && !is_table(line) && !is_link {
                wide.push(format!("{}:{number}", path.display()));
            }
        }
    }
    assert!(wide.is_empty(), "wider than {COLUMNS} columns:\n{}", wide.join("\n"));
}

#[test]
fn comments_fit_their_width() {
    let mut wide = Vec::new();
    for path in rust() {
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else { continue };
            let text = comment.trim_start_matches(['/', '!']).trim();
            if line.chars().count() > COLUMNS && !is_table(text) && text.contains(' ') {
                wide.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(wide.is_empty(), "wider than {COLUMNS} columns:\n{}", wide.join("\n"));
}

#[test]
fn doc_comments_name_their_subject() {
    let (mut all, mut found) = (0, Vec::new());
    for path in rust() {
        let mut in_comment = false;
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let line = line.trim_start();
            let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
            if let (Some(text), false) = (doc, in_comment) {
                all += 1;
                if ANAPHORS.iter().any(|word| begins_with(text.trim_start(), word)) {
                    found.push(format!("{}:{}:{text}", path.display(), number + 1));
                }
            }
            in_comment = doc.is_some();
        }
    }
    assert!(all > 1000, "only {all} doc comments were found");
    assert!(found.is_empty(), "{} begin with a pronoun:\n{}", found.len(), found.join("\n"));
}

#[test]
fn files_that_prose_names_exist() {
    let (mut all, mut missing) = (0, Vec::new());
    for path in markdown() {
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in prose_lines(&text) {
            for name in line.split('`').skip(1).step_by(2) {
                if !ROOTS.iter().any(|root| name.starts_with(root)) || name.contains(['*', ' ', '<']) {
                    continue;
                }
                all += 1;
                if !Path::new(name).exists() {
                    missing.push(format!("{}:{number}: {name}", path.display()));
                }
            }
        }
    }
    for path in rust() {
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else { continue };
            for word in comment.split(|c: char| c.is_whitespace() || "`(),;:\"".contains(c)) {
                let word = word.trim_end_matches('.');
                if word.starts_with("docs/") && word.ends_with(".md") {
                    all += 1;
                    if !Path::new(word).is_file() {
                        missing.push(format!("{}:{}: {word}", path.display(), number + 1));
                    }
                }
            }
        }
    }
    assert!(all > 60, "only {all} names were found");
    assert!(missing.is_empty(), "there is no\n{}", missing.join("\n"));
}

#[test]
fn tests_that_prose_names_exist() {
    let code: String = rust().iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let (mut all, mut missing) = (0, Vec::new());
    for path in markdown() {
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in prose_lines(&text) {
            for name in line.split('`').skip(1).step_by(2) {
                let is_sentence =
                    name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
                if is_sentence && name.matches('_').count() >= 4 {
                    all += 1;
                    if !code.contains(&format!("fn {name}(")) {
                        missing.push(format!("{}:{number}: {name}", path.display()));
                    }
                }
            }
        }
    }
    assert!(all > 10, "only {all} names were found");
    assert!(missing.is_empty(), "there is no test\n{}", missing.join("\n"));
}

#[test]
fn all_rooms_are_in_the_architecture() {
    let library = fs::read_to_string("src/lib.rs").unwrap();
    let page = fs::read_to_string("ARCHITECTURE.md").unwrap();
    let mut rooms = 0;
    for line in library.lines() {
        let Some(name) =
            line.split_once("mod ").filter(|(before, _)| before.is_empty() || before.starts_with("pub"))
        else {
            continue;
        };
        let Some(name) = name.1.strip_suffix(';') else { continue };
        rooms += 1;
        assert!(page.contains(&format!("\n| `{name}` |")), "ARCHITECTURE.md has no line for {name}");
    }
    assert!(rooms > 10, "only {rooms} rooms were found");
}

#[test]
fn links_resolve() {
    let (mut all, mut broken) = (0, Vec::new());
    for path in markdown() {
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in prose_lines(&text) {
            for target in targets(line) {
                if target.contains("://") {
                    continue;
                }
                all += 1;
                let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
                let to = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
                let has_anchor =
                    || anchor.is_empty() || headings(&to).iter().any(|heading| heading == anchor);
                if !to.exists() || !has_anchor() {
                    broken.push(format!("{}:{number}: {target}", path.display()));
                }
            }
        }
    }
    assert!(all > 20, "only {all} links were found");
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

#[test]
fn the_checks_see_what_they_look_for() {
    assert!(begins_with("The same for triangles.", "The same") && begins_with("It is", "It"));
    assert!(!begins_with("Items of a list.", "It") && !begins_with("Thatched", "That"));
    assert_eq!(targets("see [a](b.md) and ![c](d.png), [e]: f.md"), ["b.md", "d.png"]);
    assert_eq!(targets("[LW11]: docs/paper-map.md#lw11-offsets"), ["docs/paper-map.md#lw11-offsets"]);
    assert_eq!(anchor("## [LW11]: offsets, `x` & y"), "lw11-offsets-x--y");
    let text = "a\n```sh\nb\n```\nc";
    assert_eq!(prose_lines(text).map(|(_, line)| line).collect::<Vec<_>>(), ["a", "c"]);
}

/// Whether `text` begins with `word` as a whole word.
fn begins_with(text: &str, word: &str) -> bool {
    text.strip_prefix(word).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
}

/// Whether a line is a row of a table.
fn is_table(line: &str) -> bool {
    let line = line.trim();
    line.starts_with('|') && line.ends_with('|')
}

/// The lines of a Markdown text outside of code, with their numbers from 1.
fn prose_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    text.lines().enumerate().filter_map(move |(number, line)| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        (!in_code && !is_fence).then_some((number + 1, line))
    })
}

/// The targets of a line's links and pictures.
fn targets(line: &str) -> Vec<&str> {
    if let Some((name, target)) = line.split_once("]: ")
        && name.starts_with('[')
        && !target.contains(' ')
    {
        return vec![target];
    }
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// The anchors of a page's headings.
fn headings(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap_or_default();
    prose_lines(&text).filter(|(_, line)| line.starts_with('#')).map(|(_, line)| anchor(line)).collect()
}

/// The anchor that a heading gets on the usual forges.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// All pages: at the root, and under `docs`.
fn markdown() -> Vec<PathBuf> {
    let mut all = files(Path::new("docs"), "md");
    all.extend(["README.md", "ARCHITECTURE.md", "CHANGELOG.md"].map(PathBuf::from));
    all
}

/// All Rust files of the crate.
fn rust() -> Vec<PathBuf> {
    let mut all = vec![PathBuf::from("build.rs")];
    for directory in ["src", "tests", "examples", "benches"] {
        all.extend(files(Path::new(directory), "rs"));
    }
    all
}

/// All files with an extension under a directory, sorted.
fn files(directory: &Path, extension: &str) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            all.extend(files(&entry, extension));
        } else if entry.extension().is_some_and(|e| e == extension) {
            all.push(entry);
        }
    }
    all.sort();
    all
}
