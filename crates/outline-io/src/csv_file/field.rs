//! Numbers and names in the fields of a row.
use crate::error::ReadErrorKind;

/// Largest absolute coordinate and time accepted, the limit of `freeform_curve_fit::Outline`; checked here already so
/// that the message can name the line.
pub(crate) const NUMBER_LIMIT: f64 = 1e100;

/// Longest piece of a field quoted in a message, in characters.
const QUOTED_CHARACTERS: usize = 40;

/// A finite number of bounded size.
pub(crate) fn number(field: &[u8]) -> Result<f64, ReadErrorKind> {
    // Most fields are a number and nothing else.
    let plain = std::str::from_utf8(field).ok().and_then(|text| text.parse::<f64>().ok());
    if let Some(value) = plain.filter(|value| value.abs() <= NUMBER_LIMIT) {
        return Ok(value);
    }
    let text = text(field)?;
    if text.is_empty() {
        return Err(ReadErrorKind::EmptyField);
    }
    let Ok(value) = text.parse::<f64>() else {
        return Err(ReadErrorKind::NotANumber { text: quoted_start(field) });
    };
    if !value.is_finite() {
        return Err(ReadErrorKind::NotFinite { text: quoted_start(field) });
    }
    if value.abs() > NUMBER_LIMIT {
        return Err(ReadErrorKind::TooLarge { value, limit: NUMBER_LIMIT });
    }
    Ok(value)
}

/// A time in seconds.
pub(crate) fn seconds(field: &[u8]) -> Result<f64, ReadErrorKind> {
    number(field).map_err(|kind| match kind {
        ReadErrorKind::NotANumber { text } if is_clock_or_date(&text) => ReadErrorKind::NotSeconds { text },
        other => other,
    })
}

/// Whether a text is like `10:00:01.5`, `2024-05-01` or `5.1.2024 10:00`: two numbers with a colon between, or three with hyphens, slashes or points.
fn is_clock_or_date(text: &str) -> bool {
    const MARKS: [char; 3] = ['-', '/', '.'];
    let of_digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let end = text.find(|character: char| !character.is_ascii_digit() && !MARKS.contains(&character));
    let date = &text[..end.unwrap_or(text.len())];
    // Three digits are of thousands.
    let is_of_date = |part: &str| of_digits(part) && matches!(part.len(), 1 | 2 | 4);
    let is_date = MARKS.iter().any(|mark| date.split(*mark).count() == 3 && date.split(*mark).all(is_of_date));
    is_date || text.split(':').take(2).filter(|part| of_digits(part)).count() == 2
}

/// A standard deviation: a positive number, or none where nothing stands.
pub(crate) fn deviation(field: &[u8]) -> Result<Option<f64>, ReadErrorKind> {
    if field.trim_ascii().is_empty() {
        return Ok(None);
    }
    positive(number(field)?).map(Some)
}

/// A standard deviation that is a number already.
pub(crate) fn positive(value: f64) -> Result<f64, ReadErrorKind> {
    if value > 0.0 { Ok(value) } else { Err(ReadErrorKind::NotPositive { value }) }
}

/// Powers of ten that a float holds exactly, up to as many digits as it holds of any number.
const POWERS_OF_TEN: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number that a row or its rest begins with, as [`number`] reads it, and the length of its field; `None` where
/// that is none, is quoted or is not seen to end.
pub(crate) fn leading_number(text: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(text.first() == Some(&b'-'));
    let (mut digits, mut point, mut end) = (0_u64, None, None);
    for (at, &byte) in text.iter().enumerate().skip(sign) {
        match byte {
            b'0'..=b'9' => digits = digits.wrapping_mul(10).wrapping_add(u64::from(byte - b'0')),
            b'.' if point.is_none() => point = Some(at),
            _ => {
                end = Some(at).filter(|_| matches!(byte, b',' | b'\n'));
                break;
            }
        }
    }
    let decimals = end.map(|end| point.map_or(0, |point| end - point - 1));
    let count = end.map(|end| end - sign - usize::from(point.is_some()));
    match (end, count, decimals) {
        // Two exact floats: their quotient is the float nearest to the number (W. D. Clinger, 1990).
        (Some(end), Some(1..=15), Some(decimals)) => {
            let size = digits as f64 / POWERS_OF_TEN[decimals];
            Some((if sign == 1 { -size } else { size }, end))
        }
        _ => {
            let length = unquoted_length(text)?;
            number(&text[..length]).ok().map(|value| (value, length))
        }
    }
}

