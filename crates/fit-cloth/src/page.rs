//! The page of a fit or a comparison, `report.html`: a single file that needs no network.
//!
//! Its data is `report.json`; a template combines data, style and script.

mod curves;
mod fit;
mod sequences;

pub use fit::Fit;
pub use sequences::Frames;

use crate::text::Ranking;
use cloth_data::error::{Error, Result};
use cloth_data::io::read_json;
use cloth_data::io::schema::Schema;
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

/// Schema version of `report.json`.
const SCHEMA: Schema = Schema::new("report", &[]);

/// File names of the page and its data.
const PAGE: &str = "report.html";
const DATA: &str = "report.json";

/// Content of a page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Page {
    schema: String,
    program: String,
    fabric: String,
    /// One fit per model, or per model and variant.
    fits: Vec<Fit>,
    /// Ranking of the fits, if they were compared.
    ranking: Option<Ranking>,
}

impl Page {
    /// A page for fits of one fabric.
    pub fn new(fabric: &str, fits: Vec<Fit>, ranking: Option<Ranking>) -> Self {
        let program = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
        Self { schema: SCHEMA.id(), program, fabric: fabric.into(), fits, ranking }
    }

    /// Reads the data in a result folder.
    ///
    /// # Errors
    /// A missing or invalid file, with line and key.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(DATA);
        if !path.is_file() {
            let found = if folder.is_file() { "a file instead of a folder" } else { "nothing" };
            let expected = "a result folder of fit, stretch, shear, bend or compare, without --no-report; for --model all, the folder above the models' folders";
            return Err(Error::input(folder, None, DATA, found, expected));
        }
        let page: Self = read_json(&path, &SCHEMA)?;
        if page.fits.is_empty() {
            return Err(Error::input(&path, None, "fits", "none", "at least one"));
        }
        Ok(page)
    }

    /// Writes data and page into an existing folder.
    ///
    /// # Errors
    /// I/O errors.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let data = self.data();
        write_file(&folder.join(DATA), data.as_bytes())?;
        self.write_html(folder, &data)
    }

    /// Rewrites the page only and returns its path.
    ///
    /// # Errors
    /// A link at the page's path; I/O errors.
    pub fn write_again(&self, folder: &Path) -> Result<PathBuf> {
        let page = folder.join(PAGE);
        refuse_link(&page)?;
        self.write_html(folder, &self.data())?;
        Ok(page)
    }

    /// Text of `report.json`.
    fn data(&self) -> String {
        // Strings and finite numbers always serialise.
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
                // No tag in the data may close the script element around it.
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
