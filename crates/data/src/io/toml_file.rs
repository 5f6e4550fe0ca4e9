//! TOML parsing with errors that name line and key.

use super::source::{read_text, shown};
use super::unit::{conversion, same_quantity};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Text of a TOML file.
pub struct TomlFile {
    path: PathBuf,
    text: String,
}

impl TomlFile {
    /// Reads a file.
    ///
    /// # Errors
    /// A missing file, or one that is not text.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self::of(path, read_text(path)?))
    }

    /// Wraps a text that was read already.
    pub fn of(path: &Path, text: String) -> Self {
        Self { path: path.to_path_buf(), text }
    }

    /// Parses the file into a value.
    ///
    /// # Errors
    /// Invalid TOML; an unknown, missing or duplicate key; a value of another type. All with line and key.
    pub fn value<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(&self.text).map_err(|error| self.explain(&error))
    }

    /// Invalid input at a key such as `clips[1].mass_kg`.
    pub fn invalid(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        let mut line = None;
        self.visit(&mut |name, span| {
            if key.starts_with(name) {
                line = Some(self.line(span.start));
            }
        });
        Error::input(&self.path, line, key, found, expected)
    }

    /// True if the file has a key such as `gravity_m_s2[3]`.
    pub fn has(&self, key: &str) -> bool {
        let mut found = false;
        self.visit(&mut |name, _| found |= name == key);
        found
    }

    /// Visits every key of the file with the byte range of its value, outer keys first.
    fn visit(&self, visitor: &mut dyn FnMut(&str, Range<usize>)) {
        if let Ok(document) = DeTable::parse(&self.text) {
            visit_table("", document.get_ref(), visitor);
        }
    }

    fn line(&self, offset: usize) -> usize {
        1 + self.text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
    }

    /// Splits the parser's message into field, found and expected.
    fn explain(&self, error: &toml::de::Error) -> Error {
        let span = error.span().unwrap_or_default();
        let mut key = String::new();
        self.visit(&mut |name, place| {
            if place.start <= span.start && span.end <= place.end {
                key = name.to_string();
            }
        });
        let key = if key.is_empty() { key } else { shown(&key) };
        let line = self.line(span.start);
        let message = error.message().trim();
        if let Some(name) = quoted(message, "missing field ") {
            let key = if key.is_empty() { name.to_string() } else { format!("{key}.{name}") };
            let line = (span.start > 0).then_some(line);
            return Error::input(&self.path, line, key, "nothing", "a value");
        }
        if let Some(name) = quoted(message, "unknown field ") {
            // The known keys follow the unknown one, which may contain anything.
            let known = message.rsplit_once(", expected ").map_or("", |(_, known)| known);
            let known: Vec<_> = known.split('`').skip(1).step_by(2).collect();
            let expected = match known.iter().find(|known| same_quantity(name, known)) {
                Some(known) => format!("{known} ({})", conversion(name, known)),
                None => format!("one of {}", known.join(", ")),
            };
            return Error::input(&self.path, line, shown(name), "an unknown key", expected);
        }
        let (found, expected) = message.rsplit_once(", expected ").unwrap_or((message, "TOML"));
        let found = found.trim_start_matches("invalid type: ").trim_start_matches("invalid value: ");
        let text = self.text.lines().nth(line - 1).unwrap_or_default();
        let (name, value) = text.split_once('=').unwrap_or(("TOML", ""));
        let digit = |c: char| c.is_ascii_digit();
        let comma =
            value.trim().split_once(',').is_some_and(|(a, b)| a.ends_with(digit) && b.starts_with(digit));
        let expected = match expected {
            _ if found == "duplicate key" => "every key once",
            // Without a key the text is not TOML.
            _ if key.is_empty() && comma => "a number with a decimal point, not a comma",
            "f64" => "a number",
            "usize" => "a whole number from 0",
            other => other,
        };
        let key = if key.is_empty() { shown(name.trim()) } else { key };
        Error::input(&self.path, line, key, shown(&found.replace('`', "")), expected.replace('`', ""))
    }
}

/// TOML text of a value.
pub(super) fn written<T: Serialize>(path: &Path, value: &T) -> Result<String> {
    toml::to_string(value)
        .map_err(|error| Error::input(path, None, "value", error.to_string(), "one that TOML can hold"))
}

/// The text between backticks after a prefix.
fn quoted<'a>(message: &'a str, prefix: &str) -> Option<&'a str> {
    message.strip_prefix(prefix)?.strip_prefix('`')?.split('`').next()
}

fn visit_table(outer: &str, table: &DeTable<'_>, visitor: &mut dyn FnMut(&str, Range<usize>)) {
    for (key, value) in table {
        let dot = if outer.is_empty() { "" } else { "." };
        visit_value(&format!("{outer}{dot}{}", key.get_ref()), value, visitor);
    }
}

fn visit_value(name: &str, value: &Spanned<DeValue<'_>>, visitor: &mut dyn FnMut(&str, Range<usize>)) {
    visitor(name, value.span());
    match value.get_ref() {
        DeValue::Table(table) => visit_table(name, table, visitor),
        DeValue::Array(array) => {
            for (index, value) in array.iter().enumerate() {
                visit_value(&format!("{name}[{index}]"), value, visitor);
            }
        }
        _ => {}
    }
}
