use std::path::Path;

use freeform_drawing::{Drawn, Overlay};
use freeform_motion::outline_io::{
    OriginWarnings, OutlineFrame, SourcePicture, TableFormat, TableWriter, WriteError, WriterOptions,
};

use super::simulate::SequenceError;
use crate::args::OutlineArgs;
use crate::awaited::Waiting;
use crate::failure::{Failure, warn};
use crate::input::Input;
use crate::interrupt;
use crate::left_out::MissingWarnings;
use crate::output::{DrawnPictures, Sink, refuse_overwriting};
use crate::picture_input::Purpose;
use crate::progress::{Progress, Verbosity};
use crate::seen::{Item, Missing};

/// Traces the outlines of pictures, or takes those of a file, and writes them.
pub(crate) fn run(args: &OutlineArgs) -> Result<(), Failure> {
    let outputs: Vec<_> = std::iter::once(&args.output)
        .chain(&args.overlay)
        .chain(&args.pictures.candidates)
        .map(AsRef::as_ref)
        .collect();
    refuse_overwriting(&args.pictures.files_read(&args.inputs), &outputs)?;
    // A pipe that nobody reads is waited for here, which the first signal ends.
    let mut sink = Sink::open(&args.output)?;
    let verbosity = Verbosity::of_flag(args.quiet);
    let mut input =
        Input::open(&args.inputs, &args.pictures, Waiting::UntilInterrupted, verbosity)?.with_corners_alone();
    if !input.has_pictures() && args.overlay.is_some() {
        return Err(Failure::unusable(format_args!("{}: not a picture, there is nothing to draw on", input.name)));
    }
    let name = input.name.clone();
    interrupt::listen();
    if !args.quiet {
        input.tell();
    }
    let traced = trace_all(args, input, &mut sink);
    let traced = traced.map_err(|error| error.into_failure(|error| sink.failure(error)))?;
    match (traced.outlines, traced.first_missing) {
        (0, Some(missing)) => Err(missing.into_failure()),
        (0, None) => Err(Failure::no_result(format_args!("{name}: no outline"))),
        _ => sink.finish(),
    }
}

/// What became of the pictures.
struct Traced {
    outlines: u64,
    first_missing: Option<Missing>,
}

/// Writes and draws every outline of an input, and says which pictures have none.
fn trace_all(args: &OutlineArgs, mut input: Input, sink: &mut Sink) -> Result<Traced, SequenceError> {
    let drawings = args.overlay.as_deref().map(|path| Drawings::open(path, args, &input));
    let mut drawings = drawings.transpose()?;
    let progress = Progress::of_frames(input.frame_count(), args.quiet || sink.is_disturbed_by_progress());
    let single = input.frame_count() == Some(1);
    let mut table = Table::new(args, &mut input, sink);
    let mut is_begun = false;
    let mut first_missing = None;
    let mut warnings = MissingWarnings::default();
    while let Some(item) = input.next() {
        if !args.quiet {
            progress.warn_of(&input.news());
        }
        // What came after Ctrl-C may be cut short.
        if interrupt::was_asked_for() {
            break;
        }
        progress.advance();
        match item? {
            Item::Outline(frame, source) => {
                let warnings = if !std::mem::replace(&mut is_begun, true) || input.has_labels() {
                    input.origin_warnings().into_iter().map(|(warning, _)| warning).collect()
                } else {
                    input.told_so_far()
                };
                table.write(&frame, warnings)?;
                if let (Some(drawings), Some(source)) = (&mut drawings, &source) {
                    drawings.draw(source, &frame)?;
                }
            }
            Item::NoOutline { reason, .. } if !args.quiet => progress.pause(|| warn(&reason)),
            Item::NoOutline { .. } => {}
            Item::Gap(missing) => {
                // The reason of a single picture is told in the end.
                if let Some(warning) = warnings.take(&missing).filter(|_| !args.quiet && !single) {
                    progress.pause(|| warn(&warning));
                }
                if let (Some(drawings), Some(source)) = (&mut drawings, &missing.seen_in) {
                    drawings.draw_nothing(source)?;
                }
                first_missing.get_or_insert(missing);
            }
        }
    }
    if !args.quiet {
        progress.pause(|| input.tell_in_the_end(Purpose::Outlines));
    }
    warnings.finish().filter(|_| !args.quiet).for_each(|warning| progress.pause(|| warn(&warning)));
    drawings.map_or(Ok(()), Drawings::finish)?;
    Ok(Traced { outlines: table.finish()?, first_missing })
}

