//! Cases 45 to 48: malformed tables, names, faces and JSON.

use crate::inputs::{Wanted, line_of, pick, program_refused, refused};
use crate::property::for_all;
use crate::readers::{Form, Place, READERS, Reader, readers};
use crate::table::{Extent, Row};
use crate::tokens::{Token, lines, names, numbers};
use proptest::prelude::*;
use std::fs;

// 45 ---------------------------------------------------------------------------------------------------------------

/// Cells of a table.
fn cells(reader: &Reader) -> Vec<Vec<String>> {
    reader.text().lines().map(|line| line.split(',').map(String::from).collect()).collect()
}

fn joined(cells: &[Vec<String>]) -> String {
    cells.iter().map(|row| row.join(",") + "\n").collect()
}

pub(crate) fn case_45(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let tables: Vec<&Reader> = readers(&[Form::Table]).collect();
    let runs = extent.runs(60, 2_000);
    let mut rows = Vec::new();
    type Damage = fn(&mut Vec<Vec<String>>, usize, usize) -> (usize, &'static str);
    // Damage to the cells at a line below the header and a column; returns line and field of the refusal.
    let damages: [(&str, Damage); 7] = [
        ("a field too few", |cells, row, column| {
            cells[row].remove(column);
            (row + 1, "row")
        }),
        ("a field too many", |cells, row, column| {
            cells[row].insert(column, "1".into());
            (row + 1, "row")
        }),
        ("a quote that stays open", |cells, row, column| {
            cells[row][column].insert(0, '"');
            (row + 1, "quote")
        }),
        ("a quote that stays open in the header", |cells, _, column| {
            cells[0][column].insert(0, '"');
            (1, "quote")
        }),
        ("a column twice", |cells, _, column| {
            let other = cells[0][(column + 1) % cells[0].len()].clone();
            cells[0][column] = other;
            (1, "header")
        }),
        ("a column without a name", |cells, _, column| {
            cells[0][column].clear();
            (1, "header")
        }),
        ("no header", |cells, _, _| {
            cells.remove(0);
            (1, "header")
        }),
    ];
    for (name, damage) in damages {
        let row = Row::new(45, format!("{name}: any table"));
        rows.push(for_all(row, runs, any::<[usize; 3]>(), |row, [file, line, column]| {
            // Unused columns of a laboratory's table may have any name.
            let named = |reader: &&&Reader| !name.starts_with("a column") || reader.file != "strip.csv";
            let tables: Vec<&&Reader> = tables.iter().filter(named).collect();
            let reader = pick(&tables, file);
            let mut cells = cells(reader);
            let (line, column) = (1 + line % (cells.len() - 1), column % cells[0].len());
            let (line, field) = damage(&mut cells, line, column);
            refused(row, reader, &place, &joined(&cells), &Wanted { line: Some(line), field, words: "" })
        }));
    }
    // Required columns; a strip's branches are optional.
    let needed = |name: &str| {
        let optional = ["time_s", "cycle", "phase", "branch", "stiffness_n_per_m"];
        !(optional.contains(&name) || name.starts_with("stress_") && name != "stress_n_per_m")
    };
    let row = Row::new(45, "a column missing: any table");
    rows.push(for_all(row, runs, any::<[usize; 2]>(), |row, [file, column]| {
        let reader = pick(&tables, file);
        let mut cells = cells(reader);
        let columns: Vec<usize> = (0..cells[0].len()).filter(|&column| needed(&cells[0][column])).collect();
        let column = *pick(&columns, column);
        cells.iter_mut().for_each(|row| _ = row.remove(column));
        refused(row, reader, &place, &joined(&cells), &Wanted { line: Some(1), field: "header", words: "" })
    }));
    let mut row = Row::new(45, "a ragged row: every command that reads a table");
    for reader in &tables {
        let mut cells = cells(reader);
        cells[1].pop();
        program_refused(&mut row, reader, &place, joined(&cells).as_bytes(), Some(2));
    }
    rows.push(row);
    rows
}

// 46 ---------------------------------------------------------------------------------------------------------------

const SUFFIXES: [&str; 13] = [
    "_n_per_m", "_per_m", "_kg_m2", "_kg_m3", "_m_s2", "_m_s", "_n_m", "_rad", "_mm", "_m", "_n", "_N", "_s",
];

/// A name without its unit; `None` if it has none.
fn without_unit(name: &str) -> Option<&str> {
    SUFFIXES.iter().find_map(|suffix| name.strip_suffix(suffix)).filter(|rest| !rest.is_empty())
}

pub(crate) fn case_46(_: Extent) -> Vec<Row> {
    let place = Place::new();
    let mut rows = Vec::new();
    for (what, other) in [("no unit", ""), ("another unit", "_furlong")] {
        for (form, name) in
            [(Form::Table, "column"), (Form::Toml, "key of TOML"), (Form::Json, "key of JSON")]
        {
            let mut row = Row::new(46, format!("{what} in the name of any {name}"));
            for reader in readers(&[form]) {
                for token in names(reader) {
                    let Some(rest) = without_unit(&token.field) else { continue };
                    let found = format!("{rest}{other}");
                    let text = token.replaced(reader.text(), &found);
                    let words = if reader.file == "strip.csv" || reader.file == "pull.csv" {
                        "no column"
                    } else if form == Form::Table || form == Form::Toml {
                        &found
                    } else {
                        "key"
                    };
                    let outcome = reader.refusal(&place, text.as_bytes());
                    let holds = outcome.as_ref().is_ok_and(|refusal| {
                        let all = format!("{} {} {}", refusal.field, refusal.found, refusal.expected);
                        refusal.line == Some(token.line) && all.contains(words) && all.contains(&token.field)
                    });
                    row.holds(holds, || format!("{} {}: {outcome:?}", reader.file, token.field));
                }
            }
            rows.push(row);
        }
    }
    let by_name = |file: &str| READERS.iter().find(|reader| reader.file.ends_with(file)).unwrap();
    let mut damage = |what: &str, file: &str, [old, new]: [&str; 2], wanted: &Wanted<'_>| {
        let reader = by_name(file);
        assert!(reader.text().contains(old), "{old} is not in {file}");
        let text = reader.text().replacen(old, new, 1);
        let mut row = Row::new(46, what);
        refused(&mut row, reader, &place, &text, wanted);
        program_refused(&mut row, reader, &place, text.as_bytes(), wanted.line);
        rows.push(row);
    };
    let wanted = |line, field, words| Wanted { line: Some(line), field, words };
    let rad = ["largest_shear_rad = 0.2", "largest_shear_deg = 11.5"];
    damage("degrees by their key", "known.toml", rad, &wanted(12, "largest_shear_deg", "degrees to radians"));
    let rad = ["largest_shear_rad = 0.2", "largest_shear_rad = 11.5"];
    damage(
        "degrees under the key of radians",
        "known.toml",
        rad,
        &wanted(12, "largest_shear_rad", "at most 1.2"),
    );
    let turned = ["0,1,0,0,0", "0,0,0,0,30"];
    damage(
        "angles in degrees for a quaternion",
        "clips.csv",
        turned,
        &wanted(2, "qw,qx,qy,qz", "unit length"),
    );
    let turned = ["qw,qx,qy,qz", "angle_deg,qx,qy,qz"];
    damage("a column of degrees for a quaternion", "clips.csv", turned, &wanted(1, "header", "angle_deg"));
    let direction = ["weft = [1.0, 0.0, 0.0]", "weft = 30.0"];
    damage("an angle for a direction", "scene.toml", direction, &wanted(9, "sheet.weft", ""));
    let mut row = Row::new(46, "a shear angle in degrees, by its column or asked for");
    for (header, asked) in [("angle_deg", "angle_deg"), ("angle", "angle:deg"), ("angle", "angle")] {
        let pull = by_name("pull.csv");
        fs::write(place.path().join("pull.csv"), pull.text().replace("travel_mm", header)).unwrap();
        let arguments = [
            "import",
            "table",
            "pull.csv",
            "--width-m",
            "0.05",
            "--force",
            "load_N",
            "--strain",
            asked,
            "--measure",
            "shear",
            "--out",
            "out",
        ];
        let outcome = place.refuses(&arguments, &format!("pull.csv:1 {header}: found "));
        row.holds(outcome.is_ok(), || outcome.err().unwrap_or_default());
    }
    rows.push(row);
    rows
}

