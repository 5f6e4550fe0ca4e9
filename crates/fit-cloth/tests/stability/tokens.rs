//! Positions of numbers and names in a text, as targets of damage.

use crate::readers::{Form, Reader};
use std::ops::Range;

/// A number, or the name of a column or key.
#[derive(Debug, Clone)]
pub(crate) struct Token {
    /// Range of bytes.
    pub(crate) place: Range<usize>,
    /// Line, counted from 1.
    pub(crate) line: usize,
    /// Column, key or keyword it belongs to.
    pub(crate) field: String,
}

impl Token {
    /// Replaces the token in the text.
    pub(crate) fn replaced(&self, text: &str, by: &str) -> String {
        format!("{}{by}{}", &text[..self.place.start], &text[self.place.end..])
    }
}

/// Lines of a text with their starting bytes.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.split('\n').scan(0, |start, line| {
        let at = *start;
        *start += line.len() + 1;
        Some((at, line))
    })
}

/// Parts of a line between separators, with their starting bytes; quoted text is omitted.
fn words<'t>(start: usize, line: &'t str, separators: &'static str) -> Vec<(usize, &'t str)> {
    let mut quoted = false;
    let mut found = Vec::new();
    let mut from = 0;
    for (at, character) in line.char_indices().chain([(line.len(), ' ')]) {
        if character == '"' {
            quoted = !quoted;
        }
        if quoted || character == '"' || separators.contains(character) || at == line.len() {
            if from < at {
                found.push((start + from, &line[from..at]));
            }
            from = at + character.len_utf8();
        }
    }
    found
}

fn token(at: usize, word: &str, line: usize, field: &str) -> Token {
    Token { place: at..at + word.len(), line, field: field.into() }
}

/// The numbers of a file that its reader uses.
pub(crate) fn numbers(reader: &Reader) -> Vec<Token> {
    let text = reader.text();
    let header: Vec<&str> = text.lines().next().unwrap_or_default().split(',').collect();
    let (mut found, mut key, mut vertices) = (Vec::new(), String::new(), None);
    for (index, (start, line)) in lines(text).enumerate() {
        let mut add = |at: usize, word: &str, field: &str| found.push(token(at, word, index + 1, field));
        let numeric = |word: &str| word.parse::<f64>().is_ok();
        match reader.form {
            Form::Table => {
                let cells = words(start, line, ",");
                let cells = cells.iter().zip(&header).filter(|((_, word), _)| numeric(word));
                cells.for_each(|((at, word), field)| add(*at, word, field));
            }
            Form::Toml => {
                let line = line.split('#').next().unwrap_or_default();
                let Some((key, _)) = line.split_once('=') else { continue };
                let values = words(start, line, " ,[]{}=").into_iter().filter(|(_, word)| numeric(word));
                values.for_each(|(at, word)| add(at, word, key.trim()));
            }
            Form::Obj => {
                let line = line.split('#').next().unwrap_or_default();
                let words = words(start, line, " ");
                let keyword = words.first().map_or("", |(_, word)| *word);
                words.iter().skip(1).for_each(|(at, word)| add(*at, word, keyword));
            }
            // Vertices come first; the reader ignores the rest.
            Form::Ply => match &mut vertices {
                None if line == "end_header" => vertices = Some(4),
                None | Some(0) => {}
                Some(left) => {
                    *left -= 1;
                    words(start, line, " ").into_iter().for_each(|(at, word)| add(at, word, ""));
                }
            },
            Form::Json => {
                if let Some((name, _)) = line.split_once("\":") {
                    key = name.trim().trim_start_matches('"').to_string();
                }
                let values = words(start, line, " ,:").into_iter().filter(|(_, word)| numeric(word));
                values.for_each(|(at, word)| add(at, word, &key));
            }
            Form::Array => {}
        }
    }
    found
}

/// The names of columns and keys.
pub(crate) fn names(reader: &Reader) -> Vec<Token> {
    let mut found = Vec::new();
    for (index, (start, line)) in lines(reader.text()).enumerate() {
        let mut add = |at: usize, word: &str| found.push(token(at, word, index + 1, word));
        match reader.form {
            Form::Table if index == 0 => {
                words(start, line, ",").into_iter().for_each(|(at, word)| add(at, word));
            }
            Form::Toml => {
                let line = line.split('#').next().unwrap_or_default();
                let named = |(at, _): &(usize, &str)| {
                    let rest = reader.text()[*at..].split_once('=').map_or("", |(name, _)| name).trim_end();
                    !rest.is_empty() && rest.chars().all(|c| c.is_alphanumeric() || "_-".contains(c))
                };
                let words = words(start, line, " ,[]{}=").into_iter().filter(named);
                words.for_each(|(at, word)| add(at, word));
            }
            Form::Json => {
                if let Some((name, _)) = line.split_once("\":") {
                    let name = name.trim_start();
                    add(start + line.len() - line.trim_start().len() + 1, &name[1..]);
                }
            }
            _ => {}
        }
    }
    found
}
