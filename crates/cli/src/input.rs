//! Outlines from a file, pictures or standard input.
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use freeform_drawing::MeaningOfB;
use freeform_motion::outline_io::{
    FilePoints, OriginWarning, OriginWarnings, OutlineFile, OutlineFrame, OutlineReader, PictureSequence,
    PolygonSettings, ReadError, ReadErrorKind, TableFormat, VerticalAxis, labelme_files, out_of_number_order,
    read_comments,
};
use freeform_motion::{SimulatedMotion, outline_of_polygon};

use crate::args::{PictureOptions, TrackOptions};
use crate::awaited::{Awaited, Waiting};
use crate::failure::{Failure, note, plain, warn, warn_of};
use crate::picture_input::{ASSUMED_RATE, PictureInput, Purpose};
use crate::progress::Verbosity;
use crate::result_origin::{Naming, ResultOrigin};
use crate::seen::Item;

/// Options for pictures that hold for polygons in pictures too.
const OPTIONS_OF_POLYGONS: [&str; 4] = ["--fps", "--pixel-size", "--y-up", "--y-down"];

/// A sequence of outlines, open for reading.
pub(crate) struct Input {
    /// The name of the file in messages.
    pub(crate) name: String,
    /// The comment lines that the file begins with, without `#`.
    pub(crate) comments: Vec<String>,
    source: Source,
    /// Standard input or a pipe.
    is_stream: bool,
    /// Two files that were named in another order than their numbers have.
    out_of_order: Option<[PathBuf; 2]>,
    /// What the table has said of its outlines and has been told.
    told: OriginWarnings,
}

enum Source {
    Csv(Box<OutlineReader<Box<dyn Read>>>),
    /// Outlines that are handed on as they are.
    File(OutlineFile),
    /// Polygons that are handed on with points along their sides, of which the file has the corners alone.
    Polygons(OutlineFile),
    Pictures(Box<PictureInput>),
}

impl Input {
    /// What b of the motion is, by where its coordinates come from.
    pub(crate) fn meaning_of_b(&self, options: &TrackOptions) -> MeaningOfB {
        match self.pictures() {
            _ if options.rectify.is_some() => MeaningOfB::in_plane(),
            Some(pictures) => pictures.meaning_of_b(options.scale),
            None => MeaningOfB::in_coordinates(options.scale),
        }
    }

    /// As [`open`](Self::open), of objects whose motion is looked for with such options.
    pub(crate) fn open_to_track(
        paths: &[PathBuf],
        (options, of_pictures): (&TrackOptions, &PictureOptions),
        waiting: Waiting,
        verbosity: Verbosity,
    ) -> Result<Self, Failure> {
        let mut input = Self::open(paths, of_pictures, waiting, verbosity)?;
        if let Source::Pictures(pictures) = &mut input.source
            && options.allows_for_tilt()
        {
            pictures.allow_for_tilt();
        }
        Ok(input)
    }

    /// Opens CSV or pictures; standard input where the path is `-`. Names tell them apart, or what they begin with. A terminal shows
    /// that pictures are looked at, unless it is to be quiet.
    pub(crate) fn open(
        paths: &[PathBuf],
        options: &PictureOptions,
        waiting: Waiting,
        verbosity: Verbosity,
    ) -> Result<Self, Failure> {
        let out_of_order = out_of_number_order(paths).map(|pair| pair.map(Path::to_owned));
        Ok(Self { out_of_order, ..Self::open_in_order(paths, options, waiting, verbosity)? })
    }

