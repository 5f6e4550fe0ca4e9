//! The arguments of the program, and the flags that its commands share.

use crate::command::import::Import;
use clap::{Args, Parser, Subcommand};

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
pub enum Command {
    /// Turn a laboratory's table into a sequence of a measurement set
    Import(Import),
}

/// How results are told; every command has these flags.
#[derive(Debug, Clone, Copy, Default, Args)]
#[command(next_help_heading = "Output")]
pub struct Telling {
    /// Print the result as one JSON object
    #[arg(long, global = true)]
    pub json: bool,
    /// Print nothing but errors, and what --json asks for
    #[arg(short, long, global = true)]
    pub quiet: bool,
}
