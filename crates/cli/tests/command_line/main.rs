//! The contract of the command line, tested on the binary itself.
mod bad_input;
mod evaluate;
mod files;
mod filter;
mod fit;
mod help;
mod identify;
mod outline;
mod pictures;
mod real_pictures;
mod recognise;
mod reproduce;
mod simulate;
mod support;
mod track;
mod trajectory;
mod whole_files;
