//! A table of a study, a sentence on it, and its figure.

/// A table, what it says, and its figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Title.
    pub title: String,
    /// What is to be seen, in plain words.
    pub words: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
    /// Name of the figure that shows it, without its ending.
    pub plot: Option<&'static str>,
}

impl Section {
    /// The table alone.
    pub fn table(&self) -> String {
        markdown(&self.header.iter().map(String::as_str).collect::<Vec<_>>(), &self.rows)
    }
}

/// Names of columns.
pub(super) fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// Rows of cells as a Markdown table, padded so that it reads well as it stands; numbers stand on the right.
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
