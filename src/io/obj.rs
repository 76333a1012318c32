//! OBJ, through `tobj`.
//!
//! `tobj` reads from [`Filter`], which hands it only what a triangle mesh needs: vertex positions
//! and the position numbers of faces. So groups, materials, texture coordinates, curves, comments
//! and text that is not UTF-8 cannot disturb it, and each error has a line. `tobj` numbers vertices
//! by their first use in a face and drops the others; a face of one corner behind each vertex keeps
//! the file's numbering.

use std::io::{BufRead, BufReader, Read, Seek, Write};

use super::Format;
use super::error::{LoadErrorKind, ReadError, quote};
use super::loaded::{Content, NonFinite};
use super::polygon::PolygonMesh;
use super::text::{Text, is_not_finite, parse, write_number};
use crate::mesh::TriMesh;
use crate::quantity::Precision;

/// Reads a mesh.
pub(super) fn read<R: Read + Seek>(source: R) -> Result<Content, ReadError> {
    let mut filter = Filter::new(BufReader::with_capacity(1 << 16, source));
    let options = tobj::LoadOptions {
        single_index: false,
        triangulate: false,
        ignore_points: false,
        ignore_lines: false,
    };
    // No line that names a material library gets through the filter.
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let models = match tobj::load_obj_buf(&mut filter, &options, no_materials) {
        Ok((models, _)) => models,
        Err(error) => return Err(filter.explain(error)),
    };
    let mut mesh = PolygonMesh::default();
    for tobj::Model { mesh: part, .. } in models {
        mesh.vertices.extend(part.positions.as_chunks::<3>().0);
        let mut rest = part.indices.as_slice();
        for &arity in &part.face_arities {
            let (corners, behind) = rest.split_at((arity as usize).min(rest.len()));
            rest = behind;
            if corners.len() >= 3 {
                mesh.push(corners);
            }
        }
    }
    if mesh.vertices.len() > u32::MAX as usize {
        return Err(LoadErrorKind::TooManyVertices.into());
    }
    let is_finite = mesh.vertices.iter().all(|v| v.iter().all(|x| x.is_finite()));
    let non_finite = if is_finite { None } else { Some(filter.find_non_finite()?) };
    Ok(Content { mesh, non_finite, passed: Vec::new() })
}

/// The lines that `tobj` gets to see.
struct Filter<R> {
    text: Text<R>,
    /// Replacement of the present line.
    output: Vec<u8>,
    /// Number of bytes of `output` that were consumed.
    consumed: usize,
    /// Why reading stopped, if it did; `tobj` cannot carry it.
    error: Option<ReadError>,
}

/// Kind of a line.
#[derive(PartialEq)]
enum Statement {
    Vertex,
    Face,
    Other,
}

impl<R: BufRead> Filter<R> {
    fn new(reader: R) -> Self {
        let text = Text::new(reader, Format::Obj, 0).with_comments(b'#');
        Filter { text, output: Vec::new(), consumed: 0, error: None }
    }

    /// Goes to the next line, joined with those it continues on. `None` at the end of the file.
    fn next_statement(&mut self) -> Result<Option<Statement>, ReadError> {
        if !self.text.next_line()? {
            return Ok(None);
        }
        // Blanks behind the backslash cannot be seen in an editor.
        while let Some(before) = self.text.line().trim_ascii_end().strip_suffix(b"\\") {
            self.text.shorten(before.len());
            if !self.text.append_line()? {
                break;
            }
        }
        let word = self.text.word_on_line();
        Ok(Some(match word.map(|w| self.text.bytes(w)) {
            Some(b"v") => Statement::Vertex,
            Some(b"f") => Statement::Face,
            _ => Statement::Other,
        }))
    }

    /// Puts the next vertex or face into `output`; leaves it empty at the end of the file.
    fn refill(&mut self) -> Result<(), ReadError> {
        self.output.clear();
        self.consumed = 0;
        while self.output.is_empty() {
            match self.next_statement()? {
                None => return Ok(()),
                Some(Statement::Other) => {}
                Some(Statement::Vertex) => {
                    // A fourth number is a weight for rational curves; colours may follow.
                    self.output.push(b'v');
                    self.copy_words(3, |word| if is_not_finite(word) { b"nan" } else { word });
                    self.output.extend_from_slice(b"\nf -1\n");
                }
                Some(Statement::Face) => {
                    self.output.push(b'f');
                    let position = |word: &[u8]| word.iter().position(|&b| b == b'/').unwrap_or(word.len());
                    let corners = self.copy_words(usize::MAX, |word| &word[..position(word)]);
                    self.output.push(b'\n');
                    if corners < 3 {
                        let line = self.text.line();
                        return Err(self
                            .text
                            .error(LoadErrorKind::syntax(line, "a face of three or more corners")));
                    }
                }
            }
        }
        Ok(())
    }

