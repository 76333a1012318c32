//! A measured table: printed for people, JSON for programs.

use serde_json::{Map, Value};

/// One entry.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A name.
    Text(String),
    /// A number of things.
    Count(u64),
    /// A number of things as published, in thousands.
    Thousands(u64),
    /// Seconds.
    Seconds(f64),
    /// A part of a whole, 0 to 1, shown in percent.
    Part(f64),
    /// Any other number.
    Number(f64),
    /// Neither published nor measured.
    Nothing,
}

impl Cell {
    /// A name.
    pub fn text(text: impl Into<String>) -> Cell {
        Cell::Text(text.into())
    }

    fn shown(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(n) => n.to_string(),
            Cell::Thousands(n) => format!("{n}k"),
            Cell::Seconds(s) => format!("{s:.3}"),
            Cell::Part(x) => format!("{:.1}%", 100.0 * x),
            Cell::Number(x) if *x != 0.0 && x.abs() < 1e-3 => format!("{x:.2e}"),
            Cell::Number(x) => format!("{x}").chars().take(7).collect(),
            Cell::Nothing => "-".into(),
        }
    }

    fn value(&self) -> Value {
        match self {
            Cell::Text(text) => text.clone().into(),
            Cell::Count(n) => (*n).into(),
            Cell::Thousands(n) => (1000 * n).into(),
            Cell::Seconds(x) | Cell::Part(x) | Cell::Number(x) => (*x).into(),
            Cell::Nothing => Value::Null,
        }
    }
}

/// A table as it was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of the table in the paper, 1 to 7.
    pub table: u32,
    /// Caption of the table.
    pub title: &'static str,
    /// The names of the columns.
    pub columns: Vec<&'static str>,
    /// As many entries per row as there are columns.
    pub rows: Vec<Vec<Cell>>,
    /// Notes for the reader.
    pub notes: Vec<String>,
}

impl Report {
    /// A table without rows.
    pub fn new(columns: &[&'static str]) -> Report {
        Report { columns: columns.to_vec(), ..Report::default() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// When it has not an entry for each column.
    pub fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.columns.len(), "an entry for each column");
        self.rows.push(row);
    }

    /// The table for a terminal: caption, columns in line, notes.
    pub fn text(&self) -> String {
        let rows: Vec<Vec<String>> =
            self.rows.iter().map(|row| row.iter().map(Cell::shown).collect()).collect();
        let width = |i: usize| {
            let entries = rows.iter().map(|row| row[i].chars().count());
            entries.chain([self.columns[i].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let is_text = |i: usize| self.rows.iter().any(|row| matches!(row[i], Cell::Text(_)));
        let line = |entries: Vec<&str>| -> String {
            let aligned = entries.iter().enumerate().map(|(i, entry)| {
                let width = widths[i];
                if is_text(i) { format!("{entry:<width$}") } else { format!("{entry:>width$}") }
            });
            aligned.collect::<Vec<_>>().join("  ").trim_end().to_string() + "\n"
        };
        let mut text = format!("Table {}\n\n", self.title);
        text += &line(self.columns.clone());
        for row in &rows {
            text += &line(row.iter().map(String::as_str).collect());
        }
        text.push('\n');
        for note in &self.notes {
            text += &format!("  {note}\n");
        }
        text
    }

    /// The table as an object: `table`, `title`, `rows` (an object each, by column), `notes`. Times
    /// are in seconds, parts from 0 to 1, published counts rounded to thousands as in the paper.
    pub fn json(&self) -> Value {
        let row = |row: &Vec<Cell>| -> Value {
            let pairs = self.columns.iter().zip(row);
            Value::Object(pairs.map(|(name, cell)| (name.to_string(), cell.value())).collect())
        };
        let mut object = Map::new();
        object.insert("table".into(), self.table.into());
        object.insert("title".into(), self.title.into());
        object.insert("rows".into(), self.rows.iter().map(row).collect());
        object.insert("notes".into(), self.notes.clone().into());
        Value::Object(object)
    }
}
