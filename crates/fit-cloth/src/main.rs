//! The program `fit-cloth`.

use std::process::ExitCode;

fn main() -> ExitCode {
    fit_cloth::main()
}