    fn open_in_order(
        paths: &[PathBuf],
        options: &PictureOptions,
        waiting: Waiting,
        verbosity: Verbosity,
    ) -> Result<Self, Failure> {
        let name = match paths {
            [path] if path.as_os_str() == "-" => "<stdin>".to_owned(),
            [path] => path.display().to_string(),
            [first, rest @ ..] => format!("{} and {} more", first.display(), rest.len()),
            [] => return Err(Failure::unusable("no input is named")),
        };
        if let (Some((table, format)), [_, _, ..]) = (paths.iter().find_map(|path| Some((path, table(path)?))), paths) {
            let reason = format_args!("outlines are read from one {format} file, several inputs are pictures");
            return Err(Failure::unusable(format_args!("{}: {reason}", table.display())));
        }
        if let Some(files) = labelme_files(paths).map_err(Failure::unusable)? {
            return Self::of_polygons(|settings| OutlineFile::open_polygons(&files, settings), name, options);
        }
        let [path] = paths else { return Self::of_pictures(PictureInput::open(paths, options, verbosity)?, name) };
        if path.as_os_str() == "-" {
            return Ok(Self {
                is_stream: true,
                ..Self::from_source(Awaited::stdin(), name, options, (waiting, verbosity))?
            });
        }
        // A pipe can be read once, whatever its name says.
        if fs::metadata(path).is_ok_and(|place| !place.is_file() && !place.is_dir()) {
            let piped = Self::from_source(Awaited::open(path.clone()), name, options, (waiting, verbosity))?;
            return Ok(Self { is_stream: true, ..piped });
        }
        if PictureSequence::is_named_by(path) {
            return Self::of_pictures(PictureInput::open(paths, options, verbosity)?, name);
        }
        match File::open(path) {
            Ok(file) => {
                let mut source = BufReader::new(file);
                let start = source.fill_buf().unwrap_or_default();
                if TableFormat::is_parquet(start) || TableFormat::of(path) == TableFormat::Parquet {
                    refuse_options(&options.given(), &name, "Parquet")?;
                    return Self::of_file(OutlineFile::open_parquet(path), name);
                }
                Self::from_source(source, name, options, (waiting, verbosity))
            }
            Err(error) => Err(Failure::unusable(format_args!("{name}: {}", plain(&error)))),
        }
    }

    fn new(name: String, comments: Vec<String>, source: Source) -> Self {
        Self { name, comments, source, is_stream: false, out_of_order: None, told: OriginWarnings::NONE }
    }

    fn of_pictures(pictures: PictureInput, name: String) -> Result<Self, Failure> {
        Ok(Self::new(name, Vec::new(), Source::Pictures(Box::new(pictures))))
    }

    fn of_file(file: Result<OutlineFile, ReadError>, name: String) -> Result<Self, Failure> {
        let file = file.map_err(Failure::unusable)?;
        let comments = file.comments().lines().map(str::to_owned).collect();
        let source = match file.points() {
            FilePoints::Corners => Source::Polygons(file),
            FilePoints::Measured => Source::File(file),
        };
        Ok(Self::new(name, comments, source))
    }

    fn of_polygons(
        open: impl FnOnce(&PolygonSettings) -> Result<OutlineFile, ReadError>,
        name: String,
        options: &PictureOptions,
    ) -> Result<Self, Failure> {
        let only_for_pictures: Vec<_> =
            options.given().into_iter().filter(|option| !OPTIONS_OF_POLYGONS.contains(option)).collect();
        refuse_options(&only_for_pictures, &name, "polygons")?;
        let vertical = if options.y_down { VerticalAxis::Down } else { VerticalAxis::Up };
        let settings = PolygonSettings { frames_per_second: options.fps, vertical, pixel_size: options.pixel_size };
        Self::of_file(open(&settings), name)
    }

