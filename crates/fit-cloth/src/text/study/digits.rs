//! Numbers in the tables of a study.

/// A share in per cent with three digits, or a dash.
pub(super) fn percent(share: Option<f64>) -> String {
    share.map_or("-".into(), |share| match share {
        // Beyond 1000 % the exact value does not matter.
        share if share > 10.0 => "> 1000 %".into(),
        share => format!("{} %", digits(100.0 * share)),
    })
}

/// A number with three digits, or a dash.
pub(super) fn short(value: Option<f64>) -> String {
    value.map_or("-".into(), digits)
}

/// A number with three digits.
pub(super) fn digits(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 1e-3 => format!("{value:.1e}"),
        size => {
            let after = (2.0 - size.log10().floor()).clamp(0.0, 5.0) as usize;
            format!("{value:.after$}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let pairs = [(0.0, "0"), (123.4, "123"), (1.5, "1.50"), (0.0123, "0.0123"), (2e-7, "2.0e-7")];
        pairs.iter().for_each(|(value, text)| assert_eq!(digits(*value), *text));
    }
}
