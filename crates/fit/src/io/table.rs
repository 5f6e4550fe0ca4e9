//! Tables of comma-separated values whose errors name file, line and column.
//!
//! Spaces around a field and blank lines do not matter. Separators and decimal marks are never guessed.

use super::number::number;
use super::source::{read_text, shown};
use super::unit::{conversion, same_quantity};
use crate::error::{Error, Result};
use csv::{ReaderBuilder, StringRecord, Trim};
use std::path::{Path, PathBuf};

/// A table as it stands in a file: named columns, and rows of as many fields.
#[derive(Debug, Clone)]
pub struct Table {
    path: PathBuf,
    header_line: usize,
    header: StringRecord,
    rows: Vec<(usize, StringRecord)>,
}

impl Table {
    /// Reads a table.
    ///
    /// # Errors
    /// Not a readable UTF-8 file; another separator than the comma; an open quote; a column without a name or twice
    /// the same; a row with more or fewer fields than the header.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        check_separator(path, &text)?;
        if let Some(line) = open_quote(&text) {
            return Err(Error::input(
                path,
                line,
                "quote",
                "no closing quote at the end of the field",
                "a quote (\") there",
            ));
        }
        let mut records = records(path, &text)?.into_iter();
        let Some((header_line, header)) = records.next() else {
            return Err(Error::input(path, None, "header", "nothing", "the names of the columns"));
        };
        let table = Self { path: path.to_path_buf(), header_line, header, rows: records.collect() };
        table.check_header()?;
        table.check_rows()?;
        Ok(table)
    }

    /// Finds columns by their names: where the required ones are, and the optional ones that exist.
    ///
    /// # Errors
    /// A required column is missing, or one exists that is neither required nor optional.
    pub fn require<const R: usize, const O: usize>(
        &self,
        required: [&str; R],
        optional: [&str; O],
    ) -> Result<([usize; R], [Option<usize>; O])> {
        let known = || required.iter().chain(&optional).copied();
        let refuse = |found: &str, expected: String| Err(self.bad_header("header", shown(found), expected));
        if let Some(found) = self.header.iter().find(|&found| !known().any(|name| name == found)) {
            let wanted = known().find(|name| self.column(name).is_none() && same_quantity(found, name));
            return match wanted {
                Some(name) => refuse(found, format!("{name} ({})", conversion(found, name))),
                None => refuse(found, format!("only the columns {}", known().collect::<Vec<_>>().join(", "))),
            };
        }
        let mut places = [0; R];
        for (place, name) in places.iter_mut().zip(required) {
            match self.column(name) {
                Some(column) => *place = column,
                None => return refuse(&format!("no column {name}"), format!("a column {name}")),
            }
        }
        Ok((places, optional.map(|name| self.column(name))))
    }

    /// Where a column is, if it exists.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|found| found == name)
    }

    /// A column's name.
    pub fn name(&self, column: usize) -> &str {
        &self.header[column]
    }

    /// Number of rows below the header.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The line, from 1, that a row starts in.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].0
    }

    /// A field's text.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].1.get(column).unwrap_or_default()
    }

    /// A field as a finite number.
    ///
    /// # Errors
    /// It is not one.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        let text = self.text(row, column);
        number(text).map_err(|expected| self.invalid(row, &self.header[column], shown(text), expected))
    }

    /// A field as a whole number from 0.
    ///
    /// # Errors
    /// It is not one.
    pub fn index(&self, row: usize, column: usize) -> Result<usize> {
        let text = self.text(row, column);
        text.parse()
            .map_err(|_| self.invalid(row, &self.header[column], shown(text), "a whole number from 0"))
    }

    /// Bad input in a row.
    pub fn invalid(
        &self,
        row: usize,
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::input(&self.path, self.rows[row].0, shown(field), found, expected)
    }

    /// Bad input in the header.
    pub fn bad_header(&self, field: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::input(&self.path, self.header_line, shown(field), found, expected)
    }

    /// Bad input in the table as a whole.
    pub fn incomplete(&self, field: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::input(&self.path, None, shown(field), found, expected)
    }

    fn check_header(&self) -> Result<()> {
        let refuse = |found: String, expected: &str| Err(self.bad_header("header", found, expected));
        for (column, name) in self.header.iter().enumerate() {
            if name.is_empty() {
                return refuse(format!("no name for column {}", column + 1), "a name for every column");
            }
            if self.column(name) != Some(column) {
                return refuse(format!("{} twice", shown(name)), "every column once");
            }
        }
        Ok(())
    }

    fn check_rows(&self) -> Result<()> {
        let expected = self.header.len();
        match self.rows.iter().find(|(_, record)| record.len() != expected) {
            Some((line, record)) => {
                let hint = if record.len() > expected { " (decimal commas?)" } else { "" };
                let found = format!("{} fields{hint}", record.len());
                Err(Error::input(
                    &self.path,
                    *line,
                    "row",
                    found,
                    format!("{expected} fields, as in the header"),
                ))
            }
            None => Ok(()),
        }
    }
}

/// A header of semicolons or tabs and no comma: quotes would be read wrong if it went on.
fn check_separator(path: &Path, text: &str) -> Result<()> {
    let Some((line, header)) = text.lines().enumerate().find(|(_, line)| !line.trim().is_empty()) else {
        return Ok(());
    };
    // What stands in quotes is no separator.
    let bare: String = header.split('"').step_by(2).collect();
    for (separator, shown) in [(';', "semicolons (;)"), ('\t', "tabs")] {
        if bare.trim().contains(separator) && !bare.contains(',') {
            let found = format!("{shown} between the columns");
            let expected =
                "commas between the columns and points in the numbers (export as comma-separated values)";
            return Err(Error::input(path, line + 1, "header", found, expected));
        }
    }
    Ok(())
}

/// The records with the lines that they start in.
fn records(path: &Path, text: &str) -> Result<Vec<(usize, StringRecord)>> {
    let mut reader =
        ReaderBuilder::new().has_headers(false).flexible(true).trim(Trim::All).from_reader(text.as_bytes());
    let (mut line, mut counted) = (1, 0);
    let mut records = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| Error::input(path, line, "row", error.to_string(), "a row"))?;
        // The record's own position is before the blank lines that precede it.
        let before = record.position().map_or(counted, |position| position.byte() as usize);
        let blank = text[before..].bytes().take_while(|&byte| byte == b'\n').count();
        line += text[counted..before + blank].matches('\n').count();
        counted = before + blank;
        records.push((line, record));
    }
    Ok(records)
}

/// The line of a quote that opens a field and does not close at the field's end.
fn open_quote(text: &str) -> Option<usize> {
    let (mut line, mut field_starts, mut opened) = (1, true, None);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        line += usize::from(character == '\n');
        if opened.is_some() {
            // A doubled quote is a quote within the field.
            if character == '"' && characters.next_if_eq(&'"').is_none() {
                if characters.peek().is_some_and(|next| !matches!(next, ',' | '\n' | ' ' | '\t')) {
                    return opened;
                }
                opened = None;
            }
        } else if character == '"' && field_starts {
            opened = Some(line);
        }
        field_starts = matches!(character, ',' | '\n');
    }
    opened
}
