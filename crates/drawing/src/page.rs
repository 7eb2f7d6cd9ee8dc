//! Pages of figures and tables that need nothing but themselves.
use std::fmt::Write as _;

use serde::Serialize;

use crate::figure::Figure;
use crate::plot::{Svg, escape};
use crate::report::{document, write_settings};

/// Least size of a figure on a narrow page, as a share of that of its file; beyond that it is scrolled.
const SMALLEST: f64 = 0.75;

/// What belongs together on a page: figures and tables under a heading.
#[derive(Debug, Clone, Copy)]
pub struct Section<'a> {
    /// Its heading.
    pub heading: &'a str,
    /// What is said before the first figure; may be empty.
    pub text: &'a str,
    /// Its figures.
    pub drawings: &'a [Drawing],
    /// Its tables.
    pub tables: &'a [Table],
}

/// A figure and the numbers in it.
#[derive(Debug, Serialize)]
pub struct Drawing {
    /// A name as of a file, without extension.
    pub name: String,
    /// What the figure shows, and how it was made.
    pub caption: String,
    /// What is to be drawn.
    pub figure: Figure,
    /// The numbers of the figure. If its curves are smoothed or thinned, also the original numbers.
    pub data: Table,
}

/// Rows of text and numbers under heads.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Table {
    /// A name as of a file, without extension; empty for the data of a drawing.
    pub name: String,
    /// Its title; empty for the data of a drawing.
    pub title: String,
    /// What its rows and numbers are.
    pub caption: String,
    /// One for each column.
    pub heads: Vec<String>,
    /// Each with a cell for each head.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of numbers, to be filled.
    #[must_use]
    pub fn of_data(heads: &[&str]) -> Self {
        Self { heads: heads.iter().map(|&head| head.to_owned()).collect(), ..Self::default() }
    }

    /// Adds a row of names and numbers.
    pub fn push(&mut self, names: &[&str], numbers: &[f64]) {
        let known: Vec<_> = numbers.iter().copied().map(Some).collect();
        self.push_known(names, &known);
    }

    /// Adds a row of names and of numbers where they are known; the other cells are empty.
    pub fn push_known(&mut self, names: &[&str], numbers: &[Option<f64>]) {
        let names = names.iter().map(|&name| name.to_owned());
        let number = |number: &Option<f64>| number.map(|number| number.to_string()).unwrap_or_default();
        self.rows.push(names.chain(numbers.iter().map(number)).collect());
    }

    /// Whether a column holds names and not numbers.
    #[must_use]
    pub fn is_of_names(&self, column: usize) -> bool {
        column == 0 || self.heads[column] == "method"
    }
}

/// A page of figures and tables that needs nothing but itself. The names of figures and tables are those of files beside it, `NAME.svg` and
/// `NAME.csv`, which the caller writes.
#[must_use]
pub fn write_page(
    title: &str,
    introduction: &str,
    sections: &[Section<'_>],
    settings: &[(&'static str, String)],
    command: &str,
) -> String {
    let mut body = format!("<h1>{}</h1>\n<p class=\"soft\">{}</p>\n<ul>\n", escape(title), escape(introduction));
    for (index, Section { heading, .. }) in sections.iter().enumerate() {
        let _ = writeln!(body, "<li><a href=\"#part{index}\">{}</a></li>", escape(heading));
    }
    body.push_str("</ul>\n");
    for (index, section) in sections.iter().enumerate() {
        let _ = writeln!(body, "<h2 id=\"part{index}\">{}</h2>", escape(section.heading));
        if !section.text.is_empty() {
            let _ = writeln!(body, "<p>{}</p>", escape(section.text));
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
