//! Comma-separated tables with errors that name file, line and column.
//!
//! Spaces around fields and blank lines are ignored. Separators and decimal marks are never guessed.

use super::number::number;
use super::source::{read_text, shortened, shown};
use super::unit::{conversion, same_quantity};
use crate::error::{Error, Result};
use csv::{ReaderBuilder, StringRecord, Trim};
use std::path::{Path, PathBuf};

/// A table as stored in a file: named columns, and rows with the same number of fields.
#[derive(Debug, Clone)]
pub struct Table {
    path: PathBuf,
    header_line: usize,
    header: StringRecord,
    rows: Vec<(usize, StringRecord)>,
}

impl Table {
    /// Reads a table whose first line is its header.
    ///
    /// Trailing columns without name and content are dropped: some programs end every row with a comma.
    ///
    /// # Errors
    /// A file that is not readable UTF-8; a separator other than the comma; an open quote; an unnamed or duplicate
    /// column; a row with more or fewer fields than the header.
    pub fn read(path: &Path) -> Result<Self> {
        let table = Self::of(path, &read_text(path)?, 0)?;
        table.check_header()?;
        table.check_rows()?;
        Ok(table)
    }

    /// Reads a table of another program from which certain columns are needed. The header is the first line that
    /// names all of them; lines above it are skipped, and other columns may have any name.
    ///
    /// # Errors
    /// As [`Table::read`]; a file without a line that names all of the columns.
    pub fn read_columns(path: &Path, columns: &[&str]) -> Result<Self> {
        let text = read_text(path)?;
        let table = Self::of(path, &text, header_place(&text, columns))?;
        columns.iter().try_for_each(|column| table.place(column).map(|_| ()))?;
        table.check_rows()?;
        Ok(table)
    }

    /// The table that starts at a line, counted from 0, of a text.
    fn of(path: &Path, text: &str, header: usize) -> Result<Self> {
        let start: usize = text.split_inclusive('\n').take(header).map(str::len).sum();
        let in_file = |line: usize| line + header;
        let text = &text[start..];
        check_separator(path, text, header)?;
        if let Some(line) = open_quote(text) {
            let (found, expected) = ("no closing quote at the end of the field", "a quote (\") there");
            return Err(Error::input(path, in_file(line), "quote", found, expected));
        }
        let records = records(path, text)?.into_iter().map(|(line, record)| (in_file(line), record));
        let mut records = records.collect::<Vec<_>>().into_iter();
        let nameless = |line| Err(Error::input(path, line, "header", "nothing", "the names of the columns"));
        let Some((header_line, header)) = records.next() else {
            return nameless(None);
        };
        let mut table = Self { path: path.to_path_buf(), header_line, header, rows: records.collect() };
        table.drop_nothing();
        if table.header.is_empty() { nameless(Some(header_line)) } else { Ok(table) }
    }

    /// Drops trailing columns without name and content.
    fn drop_nothing(&mut self) {
        let named = (0..self.header.len()).rfind(|&column| !self.header[column].is_empty());
        let named = named.map_or(0, |last| last + 1);
        let is_empty = |(_, row): &(usize, StringRecord)| row.iter().skip(named).all(str::is_empty);
        if self.rows.iter().all(is_empty) {
            self.header.truncate(named);
            self.rows.iter_mut().for_each(|(_, row)| row.truncate(named.min(row.len())));
        }
    }

