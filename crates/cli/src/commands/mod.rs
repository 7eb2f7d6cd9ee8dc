//! What each command does.
mod completions;
mod demo;
mod evaluate;
mod fit;
mod identify;
mod identify_files;
mod listed_settings;
mod man;
mod outline;
mod recognise;
mod rectify;
mod reproduce;
mod side_by_side;
mod simulate;
mod simulate_pictures;
mod stress;
mod track;

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::interrupt;

/// Runs the command that was asked for.
pub(crate) fn run(cli: &Cli) -> Result<(), Failure> {
    interrupt::leave_nothing_unfinished();
    match &cli.command {
        Command::Demo(args) => demo::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Fit(args) => fit::run(args),
        Command::Identify(args) => identify::run(args),
        Command::Track(args) => track::run(args),
        Command::Outline(args) => outline::run(args),
        Command::Recognise(args) => recognise::run(args),
        Command::Rectify(args) => rectify::run(args),
        Command::Evaluate(args) => evaluate::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man => man::run(),
    }
}
