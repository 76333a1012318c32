//! Text files as lines and words, with line numbers for messages; and numbers as text.

use std::io::{BufRead, Read, Seek, SeekFrom, Write};
use std::ops::Range;

use super::Format;
use super::error::{Fault, Problem, quote};

/// The longest line that is read. Polygons of a million corners fit; a binary file without line ends
/// does not get to fill the memory.
const LONGEST_LINE: u64 = 1 << 26;

/// Reads a text file line by line and a line word by word. Lines end with LF or CRLF; a byte order mark
/// is skipped.
pub(super) struct Text<R> {
    reader: R,
    format: Format,
    line: Vec<u8>,
    number: u64,
    /// Where in `line` the next word is looked for.
    next: usize,
    /// Begins a comment that ends with the line.
    comment: Option<u8>,
}

impl<R: BufRead> Text<R> {
    /// Reads `reader`, whose next line is the one after `number`.
    pub(super) fn new(reader: R, format: Format, number: u64) -> Self {
        Text { reader, format, line: Vec::new(), number, next: 0, comment: None }
    }

    /// Skips everything from `mark` to the end of its line.
    pub(super) fn with_comments(mut self, mark: u8) -> Self {
        self.comment = Some(mark);
        self
    }

    /// Goes to the next line. `false` at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<bool, Fault> {
        self.line.clear();
        self.append_line()
    }

    /// Appends the next line to the present one. `false` at the end of the file.
    pub(super) fn append_line(&mut self) -> Result<bool, Fault> {
        let start = self.line.len();
        self.next = 0;
        let read = (&mut self.reader).take(LONGEST_LINE).read_until(b'\n', &mut self.line)?;
        if read == 0 {
            return Ok(false);
        }
        self.number += 1;
        let not_text = |reason: &str| {
            Problem::WrongFormat { format: self.format, reason: reason.into() }.on_line(self.number)
        };
        if self.line[start..].contains(&0) {
            return Err(not_text("binary data stands where text belongs"));
        }
        if read as u64 == LONGEST_LINE {
            return Err(not_text("the line has no end"));
        }
        while matches!(self.line.last(), Some(b'\n' | b'\r')) {
            self.line.pop();
        }
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        if let Some(mark) = self.comment
            && let Some(at) = self.line.iter().position(|&b| b == mark)
        {
            self.line.truncate(at);
        }
        Ok(true)
    }

    /// The present line.
    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Drops the last byte of the present line.
    pub(super) fn shorten(&mut self) {
        self.line.pop();
    }

    /// `problem` on the present line.
    pub(super) fn fault(&self, problem: Problem) -> Fault {
        problem.on_line(self.number)
    }

    /// The bytes of a word.
    pub(super) fn bytes(&self, word: Range<usize>) -> &[u8] {
        &self.line[word]
    }

    /// The next word of the present line, if there is one.
    pub(super) fn word_on_line(&mut self) -> Option<Range<usize>> {
        let rest = &self.line[self.next..];
        let start = self.next + rest.iter().position(|b| !is_space(*b))?;
        let length = self.line[start..].iter().position(|b| is_space(*b));
        let end = length.map_or(self.line.len(), |l| start + l);
        self.next = end;
        Some(start..end)
    }

    /// The next word of the file, on this line or on a later one; `None` at the end.
    pub(super) fn word(&mut self) -> Result<Option<Range<usize>>, Fault> {
        loop {
            if let Some(word) = self.word_on_line() {
                return Ok(Some(word));
            }
            if !self.next_line()? {
                return Ok(None);
            }
        }
    }

    /// The next word of the file, which must be there.
    pub(super) fn expect_word(&mut self, expected: &str) -> Result<Range<usize>, Fault> {
        let word = self.word()?;
        word.ok_or_else(|| self.fault(Problem::truncated(expected)))
    }

    /// The next word as a finite number.
    pub(super) fn coordinate(&mut self, expected: &str) -> Result<f64, Fault> {
        let word = self.expect_word(expected)?;
        match parse::<f64>(self.bytes(word.clone())) {
            Some(x) if x.is_finite() => Ok(x),
            Some(_) => Err(self.fault(Problem::NonFinite(quote(self.bytes(word))))),
            None => Err(self.fault(Problem::syntax(self.bytes(word), expected))),
        }
    }

    /// The next word as an integer.
    pub(super) fn integer(&mut self, expected: &str) -> Result<i64, Fault> {
        let word = self.expect_word(expected)?;
        let bytes = self.bytes(word);
        parse(bytes).ok_or_else(|| self.fault(Problem::syntax(bytes, expected)))
    }

    /// The next word as a count.
    pub(super) fn count(&mut self, expected: &str) -> Result<u64, Fault> {
        let word = self.expect_word(expected)?;
        let bytes = self.bytes(word);
        parse(bytes).ok_or_else(|| self.fault(Problem::syntax(bytes, expected)))
    }

    /// Makes `word`, of the present line, the next one.
    pub(super) fn go_back_to(&mut self, word: Range<usize>) {
        self.next = word.start;
    }

    /// Ignores what is left of the present line.
    pub(super) fn skip_rest_of_line(&mut self) {
        self.next = self.line.len();
    }
}

impl<R: BufRead + Seek> Text<R> {
    /// Goes back to the beginning of the file.
    pub(super) fn rewind(&mut self) -> Result<(), Fault> {
        self.reader.seek(SeekFrom::Start(0))?;
        self.line.clear();
        (self.number, self.next) = (0, 0);
        Ok(())
    }
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// A word as a number.
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Writes the shortest text that reads back as `x`. If `x` is exactly an f32, it reads back as that into an f32, too, but the
/// shortest text of the f32 would not do: it is another number for those who read 64 bits.
pub(super) fn write_number(x: f64, writer: &mut impl Write) -> std::io::Result<()> {
    // Outside of this range the plain notation is longer than the one with an exponent.
    let is_plain = x == 0.0 || (1e-5..1e16).contains(&x.abs());
    if is_plain { write!(writer, "{x}") } else { write!(writer, "{x:e}") }
}
