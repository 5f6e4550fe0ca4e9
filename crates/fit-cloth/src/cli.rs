//! The command line: all commands and their arguments.

use crate::command::check::CheckOptions;
use crate::command::compare::CompareOptions;
use crate::command::curve::Curve;
use crate::command::goal;
use crate::command::import::Import;
use crate::command::report::ReportOptions;
use crate::command::rig::RigOptions;
use crate::command::simulate::SimulateOptions;
use crate::command::study::StudyOptions;
use crate::command::validate::ValidateOptions;
use crate::options::FitFlags;
use crate::telling::Telling;
use clap::{Parser, Subcommand};

/// Fits stress-strain curves of cloth to measurements and writes them for simulators.
#[derive(Debug, Clone, Parser)]
#[command(name = "fit-cloth", version, arg_required_else_help = true)]
pub struct Options {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How to tell of it.
    #[command(flatten)]
    pub telling: Telling,
}

/// What to do.
#[derive(Debug, Clone, Subcommand)]
#[expect(clippy::large_enum_variant, reason = "there is one of them in a run")]
pub enum Command {
    /// Turn a laboratory's table into a sequence of a measurement set, or into a curve
    Import(Import),
    /// Measure a known cloth on a virtual rig: a measurement set to try a fit on
    Rig(RigOptions),
    /// Fit weft and warp stretch curves
    #[command(after_help = goal::STRETCH_EXAMPLE)]
    Stretch(FitFlags),
    /// Fit the shear curve, after the stretch curves that it builds on
    #[command(after_help = goal::SHEAR_EXAMPLE)]
    Shear(FitFlags),
    /// Fit the bending curves, after the stretch and shear curves that they build on
    #[command(after_help = goal::BEND_EXAMPLE)]
    Bend(FitFlags),
    /// Fit all curves that a set shows
    #[command(after_help = goal::FIT_EXAMPLE)]
    Fit(FitFlags),
    /// Fit three models in four variants, and rank them
    Compare(CompareOptions),
    /// Try fitted curves on motions and samples that the fit did not see
    Validate(ValidateOptions),
    /// Check that curves can be simulated, and repair those that cannot
    Check(CheckOptions),
    /// Edit a curve: make it wider, stronger, longer
    Curve(Curve),
    /// Simulate a scene of a material: hang it, drape it, fly it
    Simulate(SimulateOptions),
    /// Study error against run time, and what each part of a scene saves and costs
    Study(StudyOptions),
    /// Write the page of a fit or a comparison again
    Report(ReportOptions),
}
