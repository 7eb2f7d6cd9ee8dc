//! The contract of the command line, tested on the binary itself.
mod bad_input;
mod browser;
mod drawings;
mod evaluate;
mod files;
mod filter;
mod fit;
mod guides;
mod help;
#[cfg(unix)]
mod hostile_names;
#[cfg(unix)]
mod hostile_outputs;
#[cfg(unix)]
mod hostile_streams;
mod identify;
mod memory;
mod outline;
mod pictures;
mod projective;
mod real_pictures;
mod recognise;
mod rectify;
mod report;
mod reproduce;
mod simulate;
mod support;
#[cfg(feature = "parquet")]
mod tables;
mod track;
mod trajectory;
mod whole_files;