    /// Finds columns by name: the positions of the required ones, and of the optional ones present.
    ///
    /// # Errors
    /// A missing required column, or one that is neither required nor optional.
    pub fn require<const R: usize, const O: usize>(
        &self,
        required: [&str; R],
        optional: [&str; O],
    ) -> Result<([usize; R], [Option<usize>; O])> {
        let known = || required.iter().chain(&optional).copied();
        let refuse = |found: &str, expected: String| Err(self.bad_header("header", shown(found), expected));
        let strange = || self.header.iter().filter(|&found| !known().any(|name| name == found));
        if let Some(first) = strange().next() {
            let meant =
                |found| known().find(|name| self.column(name).is_none() && same_quantity(found, name));
            let (found, wanted): (Vec<_>, Vec<_>) = strange()
                .filter_map(|found| Some((found, meant(found)?)))
                .map(|(found, name)| (found, format!("{name} ({})", conversion(found, name))))
                .unzip();
            return match wanted.is_empty() {
                false => refuse(&found.join(", "), wanted.join(", ")),
                true => refuse(first, format!("only the columns {}", known().collect::<Vec<_>>().join(", "))),
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

    /// True if a column measures the same quantity as the given name, in any unit.
    pub fn has_quantity(&self, name: &str) -> bool {
        self.header.iter().any(|found| same_quantity(found, name))
    }

    /// Column names, for messages.
    pub fn names(&self) -> String {
        self.header.iter().map(shown).collect::<Vec<_>>().join(", ")
    }

    /// Index of a column, if present.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|found| found == name)
    }

    /// Index of a required column.
    ///
    /// # Errors
    /// A missing or duplicate column.
    pub fn place(&self, name: &str) -> Result<usize> {
        let mut places = (0..self.header.len()).filter(|&column| &self.header[column] == name);
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            (Some(_), Some(_)) => {
                let found = format!("{} twice", shown(name));
                Err(self.bad_header("header", found, "every requested column once"))
            }
            (None, _) => {
                let names = shortened(&self.header.iter().collect::<Vec<_>>().join(", "), 300);
                let found = format!("no column \"{}\"", shown(name));
                Err(self.bad_header("header", found, format!("one of {names}, exactly as it stands there")))
            }
        }
    }

    /// Name of a column.
    pub fn name(&self, column: usize) -> &str {
        &self.header[column]
    }

    /// Number of rows below the header.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// First line, from 1, of a row.
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].0
    }

    /// Text of a field.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].1.get(column).unwrap_or_default()
    }

    /// Parses a field as a finite number.
    ///
    /// # Errors
    /// Any other content.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        let text = self.text(row, column);
        number(text).map_err(|expected| self.invalid(row, &self.header[column], shown(text), expected))
    }

    /// Parses a field as a non-negative integer.
    ///
    /// # Errors
    /// Any other content.
    pub fn index(&self, row: usize, column: usize) -> Result<usize> {
        let text = self.text(row, column);
        text.parse()
            .map_err(|_| self.invalid(row, &self.header[column], shown(text), "a whole number from 0"))
    }

    /// Invalid input in a row.
    pub fn invalid(
        &self,
        row: usize,
        field: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::input(&self.path, self.rows[row].0, shown(field), found, expected)
    }

    /// Invalid input in the header.
    pub fn bad_header(&self, field: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::input(&self.path, self.header_line, shown(field), found, expected)
    }

    /// Invalid input in the table as a whole.
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
        let Some((line, record)) = self.rows.iter().find(|(_, record)| record.len() != expected) else {
            return Ok(());
        };
        let alike = self.rows.iter().all(|(_, other)| other.len() == record.len());
        let cause = match record.len() {
            fields if has_decimal_commas(record, expected) => format!("{fields} fields (decimal commas?)"),
            fields if alike && self.rows.len() > 1 => {
                format!("{fields} fields in every row (another line as the header?)")
            }
            fields => format!("{fields} fields"),
        };
        let expected = format!("{expected} fields, as in the header in line {}", self.header_line);
        Err(Error::input(&self.path, *line, "row", cause, expected))
    }
}

/// True if the commas of a row may be decimal marks: all surplus fields are digits only, and no number has a point.
fn has_decimal_commas(record: &StringRecord, expected: usize) -> bool {
    let is_digits = |field: &&str| !field.is_empty() && field.bytes().all(|byte| byte.is_ascii_digit());
    let has_point = |field: &str| field.contains('.') && field.parse::<f64>().is_ok();
    let fractions = record.iter().skip(1).filter(is_digits).count();
    record.len() > expected && fractions >= record.len() - expected && !record.iter().any(has_point)
}

/// Number of lines above the header: before the first line that names all of the columns, or else the last of those
/// that name most of them.
fn header_place(text: &str, columns: &[&str]) -> usize {
    let named = |line: &str| {
        let of = |separator: &u8| {
            let mut reader = ReaderBuilder::new();
            reader.has_headers(false).trim(Trim::All).delimiter(*separator);
            let record = reader.from_reader(line.as_bytes()).into_records().next();
            let record = record.and_then(|record| record.ok()).unwrap_or_default();
            columns.iter().filter(|column| record.iter().any(|name| name == **column)).count()
        };
        b",;\t".iter().map(of).max().unwrap_or_default()
    };
    let mut best = (0, 0);
    for (place, line) in text.lines().enumerate() {
        // Names may be quoted, but occur literally in the line.
        let may_be = columns.iter().filter(|column| line.contains(**column)).count() >= best.1.max(1);
        let count = if may_be { named(line) } else { 0 };
        if count > 0 && count >= best.1 {
            best = (place, count);
        }
        if count == columns.len() {
            break;
        }
    }
    best.0
}

/// Number of lines above the header of another program's table: see [`Table::read_columns`].
///
/// # Errors
/// A file that is not readable UTF-8.
pub fn lines_above_header(path: &Path, columns: &[&str]) -> Result<usize> {
    let text = read_text(path)?;
    let above = text.lines().take(header_place(&text, columns));
    Ok(above.filter(|line| !line.trim().is_empty()).count())
}

