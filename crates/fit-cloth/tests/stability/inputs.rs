//! Cases 41 to 44, and 18: damaged text. Every kind of damage is tried on every reader it applies to, at random places;
//! the reported line and field must be those of the damage.

use crate::property::for_all;
use crate::readers::{Form, Place, READERS, Reader, Refusal, TEXTS, contents, readers};
use crate::table::{Extent, Row};
use crate::tokens::{Token, lines, numbers};
use proptest::prelude::*;
use std::fs;

/// Expected refusal: line, part of the field, and part of what was found or expected.
pub(crate) struct Wanted<'a> {
    pub(crate) line: Option<usize>,
    pub(crate) field: &'a str,
    pub(crate) words: &'a str,
}

impl Wanted<'_> {
    pub(crate) fn complaint(&self, outcome: Result<Refusal, String>) -> Option<String> {
        let Refusal { line, field, found, expected } = match outcome {
            Ok(refusal) => refusal,
            Err(complaint) => return Some(complaint),
        };
        let holds = line == self.line
            && field.contains(self.field)
            && (found.contains(self.words) || expected.contains(self.words));
        (!holds).then(|| {
            let Wanted { line: wanted, field: key, words } = self;
            format!("line {line:?} of {wanted:?}, field {field} of {key}, found {found}, expected {expected}, wanted {words}")
        })
    }
}

/// One run: a damaged file and its expected refusal.
pub(crate) fn refused(
    row: &mut Row,
    reader: &Reader,
    place: &Place,
    text: &str,
    wanted: &Wanted<'_>,
) -> bool {
    let complaint = wanted.complaint(reader.refusal(place, text.as_bytes()));
    row.holds(complaint.is_none(), || format!("{}: {}", reader.file, complaint.unwrap_or_default()))
}

/// One run of the program with the damaged file.
pub(crate) fn program_refused(
    row: &mut Row,
    reader: &Reader,
    place: &Place,
    bytes: &[u8],
    line: Option<usize>,
) -> bool {
    let outcome = reader.program_refuses(place, bytes, line);
    row.holds(outcome.is_ok(), || outcome.err().unwrap_or_default())
}

/// Picks an element by a random number.
pub(crate) fn pick<T>(all: &[T], random: usize) -> &T {
    &all[random % all.len()]
}

/// Line of a byte, counted from 1.
pub(crate) fn line_of(text: &str, offset: usize) -> usize {
    1 + text[..offset].matches('\n').count()
}

// 18 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_18(_: Extent) -> Vec<Row> {
    let place = Place::new();
    let by_name = |file: &str| READERS.iter().find(|reader| reader.file.ends_with(file)).unwrap();
    // File, quantity multiplied by a thousand, line and field of the refusal, and its words.
    let lengths: [(&str, &str, Option<usize>, &str); 8] = [
        ("stretch-weft/mesh.obj", "v ", Some(10), "mesh"),
        ("stretch-weft/mesh.obj", "vt ", Some(10), "mesh"),
        ("stretch-weft/clips.csv", "tx_m", None, "frame"),
        ("frames/0001.obj", "v ", None, "frame 1"),
        ("set/fabric.toml", "width_m", Some(2), "width_m"),
        ("known.toml", "height_m", Some(8), "height_m"),
        ("strip.csv", "clamp_distance_m", Some(2), "clamp_distance_m"),
        ("pull.csv", "travel_mm", Some(3), "travel_mm"),
    ];
    lengths
        .into_iter()
        .map(|(file, what, line, field)| {
            let reader = by_name(file);
            let mut row = Row::new(18, format!("millimetres for metres: {what} of {file}"));
            let mut text = reader.text().to_string();
            // From the end, so that earlier positions stay valid.
            for token in numbers(reader).iter().rev().filter(|token| token.field == what.trim()) {
                let value: f64 = text[token.place.clone()].parse().unwrap();
                text = token.replaced(&text, &(1000.0 * value).to_string());
            }
            let millimetres =
                if file == "strip.csv" || file == "pull.csv" { "another unit" } else { "millimetres" };
            refused(&mut row, reader, &place, &text, &Wanted { line, field, words: millimetres });
            program_refused(&mut row, reader, &place, text.as_bytes(), line);
            row
        })
        .collect()
}

// 41 ---------------------------------------------------------------------------------------------------------------

/// Harmless variants of the same text.
fn variants(text: &str) -> [Vec<u8>; 6] {
    let mark = |text: &str| format!("\u{feff}{text}").into_bytes();
    [
        mark(text),
        text.replace('\n', "\r\n").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        text.trim_end().as_bytes().to_vec(),
        mark(&text.replace('\n', "\r\n")),
        mark(text.replace('\n', "\r").trim_end()),
    ]
}

