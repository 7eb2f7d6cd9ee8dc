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

/// A time in seconds to a tenth of a millisecond, or with four significant digits where these say more.
pub(crate) fn of_time(seconds: f64) -> String {
    without_zeros(if seconds.abs() < 1.0 { significant(seconds, 4) } else { format!("{seconds:.4}") })
}

/// A number without zeros at its end.
fn without_zeros(text: String) -> String {
    text.parse::<f64>().map_or(text, |rounded| rounded.to_string())
}

/// Most digits of a value with a standard deviation.
const MOST_DIGITS: i32 = 8;

/// A value to the place of the second digit of its standard deviation, and the standard deviation with two digits. The value has six digits
/// where the standard deviation tells no place.
///
/// ```
/// use freeform_motion::with_deviation;
///
/// assert_eq!(with_deviation(1.2345678, 0.00012), ["1.23457", "0.00012"]);
/// ```
#[must_use]
pub fn with_deviation(value: f64, deviation: f64) -> [String; 2] {
    let exponent = |number: f64| number.abs().log10().floor() as i32;
    let is_proper = deviation.is_finite() && deviation > 0.0 && value != 0.0;
    let digits = if is_proper { (exponent(value) - exponent(deviation) + 2).clamp(1, MOST_DIGITS) as usize } else { 6 };
    [significant(value, digits), significant(deviation, 2)]
}

/// A number with at most six significant digits and no zeros at its end.
///
/// ```
/// assert_eq!(freeform_motion::short(0.2 / 3.0), "0.0666667");
/// ```
#[must_use]
pub fn short(value: f64) -> String {
    without_zeros(significant(value, 6))
}

#[cfg(test)]
mod tests {
    use super::{of_time, short, significant, with_deviation};

    #[test]
    fn times_tell_frames_apart_however_late_they_are() {
        let times = [1.733_333_3, 1234.6, 1_764_249_600.233_3, 0.033_333, 3.25e-8, 0.0, -12.5];
        let written = ["1.7333", "1234.6", "1764249600.2333", "0.03333", "0.0000000325", "0", "-12.5"];
        assert_eq!(times.map(of_time), written);
    }

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

    #[test]
    fn a_value_has_the_places_of_its_deviation() {
        for (value, deviation, texts) in [
            (1.234_567_8, 0.000_12, ["1.23457", "0.00012"]),
            (-0.003_735_14, 0.026, ["-0.004", "0.026"]),
            (57.9165, 6.3, ["57.9", "6.3"]),
            (12_345.678, 250.0, ["12346", "250"]),
            (3.0, 1e-12, ["3.0000000", "1.0e-12"]),
            (2.5, 0.0, ["2.50000", "0"]),
            (0.0, 0.1, ["0", "0.10"]),
        ] {
            assert_eq!(with_deviation(value, deviation), texts);
        }
    }

    #[test]
    fn a_short_number_has_no_zeros_at_its_end() {
        assert_eq!([0.2 / 3.0, 5.0, 0.0, 120.25].map(short), ["0.0666667", "5", "0", "120.25"]);
    }
}
