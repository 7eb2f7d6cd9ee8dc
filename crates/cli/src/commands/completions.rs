use std::io::Write as _;

use crate::args::{CompletionsArgs, definition};
use crate::failure::Failure;
use crate::output::Sink;

/// Prints the completion script.
pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut definition(), "freeform", &mut script);
    let mut sink = Sink::stdout();
    sink.write_all(&script).map_err(|error| sink.failure(&error))?;
    sink.finish()
}