    fn from_source(
        mut source: impl BufRead + 'static,
        name: String,
        options: &PictureOptions,
        (waiting, verbosity): (Waiting, Verbosity),
    ) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::unusable(format_args!("{name}: {}", plain(&error)));
        let start = source.fill_buf().map_err(failed)?;
        if start.is_empty() {
            return Err(Failure::unusable(format_args!("{name}: empty, neither outlines (CSV) nor pictures")));
        }
        if PictureSequence::begins_with(start) {
            let pictures = PictureInput::from_stream(source, &name, options, (waiting, verbosity))?;
            return Self::of_pictures(pictures, name);
        }
        if OutlineFile::begins_like_polygons(start) {
            return Self::of_polygons(
                |settings| OutlineFile::polygons_from(source, &name.clone(), settings),
                name.clone(),
                options,
            );
        }
        refuse_options(&options.given(), &name, "CSV")?;
        let head = read_comments(&mut source).map_err(failed)?;
        let comment = |line: &str| line.trim_start_matches('#').trim().to_owned();
        let comments = String::from_utf8_lossy(&head).lines().map(comment).collect();
        // The head is read again with the rest, so that line numbers are right.
        let whole: Box<dyn Read> = Box::new(Cursor::new(head).chain(source));
        let outlines = OutlineReader::new(whole, name.clone()).map_err(Failure::unusable)?;
        Ok(Self::new(name, comments, Source::Csv(Box::new(outlines))))
    }

    /// Polygons of annotation programs are handed on with their corners alone.
    pub(crate) fn with_corners_alone(self) -> Self {
        match self.source {
            Source::Polygons(polygons) => Self { source: Source::File(polygons), ..self },
            source => Self { source, ..self },
        }
    }

    /// The motion that the head of the file says it was simulated with.
    pub(crate) fn truth(&self) -> Option<SimulatedMotion> {
        self.comments.iter().find_map(|comment| SimulatedMotion::parse(comment))
    }

    /// Number of frames, where it is known before they are read.
    pub(crate) fn frame_count(&self) -> Option<u64> {
        self.pictures().and_then(PictureInput::frame_count)
    }

    /// Whether it comes from standard input or a pipe, which may stand still.
    pub(crate) fn is_stream(&self) -> bool {
        self.is_stream
    }

    /// Whether the outlines come from pictures.
    pub(crate) fn has_pictures(&self) -> bool {
        self.pictures().is_some()
    }

    /// Whether the outlines come from a table with standard deviations of points.
    pub(crate) fn has_deviation_column(&self) -> bool {
        match &self.source {
            Source::Csv(outlines) => outlines.has_deviation_column(),
            Source::File(outlines) | Source::Polygons(outlines) => outlines.has_deviation_column(),
            Source::Pictures(_) => false,
        }
    }

    /// Whether the outlines come from a table that says of its outlines how they were found.
    pub(crate) fn has_warning_column(&self) -> bool {
        match &self.source {
            Source::Csv(outlines) => outlines.has_warning_column(),
            Source::File(outlines) | Source::Polygons(outlines) => outlines.has_warning_column(),
            Source::Pictures(_) => false,
        }
    }

    /// What may be wrong with how its outlines were found, as far as that is known, with the codes.
    pub(crate) fn origin_warnings(&self) -> Vec<(OriginWarning, String)> {
        let mut warnings: Vec<_> =
            self.warning_of_order().map(|told| (OriginWarning::FilesOutOfOrder, told)).into_iter().collect();
        if matches!(&self.source, Source::File(file) | Source::Polygons(file) if file.is_rate_assumed()) {
            let message = format!("{ASSUMED_RATE} frames/s assumed, the file does not say; give the rate with --fps");
            warnings.push((OriginWarning::RateAssumed, message));
        }
        let of_pictures = self.pictures().map(PictureInput::origin_warnings).unwrap_or_default().into_iter();
        warnings.extend(of_pictures.map(|(warning, message)| match warning {
            OriginWarning::Interlaced => (warning, format!("{}: {message}", self.name)),
            _ => (warning, message),
        }));
        warnings.extend(self.told_by_table().iter().map(|warning| (warning, self.of_table(warning))));
        warnings
    }

    /// As that, with what only many outlines together tell, which takes a while to be looked for: after all have been read.
    pub(crate) fn closing_warnings(&self) -> Vec<(OriginWarning, String)> {
        let of_aspect = self.pictures().and_then(PictureInput::warning_of_aspect);
        let of_names = self.pictures().map(|pictures| pictures.warnings_of_names(Purpose::Motions)).unwrap_or_default();
        self.origin_warnings().into_iter().chain(of_aspect).chain(of_names).collect()
    }

    /// What a table has said so far of how its outlines were found.
    pub(crate) fn told_by_table(&self) -> OriginWarnings {
        match &self.source {
            Source::Csv(outlines) => outlines.warnings(),
            Source::File(outlines) | Source::Polygons(outlines) => outlines.warnings(),
            Source::Pictures(_) => OriginWarnings::NONE,
        }
    }

    /// What is known by now of how the outlines were found, beyond what was known before the first.
    pub(crate) fn told_so_far(&self) -> OriginWarnings {
        self.told_by_table().and(self.pictures().map_or(OriginWarnings::NONE, PictureInput::told_so_far))
    }

    fn of_table(&self, warning: OriginWarning) -> String {
        format!("{}: {warning} (column warning: {})", self.name, warning.code())
    }

    /// What the table says of its outlines and has not been told, with the codes.
    pub(crate) fn news(&mut self) -> Vec<(OriginWarning, String)> {
        let new = self.told_by_table().without(self.told);
        self.told = self.told.and(new);
        new.iter().map(|warning| (warning, self.of_table(warning))).collect()
    }

    /// Whether two outlines of one name may be of two things.
    fn may_mistake_one_for_another(&self) -> bool {
        self.pictures().is_some_and(PictureInput::may_mistake_one_for_another)
            || self.told_by_table().contains(OriginWarning::TracingDoubtful)
    }

    /// What the warnings of its results depend on.
    pub(crate) fn result_origin(&self) -> ResultOrigin {
        let tracing = self.pictures().map(PictureInput::tracing).unwrap_or_default();
        let naming = if self.may_mistake_one_for_another() { Naming::InDoubt } else { Naming::Certain };
        ResultOrigin { tracing, naming }
    }

    /// That files were named in another order than their numbers have, as a shell orders them.
    fn warning_of_order(&self) -> Option<String> {
        let [before, after] = self.out_of_order.as_ref()?;
        Some(format!(
            "{} is taken before {}, in the order in which the files are named: a folder, or a pattern in quotes such as 'masks/*.png', is \
             sorted by number",
            before.display(),
            after.display()
        ))
    }

    /// Says how pictures are traced, if that was chosen, and what may be wrong with the input.
    pub(crate) fn tell(&mut self) {
        self.pictures().map(PictureInput::notes).unwrap_or_default().iter().for_each(|told| note(told));
        self.origin_warnings().iter().for_each(|(warning, message)| warn_of(warning.code(), message));
        // Rows that had to be ordered have all been read.
        self.told = self.told.and(self.told_by_table());
        self.pictures().and_then(PictureInput::not_drawn).iter().for_each(|warning| warn(warning));
    }

    /// Says how the pictures are traced where that was chosen, and whether it is not to be trusted.
    pub(crate) fn tell_tracing(&self) {
        self.pictures().map(PictureInput::notes).unwrap_or_default().iter().for_each(|told| note(told));
        let doubts = self.pictures().map(PictureInput::tracing_warnings).unwrap_or_default();
        doubts.iter().for_each(|(warning, message)| warn_of(warning.code(), message));
        self.pictures().and_then(PictureInput::not_drawn).iter().for_each(|warning| warn(warning));
    }

    /// Says what was seen to be wrong while the input was read.
    pub(crate) fn tell_in_the_end(&self, purpose: Purpose) {
        let remarks = self.pictures().map(|pictures| pictures.closing_remarks(purpose)).unwrap_or_default();
        remarks.iter().for_each(|(warning, message)| warn_of(warning.code(), message));
    }

    /// Whether all objects of the last picture have been handed on.
    pub(crate) fn is_picture_over(&self) -> bool {
        self.pictures().is_some_and(PictureInput::is_picture_over)
    }

    /// Whether the outlines are those of labels, which are told without their surroundings.
    pub(crate) fn has_labels(&self) -> bool {
        self.pictures().is_some_and(PictureInput::has_labels)
    }

    /// Marks an object as present in a picture in which it was not traced.
    pub(crate) fn keep(&mut self, object: &str, frame: u64) {
        if let Source::Pictures(pictures) = &mut self.source {
            pictures.keep(object, frame);
        }
    }

    /// The pictures that the outlines come from.
    pub(crate) fn pictures(&self) -> Option<&PictureInput> {
        match &self.source {
            Source::Csv(_) | Source::File(_) | Source::Polygons(_) => None,
            Source::Pictures(pictures) => Some(pictures),
        }
    }
}

