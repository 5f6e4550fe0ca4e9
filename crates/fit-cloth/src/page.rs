//! The page of a fit or a comparison: one file that opens without a network, `report.html`.
//!
//! `report.json` is what it shows, as data; a template puts that, the style and the script together.

mod curves;
mod fit;
mod sequences;

pub use fit::Fit;
pub use sequences::Frames;

use crate::text::Ranking;
use cloth_data::error::{Error, Result};
use cloth_data::io::read_json;
use cloth_data::store::{refuse_link, write_file};
use minijinja::{AutoEscape, Environment, context};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const TEMPLATE: &str = include_str!("page/template.html");
const STYLE: &str = include_str!("page/style.css");
const SCRIPT: [&str; 6] = [
    include_str!("page/decode.js"),
    include_str!("page/colours.js"),
    include_str!("page/charts.js"),
    include_str!("page/figures.js"),
    include_str!("page/viewer.js"),
    include_str!("page/main.js"),
];
const CHART_LIBRARY: &str = include_str!("page/vendor/uPlot.iife.min.js");
const CHART_LICENCE: &str = include_str!("page/vendor/uPlot.LICENSE");
const CHART_STYLE: &str = include_str!("page/vendor/uPlot.min.css");

/// The version of `report.json`.
const SCHEMA: &str = "fit-cloth/report/1";

/// The page's file, and that of its data.
const PAGE: &str = "report.html";
const DATA: &str = "report.json";

/// What a page shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Page {
    schema: String,
    program: String,
    fabric: String,
    /// One model each, or one model in one variant each.
    fits: Vec<Fit>,
    /// Which of them is best, if they were compared.
    ranking: Option<Ranking>,
}

impl Page {
    /// A page of some fits of a fabric.
    pub fn new(fabric: &str, fits: Vec<Fit>, ranking: Option<Ranking>) -> Self {
        let program = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        Self { schema: SCHEMA.into(), program, fabric: fabric.into(), fits, ranking }
    }

    /// Reads the data of a result folder.
    ///
    /// # Errors
    /// No such file, or another one: with line and key.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(DATA);
        if !path.is_file() {
            let found = if folder.is_file() { "a file in the place of its folder" } else { "nothing" };
            let expected = "a result folder of fit, stretch, shear, bend or compare, without --no-report; models that were fitted together have theirs in the folder above";
            return Err(Error::input(folder, None, DATA, found, expected));
        }
        let page: Self = read_json(&path, SCHEMA)?;
        if page.fits.is_empty() {
            return Err(Error::input(&path, None, "fits", "none", "one at least"));
        }
        Ok(page)
    }

    /// Writes data and page into a folder that exists.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let data = self.data();
        write_file(&folder.join(DATA), data.as_bytes())?;
        self.write_html(folder, &data)
    }

    /// Writes the page alone, and says where.
    ///
    /// # Errors
    /// Something else than a file in its place; what the operating system refuses.
    pub fn write_again(&self, folder: &Path) -> Result<PathBuf> {
        let page = folder.join(PAGE);
        refuse_link(&page)?;
        self.write_html(folder, &self.data())?;
        Ok(page)
    }

    /// The text of `report.json`.
    fn data(&self) -> String {
        // Strings and finite numbers: nothing here can fail to be JSON.
        serde_json::to_string(self).unwrap_or_default()
    }

    fn write_html(&self, folder: &Path, data: &str) -> Result<()> {
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| AutoEscape::Html);
        let rendered = environment.render_str(
            TEMPLATE,
            context! {
                title => &self.fabric,
                fits => &self.fits,
                chart_style => CHART_STYLE,
                style => STYLE,
                // Nothing in the data may end the script that holds it.
                data => data.replace('<', "\\u003c"),
                chart_licence => CHART_LICENCE,
                chart_library => CHART_LIBRARY,
                script => SCRIPT.join("\n"),
            },
        );
        let refuse = |found: String| Error::Setting { field: "report", found, expected: "a template".into() };
        let page = rendered.map_err(|error| refuse(error.to_string()))?;
        write_file(&folder.join(PAGE), page.as_bytes())
    }
}
