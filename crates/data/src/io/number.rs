//! Numbers as text: finite, with a decimal point and an ASCII sign, or refused with the reason.

/// Reads a finite number.
///
/// # Errors
/// What was expected, if the text is not one.
pub(super) fn number(text: &str) -> Result<f64, &'static str> {
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

/// Refuses a length that is not above 0 and at most so many metres.
///
/// # Errors
/// What was expected; the unit that a longer one may be in.
pub fn check_length(value: f64, most: f64) -> Result<(), String> {
    let unit = match value > most && value.is_finite() {
        // Nothing is as thick in centimetres as a sheet is wide in metres.
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

/// Reads a finite number, or `nan` for what was not observed.
///
/// # Errors
/// What was expected, if the text is neither.
pub(super) fn number_or_unseen(text: &str) -> Result<f64, &'static str> {
    // Printed with its sign bit a nan may have a sign.
    if text.trim_start_matches(['+', '-']).eq_ignore_ascii_case("nan") { Ok(f64::NAN) } else { number(text) }
}
