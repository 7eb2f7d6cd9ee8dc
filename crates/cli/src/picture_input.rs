//! Outlines of the objects in pictures.
mod warnings;

use std::collections::VecDeque;
use std::io::{BufRead, Cursor, Read as _};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::available_parallelism;

use freeform_drawing::{MeaningOfB, candidate_sheet};
use freeform_motion::outline_io::{
    Channel, LabelPictures, OutlineUncertainty, PictureError, PictureErrorKind, PicturePreview, PictureSequence,
    PictureSettings, TracedPicture, TracedPictures, TracingEvidence, read_ahead,
};
use freeform_motion::riccati::CameraScale;
use freeform_motion::{PictureTracing, TracedContours, TracedGround, short};
use image::ImageFormat;

use crate::args::{ContoursChoice, ObjectsChoice, PictureOptions, through_ffmpeg};
use crate::awaited::{Awaited, Waiting};
use crate::command_line::{command_line_of_stdin, quoted};
use crate::failure::{Failure, plain};
use crate::interrupt;
use crate::label_choice::{LabelChoice, refused_stream};
use crate::output::WholeFile;
use crate::picture_hints::{hint, missed_bodies};
use crate::picture_settings::{picture_settings, sequence_settings};
use crate::progress::Verbosity;
use crate::seen::{Item, Missing, MissingKind};
use crate::traced_input::Traced;
use crate::tracing_choice::{Chosen, choose, options_of};

pub(crate) use self::warnings::Purpose;

/// Pictures that are traced side by side for each core, so that none stands still while the next ones are read.
const PICTURES_OF_CORE: usize = 2;

/// Frames per second of pictures that do not tell.
pub(crate) const ASSUMED_RATE: u32 = 30;

/// What an object does to the shape that it has in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ShapeInPicture {
    /// It keeps it as it turns, if pixels are what they are taken to be.
    Kept,
    /// It need not: the camera is known to look at it from aside.
    SeenFromAside,
}

/// The outlines in pictures, one object after the other.
pub(crate) struct PictureInput {
    /// What was named for input.
    inputs: Vec<PathBuf>,
    traced: Traced,
    options: PictureOptions,
    chosen: Option<Chosen>,
    /// Whether labels are objects.
    labels: LabelChoice,
    /// What finds bodies that are not followed.
    missed: Option<String>,
    /// Whether nothing was given or chosen, as a stream is not to be waited for.
    is_traced_unseen: bool,
    outline_uncertainty: Option<OutlineUncertainty>,
    shape: ShapeInPicture,
    /// Objects of the present picture that have not been handed on.
    waiting: VecDeque<Item>,
    /// Pictures read.
    frames: u64,
}

impl PictureInput {
    /// Pictures in files, folders and patterns.
    pub(crate) fn open(paths: &[PathBuf], options: &PictureOptions, verbosity: Verbosity) -> Result<Self, Failure> {
        let inputs = paths.to_owned();
        let open = |options: &PictureOptions| {
            // One that nobody writes to must not keep Ctrl-C from ending the work.
            PictureSequence::open(paths, sequence_settings(options))
                .map(|sequence| sequence.with_pipes_opened_by(|pipe| Ok(Box::new(Awaited::open(pipe.to_owned())))))
                .map_err(|error| Failure::unusable(described(&error, paths)))
        };
        let mut sequence = open(options)?;
        let preview = PicturePreview::of_paths(paths, &sequence);
        let base = picture_settings(options, sequence.pixel_aspect(), None)?;
        base.check().map_err(Failure::unusable)?;
        let labels = LabelChoice::of(options, &preview)?;
        if let (LabelChoice::Labels(_), Some(files)) = (labels, preview.single_files()) {
            return Self::of_labels(files.to_vec(), inputs, options, labels);
        }
        let (options, chosen) = choose(&preview, &base, options, verbosity);
        draw_candidates(options.candidates.as_deref(), &preview, &base, chosen.as_ref())?;
        if chosen.is_some() && options.channel().channel() != Channel::Luminance {
            sequence = open(&options)?;
        }
        let missed = chosen
            .as_ref()
            .and_then(|_| missed_bodies(&preview, &picture_settings(&options, None, None).ok()?, &options));
        let is_read_once = preview.is_read_once();
        let is_traced_unseen = is_read_once && chosen.is_none() && !options.has_way();
        let mut input = Self::of(sequence, Some(preview), inputs, (options, chosen))?;
        if !is_read_once {
            // Nobody waits for what is in files.
            let cores = available_parallelism().map_or(1, NonZero::get);
            input.traced = input.traced.tracing_at_once(PICTURES_OF_CORE * cores);
        }
        input.is_traced_unseen = is_traced_unseen;
        (input.labels, input.missed) = (labels, missed);
        Ok(input)
    }

