//! The commands, one file each.

pub mod check;
pub mod compare;
pub mod curve;
pub mod fit;
pub mod goal;
pub mod import;
mod journal;
mod kinds;
pub mod report;
pub mod rig;
pub mod simulate;
pub mod study;
pub mod validate;

use crate::cli::{Command, Options};
use crate::failure::Failure;
use crate::outcome::Outcome;
use goal::Goal;
use std::io::Write;

/// Carries out a command and writes its result to `output`.
///
/// # Errors
/// What stopped it.
pub fn run(options: &Options, output: &mut impl Write) -> Result<Outcome, Failure> {
    match &options.command {
        Command::Import(import) => import::run(import, options.telling, output),
        Command::Rig(rig) => rig::run(rig, options.telling, output),
        Command::Stretch(flags) => fit::run(Goal::Stretch, flags, options.telling, output),
        Command::Shear(flags) => fit::run(Goal::Shear, flags, options.telling, output),
        Command::Bend(flags) => fit::run(Goal::Bend, flags, options.telling, output),
        Command::Fit(flags) => fit::run(Goal::All, flags, options.telling, output),
        Command::Check(check) => check::run(check, options.telling, output),
        Command::Curve(curve) => curve::run(curve, options.telling, output),
        Command::Compare(compare) => compare::run(compare, options.telling, output),
        Command::Simulate(simulate) => simulate::run(simulate, options.telling, output),
        Command::Report(report) => report::run(report, options.telling, output),
        Command::Study(study) => study::run(study, options.telling, output),
        Command::Validate(validate) => validate::run(validate, options.telling, output),
    }
}
