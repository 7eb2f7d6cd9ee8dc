//! Outlines from and to files: streamed CSV.
mod csv_columns;
mod csv_field;
mod csv_reader;
mod csv_rows;
mod csv_writer;
mod error;
mod frame;
mod outline_rows;
mod row_limit;

pub use csv_columns::Column;
pub use csv_reader::OutlineReader;
pub use csv_writer::{OutlineWriter, WriterOptions};
pub use error::{Place, ReadError, ReadErrorKind, WriteError};
pub use frame::{DEFAULT_OBJECT, OutlineFrame};
