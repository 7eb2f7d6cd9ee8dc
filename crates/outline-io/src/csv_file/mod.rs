//! Outlines as CSV, streamed.
pub(crate) mod columns;
pub(crate) mod comments;
pub(crate) mod field;
pub(crate) mod lines;
pub(crate) mod not_csv;
pub(crate) mod reader;
pub(crate) mod rows;
pub(crate) mod writer;
