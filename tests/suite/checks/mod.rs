//! What must hold for any input, as functions of bytes: driven by seeded tests here and by the targets in `fuzz/`.
#![allow(dead_code, reason = "every target in `fuzz` takes a part")]
mod files;
mod finite;
mod hostile_input;
mod stages;
#[cfg(feature = "serde")]
mod states;

#[cfg(feature = "parquet")]
#[allow(unused_imports, reason = "every target in `fuzz` takes a part")]
pub(crate) use files::parquet_reader;
#[allow(unused_imports, reason = "every target in `fuzz` takes a part")]
pub(crate) use files::{csv_reader, names, picture_folder, picture_reader, picture_stream, polygon_reader, tracing};
#[allow(unused_imports, reason = "every target in `fuzz` takes a part")]
pub(crate) use finite::{assert_covariance, assert_finite};
#[allow(unused_imports, reason = "every target in `fuzz` takes a part")]
pub(crate) use stages::{adaptive_identifier, fit_and_decomposition, motion_filter};
#[cfg(feature = "serde")]
#[allow(unused_imports, reason = "every user takes a part")]
pub(crate) use states::saved_state;
