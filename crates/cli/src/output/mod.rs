//! What is written: one file per format.
mod csv;
mod figures;
mod file;
mod fit_json;
mod fit_table;
mod html;
mod identify_json;
mod identify_table;
mod number;

pub(crate) use csv::{TraceWriter, write_parameters};
pub(crate) use figures::{fit_figure, parameter_figure};
pub(crate) use file::{Sink, WholeFile, refuse_overwriting};
pub(crate) use fit_json::write_fits_json;
pub(crate) use fit_table::write_fit_table;
pub(crate) use html::{Findings, Report, write_report};
pub(crate) use identify_json::{track_line, write_identify_json};
pub(crate) use identify_table::write_identify_table;