// 47 ---------------------------------------------------------------------------------------------------------------

/// Damages a corner of an OBJ face and returns the expected words. Arguments: number of vertices, the corner's parts, a
/// random number.
type Corner = fn(usize, &mut Vec<String>, usize) -> &'static str;

pub(crate) fn case_47(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let meshes: Vec<&Reader> =
        readers(&[Form::Obj]).filter(|reader| !reader.file.contains("frames")).collect();
    let runs = extent.runs(60, 2_000);
    let mut rows = Vec::new();
    let damages: [(&str, &str, Corner); 9] = [
        ("index 0", "f v", |_, parts, _| {
            parts[0] = "0".into();
            "an index from 1"
        }),
        ("index 0 of vt", "f vt", |_, parts, _| {
            parts[1] = "0".into();
            "an index from 1"
        }),
        ("an index out of range", "f v", |vertices, parts, by| {
            parts[0] = (vertices + 1 + by % 1_000_000).to_string();
            "an index that exists"
        }),
        ("an index of vt out of range", "f vt", |vertices, parts, by| {
            parts[1] = (vertices + 1 + by % 1_000_000).to_string();
            "an index that exists"
        }),
        ("a negative index out of range", "f v", |vertices, parts, by| {
            parts[0] = format!("-{}", vertices + 1 + by % 1_000_000);
            "backwards"
        }),
        ("an index that no integer holds", "f v", |_, parts, by| {
            parts[0] =
                ["99999999999999999999", "-99999999999999999999", "9223372036854775808"][by % 3].into();
            "an index"
        }),
        ("no vt", "f vt", |_, parts, by| {
            *parts =
                [vec![parts[0].clone()], vec![parts[0].clone(), String::new(), "1".into()]][by % 2].clone();
            "v/vt at every corner"
        }),
        ("no index", "f v", |_, parts, by| {
            parts[0] = ["x", "1.0", "", "+"][by % 4].into();
            "an index"
        }),
        ("a corner twice", "mesh", |_, parts, _| {
            *parts = vec!["1".into(), "1".into()];
            "named twice"
        }),
    ];
    for (name, field, damage) in damages {
        let row = Row::new(47, format!("{name}: any face of any mesh"));
        rows.push(for_all(row, runs, any::<[usize; 3]>(), |row, [file, at, by]| {
            let reader = pick(&meshes, file);
            let vertices = reader.text().lines().filter(|line| line.starts_with("v ")).count();
            let corners: Vec<Token> =
                numbers(reader).into_iter().filter(|token| token.field == "f").collect();
            let mut token = pick(&corners, at);
            // Another corner of a face that already has the first vertex.
            if field == "mesh" {
                let first = |token: &&Token| reader.text()[token.place.clone()].starts_with("1/");
                let line = corners.iter().find(first).unwrap().line;
                let others = corners.iter().filter(|other| other.line == line && !first(other));
                token = *pick(&others.collect::<Vec<_>>(), at);
            }
            let mut parts: Vec<String> =
                reader.text()[token.place.clone()].split('/').map(String::from).collect();
            let words = damage(vertices, &mut parts, by);
            let text = token.replaced(reader.text(), &parts.join("/"));
            refused(row, reader, &place, &text, &Wanted { line: Some(token.line), field, words })
        }));
    }
    let row = Row::measured(47, "quads and indices counted backwards: the mesh of its triangles", "m", 0.0);
    rows.push(for_all(row, extent.runs(30, 2_000), (2usize..9, 2usize..9, any::<bool>()), quads));
    let mut row = Row::new(47, "index 0: every command that reads a mesh");
    for reader in &meshes {
        let token = numbers(reader).pop().unwrap();
        let text = token.replaced(reader.text(), "0/1");
        program_refused(&mut row, reader, &place, text.as_bytes(), Some(token.line));
    }
    rows.push(row);
    rows
}