    /// Copies up to `most` words of the present line to `output`, cut by `part`; returns how many.
    fn copy_words(&mut self, most: usize, part: impl Fn(&[u8]) -> &[u8]) -> usize {
        let mut count = 0;
        while count < most
            && let Some(word) = self.text.word_on_line()
        {
            self.output.push(b' ');
            self.output.extend_from_slice(part(self.text.bytes(word)));
            count += 1;
        }
        count
    }
}

impl<R: BufRead> BufRead for Filter<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.consumed == self.output.len()
            && let Err(error) = self.refill()
        {
            self.output.clear();
            self.error = Some(error);
            return Err(std::io::Error::other("see Filter::error"));
        }
        Ok(&self.output[self.consumed..])
    }

    fn consume(&mut self, amount: usize) {
        self.consumed = (self.consumed + amount).min(self.output.len());
    }
}

impl<R: BufRead> Read for Filter<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}

impl<R: BufRead + Seek> Filter<R> {
    /// Returns the meaning and the location of `error`. While lines are parsed, the filter stands
    /// on the culprit.
    fn explain(&mut self, error: tobj::LoadError) -> ReadError {
        if let Some(error) = self.error.take() {
            return error;
        }
        let line = self.text.line();
        match error {
            tobj::LoadError::FaceVertexOutOfBounds => self.find_vertex_number().unwrap_or_else(|error| error),
            tobj::LoadError::PositionParseError => {
                self.text.error(LoadErrorKind::syntax(line, "a vertex \"v x y z\""))
            }
            tobj::LoadError::FaceParseError => {
                self.text.error(LoadErrorKind::syntax(line, "a face \"f i j k\" of whole vertex numbers"))
            }
            other => self.text.error(LoadErrorKind::syntax(line, format!("valid OBJ ({other})"))),
        }
    }

    /// The first face that names a vertex that the file does not have.
    fn find_vertex_number(&mut self) -> Result<ReadError, ReadError> {
        let mut count = 0i64;
        self.text.rewind()?;
        while let Some(statement) = self.next_statement()? {
            count += i64::from(statement == Statement::Vertex);
        }
        let mut so_far = 0i64;
        self.text.rewind()?;
        while let Some(statement) = self.next_statement()? {
            so_far += i64::from(statement == Statement::Vertex);
            while statement == Statement::Face
                && let Some(word) = self.text.word_on_line()
            {
                let found = self.text.bytes(word).split(|&b| b == b'/').next().unwrap_or_default();
                let number = parse::<i64>(found).unwrap_or(0);
                if number == 0 || number > count || number < -so_far {
                    let found = quote(found);
                    return Ok(self.text.error(LoadErrorKind::VertexNumber { found, first: 1, last: count }));
                }
            }
        }
        // The file changed while it was read.
        Ok(LoadErrorKind::truncated("the vertices that its faces name").into())
    }

    /// The first coordinate that is not finite.
    fn find_non_finite(&mut self) -> Result<NonFinite, ReadError> {
        self.text.rewind()?;
        while let Some(statement) = self.next_statement()? {
            if statement == Statement::Vertex {
                for _ in 0..3 {
                    self.text.coordinate("a vertex \"v x y z\"")?;
                }
                if let Some(found) = self.text.take_non_finite() {
                    return Ok(found);
                }
            }
        }
        // The file changed while it was read.
        Err(LoadErrorKind::truncated("the coordinate that is not finite").into())
    }
}

/// Writes a mesh.
pub(super) fn write(mesh: &TriMesh, coordinates: Precision, writer: &mut impl Write) -> std::io::Result<()> {
    for v in &mesh.vertices {
        writer.write_all(b"v")?;
        for &x in v {
            writer.write_all(b" ")?;
            write_number(coordinates.round(x), writer)?;
        }
        writer.write_all(b"\n")?;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        writeln!(writer, "f {a} {b} {c}")?;
    }
    Ok(())
}