impl Iterator for Input {
    type Item = Result<Item, Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        match &mut self.source {
            Source::Pictures(pictures) => pictures.next().map(Ok),
            Source::Csv(outlines) => outlines.next().map(item),
            Source::File(outlines) => outlines.next().map(item),
            Source::Polygons(polygons) => polygons.next().map(|polygon| item(polygon.map(filled))),
        }
    }
}

fn filled(frame: OutlineFrame) -> OutlineFrame {
    OutlineFrame { outline: outline_of_polygon(&frame.outline), ..frame }
}

/// Refuses options that are only for pictures.
fn refuse_options(given: &[&str], name: &str, format: &str) -> Result<(), Failure> {
    match given {
        [] => Ok(()),
        given => {
            let options = given.join(", ");
            Err(Failure::unusable(format_args!("{options}: only for pictures, but {name} was read as {format}")))
        }
    }
}

fn item(outline: Result<OutlineFrame, ReadError>) -> Result<Item, Failure> {
    match outline {
        Ok(frame) => Ok(Item::Outline(frame, None)),
        Err(error) => rejected(error),
    }
}

/// Points that are not an outline are an item; any other error ends the reading.
fn rejected(error: ReadError) -> Result<Item, Failure> {
    let reason = error.to_string();
    match error.kind {
        ReadErrorKind::Degenerate { object, frame, .. } => Ok(Item::NoOutline { object, frame, reason }),
        _ => Err(Failure::unusable(reason)),
    }
}

/// The format of a table that the extension says.
fn table(path: &Path) -> Option<&'static str> {
    if TableFormat::of(path) == TableFormat::Parquet {
        return Some("Parquet");
    }
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")).then_some("CSV")
}