/// A grid of quads as OBJ, with indices from 1 or relative to the end, against directly counted nodes.
fn quads(row: &mut Row, (columns, rows, backwards): (usize, usize, bool)) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.obj");
    let mut text = String::new();
    for node in 0..columns * rows {
        let (u, v) = (0.01 * (node % columns) as f64, 0.01 * (node / columns) as f64);
        text += &format!("v {u} {v} 0\nvt {u} {v}\n");
    }
    let index = |node: usize| match backwards {
        true => format!("{0}/{0}", node as i64 - (columns * rows) as i64),
        false => format!("{0}/{0}", node + 1),
    };
    let mut triangles = Vec::new();
    for cell in (0..columns * (rows - 1)).filter(|cell| cell % columns != columns - 1) {
        let [a, b, c, d] = [cell, cell + 1, cell + 1 + columns, cell + columns];
        text += &format!("f {} {} {} {}\n", index(a), index(b), index(c), index(d));
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    fs::write(&path, text).unwrap();
    let mesh = match cloth_data::io::read_mesh(&path, None) {
        Ok(mesh) if mesh.triangles == triangles => mesh,
        other => return row.holds(false, || format!("{columns}x{rows}: {other:?}")),
    };
    let apart = mesh.positions.iter().zip(&mesh.material).map(|(p, m)| (p.xy() - m).norm());
    row.measure(apart.fold(0.0, f64::max), || format!("{columns}x{rows}"))
}

// 48 ---------------------------------------------------------------------------------------------------------------