/// Refuses a header with semicolons or tabs and no comma before quotes are parsed.
///
/// * `above` — lines of the file above the text
fn check_separator(path: &Path, text: &str, above: usize) -> Result<()> {
    let Some((line, header)) = text.lines().enumerate().find(|(_, line)| !line.trim().is_empty()) else {
        return Ok(());
    };
    // Quoted text contains no separators.
    let bare: String = header.split('"').step_by(2).collect();
    for (separator, shown) in [(';', "semicolons (;)"), ('\t', "tabs")] {
        if bare.trim().contains(separator) && !bare.contains(',') {
            let found = format!("{shown} between the columns");
            let expected =
                "commas between the columns and points in the numbers (export as comma-separated values)";
            return Err(Error::input(path, above + line + 1, "header", found, expected));
        }
    }
    Ok(())
}

/// Records with their first lines.
fn records(path: &Path, text: &str) -> Result<Vec<(usize, StringRecord)>> {
    let mut reader =
        ReaderBuilder::new().has_headers(false).flexible(true).trim(Trim::All).from_reader(text.as_bytes());
    let (mut line, mut counted) = (1, 0);
    let mut records = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| Error::input(path, line, "row", error.to_string(), "a row"))?;
        // The position of a record precedes blank lines before it.
        let before = record.position().map_or(counted, |position| position.byte() as usize);
        let blank = text[before..].bytes().take_while(|&byte| byte == b'\n').count();
        line += text[counted..before + blank].matches('\n').count();
        counted = before + blank;
        records.push((line, record));
    }
    Ok(records)
}

/// Line of a quote that opens a field and is not closed at the end of the field.
fn open_quote(text: &str) -> Option<usize> {
    let (mut line, mut field_starts, mut opened) = (1, true, None);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        line += usize::from(character == '\n');
        if opened.is_some() {
            // A doubled quote is a literal quote within the field.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of another program, read for force and travel.
    fn read(text: &str) -> Result<Table> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, text).unwrap();
        Table::read_columns(&path, &["travel", "force"])
    }

    fn message(text: &str) -> String {
        let message = read(text).unwrap_err().to_string();
        message[message.find("t.csv").unwrap()..].into()
    }

    #[test]
    fn lines_above_the_header_are_passed_over_and_counted_in_messages() {
        let above = "{\"specimen\": 1, \"rate\": 0.5}\n***\n*** travel; force\n\n";
        let table = read(&format!("{above}time,travel,force\n0,1,2\n3,4,5\n")).unwrap();
        assert_eq!((table.rows(), table.line(1)), (2, 7));
        assert_eq!(table.number(1, table.place("force").unwrap()).unwrap(), 5.0);
        assert!(
            message(&format!("{above}time;travel;force\n0;1;2\n"))
                .starts_with("t.csv:5 header: found semicolons")
        );
        let misspelt = message(&format!("{above}time,travel,load\n0,1,2\n"));
        let expected = "t.csv:5 header: found no column \"force\", expected one of time, travel, load, exactly as it stands there";
        assert_eq!(misspelt, expected);
        let ragged = message(&format!("{above}time,travel,force\n0,1,2\n3,4\n"));
        assert_eq!(ragged, "t.csv:7 row: found 2 fields, expected 3 fields, as in the header in line 5");
        // Nothing is skipped if the first line is the header.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        for (text, lines) in [("travel,force\ntravel,force\n", 0), (&format!("{above}force,travel\n"), 3)] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(lines_above_header(&path, &["travel", "force"]).unwrap(), lines);
        }
    }

    #[test]
    fn a_comma_at_the_end_of_every_row_is_no_column() {
        for text in
            ["travel,force\n1,2,\n3,4,\n", "travel,force,\n1,2,\n3,4,\n", "travel,force,,\n1,2\n3,4,,\n"]
        {
            let table = read(text).unwrap();
            assert_eq!((table.rows(), table.number(1, 1).unwrap()), (2, 4.0), "{text}");
        }
        let one = message("travel,force\n1,2,\n3,4,9.5\n");
        let expected =
            "t.csv:2 row: found 3 fields (decimal commas?), expected 2 fields, as in the header in line 1";
        assert_eq!(one, expected);
    }

    #[test]
    fn only_columns_that_are_asked_for_must_be_there_once() {
        let table = read("time,travel,time,,force\n0,1,0,,2\n").unwrap();
        assert_eq!(table.number(0, 4).unwrap(), 2.0);
        let twice = message("travel,force,force\n0,1,2\n");
        assert_eq!(twice, "t.csv:1 header: found force twice, expected every requested column once");
    }

    #[test]
    fn decimal_commas_are_suspected_where_they_can_be() {
        let suspected = |row: &str| message(&format!("travel,force\n{row}\n")).contains("decimal commas?");
        assert!(suspected("0,5,1,25") && suspected("3,1,25") && suspected("-0,5,1,25e1,0"));
        assert!(!suspected("0.5,1.25,3") && !suspected("7"));
    }
}
