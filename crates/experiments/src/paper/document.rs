use freeform_drawing::page::{Drawing, Table};

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
