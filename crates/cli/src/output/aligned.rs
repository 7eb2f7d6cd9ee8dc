use std::io::{self, Write};

/// Columns as wide as their widest entry: those listed in `text_columns` to the left, numbers to the right. Columns that no row
/// has are left out.
pub(crate) fn write_aligned(
    sink: &mut impl Write,
    heads: &[&str],
    rows: &[Vec<String>],
    text_columns: &[usize],
) -> io::Result<()> {
    let count = rows.first().map_or(heads.len(), Vec::len);
    let cells = |column: usize| rows.iter().map(move |row| row[column].chars().count());
    let widths: Vec<usize> = (0..count).map(|c| cells(c).chain([heads[c].len()]).max().unwrap_or(0)).collect();
    let mut line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut text = String::new();
        for (column, (cell, &width)) in cells.zip(&widths).enumerate() {
            let gap = if column == 0 { "  " } else { "   " };
            let is_text = text_columns.contains(&column);
            text.push_str(&if is_text { format!("{gap}{cell:<width$}") } else { format!("{gap}{cell:>width$}") });
        }
        writeln!(sink, "{}", text.trim_end())
    };
    line(&mut heads.iter().take(count).copied())?;
    rows.iter().try_for_each(|row| line(&mut row.iter().map(String::as_str)))
}
