//! Command line of freeform: how a flat free-form object moves, from nothing but its outlines.
mod args;
mod awaited;
mod bound_found;
mod candidate_sheet;
mod command_line;
mod commands;
mod edge_seeker;
mod failure;
mod fitted_outline;
mod handful;
mod history;
mod input;
mod interrupt;
mod left_out;
mod meaning_of_b;
mod outline_error;
mod output;
mod overlay;
mod picture_input;
mod playback;
mod plot;
mod pose_history;
mod progress;
mod reader;
mod seen;
mod thinned;
mod tracing_choice;
mod truth;

use std::process::ExitCode;

fn main() -> ExitCode {
    match args::parse().and_then(|cli| commands::run(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
