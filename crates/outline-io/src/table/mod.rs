//! What all tables of outlines have in common: columns, rows, and the frames made of them.
pub(crate) mod column;
pub(crate) mod header_hint;
pub(crate) mod keys;
pub(crate) mod latest_frames;
pub(crate) mod outline_columns;
pub(crate) mod outline_lists;
pub(crate) mod outline_rows;
pub(crate) mod rounding;
