//! Outlines as Parquet.
pub(crate) mod batch;
pub(crate) mod columns;
pub(crate) mod leaf;
pub(crate) mod limit;
pub(crate) mod pages;
pub(crate) mod reader;
pub(crate) mod schema;
pub(crate) mod source;
pub(crate) mod table;
pub(crate) mod writer;
