//! A section of a study.

/// A table, its explanation and its figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Title.
    pub title: String,
    /// Explanation of the table.
    pub words: String,
    /// Column names.
    pub header: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
    /// Name of the figure, without its extension.
    pub plot: Option<&'static str>,
}

impl Section {
    /// The table as Markdown.
    pub fn table(&self) -> String {
        markdown(&self.header.iter().map(String::as_str).collect::<Vec<_>>(), &self.rows)
    }
}

/// Column names as strings.
pub(super) fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// A Markdown table, padded to be readable as plain text; numbers are right-aligned.
fn markdown(header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.chain([header[column].chars().count(), 3]).max().unwrap_or(3)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let pad = |column: usize, cell: &str| match column {
        0 => format!("{cell:0$}", widths[column]),
        _ => format!("{cell:>0$}", widths[column]),
    };
    let padded = |cells: Vec<&str>| line(cells.iter().enumerate().map(|(i, cell)| pad(i, cell)).collect());
    let rule = widths.iter().enumerate().map(|(column, &width)| match column {
        0 => "-".repeat(width),
        _ => "-".repeat(width - 1) + ":",
    });
    let body = rows.iter().map(|row| padded(row.iter().map(String::as_str).collect()));
    std::iter::once(padded(header.to_vec())).chain([line(rule.collect())]).chain(body).collect()
}
