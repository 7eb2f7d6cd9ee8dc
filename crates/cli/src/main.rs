//! Command line of freeform: how a flat free-form object moves, from nothing but its outlines.
mod args;
mod awaited;
mod command_line;
mod commands;
mod failure;
mod handful;
mod hints;
mod input;
mod interrupt;
mod label_choice;
mod left_out;
mod output;
mod overlay;
mod picture_hints;
mod picture_input;
mod picture_settings;
mod progress;
mod reader;
mod result_origin;
mod seen;
mod stream_warnings;
mod traced_input;
mod tracing_choice;

use std::process::ExitCode;

fn main() -> ExitCode {
    match args::parse().and_then(|cli| commands::run(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