pub(crate) fn case_48(extent: Extent) -> Vec<Row> {
    let place = Place::new();
    let reader = readers(&[Form::Json]).next().unwrap();
    let text = reader.text();
    let mut rows = Vec::new();
    let mut row = Row::new(48, "too deep, as JSON, in any bracket");
    for depth in [128, 1_000, 1_000_000] {
        for [open, close] in [["[", "]"], ["{\"a\":", "}"]] {
            let deep = open.repeat(depth) + "1" + &close.repeat(depth);
            refused(
                &mut row,
                reader,
                &place,
                &deep,
                &Wanted { line: Some(1), field: "", words: "recursion limit" },
            );
            let within = text.replacen("0.003", &deep, 1);
            let line = Some(line_of(text, text.find("0.003").unwrap()));
            refused(
                &mut row,
                reader,
                &place,
                &within,
                &Wanted { line, field: "noise_n", words: "recursion limit" },
            );
            program_refused(&mut row, reader, &place, within.as_bytes(), line);
        }
    }
    rows.push(row);
    let mut row = Row::new(48, "too deep, as TOML");
    for reader in readers(&[Form::Toml]) {
        for depth in [1_000, 100_000] {
            let deep = format!("deep = {}1{}\n{}", "[".repeat(depth), "]".repeat(depth), reader.text());
            refused(&mut row, reader, &place, &deep, &Wanted { line: Some(1), field: "deep", words: "" });
            program_refused(&mut row, reader, &place, deep.as_bytes(), Some(1));
        }
    }
    rows.push(row);
    let keys = names(reader);
    let row = Row::new(48, "any key of JSON twice");
    rows.push(for_all(row, extent.runs(60, 2_000), any::<usize>(), |row, at| {
        let token = pick(&keys, at);
        // The value repeated on the line above.
        let start = token.place.start - 1;
        let value = value_of(&text[token.place.end + 2..]);
        let again = format!("{}\"{}\": {value},\n{}", &text[..start], token.field, &text[start..]);
        let line = token.line + value.matches('\n').count() + 1;
        let outcome = reader.refusal(&place, again.as_bytes());
        let holds = outcome.as_ref().is_ok_and(|refusal| {
            refusal.line == Some(line)
                && refusal.expected == "every key once"
                && refusal.field.contains(&token.field)
        });
        row.holds(holds, || format!("{} on line {line}: {outcome:?}", token.field))
    }));
    let mut row = Row::new(48, "any key of TOML twice");
    for reader in readers(&[Form::Toml]) {
        for token in names(reader) {
            let (start, line) = lines(reader.text()).nth(token.line - 1).unwrap();
            if token.place.start != start {
                continue;
            }
            let again = format!("{}{line}\n{}", &reader.text()[..start], &reader.text()[start..]);
            let wanted = Wanted { line: Some(token.line + 1), field: &token.field, words: "every key once" };
            refused(&mut row, reader, &place, &again, &wanted);
        }
    }
    rows.push(row);
    let mut row = Row::new(48, "null for any number that must be there");
    for token in numbers(reader) {
        // A deviation, a range, a noise and a residual may be null: unknown.
        if ["deviation_n_per_m", "rank", "noise_n", "rms_force_n"].contains(&&token.field[..]) {
            continue;
        }
        let wanted = Wanted { line: Some(token.line), field: &token.field, words: "" };
        refused(&mut row, reader, &place, &token.replaced(text, "null"), &wanted);
    }
    rows.push(row);
    let mut row = Row::new(48, "null for what may be unknown: read as if it were not there");
    for token in numbers(reader) {
        if !["rank", "noise_n", "rms_force_n"].contains(&&token.field[..]) {
            continue;
        }
        let null = reader.read_of(&place, token.replaced(text, "null").as_bytes());
        let none = reader.read(&place).unwrap().replacen(
            &format!("{}: Some({})", token.field, &text[token.place.clone()]),
            &format!("{}: None", token.field),
            1,
        );
        row.holds(null.as_ref().is_ok_and(|read| *read == none), || format!("{}: {null:?}", token.field));
    }
    rows.push(row);
    let row = Row::new(48, "cut off anywhere");
    rows.push(for_all(row, extent.runs(60, 2_000), 1..text.trim_end().len(), |row, end| {
        let cut = &text[..end];
        // The parser names the line where the text ends.
        let outcome = reader.refusal(&place, cut.as_bytes());
        let last = line_of(cut, cut.len());
        let holds = outcome
            .as_ref()
            .is_ok_and(|refusal| refusal.line.is_some_and(|line| line == last || line + 1 == last));
        row.holds(holds, || format!("at {end}: {outcome:?}"))
    }));
    rows
}

/// The value at the beginning of a text, up to a comma or line end.
fn value_of(text: &str) -> &str {
    let mut depth = 0;
    for (at, character) in text.char_indices() {
        match character {
            '{' | '[' => depth += 1,
            '}' | ']' => depth -= 1,
            _ => {}
        }
        if depth < 0 || depth == 0 && (character == ',' || character == '\n') {
            return text[..at].trim();
        }
    }
    text.trim()
}