/// Length of the field that a row or its rest begins with; `None` where it has quotes or is not seen to end.
pub(crate) fn unquoted_length(text: &[u8]) -> Option<usize> {
    let length = text.iter().position(|byte| matches!(byte, b',' | b'\n' | b'"'))?;
    (text[length] != b'"').then_some(length)
}

/// Largest whole number up to which a float holds every one.
const LARGEST_WHOLE_FLOAT: f64 = 9_007_199_254_740_992.0;

/// A whole number from 0, which may be written as a float, as `numpy.savetxt` writes all numbers.
pub(crate) fn frame_number(field: &[u8]) -> Result<u64, ReadErrorKind> {
    let text = text(field)?;
    if text.is_empty() {
        return Err(ReadErrorKind::EmptyField);
    }
    let is_whole = |value: &f64| (0.0..=LARGEST_WHOLE_FLOAT).contains(value) && value.fract() == 0.0;
    let written_as_float = || text.parse::<f64>().ok().filter(is_whole).map(|value| value as u64);
    let number = text.parse().ok().or_else(written_as_float);
    number.ok_or_else(|| ReadErrorKind::NotAFrameNumber { text: quoted_start(field) })
}

/// The field without white space at its ends.
pub(crate) fn text(field: &[u8]) -> Result<&str, ReadErrorKind> {
    std::str::from_utf8(field.trim_ascii()).map_err(|_| ReadErrorKind::NotUtf8 { text: quoted_start(field) })
}

/// The beginning of a field for a message, marked with `...` where cut.
pub(crate) fn quoted_start(field: &[u8]) -> String {
    // Four bytes hold any character, so this much is enough whatever the length of the field.
    let start = &field[..field.len().min(4 * QUOTED_CHARACTERS + 4)];
    let text = String::from_utf8_lossy(start);
    let text = text.trim();
    match text.char_indices().nth(QUOTED_CHARACTERS) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_may_have_white_space_and_any_usual_form() {
        for (field, value) in [("1", 1.0), (" -2.5\r", -2.5), ("1e-3", 1e-3), (".5", 0.5), ("+4.", 4.0), ("-0", 0.0)] {
            assert_eq!(number(field.as_bytes()).expect("a number"), value);
        }
    }

    proptest! {
        #[test]
        fn a_leading_number_is_the_number_of_its_field(field in "-?[0-9]{0,20}(\\.[0-9]{0,20})?", end in "[,\n][0-9.]{0,3}") {
            let expected = number(field.as_bytes()).ok().map(|value| (value.to_bits(), field.len()));
            let found = leading_number(format!("{field}{end}").as_bytes());
            prop_assert_eq!(found.map(|(value, length)| (value.to_bits(), length)), expected);
        }
    }

    #[test]
    fn a_leading_number_is_left_where_its_field_is_quoted_or_not_seen_to_end() {
        for text in ["1.5", "1", "", "-", "1\"", "\"1\",", "x,", "1e400,", "-,", ".\n", " "] {
            assert_eq!(leading_number(text.as_bytes()), None, "{text:?}");
        }
        assert_eq!(leading_number(b" 1e2\r\n"), Some((100.0, 5)));
    }

    #[test]
    fn the_largest_number_accepted_is_also_accepted_by_an_outline() {
        use freeform_curve_fit::Outline;
        use nalgebra::Point2;
        let corner = number(b"1e100").expect("at the limit");
        let points = vec![Point2::origin(), Point2::new(corner, 0.0), Point2::new(0.0, corner)];
        assert!(Outline::closed(points).is_ok());
        assert!(number(b"1.0000001e100").is_err());
    }

    #[test]
    fn dates_and_times_of_day_are_told_from_what_is_no_number_otherwise() {
        let is_told = |text: &str| matches!(seconds(text.as_bytes()), Err(ReadErrorKind::NotSeconds { .. }));
        for text in ["5.1.2024 10:00", "05.01.24", "5/1/2024", "2024-05-01T10:00:00Z", "2024-05-01_10:00", "10:00:01.5"]
        {
            assert!(is_told(text), "{text}");
        }
        for text in ["1.2.3.4", "1.234.567", "1-2", "..", "a:b", "x5.1.2024", "1.5 s"] {
            assert!(!is_told(text), "{text}");
        }
    }

    #[test]
    fn a_long_field_is_quoted_by_its_beginning() {
        assert_eq!(quoted_start(b"  abc "), "abc");
        assert_eq!(quoted_start("\u{e4}".repeat(1000).as_bytes()), format!("{}...", "\u{e4}".repeat(40)));
        assert_eq!(quoted_start(&[b'x'; 40]), "x".repeat(40));
    }
}
