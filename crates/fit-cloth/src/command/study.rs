//! `fit-cloth study`: error against run time, and the savings and costs of each optional part of a scene.

use crate::failure::Failure;
use crate::options::{SetFlags, TopicChoice, use_threads};
use crate::outcome::Outcome;
use crate::output::Output;
use crate::plot::write_study_plots;
use crate::printing::{Printing, print_result};
use crate::progress::Progress;
use crate::text;
use clap::Args;
use cloth_data::store::write_file;
use cloth_fit::result::check_output;
use cloth_study::extent::Extent;
use cloth_study::study::{self, Study};
use cloth_study::subject::Subject;
use cloth_study::table::{ablation_csv, study_csv, study_json};
use std::io::Write;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = "\
Example:
  fit-cloth study --quick --topics noise,ablation fixtures/cotton-denim --out out/study

With all topics, --quick takes about a minute and the full study about ten.

Writes study.md, study.csv (one row per run), ablation.csv (one row per part) and plots/*.svg. Errors are relative to the
known curves if the set's fabric is one of the virtual rig's, else to the default fit on the finest grid. Runs are timed one
at a time on this machine: leave it idle otherwise.";

/// `fit-cloth study`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct StudyOptions {
    /// Folder of the measurement set [default: cotton denim, measured on the virtual rig]
    pub set: Option<PathBuf>,
    /// Output folder; a previous study there is replaced [default: out/ and the set's name with -study]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Use coarser meshes and fewer runs
    #[arg(long)]
    pub quick: bool,
    /// Use the published method on every grid, not only on the coarsest: at least ten times as long
    #[arg(long)]
    pub as_published: bool,
    /// Topics to study [default: all]
    #[arg(long, value_delimiter = ',', value_enum, hide_default_value = true, default_values_t = TopicChoice::ALL)]
    pub topics: Vec<TopicChoice>,
    /// Number of threads, 1 to 1024 [default: one per core]
    #[arg(long)]
    pub threads: Option<usize>,
}

/// Runs a study. A run that fails is recorded in its row and does not stop the study.
///
/// # Errors
/// Bad input; an output folder that is not a previous result; I/O errors.
pub fn run(options: &StudyOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let extent = if options.quick { Extent::quick() } else { Extent::full() };
    let published_nodes = match options.as_published {
        true => extent.fit_nodes.clone(),
        false => extent.published_nodes,
    };
    let topics = options.topics.iter().map(|topic| (*topic).into()).collect();
    let extent = Extent { topics, published_nodes, ..extent };
    let progress = Progress::new("study", !printing.quiet);
    let (subject, out) = options.subject(&extent)?;
    let study = study::run(&subject, &extent, &progress);
    progress.finish();
    let study = study?;
    out.replace(|temporary| {
        write(temporary, &study)?;
        write_study_plots(temporary, &study)
    })?;
    let text = format!("{}\nWritten to {}", text::study(&study), out.path().display());
    print_result(printing, output, &text, &study_json(&study))?;
    Ok(Outcome::Done)
}

impl StudyOptions {
    /// The subject of the study and the claimed output folder.
    fn subject(&self, extent: &Extent) -> Result<(Subject, Output), Failure> {
        if let Some(set) = &self.set {
            let flags =
                SetFlags { set: set.clone(), out: self.out.clone(), nodes: None, threads: self.threads };
            let (set, out) = flags.open("-study")?;
            return Ok((Subject::of_set(set)?, out));
        }
        let folder = self.out.clone().unwrap_or_else(|| PathBuf::from("out/study"));
        use_threads(self.threads)?;
        check_output(&folder, "--out")?;
        let out = Output::claim(&folder)?;
        Ok((Subject::built_in(extent)?, out))
    }
}

fn write(folder: &Path, study: &Study) -> cloth_data::error::Result<()> {
    write_file(&folder.join("study.csv"), study_csv(study).as_bytes())?;
    write_file(&folder.join("ablation.csv"), ablation_csv(study).as_bytes())?;
    write_file(&folder.join("study.md"), text::study_page(study).as_bytes())
}
