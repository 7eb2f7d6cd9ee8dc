//! The figures and experiments of the paper, as files and a page.
use std::fs;
use std::io::Write as _;
use std::path::Path;

use freeform_drawing::page::{self, write_page};
use freeform_experiments::paper::{Part, Reproduction, Section};

use super::listed_settings::version;
use crate::args::ReproduceArgs;
use crate::command_line::command_line;
use crate::failure::{Failure, plain};
use crate::output::{Sink, WholeFile, table_text, write_section_files};
use crate::progress::Progress;

const PAGE: &str = "index.html";

const TITLE: &str = "Motion identification of planar free-form objects, reproduced";

const INTRODUCTION: &str = "The figures and experiments of M. Unel and B. K. Ghosh, Motion identification of planar \
    free-form objects, made anew from simulated outlines, and beside them what the paper leaves open or only announces. \
    Every figure stands beside this page as SVG, and the numbers behind it as CSV.";

/// Makes the figures and tables asked for and the page that shows them.
pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let folder = &args.out;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::unusable(format_args!("{}: {}", folder.display(), plain(&error))))?;
    let parts = Part::ALL.into_iter().filter(|part| args.only.is_empty() || args.only.contains(part)).collect();
    let &ReproduceArgs { seconds, starts, repeats, seed, .. } = args;
    let reproduction = Reproduction { parts, seconds, starts, repeats, seed };
    let progress = Progress::of_runs(reproduction.step_count());
    let sections = reproduction.run(&|| progress.advance()).map_err(Failure::of_experiment)?;
    drop(progress);
    sections.iter().try_for_each(|section| write_section_files(section, folder))?;
    let mut settings = reproduction.settings();
    settings.push(version());
    let parts: Vec<_> = sections.iter().map(part_of_page).collect();
    let page = write_page(TITLE, INTRODUCTION, &parts, &settings, &command_line());
    WholeFile::write(&folder.join(PAGE), &page)?;
    print(&sections, folder)
}

fn part_of_page(Section { heading, text, drawings, tables, .. }: &Section) -> page::Section<'_> {
    page::Section { heading, text, drawings, tables }
}

fn print(sections: &[Section], folder: &Path) -> Result<(), Failure> {
    let mut sink = Sink::stdout();
    let mut tables = sections.iter().flat_map(|section| &section.tables);
    let written = tables.try_for_each(|table| writeln!(sink, "{}\n{}", table.title, table_text(table)));
    let written = written.and_then(|()| {
        let drawings: usize = sections.iter().map(|section| section.drawings.len()).sum();
        let page = folder.join(PAGE);
        writeln!(sink, "{drawings} figure(s) with their numbers, and the page that shows them: {}", page.display())
    });
    written.map_err(|error| sink.failure(&error))?;
    sink.finish()
}
