//! The `fit-cloth` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    fit_cloth::main()
}
