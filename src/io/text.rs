//! Text files as lines and words, with line numbers for messages; and numbers as text.

use std::io::{BufRead, ErrorKind, Seek, SeekFrom, Write};
use std::ops::Range;

use memchr::{memchr_iter, memchr2};

use super::Format;
use super::error::{LoadErrorKind, Location, ReadError, quote};
use super::loaded::NonFinite;

/// The longest line that is read. Polygons of a million corners fit; a binary file without line
/// ends does not get to fill the memory.
const LONGEST_LINE: usize = 1 << 26;

/// Mark that some programs write before the first character of UTF-8 text.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a text file line by line and a line word by word. Lines end with LF, CRLF or CR; a byte
/// order mark is skipped.
pub(super) struct Text<R> {
    reader: R,
    format: Format,
    line: Vec<u8>,
    number: u64,
    /// Byte of `line` at which the next word is looked for.
    next: usize,
    /// Begins a comment that ends with the line.
    comment: Option<u8>,
    /// The first coordinate that is not finite.
    non_finite: Option<NonFinite>,
}

impl<R: BufRead> Text<R> {
    /// Reads `reader`, whose next line is the one after `number`.
    pub(super) fn new(reader: R, format: Format, number: u64) -> Self {
        Text { reader, format, line: Vec::new(), number, next: 0, comment: None, non_finite: None }
    }

    /// Skips everything from `mark` to the end of its line.
    pub(super) fn with_comments(mut self, mark: u8) -> Self {
        self.comment = Some(mark);
        self
    }

