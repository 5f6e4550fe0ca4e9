//! A study in tables with a sentence each: `study.md`, and what a person reads on the terminal.

mod equilibria;
mod fits;
mod noise;
mod parts;

use super::{Study, table};

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
        table::markdown(&self.header.iter().map(String::as_str).collect::<Vec<_>>(), &self.rows)
    }
}

/// All sections, in order; what was not run has none.
pub fn sections(study: &Study) -> Vec<Section> {
    let all = [
        equilibria::meshes(study),
        equilibria::tolerances(study),
        fits::fits(study),
        fits::stages(study),
        noise::noise(study),
        parts::parts(study),
    ];
    all.into_iter().filter(|section| !section.rows.is_empty()).collect()
}

fn header(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// A share in per cent, three digits.
fn percent(share: Option<f64>) -> String {
    share.map_or("-".into(), |share| match share {
        // So far off that it does not matter by how much.
        share if share > 10.0 => "> 1000 %".into(),
        share => format!("{} %", digits(100.0 * share)),
    })
}

/// A number with three digits, or a dash.
fn short(value: Option<f64>) -> String {
    value.map_or("-".into(), digits)
}

fn digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 1e-3 => format!("{value:.1e}"),
        size => {
            let after = (2.0 - size.log10().floor()).clamp(0.0, 5.0) as usize;
            format!("{value:.after$}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let pairs = [(0.0, "0"), (123.4, "123"), (1.5, "1.50"), (0.0123, "0.0123"), (2e-7, "2.0e-7")];
        pairs.iter().for_each(|(value, text)| assert_eq!(digits(*value), *text));
    }
}