pub(crate) fn case_41(_: Extent) -> Vec<Row> {
    let place = Place::new();
    let mut rows: Vec<Row> = readers(&TEXTS)
        .map(|reader| {
            let mut row = Row::new(41, format!("mark, CR, CRLF, no last line end: {}", reader.file));
            let plain = reader.read(&place).unwrap();
            for bytes in variants(reader.text()) {
                let read = reader.read_of(&place, &bytes);
                row.holds(read.as_ref().is_ok_and(|read| *read == plain), || {
                    format!("{:?}… gives {read:?} for {plain}", &bytes[..bytes.len().min(12)])
                });
            }
            row
        })
        .collect();
    let mut row = Row::new(41, "all files with a mark and CRLF: each command writes the same bytes");
    let mut done: Vec<&[&str]> = Vec::new();
    for reader in &READERS {
        if done.contains(&reader.command()) {
            continue;
        }
        done.push(reader.command());
        let written = [false, true].map(|marked| {
            let place = Place::new();
            for reader in readers(&TEXTS).filter(|_| marked) {
                fs::write(place.path().join(reader.file), &variants(reader.text())[4]).unwrap();
            }
            let output = place.run(reader.command());
            let mut written = contents(place.path());
            written.retain(|name, _| name.starts_with("out"));
            // Wall times differ.
            written.retain(|name, _| !name.ends_with("residuals.csv") && !name.ends_with("simulation.json"));
            (output.status.code(), written)
        });
        let [plain, marked] = &written;
        row.holds(!plain.1.is_empty() && matches!(plain.0, Some(0 | 3 | 4)) && plain == marked, || {
            format!("{}: {:?} and {:?}", reader.command().join(" "), plain.0, marked.0)
        });
    }
    rows.push(row);
    rows
}

// 42 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_42(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let mut rows = Vec::new();
    let little = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let big = |text: &str| text.encode_utf16().flat_map(u16::to_be_bytes).collect::<Vec<u8>>();
    type Encode<'a> = &'a dyn Fn(&str) -> Vec<u8>;
    let encodings: [(&str, Encode<'_>); 4] = [
        ("UTF-16, little-endian", &|text| little(&format!("\u{feff}{text}"))),
        ("UTF-16, big-endian", &|text| big(&format!("\u{feff}{text}"))),
        ("UTF-16 without a mark, little-endian", &little),
        ("UTF-16 without a mark, big-endian", &big),
    ];
    for (name, encode) in encodings {
        let mut row = Row::new(42, format!("{name}: every text"));
        for reader in readers(&TEXTS) {
            let wanted = Wanted { line: Some(1), field: "text", words: "UTF-16" };
            let complaint = wanted.complaint(reader.refusal(&place, &encode(reader.text())));
            row.holds(complaint.is_none(), || format!("{}: {complaint:?}", reader.file));
        }
        rows.push(row);
    }
    let mut row = Row::new(42, "UTF-16: every command");
    for reader in readers(&TEXTS) {
        let bytes = encodings[0].1(reader.text());
        program_refused(&mut row, reader, &place, &bytes, Some(1));
    }
    rows.push(row);
    let texts: Vec<&Reader> = readers(&TEXTS).collect();
    let inputs = (any::<usize>(), any::<usize>(), 0x80u8..);
    let row = Row::new(42, "a byte of Latin-1 at any place of any text");
    rows.push(for_all(row, extent.runs(300, 10_000), inputs, |row, (file, at, byte)| {
        let reader = pick(&texts, file);
        // Beside a two-byte character it might form another character.
        let places: Vec<usize> =
            (0..reader.text().len()).filter(|&at| reader.bytes()[..at].is_ascii()).collect();
        let at = *pick(&places, at);
        let mut bytes = reader.bytes().to_vec();
        bytes.insert(at, byte);
        let wanted = Wanted { line: Some(line_of(reader.text(), at)), field: "text", words: "Latin-1" };
        let complaint = wanted.complaint(reader.refusal(&place, &bytes));
        row.holds(complaint.is_none(), || format!("{} at {at}: {complaint:?}", reader.file))
    }));
    rows
}

