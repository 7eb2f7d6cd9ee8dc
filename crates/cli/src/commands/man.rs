use std::io::Write as _;

use crate::args::definition;
use crate::failure::Failure;
use crate::output::Sink;

/// Prints the manual page: the program, then every command.
pub(crate) fn run() -> Result<(), Failure> {
    let mut page = Vec::new();
    let definition = definition();
    let failed = |error: std::io::Error| Failure::unusable(error);
    clap_mangen::Man::new(definition.clone()).render(&mut page).map_err(failed)?;
    for command in definition.get_subcommands().filter(|command| command.get_name() != "help") {
        let name = command.get_name().to_uppercase();
        writeln!(page, ".SH \"FREEFORM {name}\"").map_err(failed)?;
        let manual = clap_mangen::Man::new(command.clone());
        manual.render_description_section(&mut page).map_err(failed)?;
        manual.render_options_section(&mut page).map_err(failed)?;
        manual.render_extra_section(&mut page).map_err(failed)?;
    }
    let mut sink = Sink::stdout();
    sink.write_all(&page).map_err(|error| sink.failure(&error))?;
    sink.finish()
}
