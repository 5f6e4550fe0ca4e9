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