// 43 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_43(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let mut rows = Vec::new();
    let comma = |text: &str| text.replace(',', ";").replace('.', ",");
    type Change<'a> = &'a dyn Fn(&str) -> String;
    let quoted = |text: &str| {
        let quote =
            |line: &str| line.split(',').map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(";");
        text.lines().map(quote).collect::<Vec<_>>().join("\n")
    };
    let separators: [(&str, Change<'_>, &str); 4] = [
        ("semicolons", &|text| text.replace(',', ";"), "semicolons"),
        ("semicolons and decimal commas", &comma, "semicolons"),
        ("semicolons, every field quoted", &quoted, "semicolons"),
        ("tabs", &|text| text.replace(',', "\t"), "tabs"),
    ];
    for (name, change, words) in separators {
        let mut row = Row::new(43, format!("{name}: every table"));
        for reader in readers(&[Form::Table]) {
            let wanted = Wanted { line: Some(1), field: "header", words };
            refused(&mut row, reader, &place, &change(reader.text()), &wanted);
        }
        rows.push(row);
    }
    let mut row = Row::new(43, "semicolons: every command that reads a table");
    for reader in readers(&[Form::Table]) {
        program_refused(&mut row, reader, &place, comma(reader.text()).as_bytes(), Some(1));
    }
    rows.push(row);
    for (form, name) in [(Form::Table, "table"), (Form::Obj, "OBJ"), (Form::Ply, "PLY"), (Form::Json, "JSON")]
    {
        let all: Vec<&Reader> = readers(&[form]).collect();
        let row = Row::new(43, format!("a decimal comma for any point: {name}"));
        rows.push(for_all(row, extent.runs(60, 2_000), any::<[usize; 3]>(), |row, [file, at, quotes]| {
            let reader = pick(&all, file);
            let tokens = numbers(reader);
            // In a list it would be an additional number.
            let listed = |token: &Token| {
                let line = lines(reader.text()).nth(token.line - 1).map_or("", |(_, line)| line);
                form == Form::Json && !line.contains(':')
            };
            let pointed: Vec<&Token> = tokens
                .iter()
                .filter(|token| reader.text()[token.place.clone()].contains('.') && !listed(token))
                .collect();
            if pointed.is_empty() {
                return row.holds(true, String::new);
            }
            let token = *pick(&pointed, at);
            let with_comma = reader.text()[token.place.clone()].replace('.', ",");
            let quoted = form == Form::Table && quotes % 2 == 0;
            let (by, field) = match (form, quoted) {
                (Form::Table, true) => (format!("\"{with_comma}\""), &token.field[..]),
                (Form::Table, false) => (with_comma, "row"),
                (Form::Json, _) => (with_comma, ""),
                _ => (with_comma, &token.field[..]),
            };
            let text = token.replaced(reader.text(), &by);
            // One decimal comma in a table is one field too many, and the message cannot say more.
            let known = quoted || form == Form::Obj;
            let words = if known { "comma" } else { "" };
            refused(row, reader, &place, &text, &Wanted { line: Some(token.line), field, words })
        }));
    }
    // In a list it would be an additional number.
    let single = |reader: &Reader, token: &Token| {
        let line = lines(reader.text()).nth(token.line - 1).map_or("", |(_, line)| line);
        !line.contains(['[', '{']) && reader.text()[token.place.clone()].contains('.')
    };
    let all: Vec<(&Reader, Token)> = readers(&[Form::Toml])
        .flat_map(|reader| numbers(reader).into_iter().map(move |token| (reader, token)))
        .filter(|(reader, token)| single(reader, token))
        .collect();
    let mut row = Row::new(43, "a decimal comma: every TOML");
    for (reader, token) in &all {
        let text = token.replaced(reader.text(), &reader.text()[token.place.clone()].replace('.', ","));
        let wanted = Wanted { line: Some(token.line), field: &token.field, words: "comma" };
        refused(&mut row, reader, &place, &text, &wanted);
    }
    rows.push(row);
    rows
}

// 44 ---------------------------------------------------------------------------------------------------------------

const NO_NUMBERS: [&str; 7] = ["nan", "inf", "-inf", "1e400", "-1e400", "\u{2212}1", ""];

/// True if an empty number is harmless, or detected on another line.
fn may_miss(reader: &Reader, token: &Token) -> bool {
    let line = lines(reader.text()).nth(token.line - 1).map_or("", |(_, line)| line);
    match reader.form {
        Form::Toml => line.contains(['[', '{']),
        Form::Json => !line.trim_end().ends_with(','),
        _ => false,
    }
}

pub(crate) fn case_44(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let mut rows: Vec<Row> = readers(&TEXTS)
        .map(|reader| {
            let tokens = numbers(reader);
            let row = Row::new(
                44,
                format!("nan, inf, 1e400, \u{2212}1 or nothing for any number: {}", reader.file),
            );
            for_all(row, extent.runs(40, 1_000), any::<[usize; 2]>(), |row, [at, damage]| {
                let (token, by) = (pick(&tokens, at), *pick(&NO_NUMBERS, damage));
                let by = if by.is_empty() && may_miss(reader, token) { "nan" } else { by };
                // NaN in PLY marks an unobserved vertex, in all three coordinates; the mismatch has no line of its own.
                let by = if by == "nan" && reader.file.ends_with(".ply") { "inf" } else { by };
                let wanted = Wanted { line: Some(token.line), field: &token.field, words: "" };
                refused(row, reader, &place, &token.replaced(reader.text(), by), &wanted)
            })
        })
        .collect();
    let mut row = Row::new(44, "1e400: every command");
    for reader in readers(&TEXTS) {
        let token = numbers(reader).pop().unwrap();
        let text = token.replaced(reader.text(), "1e400");
        program_refused(&mut row, reader, &place, text.as_bytes(), Some(token.line));
    }
    rows.push(row);
    rows
}
