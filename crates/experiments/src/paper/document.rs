use crate::figure::Figure;

/// What belongs together: figures and tables under a heading.
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// What is said before the first figure; may be empty.
    pub text: String,
    /// Its figures.
    pub drawings: Vec<Drawing>,
    /// Its tables.
    pub tables: Vec<Table>,
    /// Rows of the table of final errors, which all sections share.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) findings: Vec<Vec<String>>,
}

/// A figure and the numbers in it.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
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
    pub(super) fn of_data(heads: &[&str]) -> Self {
        Self { heads: heads.iter().map(|&head| head.to_owned()).collect(), ..Self::default() }
    }

    /// Adds a row of names and numbers.
    pub(super) fn push(&mut self, names: &[&str], numbers: &[f64]) {
        let known: Vec<_> = numbers.iter().copied().map(Some).collect();
        self.push_known(names, &known);
    }

    /// Adds a row of names and of numbers where they are known; the other cells are empty.
    pub(super) fn push_known(&mut self, names: &[&str], numbers: &[Option<f64>]) {
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
