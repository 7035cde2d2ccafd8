//! Formatting of numbers.

/// Formats a number with four significant digits, without trailing zeros.
pub(crate) fn digits(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return format!("{number}");
    }
    let size = number.abs().log10().floor() as i32;
    if !(-4..6).contains(&size) {
        return format!("{number:.2e}");
    }
    let text = format!("{number:.*}", (3 - size).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let texts = [0.0, 1.0, 0.123_456, 12_345.6, 1e-7, -0.000_123_456, 3.0e9].map(digits);
        assert_eq!(texts, ["0", "1", "0.1235", "12346", "1.00e-7", "-0.0001235", "3.00e9"]);
    }
}