    /// Label masks in files.
    fn of_labels(
        files: Vec<PathBuf>,
        inputs: Vec<PathBuf>,
        options: &PictureOptions,
        labels: LabelChoice,
    ) -> Result<Self, Failure> {
        let settings = picture_settings(options, None, None)?;
        let traced = LabelPictures::new(files, options.fps, settings.trace).map_err(Failure::unusable)?;
        Ok(Self {
            inputs,
            traced: Traced::Labels(Box::new(traced)),
            options: PictureOptions { objects: Some(ObjectsChoice::Labels), ..options.clone() },
            chosen: None,
            labels,
            missed: None,
            is_traced_unseen: false,
            outline_uncertainty: Some(OutlineUncertainty::MaskPixel(settings.trace.pixel())),
            shape: ShapeInPicture::Kept,
            waiting: VecDeque::new(),
            frames: 0,
        })
    }

    /// Pictures in a stream.
    pub(crate) fn from_stream(
        mut source: impl BufRead + 'static,
        name: &str,
        options: &PictureOptions,
        (waiting, verbosity): (Waiting, Verbosity),
    ) -> Result<Self, Failure> {
        let inputs = vec![PathBuf::from(name)];
        if options.objects == Some(ObjectsChoice::Labels) {
            return Err(refused_stream());
        }
        if (options.has_way() || waiting == Waiting::None) && !options.compares_with_whole() {
            let sequence = PictureSequence::from_stream(source, name, sequence_settings(options))
                .map_err(|error| Failure::unusable(described(&error, &inputs)))?;
            let mut input = Self::of(sequence, None, inputs, (options.clone(), None))?;
            input.is_traced_unseen = !options.has_way();
            return Ok(input);
        }
        if waiting != Waiting::Allowed {
            interrupt::listen();
        }
        let beginning = read_ahead(&mut source);
        let beginning = beginning.map_err(|error| Failure::unusable(format_args!("{name}: {}", plain(&error))))?;
        // What has come until then is dealt with as a whole, and no more is waited for.
        let is_over = interrupt::was_asked_for();
        if is_over {
            interrupt::put_off();
        }
        let preview = PicturePreview::Beginning(Arc::clone(&beginning));
        let settings = picture_settings(options, None, None)?;
        let (options, chosen) = choose(&preview, &settings, options, verbosity);
        draw_candidates(options.candidates.as_deref(), &preview, &settings, chosen.as_ref())?;
        let rest = source.take(if is_over { 0 } else { u64::MAX });
        let sequence =
            PictureSequence::from_stream(Cursor::new(beginning).chain(rest), name, sequence_settings(&options))
                .map_err(|error| Failure::unusable(described(&error, &inputs)))?;
        Self::of(sequence, Some(preview), inputs, (options, chosen))
    }

    fn of(
        sequence: PictureSequence,
        preview: Option<PicturePreview>,
        inputs: Vec<PathBuf>,
        (options, chosen): (PictureOptions, Option<Chosen>),
    ) -> Result<Self, Failure> {
        let settings = picture_settings(&options, sequence.pixel_aspect(), preview.as_ref())?;
        if options.compares_with_whole() && settings.background.is_none() {
            return Err(Failure::unusable(
                "--background whole: the pictures cannot be read ahead; give --background FILE or median",
            ));
        }
        let outline_uncertainty =
            preview.and_then(|preview| preview.outline_uncertainty(&settings, options.channel().channel()));
        let traced = TracedPictures::new(sequence, settings).map_err(Failure::unusable)?;
        Ok(Self {
            inputs,
            traced: Traced::Greys(Box::new(traced)),
            options,
            chosen,
            labels: LabelChoice::Greys,
            missed: None,
            is_traced_unseen: false,
            outline_uncertainty,
            shape: ShapeInPicture::Kept,
            waiting: VecDeque::new(),
            frames: 0,
        })
    }

