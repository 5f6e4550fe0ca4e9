//! The command line: every command with its arguments, dispatched to its module.

use crate::command::check::{self, CheckOptions};
use crate::command::compare::{self, CompareOptions};
use crate::command::curve::{self, Curve};
use crate::command::fit;
use crate::command::goal::{self, Goal};
use crate::command::import::{self, Import};
use crate::command::report::{self, ReportOptions};
use crate::command::rig::{self, RigOptions};
use crate::command::simulate::{self, SimulateOptions};
use crate::command::study::{self, StudyOptions};
use crate::command::validate::{self, ValidateOptions};
use crate::failure::Failure;
use crate::options::FitFlags;
use crate::outcome::Outcome;
use crate::printing::Printing;
use clap::{Parser, Subcommand};
use std::io::Write;

/// Fits stress-strain curves of cloth to measurements and writes them for simulators.
#[derive(Debug, Clone, Parser)]
#[command(name = "fit-cloth", version, arg_required_else_help = true)]
pub struct Options {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
    /// Output flags.
    #[command(flatten)]
    pub printing: Printing,
}

/// The commands.
#[derive(Debug, Clone, Subcommand)]
#[expect(clippy::large_enum_variant, reason = "one instance per run")]
pub enum Command {
    /// Import a laboratory's table into a measurement set, or convert it into a curve
    Import(Import),
    /// Measure a known fabric on a virtual rig and write a measurement set
    Rig(RigOptions),
    /// Fit the stretch curves along weft and warp
    #[command(after_help = goal::STRETCH_EXAMPLE)]
    Stretch(FitFlags),
    /// Fit the shear curve, after the stretch curves that it depends on
    #[command(after_help = goal::SHEAR_EXAMPLE)]
    Shear(FitFlags),
    /// Fit the bending curves, after the stretch and shear curves that they depend on
    #[command(after_help = goal::BEND_EXAMPLE)]
    Bend(FitFlags),
    /// Fit every curve that a set observes
    #[command(after_help = goal::FIT_EXAMPLE)]
    Fit(FitFlags),
    /// Fit all models in four variants and rank them
    Compare(CompareOptions),
    /// Test fitted curves on motions and samples that the fit did not use
    Validate(ValidateOptions),
    /// Check curves for simulation and repair unsound ones
    Check(CheckOptions),
    /// Scale or extend a curve
    Curve(Curve),
    /// Simulate a scene with a material, in motion or at rest
    Simulate(SimulateOptions),
    /// Measure error against run time, and what each part of a scene saves and costs
    Study(StudyOptions),
    /// Rewrite the report page of a fit or a comparison
    Report(ReportOptions),
}

/// Runs a command and writes its result to `output`.
///
/// # Errors
/// The error that stopped the command.
pub fn run(options: &Options, output: &mut impl Write) -> Result<Outcome, Failure> {
    match &options.command {
        Command::Import(import) => import::run(import, options.printing, output),
        Command::Rig(rig) => rig::run(rig, options.printing, output),
        Command::Stretch(flags) => fit::run(Goal::Stretch, flags, options.printing, output),
        Command::Shear(flags) => fit::run(Goal::Shear, flags, options.printing, output),
        Command::Bend(flags) => fit::run(Goal::Bend, flags, options.printing, output),
        Command::Fit(flags) => fit::run(Goal::All, flags, options.printing, output),
        Command::Check(check) => check::run(check, options.printing, output),
        Command::Curve(curve) => curve::run(curve, options.printing, output),
        Command::Compare(compare) => compare::run(compare, options.printing, output),
        Command::Simulate(simulate) => simulate::run(simulate, options.printing, output),
        Command::Report(report) => report::run(report, options.printing, output),
        Command::Study(study) => study::run(study, options.printing, output),
        Command::Validate(validate) => validate::run(validate, options.printing, output),
    }
}