/// The table that outlines are written to. Its header waits for the first of them, so that nothing is printed where there is none.
struct Table<'a> {
    sink: Option<&'a mut Sink>,
    writer: Option<TableWriter<&'a mut Sink>>,
    format: TableFormat,
    options: WriterOptions,
    comments: Vec<String>,
    outlines: u64,
}

impl<'a> Table<'a> {
    fn new(args: &OutlineArgs, input: &mut Input, sink: &'a mut Sink) -> Self {
        let follows_all = input.pictures().is_some_and(|pictures| pictures.options().follows_all());
        let options = WriterOptions {
            arc_column: true,
            object_column: names_objects(input),
            contour_column: input.pictures().is_none_or(|pictures| pictures.options().traces_contours()),
            // A copy of a table says no less than the table.
            deviation_column: args.deviations || input.has_deviation_column(),
            resolution: None,
            warnings: OriginWarnings::NONE,
            // A table that is copied says it in its rows, a label may fall apart in a later mask than the first, and objects touch when they do.
            warning_column: input.has_warning_column() || input.has_labels() || follows_all,
        };
        let (format, comments) = (TableFormat::of(&args.output), std::mem::take(&mut input.comments));
        Self { sink: Some(sink), writer: None, format, options, comments, outlines: 0 }
    }

    /// Writes an outline, with what is known by now of how all were found.
    fn write(&mut self, frame: &OutlineFrame, warnings: OriginWarnings) -> Result<(), WriteError> {
        if let Some(sink) = self.sink.take() {
            self.options.warnings = warnings;
            self.writer = Some(TableWriter::new(sink, self.format, self.options, &self.comments)?);
        }
        if let Some(writer) = &mut self.writer {
            writer.warn(warnings);
            writer.write(frame)?;
        }
        self.outlines += 1;
        Ok(())
    }

    /// Writes what is left. Returns the number of outlines.
    fn finish(self) -> Result<u64, WriteError> {
        if let Some(writer) = self.writer {
            writer.finish()?;
        }
        Ok(self.outlines)
    }
}

/// Drawings of the outlines on their pictures.
struct Drawings {
    overlay: Overlay,
    pictures: DrawnPictures,
    /// Whether the objects are named.
    names: bool,
}

impl Drawings {
    fn open(path: &Path, args: &OutlineArgs, input: &Input) -> Result<Self, Failure> {
        let pictures = DrawnPictures::open(path, &args.inputs)?;
        Ok(Self { overlay: Overlay::default(), pictures, names: names_objects(input) })
    }

    fn draw(&mut self, source: &SourcePicture, frame: &OutlineFrame) -> Result<(), Failure> {
        let name = self.names.then_some(frame.object.as_str());
        let drawn = Drawn { outline: &frame.outline, name, accepted: true, known: &[], fit: None, generator: None };
        self.pictures.take(self.overlay.draw(source, &drawn))
    }

    fn draw_nothing(&mut self, source: &SourcePicture) -> Result<(), Failure> {
        self.pictures.take(self.overlay.draw_nothing(source))
    }

    fn finish(self) -> Result<(), Failure> {
        self.pictures.finish(self.overlay.finish())
    }
}

/// Whether objects need their names. What a file holds is not known before all of it has been read.
fn names_objects(input: &Input) -> bool {
    input.pictures().is_none_or(|pictures| pictures.options().follows_all())
}