    /// The options, with what was chosen.
    pub(crate) fn options(&self) -> &PictureOptions {
        &self.options
    }

    /// Takes it to be known that the camera looks at the objects from aside, so that what their shapes do says nothing of the pixels.
    pub(crate) fn allow_for_tilt(&mut self) {
        self.shape = ShapeInPicture::SeenFromAside;
    }

    /// How far the outlines may lie off; `None` where nothing tells.
    pub(crate) fn outline_uncertainty(&self) -> Option<OutlineUncertainty> {
        self.outline_uncertainty
    }

    /// What should be known of how the pictures are traced.
    pub(crate) fn notes(&self) -> Vec<String> {
        let unseen = "a stream is traced as it comes: --light is taken, as nothing else is given; 'freeform identify' on a piece of it \
                      prints the options that suit it";
        let unseen = self.is_traced_unseen.then(|| unseen.to_owned());
        self.labels
            .note()
            .into_iter()
            .chain(self.chosen.iter().map(Chosen::note))
            .chain(unseen)
            .chain(self.missed.clone())
            .collect()
    }

    /// Whether the way of tracing was chosen, and may show something else than an object.
    fn is_tracing_in_doubt(&self) -> bool {
        self.chosen.as_ref().is_some_and(|chosen| !chosen.choice.is_convincing())
    }

    /// How objects are traced, as far as another choice may show more.
    pub(crate) fn tracing(&self) -> PictureTracing {
        if self.has_labels() {
            return PictureTracing::default();
        }
        let contours = match (&self.chosen, self.options.contours) {
            // Where the way was chosen, steady ones have been looked for.
            (_, Some(ContoursChoice::All)) | (Some(_), None) => TracedContours::AllKnown,
            (_, Some(ContoursChoice::Boundary)) | (None, None) => TracedContours::BoundaryAlone,
        };
        let is_mask = matches!(self.outline_uncertainty, Some(OutlineUncertainty::MaskPixel(_)));
        let ground = if self.options.background.is_some() {
            TracedGround::Background
        } else if self.options.ring.is_some() || is_mask {
            TracedGround::Unknown
        } else {
            TracedGround::GreyValues
        };
        PictureTracing { ground, contours }
    }

    /// Whether two outlines of one name may be of two things: the way of tracing is in doubt, or there are more than two pictures, in the others of
    /// which what bears the name was not seen.
    pub(crate) fn may_mistake_one_for_another(&self) -> bool {
        !self.has_labels() && (self.is_tracing_in_doubt() || self.frame_count().is_none_or(|count| count > 2))
    }

    /// That the ways of tracing that were asked for are not drawn.
    pub(crate) fn not_drawn(&self) -> Option<String> {
        let drawn = self.options.candidates.as_deref().filter(|_| self.chosen.is_none());
        drawn.map(|path| format!("{}: not written, as no way of tracing was chosen", path.display()))
    }

    /// Whether every label is an object.
    pub(crate) fn has_labels(&self) -> bool {
        matches!(self.labels, LabelChoice::Labels(_))
    }

