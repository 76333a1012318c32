//! The shell blocks of README.md, run as they stand.

mod common;

use std::fs;
use std::process::{Command, Stdio};

/// Stands before a block that is not run, with the reason.
const NOT_RUN: &str = "<!-- not run: ";

/// Resolution at most: each command runs as it stands but for this, so that a debug build does them
/// all.
const RESOLUTION: u32 = 64;

#[test]
fn shell_blocks_can_be_pasted() {
    let text = fs::read_to_string("README.md").unwrap();
    let blocks = shell_blocks(&text);
    assert!(blocks.len() >= 4, "only {} blocks were found", blocks.len());
    for block in blocks {
        let directory = tempfile::tempdir().unwrap();
        let output = Command::new("bash")
            .args(["-e", "-u", "-o", "pipefail", "-c", &coarser(&block)])
            .current_dir(&directory)
            .env("PATH", path_with_the_program())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        assert!(output.status.success(), "{block}\n{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn blocks_are_found_and_made_coarser() {
    let text = "```sh\na\n```\n<!-- not run: b -->\n```sh\nc\n```\n```rust\nd\n```\n```sh\ne\nf\n```\n";
    assert_eq!(shell_blocks(text), ["a\n", "e\nf\n"]);
    assert_eq!(coarser("x --resolution 512 -o y\nz\n"), "x --resolution 64 -o y\nz\n");
    assert_eq!(coarser("x --resolution 48\n"), "x --resolution 48\n");
}

/// The `sh` blocks of a Markdown text that are to be run.
fn shell_blocks(text: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut before = "";
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line == "```sh" {
            let block = lines.by_ref().take_while(|line| *line != "```");
            let block: String = block.map(|line| format!("{line}\n")).collect();
            if !before.starts_with(NOT_RUN) {
                blocks.push(block);
            }
        }
        before = line;
    }
    blocks
}

/// A block with no resolution above [`RESOLUTION`].
fn coarser(block: &str) -> String {
    let mut parts = block.split("--resolution ");
    let mut text = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        let resolution: u32 = part[..digits].parse().unwrap();
        text += &format!("--resolution {}{}", resolution.min(RESOLUTION), &part[digits..]);
    }
    text
}

/// The search path, with the directory of the program that is tested first.
fn path_with_the_program() -> std::ffi::OsString {
    let program = common::command(&[]).get_program().to_owned();
    let directory = std::path::PathBuf::from(program).parent().unwrap().to_path_buf();
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths([directory].into_iter().chain(std::env::split_paths(&others))).unwrap()
}
