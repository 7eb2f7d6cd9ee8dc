//! What `reproduce` makes: figures and tables, each with the numbers behind it.
use std::path::Path;

use crate::failure::Failure;
use crate::output::WholeFile;
use crate::plot::Figure;

/// A part of the page.
#[derive(Debug, Default)]
pub(crate) struct Section {
    pub(crate) heading: String,
    /// What is said before the first figure.
    pub(crate) text: String,
    pub(crate) drawings: Vec<Drawing>,
    pub(crate) tables: Vec<Table>,
    /// Rows of the table of final errors, which all sections share.
    pub(crate) findings: Vec<Vec<String>>,
}

/// A figure and the numbers in it.
#[derive(Debug)]
pub(crate) struct Drawing {
    /// Of its files, without extension.
    pub(crate) name: String,
    pub(crate) caption: String,
    pub(crate) figure: Figure,
    pub(crate) data: Table,
}

/// Rows under heads.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    /// Of its file, without extension; empty for the data of a drawing.
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) heads: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of numbers, to be filled.
    pub(crate) fn of_data(heads: &[&str]) -> Self {
        Self { heads: heads.iter().map(|&head| head.to_owned()).collect(), ..Self::default() }
    }

    /// Adds a row of names and numbers.
    pub(crate) fn push(&mut self, names: &[&str], numbers: &[f64]) {
        let known: Vec<_> = numbers.iter().copied().map(Some).collect();
        self.push_known(names, &known);
    }

    /// Adds a row of names and of numbers where they are known; the other cells are empty.
    pub(crate) fn push_known(&mut self, names: &[&str], numbers: &[Option<f64>]) {
        let names = names.iter().map(|&name| name.to_owned());
        let number = |number: &Option<f64>| number.map(|number| number.to_string()).unwrap_or_default();
        self.rows.push(names.chain(numbers.iter().map(number)).collect());
    }

    fn csv(&self) -> Result<String, Failure> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        std::iter::once(&self.heads)
            .chain(&self.rows)
            .try_for_each(|row| writer.write_record(row))
            .map_err(Failure::unusable)?;
        let bytes = writer.into_inner().map_err(Failure::unusable)?;
        String::from_utf8(bytes).map_err(Failure::unusable)
    }

    /// Whether a column holds names and not numbers.
    pub(crate) fn is_of_names(&self, column: usize) -> bool {
        column == 0 || self.heads[column] == "method"
    }

    /// Columns as wide as their widest entry, names to the left and numbers to the right.
    pub(crate) fn text(&self) -> String {
        let all = || std::iter::once(&self.heads).chain(&self.rows);
        let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.heads.len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells =
                row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match self.is_of_names(column) {
                    true => format!("  {cell:<width$}"),
                    false => format!("  {cell:>width$}"),
                });
            cells.collect::<String>().trim_end().to_owned() + "\n"
        };
        all().map(line).collect()
    }
}

impl Section {
    /// Writes the figures and the numbers behind figures and tables into a folder.
    pub(crate) fn write_files(&self, folder: &Path) -> Result<(), Failure> {
        for Drawing { name, figure, data, .. } in &self.drawings {
            WholeFile::write(&folder.join(format!("{name}.svg")), &figure.file())?;
            WholeFile::write(&folder.join(format!("{name}.csv")), &data.csv()?)?;
        }
        for table in &self.tables {
            WholeFile::write(&folder.join(format!("{}.csv", table.name)), &table.csv()?)?;
        }
        Ok(())
    }
}