    /// Goes to the next line. `false` at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<bool, ReadError> {
        self.line.clear();
        self.append_line()
    }

    /// Appends the next line to the present one. `false` at the end of the file.
    pub(super) fn append_line(&mut self) -> Result<bool, ReadError> {
        let start = self.line.len();
        self.next = 0;
        let Some(ended) = read_line(&mut self.reader, LONGEST_LINE, &mut self.line)? else {
            return Ok(false);
        };
        self.number += 1;
        let not_text = |reason: &str| {
            LoadErrorKind::WrongFormat { format: self.format, reason: reason.into() }.on_line(self.number)
        };
        if self.line[start..].contains(&0) {
            return Err(not_text("binary data stands where text belongs"));
        }
        if ended == Ended::TooLong {
            return Err(not_text("the line has no end"));
        }
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        if let Some(mark) = self.comment
            && let Some(at) = comment(&self.line, start, mark)
        {
            self.line.truncate(at);
        }
        Ok(true)
    }

    /// The present line.
    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Keeps the first `length` bytes of the present line.
    pub(super) fn shorten(&mut self, length: usize) {
        self.line.truncate(length);
    }

    /// `problem` on the present line.
    pub(super) fn error(&self, kind: LoadErrorKind) -> ReadError {
        kind.on_line(self.number)
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
    pub(super) fn word(&mut self) -> Result<Option<Range<usize>>, ReadError> {
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
    pub(super) fn expect_word(&mut self, expected: &str) -> Result<Range<usize>, ReadError> {
        let word = self.word()?;
        word.ok_or_else(|| self.error(LoadErrorKind::truncated(expected)))
    }

    /// The next word as a number. The first that is not finite is remembered.
    pub(super) fn coordinate(&mut self, expected: &str) -> Result<f64, ReadError> {
        let word = self.expect_word(expected)?;
        let bytes = self.bytes(word);
        let number = parse::<f64>(bytes).or_else(|| is_not_finite(bytes).then_some(f64::NAN));
        let Some(x) = number else { return Err(self.error(LoadErrorKind::syntax(bytes, expected))) };
        if !x.is_finite() && self.non_finite.is_none() {
            let location = Location::Line(self.number);
            self.non_finite = Some(NonFinite { location, coordinate: quote(bytes) });
        }
        Ok(x)
    }

    /// The first coordinate that was not finite.
    pub(super) fn take_non_finite(&mut self) -> Option<NonFinite> {
        self.non_finite.take()
    }

    /// The next word as an integer.
    pub(super) fn integer(&mut self, expected: &str) -> Result<i64, ReadError> {
        let word = self.expect_word(expected)?;
        let bytes = self.bytes(word);
        parse(bytes).ok_or_else(|| self.error(LoadErrorKind::syntax(bytes, expected)))
    }

    /// The next word as a count.
    pub(super) fn count(&mut self, expected: &str) -> Result<u64, ReadError> {
        let word = self.expect_word(expected)?;
        let bytes = self.bytes(word);
        parse(bytes).ok_or_else(|| self.error(LoadErrorKind::syntax(bytes, expected)))
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
    pub(super) fn rewind(&mut self) -> Result<(), ReadError> {
        self.reader.seek(SeekFrom::Start(0))?;
        self.line.clear();
        (self.number, self.next) = (0, 0);
        Ok(())
    }
}

/// End of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// With LF or CRLF.
    LineFeed,
    /// With CR alone, as on Macs of the last century.
    Return,
    /// With the file.
    File,
    /// The line has more bytes than are read.
    TooLong,
}

/// Appends the next line to `line`, without its end. `None` at the end of the file.
pub(super) fn read_line(
    reader: &mut impl BufRead,
    longest: usize,
    line: &mut Vec<u8>,
) -> std::io::Result<Option<Ended>> {
    let start = line.len();
    loop {
        let buffer = match reader.fill_buf() {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            buffer => buffer?,
        };
        if buffer.is_empty() {
            return Ok((line.len() > start).then_some(Ended::File));
        }
        let room = longest - (line.len() - start);
        let part = &buffer[..buffer.len().min(room)];
        let end = memchr2(b'\n', b'\r', part);
        line.extend_from_slice(&part[..end.unwrap_or(part.len())]);
        let (is_return, read) =
            (end.is_some_and(|at| part[at] == b'\r'), end.map_or(part.len(), |at| at + 1));
        reader.consume(read);
        match end {
            Some(_) if is_return && !step_over_line_feed(reader)? => return Ok(Some(Ended::Return)),
            Some(_) => return Ok(Some(Ended::LineFeed)),
            None if line.len() - start >= longest => return Ok(Some(Ended::TooLong)),
            None => {}
        }
    }
}

/// Steps over the LF behind a CR, if there is one; also where a second CR stands between them, as
/// in files that were converted twice.
fn step_over_line_feed(reader: &mut impl BufRead) -> std::io::Result<bool> {
    let length = match reader.fill_buf()? {
        [b'\n', ..] => 1,
        [b'\r', b'\n', ..] => 2,
        _ => 0,
    };
    reader.consume(length);
    Ok(length > 0)
}

/// Text after "1." in numbers that are none, as Microsoft's C library writes them.
const NO_NUMBERS: [&[u8]; 4] = [b"#IND", b"#QNAN", b"#SNAN", b"#INF"];

/// Whether a word that is no number in Rust is what a C library writes where there is none:
/// `-nan(ind)`, `1.#QNAN`, `-1.#IND00`.
pub(super) fn is_not_finite(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    word.get(..4).is_some_and(|start| start.eq_ignore_ascii_case(b"nan("))
        || word.strip_prefix(b"1.").is_some_and(|rest| NO_NUMBERS.iter().any(|name| rest.starts_with(name)))
}

/// Returns the first byte of a line's comment, behind `start`: not in the midst of `1.#IND`.
fn comment(line: &[u8], start: usize, mark: u8) -> Option<usize> {
    let is_number =
        |at: usize| line[..at].ends_with(b"1.") && NO_NUMBERS.iter().any(|name| line[at..].starts_with(name));
    memchr_iter(mark, &line[start..]).map(|n| start + n).find(|&at| !is_number(at))
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// A word as a number.
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Writes the shortest text that reads back as `x`. If `x` is exactly an f32, it reads back as that
/// into an f32, too, but the shortest text of the f32 would not do: it is another number for those
/// who read 64 bits.
pub(super) fn write_number(x: f64, writer: &mut impl Write) -> std::io::Result<()> {
    // Outside of this range the plain notation is longer than the one with an exponent.
    let is_plain = x == 0.0 || (1e-5..1e16).contains(&x.abs());
    if is_plain { write!(writer, "{x}") } else { write!(writer, "{x:e}") }
}
