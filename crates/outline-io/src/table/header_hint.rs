//! What may be wrong with a header that lacks columns.
use crate::table::column::Column;

/// What may be wrong with a header: its letters, what separates its names, that there is none, or that the time has another name.
pub(crate) fn header_hint(missing: &[Column], header: &str) -> &'static str {
    let is_there = |column: &Column| header.split(',').any(|name| name.trim().eq_ignore_ascii_case(column.name()));
    if missing.iter().any(is_there) {
        return "; names of columns are in lower case";
    }
    let separator = separator_hint(header);
    match missing {
        _ if !separator.is_empty() => separator,
        _ if begins_with_number(header) => {
            "; that is a row of numbers: add a line before it that names the columns, without # (numpy.savetxt: comments='')"
        }
        [Column::Time] => "; give the time of each frame in seconds in a column named time",
        _ => "",
    }
}

/// Whether a header is none, but a row of numbers.
fn begins_with_number(header: &str) -> bool {
    let first = header.split(',').next().unwrap_or_default();
    first.trim().parse::<f64>().is_ok()
}

/// What to say of a header that lacks columns since something else than commas separates them.
fn separator_hint(header: &str) -> &'static str {
    match header {
        _ if header.contains(',') => "",
        _ if header.contains(';') => ": columns are separated by commas, not by semicolons",
        _ if header.contains('\t') => ": columns are separated by commas, not by tabs",
        _ if header.trim().contains(' ') => ": columns are separated by commas, not by spaces",
        _ => "",
    }
}