    /// Whether all objects of the last picture have been handed on.
    pub(crate) fn is_picture_over(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Marks an object as present in a picture in which it was not traced, so that it keeps its name.
    pub(crate) fn keep(&mut self, object: &str, frame: u64) {
        self.traced.keep(object, frame);
    }

    /// Number of pictures, where it is known.
    pub(crate) fn frame_count(&self) -> Option<u64> {
        self.traced.frame_count()
    }

    /// Which velocity b is in these pictures.
    pub(crate) fn meaning_of_b(&self, scale: Option<CameraScale>) -> MeaningOfB {
        MeaningOfB::in_pictures(self.options.y_down, self.options.pixel_size, self.traced.trace().pixel_aspect, scale)
    }

    /// How outlines were found, as a report lists it: the options, and what those that were left open came to.
    pub(crate) fn listed(&self) -> Vec<(&'static str, String)> {
        let (options, trace, found) = (&self.options, self.traced.trace(), self.traced.summary());
        let mut listed = options.listed();
        listed.extend(self.chosen.as_ref().map(|chosen| ("Tracing chosen", chosen.options.clone())));
        let rate = found.last.filter(|(_, time)| *time > 0.0).map(|(frame, time)| short(frame as f64 / time));
        let rate = match (options.fps, rate) {
            (Some(fps), _) => fps.to_string(),
            (None, Some(rate)) if self.frame_count().is_some() => format!("{rate}, assumed, as none is given"),
            (None, Some(rate)) => format!("{rate}, of the video or animation"),
            (None, None) => "unknown from one picture".to_owned(),
        };
        listed.push(("Frames per second", rate));
        match (trace.ring, found.size) {
            (Some(ring), Some((columns, rows))) => {
                let by_default = if ring.width.is_none() { ", a sixtieth of the shorter side" } else { "" };
                let width = short(ring.widest(columns, rows));
                listed.push(("Widest line expected", format!("{width} pixels{by_default}")));
            }
            (Some(_), None) => {}
            (None, _) => listed.push((
                "Smoothing",
                options.smoothing.map_or_else(
                    || "1 pixel in masks, 0.5 pixels in others".to_owned(),
                    |sigma| format!("{sigma} pixels"),
                ),
            )),
        }
        // Given levels and rings have no threshold of Otsu's.
        if let (None, None, Some((low, high))) = (trace.ring, options.threshold, found.thresholds) {
            let of = if options.background.is_some() { "differences from the background" } else { "grey values" };
            let [low, high] = [low, high].map(short);
            let range = if low == high { low } else { format!("{low} to {high}") };
            listed.push(("Thresholds by Otsu", format!("{range} ({of})")));
        }
        listed.push(("Pixel width over height", trace.pixel_aspect.to_string()));
        listed
    }

    fn read_picture(&mut self) -> Option<()> {
        let traced = self.traced.next()?;
        let frame = self.frames;
        self.frames += 1;
        match traced {
            Err(error) => {
                let (reason, kind) = (described(&error, &self.inputs), MissingKind::from(&error.kind));
                let missing = Missing { frame, file: error.file, reason, hint: None, kind, seen_in: None };
                self.waiting.push_back(Item::Gap(missing));
            }
            Ok(TracedPicture { source, file, outlines: Err(error) }) => {
                let reason = format!("{file}: frame {}: {error}", source.frame);
                let (hint, kind) = (hint(&error, &self.options), MissingKind::from(&error));
                let missing = Missing { frame: source.frame, file, reason, hint, kind, seen_in: Some(source) };
                self.waiting.push_back(Item::Gap(missing));
            }
            Ok(TracedPicture { source, outlines: Ok(outlines), .. }) => {
                self.waiting.extend(outlines.into_iter().map(|outline| Item::Outline(outline, Some(source.clone()))));
            }
        }
        Some(())
    }
}

impl Iterator for PictureInput {
    type Item = Item;

    fn next(&mut self) -> Option<Item> {
        while self.waiting.is_empty() {
            self.read_picture()?;
        }
        self.waiting.pop_front()
    }
}

/// Draws the best ways of a choice where that is asked for and there was one.
fn draw_candidates(
    path: Option<&Path>,
    preview: &PicturePreview,
    base: &PictureSettings,
    chosen: Option<&Chosen>,
) -> Result<(), Failure> {
    let Some((path, Chosen { choice, .. })) = path.zip(chosen) else { return Ok(()) };
    let name = |candidate: &TracingEvidence| options_of(&candidate.tracing).join(" ");
    let sheet = candidate_sheet(preview, &choice.base(base), &choice.candidates, name);
    let mut bytes = Cursor::new(Vec::new());
    let written = sheet.write_to(&mut bytes, ImageFormat::Png);
    written.map_err(|error| Failure::unusable(format_args!("{}: {error}", path.display())))?;
    WholeFile::write_bytes(path, bytes.get_ref())
}

/// An error, and what to do about it where that is known.
fn described(error: &PictureError, inputs: &[PathBuf]) -> String {
    match error.kind {
        PictureErrorKind::CompressedVideo { .. } => {
            let video = if error.file == "<stdin>" { "video.mp4".to_owned() } else { quoted(&error.file) };
            format!("{error}; pipe it: {}", through_ffmpeg(&video, &command_line_of_stdin(inputs)))
        }
        _ => plain(error),
    }
}
