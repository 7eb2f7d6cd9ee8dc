use std::io::{self, Write};

use freeform_experiments::paper::Table;
use freeform_motion::outline_io::readable;

/// Columns as wide as their widest entry: those listed in `text_columns` to the left, numbers to the right. Columns that no row
/// has are left out.
pub(crate) fn write_aligned(
    sink: &mut impl Write,
    heads: &[&str],
    rows: &[Vec<String>],
    text_columns: &[usize],
) -> io::Result<()> {
    let count = rows.first().map_or(heads.len(), Vec::len);
    let heads = heads.iter().take(count).map(|&head| head.to_owned()).collect();
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| readable(cell).to_string()).collect()).collect();
    sink.write_all(aligned(&heads, &rows, "   ", |column| text_columns.contains(&column)).as_bytes())
}

/// A table of the experiments.
pub(crate) fn table_text(table: &Table) -> String {
    aligned(&table.heads, &table.rows, "  ", |column| table.is_of_names(column))
}

/// Heads and rows line by line, the columns apart by a gap.
fn aligned(heads: &Vec<String>, rows: &[Vec<String>], gap: &str, is_text: impl Fn(usize) -> bool) -> String {
    let all = || std::iter::once(heads).chain(rows);
    let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let mut text = String::new();
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            text.push_str(if column == 0 { "  " } else { gap });
            text.push_str(&if is_text(column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") });
        }
        text.trim_end().to_owned() + "\n"
    };
    all().map(line).collect()
}
