//! The report of what was identified: a page that needs nothing but itself, and its figures.
mod bound_found;
mod document;
mod figures;
mod meaning_of_b;
mod object_section;
mod parameter_table;
mod pictures_left_out;
mod player;
mod pose_figures;
mod report_page;

pub(crate) use document::{document, write_settings};
pub use figures::{fit_figure, parameter_figure};
pub use meaning_of_b::MeaningOfB;
pub use parameter_table::{PARAMETER_COLUMNS, meaning_of_v, parameter_rows};
pub use pictures_left_out::PicturesLeftOut;
pub use report_page::{Findings, Report, write_report};
