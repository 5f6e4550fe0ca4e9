//! Number parsing: finite, with a decimal point and an ASCII sign; errors name the reason.

/// Parses a finite number.
///
/// # Errors
/// The expected form.
pub fn number(text: &str) -> Result<f64, &'static str> {
    if text.contains('\u{2212}') {
        return Err("a number with the ASCII minus sign (-), not the Unicode one");
    }
    if text.contains(',') {
        return Err("a number with a decimal point, not a comma");
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) if text.contains(|c: char| c.is_ascii_digit()) => Err("a number below 1.8e308"),
        Ok(_) => Err("a finite number"),
        Err(_) => Err("a number"),
    }
}

/// Checks that a length is positive and at most `most` metres.
///
/// # Errors
/// The expected range, and the unit that a longer value may be in.
pub fn check_length(value: f64, most: f64) -> Result<(), String> {
    let unit = match value > most && value.is_finite() {
        // A small limit is that of a thickness, which is not given in centimetres.
        true if most < 1.0 => " (millimetres?)",
        true => " (millimetres or centimetres?)",
        false => "",
    };
    if value > 0.0 && value <= most {
        Ok(())
    } else {
        Err(format!("a length above 0 and at most {most} m{unit}"))
    }
}

/// Parses a finite number, or `nan` for an unobserved value.
///
/// # Errors
/// The expected form.
pub(super) fn number_or_unseen(text: &str) -> Result<f64, &'static str> {
    // NaN printed with its sign bit may have a sign.
    if text.trim_start_matches(['+', '-']).eq_ignore_ascii_case("nan") { Ok(f64::NAN) } else { number(text) }
}
