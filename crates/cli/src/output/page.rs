use std::fmt::Write as _;
use std::path::Path;

use freeform_experiments::paper::{Drawing, Section, Table};

use super::file::WholeFile;
use super::html::{document, write_settings};
use crate::failure::Failure;
use crate::plot::{Svg, escape};

/// Least size of a figure on a narrow page, as a share of that of its file; beyond that it is scrolled.
const SMALLEST: f64 = 0.75;

/// A page of figures and tables that needs nothing but itself.
pub(crate) fn write_page(
    title: &str,
    introduction: &str,
    sections: &[Section],
    settings: &[(&'static str, String)],
    command: &str,
) -> String {
    let mut body = format!("<h1>{}</h1>\n<p class=\"soft\">{}</p>\n<ul>\n", escape(title), escape(introduction));
    for (index, Section { heading, .. }) in sections.iter().enumerate() {
        let _ = writeln!(body, "<li><a href=\"#part{index}\">{}</a></li>", escape(heading));
    }
    body.push_str("</ul>\n");
    for (index, section) in sections.iter().enumerate() {
        let _ = writeln!(body, "<h2 id=\"part{index}\">{}</h2>", escape(&section.heading));
        if !section.text.is_empty() {
            let _ = writeln!(body, "<p>{}</p>", escape(&section.text));
        }
        section.drawings.iter().for_each(|drawing| write_drawing(&mut body, drawing));
        section.tables.iter().for_each(|table| write_table(&mut body, table));
    }
    write_settings(&mut body, settings, command);
    document(&escape(title), &body)
}

fn write_drawing(body: &mut String, drawing: &Drawing) {
    let Drawing { name, caption, figure, .. } = drawing;
    // No larger than as a file, and where there is no room for it not so small that its text cannot be read.
    let [width, _] = Svg(figure).size();
    let least = (SMALLEST * width).round();
    let (caption, element) = (escape(caption), Svg(figure).element());
    let _ = writeln!(
        body,
        "<figure style=\"max-width:{width}px\">\n<div class=\"scroll\"><div style=\"min-width:{least}px\">{element}</div></div>\n\
         <figcaption>{caption} \
         <span class=\"soft\">{name}.svg, {name}.csv</span></figcaption>\n</figure>"
    );
}

fn write_table(body: &mut String, table: &Table) {
    let (title, caption) = (escape(&table.title), escape(&table.caption));
    let _ = writeln!(body, "<h3>{title}</h3>\n<p>{caption} <span class=\"soft\">{}.csv</span></p>", table.name);
    body.push_str("<div class=\"scroll\"><table class=\"numbers\">\n");
    for (tag, row) in std::iter::once(("th", &table.heads)).chain(table.rows.iter().map(|row| ("td", row))) {
        let cells = row.iter().enumerate().map(|(column, cell)| {
            let class = if table.is_of_names(column) { " class=\"name\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", escape(cell))
        });
        let _ = writeln!(body, "<tr>{}</tr>", cells.collect::<String>());
    }
    body.push_str("</table></div>\n");
}

/// Writes the figures of a section and the numbers behind its figures and tables into a folder.
pub(crate) fn write_section_files(section: &Section, folder: &Path) -> Result<(), Failure> {
    for Drawing { name, figure, data, .. } in &section.drawings {
        WholeFile::write(&folder.join(format!("{name}.svg")), &Svg(figure).file())?;
        WholeFile::write(&folder.join(format!("{name}.csv")), &table_csv(data)?)?;
    }
    for table in &section.tables {
        WholeFile::write(&folder.join(format!("{}.csv", table.name)), &table_csv(table)?)?;
    }
    Ok(())
}

fn table_csv(table: &Table) -> Result<String, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut rows = std::iter::once(&table.heads).chain(&table.rows);
    rows.try_for_each(|row| writer.write_record(row)).map_err(Failure::unusable)?;
    let bytes = writer.into_inner().map_err(Failure::unusable)?;
    String::from_utf8(bytes).map_err(Failure::unusable)
}
