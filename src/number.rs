/// A number with the given count of significant digits, for messages; in plain notation if that is short.
///
/// ```
/// use freeform_motion::significant;
///
/// assert_eq!(significant(1.23456, 4), "1.235");
/// assert_eq!(significant(1.234e-9, 3), "1.23e-9");
/// ```
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if !(-5..=6).contains(&exponent) {
        return rounded;
    }
    let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn numbers_keep_their_significant_digits() {
        for (value, digits, text) in [
            (1.23456, 4, "1.235"),
            (-0.3, 3, "-0.300"),
            (0.000_012_34, 2, "0.000012"),
            (1.234e-9, 3, "1.23e-9"),
            (123_456.0, 3, "123456"),
            (9.9996, 3, "10.0"),
            (0.0, 4, "0"),
            (4.2e100, 2, "4.2e100"),
        ] {
            assert_eq!(significant(value, digits), text);
        }
    }
}
