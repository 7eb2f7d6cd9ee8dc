//! The contract of the command line, tested on the binary itself.
mod adaptive_study;
mod advice;
mod bad_input;
mod browser;
mod contacts;
mod drawings;
mod evaluate;
#[cfg(target_os = "linux")]
mod fault_injection;
mod files;
mod filter;
mod fit;
mod foreign_formats;
mod guides;
mod help;
#[cfg(unix)]
mod hostile_names;
#[cfg(unix)]
mod hostile_outputs;
#[cfg(unix)]
mod hostile_streams;
mod identify;
mod label_masks;
mod memory;
mod origin_warnings;
mod outline;
mod pears;
mod picture_drawings;
mod picture_input;
mod picture_results;
mod pixel_aspect;
mod plane;
mod projective;
mod real_pictures;
mod recognise;
mod rectify;
mod report;
mod reproduce;
mod simulate;
mod sought_edges;
mod support;
#[cfg(feature = "parquet")]
mod tables;
mod tracing;
mod track;
mod track_poses;
mod trajectory;
mod void_borders;
mod warning_codes;
mod whole_files;
