//! Reads the bytes or the text of a file; unreadable kinds of file are refused early.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Largest file size: files are read into memory, and no measurement needs more.
const LARGEST: u64 = 2 << 30;

/// Signatures of spreadsheet files: ZIP and the older compound files.
const WORKBOOKS: [&[u8]; 2] = [b"PK\x03\x04", b"\xD0\xCF\x11\xE0"];

/// Reads a regular, non-empty file of at most 2 GiB.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let refuse = |found: &str, expected: &str| Err(Error::input(path, None, "file", found, expected));
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => Error::input(path, None, "file", "nothing", "a file"),
        ErrorKind::PermissionDenied => {
            Error::input(path, None, "file", "no permission to read it", "a readable file")
        }
        _ => Error::io(path, error),
    };
    let about = fs::metadata(path).map_err(failed)?;
    if about.is_dir() {
        return refuse("a folder", "a regular file");
    }
    if !about.is_file() {
        return refuse("a pipe, socket or device", "a regular file");
    }
    let mut bytes = Vec::new();
    if about.len() <= LARGEST {
        // The limit applies even if the file grows while it is read.
        File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes)).map_err(failed)?;
    }
    match bytes.len() as u64 {
        _ if about.len() > LARGEST => refuse(&format!("{} bytes", about.len()), "at most 2 GiB"),
        0 => refuse("an empty file", "content"),
        1..=LARGEST => Ok(bytes),
        _ => refuse("a file that grows", "at most 2 GiB"),
    }
}

/// Reads UTF-8 text; a byte order mark is dropped and every line ending becomes a line feed.
pub fn read_text(path: &Path) -> Result<String> {
    decoded(path, read_bytes(path)?)
}

/// Decodes bytes that were read already.
pub(crate) fn decoded(path: &Path, mut bytes: Vec<u8>) -> Result<String> {
    let refuse = |offset: usize, found: String| {
        Err(Error::input(path, line_at(&bytes, offset), "text", found, "UTF-8 (save the file as UTF-8)"))
    };
    if WORKBOOKS.iter().any(|magic| bytes.starts_with(magic)) {
        let found = "a workbook (.xlsx, .ods or .xls) or another archive";
        return Err(Error::input(
            path,
            None,
            "text",
            found,
            "plain text (of a workbook save the sheet as CSV)",
        ));
    }
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        return refuse(0, "UTF-16".into());
    }
    if let Some(offset) = bytes.iter().position(|&byte| byte == 0) {
        return refuse(offset, "a zero byte (UTF-16, or not a text?)".into());
    }
    if let Err(error) = std::str::from_utf8(&bytes) {
        let offset = error.valid_up_to();
        return refuse(offset, format!("the byte 0x{:02X} (Latin-1?)", bytes[offset]));
    }
    if bytes.starts_with(&[0xEF, 0xBB, 0xBF]) {
        bytes.drain(..3);
    }
    let text =
        String::from_utf8(bytes).map_err(|_| Error::input(path, None, "text", "other bytes", "UTF-8"))?;
    Ok(if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text })
}

/// Line, from 1, that contains a byte; lines may end in CR, LF or both.
fn line_at(bytes: &[u8], offset: usize) -> usize {
    let ends = |&at: &usize| match bytes[at] {
        b'\n' => true,
        b'\r' => bytes.get(at + 1) != Some(&b'\n'),
        _ => false,
    };
    1 + (0..offset).filter(ends).count()
}

/// Formats file content for a one-line message.
pub fn shown(text: &str) -> String {
    shortened(text, 60)
}

/// As [`shown`], with a maximum number of characters.
pub fn shortened(text: &str, longest: usize) -> String {
    if text.trim().is_empty() {
        return if text.is_empty() { "nothing" } else { "blanks" }.into();
    }
    let mut characters = text.chars().flat_map(escaped);
    let mut short: String = characters.by_ref().take(longest).collect();
    if characters.next().is_some() {
        short.push('…');
    }
    short
}

fn escaped(character: char) -> Vec<char> {
    if character.is_control() { character.escape_default().collect() } else { vec![character] }
}
