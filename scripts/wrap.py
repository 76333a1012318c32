#!/usr/bin/env python3
"""Wraps comments of Rust files and prose of Markdown files at 100 columns.

    python3 scripts/wrap.py README.md src/io      files, or directories with all in them

A paragraph is wrapped anew where one of its lines is too long; all others stay as they are. Code,
tables, headings, pictures in text and comments behind code are left alone. tests/prose.rs checks
the width.
"""

import re
import sys
import textwrap
from pathlib import Path

WIDTH = 100
# A word that would begin a list or a heading at the start of a line stays behind its predecessor.
MARKER = re.compile(r"^([-+*#>=|]+|\d+[.)])$")
# Rows of tables, headings, pictures, HTML, quotes, and the targets of links.
LEFT_ALONE = re.compile(r"^\|.*\|$|^#+ |^!\[|^<|^>|^\[[^]]*\]: \S+$")
ITEM = re.compile(r"^(\s*)([-*]|\d+\.) +(?=\S)")


def fill(text, first, rest, width):
    words = []
    for word in text.split():
        if words and MARKER.match(word):
            words[-1] += "\0" + word
        else:
            words.append(word)
    lines = textwrap.wrap(
        " ".join(words),
        width,
        initial_indent=first,
        subsequent_indent=rest,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace("\0", " ") for line in lines]


def wrapped(lines, width):
    """Wraps Markdown lines; paragraphs that fit stay as they are."""
    out, paragraph, in_code = [], [], False

    def flush():
        if paragraph and any(len(line) > width for line in paragraph):
            item = ITEM.match(paragraph[0])
            first = item.group(0) if item else re.match(r"\s*", paragraph[0]).group(0)
            text = " ".join([paragraph[0][len(first) :]] + paragraph[1:])
            out.extend(fill(text, first, " " * len(first), width))
        else:
            out.extend(paragraph)
        paragraph.clear()

    for line in lines:
        stripped = line.strip()
        if stripped.startswith("```"):
            flush()
            in_code = not in_code
            out.append(line)
        elif in_code or not stripped or LEFT_ALONE.match(stripped):
            flush()
            out.append(line)
        elif not paragraph and line.startswith("    ") and not ITEM.match(line):
            out.append(line)
        else:
            if ITEM.match(line):
                flush()
            paragraph.append(line)
    flush()
    return out


def rust(lines):
    """Wraps the comments that have their lines to themselves."""
    out, block, prefix = [], [], None

    def flush():
        width = WIDTH - len(prefix or "")
        out.extend((prefix + line).rstrip() for line in wrapped(block, width))
        block.clear()

    for line in lines:
        comment = re.match(r"^(\s*//[/!]?(?!/) ?)(.*)$", line)
        found = comment.group(1).rstrip() + " " if comment else None
        if found != prefix:
            flush()
            prefix = found
        if comment:
            block.append(comment.group(2))
        else:
            out.append(line)
    flush()
    return out


def main():
    for root in map(Path, sys.argv[1:]):
        files = [root] if root.is_file() else sorted(root.rglob("*"))
        for path in files:
            if path.suffix not in (".rs", ".md"):
                continue
            text = path.read_text()
            lines = text.split("\n")
            new = "\n".join(rust(lines) if path.suffix == ".rs" else wrapped(lines, WIDTH))
            if new != text:
                path.write_text(new)
                print(path)


if __name__ == "__main__":
    main()
