//! What can be asked for on the command line.
mod dynamics;
mod evaluate;
mod fit;
mod identify;
mod law;
mod outline;
mod pictures;
mod recognise;
mod rectify;
mod reproduce;
mod simulate;
mod simulated;
mod space;
mod track;
mod values;

use std::path::PathBuf;

use clap::{
    Args, CommandFactory, FromArgMatches as _, Parser, Subcommand,
    error::{ContextKind, ContextValue, ErrorKind},
};

pub(crate) use evaluate::{EvaluateArgs, EvaluateFormat};
pub(crate) use fit::{FitArgs, FitFormat};
pub(crate) use identify::{DynamicsChoice, IdentifyArgs, IdentifyFormat, IdentifyMethod, MotionChoice, TrackOptions};
pub(crate) use outline::OutlineArgs;
pub(crate) use pictures::{
    ChannelChoice, ContoursChoice, ObjectsChoice, PictureOptions, RingChoice, TransferChoice, through_ffmpeg,
};
pub(crate) use recognise::{RecogniseArgs, RecogniseFormat};
pub(crate) use rectify::RectifyArgs;
pub(crate) use reproduce::ReproduceArgs;
pub(crate) use simulate::SimulateArgs;
pub(crate) use simulated::DisturbanceArgs;
pub(crate) use space::{PerspectiveArgs, PlaneBefore};
pub(crate) use track::TrackArgs;

use crate::failure::{Failure, plain};

const EXAMPLES: &str = "\
Examples:
  freeform demo
  freeform simulate --shape glider --omega -1.05 --b 0,4 --output outlines.csv
  freeform identify outlines.csv --scale 0.1 --report report.html
  freeform simulate --seconds 5 | freeform identify - --format json
  freeform outline 'mask-*.png' --fps 25 | freeform identify -

Exit status: 0 done; 1 input understood, but no result; 2 wrong usage or unreadable input.
'freeform COMMAND --help' describes a command and its options.";

/// Finds how a flat free-form object moves, from its outlines alone.
///
/// The motion is x' = a1 x + a2 y + b1, y' = a3 x + a4 y + b2. The motion filter estimates it together with the outline and
/// the pose. The adaptive method is that of the paper: it fits an implicit polynomial to every outline, decomposes it into
/// complex lines, and identifies the motion from the motion of the lines.
#[derive(Debug, Parser)]
#[command(name = "freeform", version, after_help = EXAMPLES, arg_required_else_help = true, args_override_self = true, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Simulate(SimulateArgs),
    Fit(FitArgs),
    Identify(Box<IdentifyArgs>),
    Track(TrackArgs),
    Outline(OutlineArgs),
    Recognise(RecogniseArgs),
    Rectify(RectifyArgs),
    Evaluate(EvaluateArgs),
    Reproduce(ReproduceArgs),
    Completions(CompletionsArgs),
    /// Print the manual page: freeform man > freeform.1
    Man,
}

const DEMO_EXAMPLES: &str = "\
Examples:
  freeform demo
  freeform demo --out bird";

/// Simulate a flying bird, identify its motion and write a report; needs no input.
///
/// Simulates the flight bird of the paper (omega = pi/2 rad/s, b = (-3, 4), f/Z0 = 0.1, noise 0.005, 30 s at 30
/// frames/s). Identifies its motion with the motion filter and, for comparison, with the adaptive law of the paper. Prints
/// the results next to the truth. The folder then contains report.html, outlines.csv, curve.svg, trace.csv and
/// parameters.svg (filter), trace-adaptive.csv and parameters-adaptive.svg (adaptive).
#[derive(Debug, Args)]
#[command(after_help = DEMO_EXAMPLES)]
pub(crate) struct DemoArgs {
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "freeform-demo")]
    pub(crate) out: PathBuf,
}

/// Print a completion script for a shell.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  freeform completions bash > ~/.local/share/bash-completion/completions/freeform")]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: clap_complete::Shell,
}

/// Reads the arguments of the process. Help and version are printed here.
pub(crate) fn parse() -> Result<Cli, Failure> {
    let matches = with_negative_values(Cli::command()).try_get_matches();
    matches.and_then(|matches| Cli::from_arg_matches(&matches)).map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match error.print() {
            // A closed pipe is no error.
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                Failure::unusable(format_args!("standard output: {}", plain(&error)))
            }
            _ => Failure::Silent,
        },
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            Failure::unusable("a command is missing")
        }
        _ => Failure::unusable(with_tip(&error, one_line(&error.render().to_string()))),
    })
}

/// Takes negative numbers for values of options, so that one out of range is refused as such and not as an unknown option.
fn with_negative_values(command: clap::Command) -> clap::Command {
    command.mut_subcommands(|command| {
        command.mut_args(|arg| {
            let takes_value = arg.get_long().is_some() && arg.get_action().takes_values();
            if takes_value { arg.allow_negative_numbers(true) } else { arg }
        })
    })
}

/// The command as it is defined, to make completions from.
pub(crate) fn definition() -> clap::Command {
    Cli::command()
}

/// Whether an argument is an option whose value is the argument after it.
pub(crate) fn takes_next(argument: &str) -> bool {
    let definition = definition();
    let mut options = definition.get_subcommands().flat_map(clap::Command::get_arguments);
    options.any(|option| {
        let long = option.get_long().map(|name| format!("--{name}"));
        let short = option.get_short().map(|name| format!("-{name}"));
        option.get_action().takes_values() && long.into_iter().chain(short).any(|name| name == argument)
    })
}

/// With the command that has an option which another does not know, in place of how to pass its name as a value, and of an option of a similar name.
fn with_tip(error: &clap::Error, message: String) -> String {
    let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else { return message };
    if error.kind() != ErrorKind::UnknownArgument {
        return message;
    }
    let definition = definition();
    let has_it = |command: &&clap::Command| {
        command.get_arguments().any(|option| option.get_long().is_some_and(|long| argument == &format!("--{long}")))
    };
    let commands: Vec<_> = definition.get_subcommands().filter(has_it).map(clap::Command::get_name).collect();
    if commands.is_empty() {
        return message;
    }
    let said = message.split("; tip:").next().unwrap_or_default();
    format!("{said}; tip: it is an option of freeform {}", commands.join(" and "))
}

/// What clap says, without the usage that it prints below.
fn one_line(rendered: &str) -> String {
    let message = rendered.split("\n\nUsage:").next().unwrap_or(rendered);
    let message = message.split("\n\nFor more information").next().unwrap_or(message);
    let message = message.strip_prefix("error: ").unwrap_or(message).replace("\n\n  tip:", "; tip:");
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
