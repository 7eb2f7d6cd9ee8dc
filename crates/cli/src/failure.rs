use std::fmt::Display;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use freeform_experiments::ExperimentError;
use freeform_motion::outline_io::readable;

/// Why a command ends before its time; decides the exit status.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Help or version was asked for and has been printed, or the reader of the output has gone: no error.
    Silent,
    /// The input was understood but no result can be given: status 1.
    NoResult(String),
    /// Wrong usage, or input or output that cannot be read or written: status 2.
    Unusable(String),
}

impl Failure {
    pub(crate) fn no_result(reason: impl Display) -> Self {
        Self::NoResult(reason.to_string())
    }

    pub(crate) fn unusable(reason: impl Display) -> Self {
        Self::Unusable(reason.to_string())
    }

    /// An experiment that cannot be made, or that was made and gives nothing.
    pub(crate) fn of_experiment(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Fit(_) | ExperimentError::Decomposition(_) | ExperimentError::NoOutline { .. } => {
                Self::no_result(error)
            }
            _ => Self::unusable(error),
        }
    }

    /// An error of standard output: a closed pipe means that the reader has seen enough.
    pub(crate) fn of_stdout(error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::Silent,
            _ => Self::Unusable(format!("standard output: {}", plain(error))),
        }
    }

    /// The reason; empty if there is nothing to print.
    pub(crate) fn text(&self) -> &str {
        match self {
            Self::Silent => "",
            Self::NoResult(reason) | Self::Unusable(reason) => reason,
        }
    }

    /// Prints the reason on one line and gives the exit status.
    pub(crate) fn report(&self) -> ExitCode {
        let (reason, status) = match self {
            Self::Silent => return ExitCode::SUCCESS,
            Self::NoResult(reason) => (reason, 1),
            Self::Unusable(reason) => (reason, 2),
        };
        say(reason);
        ExitCode::from(status)
    }
}

/// An error of the system in reading or writing a file.
pub(crate) fn file_failure(path: &Path, error: &io::Error) -> Failure {
    Failure::unusable(format_args!("{}: {}", path.display(), plain(error)))
}

/// An error, which may be one of the system, without the number that Rust adds to those.
pub(crate) fn plain(error: &impl Display) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

/// Prints one line on standard error, which may be closed. Names in it may hold anything: nothing reaches the terminal that it
/// would act upon.
pub(crate) fn say(message: &str) {
    let lines: Vec<&str> = message.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    // At once: what is written there is not buffered.
    let line = format!("freeform: {}\n", readable(&lines.join(" ")));
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Prints what a user may want to know on standard error.
pub(crate) fn note(message: &str) {
    say(&format!("note: {message}"));
}

/// Prints a warning on standard error that docs/warnings.md does not list: of the options, the input or files, or a count of others.
pub(crate) fn warn(message: &str) {
    say(&format!("warning: {message}"));
}

/// Prints a warning on standard error with the code by which docs/warnings.md lists it.
pub(crate) fn warn_of(code: &str, message: &str) {
    say(&format!("warning[{code}]: {message}"));
}
