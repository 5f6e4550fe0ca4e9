//! A notice, with the options that would settle it.

use cloth_data::notice::{Notice, Remedy};

/// The notice in one sentence, and the options in brackets.
pub fn notice(notice: &Notice) -> String {
    let options: Vec<String> = notice.remedies.iter().map(option).collect();
    match &options[..] {
        [] => notice.to_string(),
        options => format!("{notice} ({})", options.join(", or ")),
    }
}

fn option(remedy: &Remedy) -> String {
    match remedy {
        Remedy::Zero(force) => format!("import strip --replace --zero {force}"),
        Remedy::FreeLength(length) => format!("import strip --replace --free-length-m {length:.5}"),
        Remedy::Robust => "fit with --robust".into(),
    }
}
