use std::io::{IsTerminal as _, stderr, stdout};
use std::time::Duration;

use freeform_motion::outline_io::OriginWarning;
use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::warn_of;

/// Whether standard output is a terminal: a bar would stand in the lines that are printed there meanwhile, and they show how
/// far the work has come.
pub(crate) fn would_stand_in_output() -> bool {
    stdout().is_terminal()
}

/// How much a command tells beside its results and errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verbosity {
    /// Warnings and notes; a terminal shows how far it has come.
    Usual,
    /// Nothing.
    Quiet,
}

impl Verbosity {
    /// What the option `--quiet` says.
    pub(crate) fn of_flag(quiet: bool) -> Self {
        if quiet { Self::Quiet } else { Self::Usual }
    }

    pub(crate) fn is_quiet(self) -> bool {
        self == Self::Quiet
    }
}

/// What is shown of a running command, on a terminal only.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Of a known or unknown number of frames.
    pub(crate) fn of_frames(total: Option<u64>, quiet: bool) -> Self {
        if quiet { Self { bar: None } } else { Self::of(total, "frames") }
    }

    /// Of pictures that are looked at before they are read, to choose how they are traced.
    pub(crate) fn of_choice(verbosity: Verbosity) -> Self {
        match verbosity {
            Verbosity::Usual => Self::shown(None, "{spinner} looking for a way to trace the pictures"),
            Verbosity::Quiet => Self { bar: None },
        }
    }

    /// Of a number of Monte Carlo runs.
    pub(crate) fn of_runs(total: u64) -> Self {
        Self::of(Some(total), "runs, {eta} left")
    }

    fn of(total: Option<u64>, what: &str) -> Self {
        let count = if total.is_some() { "{bar:40} {pos}/{len}" } else { "{spinner} {pos}" };
        Self::shown(total, &format!("{count} {what}"))
    }

    fn shown(total: Option<u64>, template: &str) -> Self {
        if !stderr().is_terminal() {
            return Self { bar: None };
        }
        let bar = total.map_or_else(ProgressBar::new_spinner, ProgressBar::new);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar: Some(bar) }
    }

    /// One more of them is done.
    pub(crate) fn advance(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// Warns of all of these.
    pub(crate) fn warn_of(&self, told: &[(OriginWarning, String)]) {
        told.iter().for_each(|(warning, message)| self.pause(|| warn_of(warning.code(), message)));
    }

    /// Lets something be printed on the terminal.
    pub(crate) fn pause(&self, print: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
