//! The outlines of the objects of a sequence of pictures, followed from picture to picture.
use std::borrow::Cow;
use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread::{self, Scope, ScopedJoinHandle};
use std::time::{Duration, Instant};

use image::GrayImage;

use crate::ground::background::{Background, Difference, RunningMedian};
use crate::ground::ground_surface::ground_surface;
use crate::identity::contacts::AfterContact;
use crate::identity::identities::{AmongAlike, Identities, Selection};
use crate::picture_file::error::{PictureError, TraceError};
use crate::picture_file::sequence::PictureFrame;
use crate::tracing::contrast::Contrast;
use crate::tracing::input::{GroundComparison, TracingInput};
use crate::tracing::settings::TraceSettings;
use crate::tracing::trace::{TracedOutline, trace_within};

/// Pixels of the pictures that are traced side by side, at most: two pictures of 1920 x 1080, or one that is larger. What is worked with is some
/// tens of bytes for each, which a picture of the largest size takes alone.
const PIXELS_AT_ONCE: usize = 1 << 22;

/// Time that pictures are read ahead for: no longer, so that what has been read is soon dealt with where reading is slow.
const LONGEST_READING: Duration = Duration::from_millis(200);

/// How outlines are found in a sequence of pictures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PictureSettings {
    /// How an outline is traced. With a background, its contrast and threshold are those of the difference.
    pub trace: TraceSettings,
    /// Which objects are taken.
    pub selection: Selection,
    /// What the pictures are compared with, if with anything.
    pub background: Option<Background>,
    /// Which differences from the background belong to an object.
    pub difference: Difference,
}

impl PictureSettings {
    /// Whether they are in their ranges.
    ///
    /// # Errors
    /// A setting out of range.
    pub fn check(&self) -> Result<(), TraceError> {
        self.trace.check()
    }
}

/// One picture and the objects in it.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedFrame {
    /// The picture as it was read.
    pub frame: PictureFrame,
    /// The names of the objects and their outlines, or the reason for their absence.
    pub objects: Result<Vec<(u64, TracedOutline)>, TraceError>,
}

/// The outlines of the objects in a sequence of pictures, one picture after the other, in constant memory.
///
/// ```
/// use freeform_outline_io::{GrayImage, PictureFrame, PictureOutlines, PictureSettings};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let disc = |centre: f64| {
///     GrayImage::from_fn(64, 64, |x, y| {
///         let inside = (f64::from(x) + 0.5 - centre).hypot(f64::from(y) - 31.5) < 12.0;
///         image::Luma([if inside { 200 } else { 20 }])
///     })
/// };
/// let frames = (0..5_u64).map(|frame| {
///     let picture = disc(20.0 + 3.0 * frame as f64);
///     Ok(PictureFrame { frame, time: frame as f64 / 30.0, file: "memory".to_owned(), picture: picture.into() })
/// });
/// for traced in PictureOutlines::new(frames, PictureSettings::default())? {
///     let traced = traced?;
///     let (_, disc) = &traced.objects?[0];
///     assert!((disc.centre.x - 20.0 - 90.0 * traced.frame.time).abs() < 0.1);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct PictureOutlines<S> {
    source: S,
    settings: PictureSettings,
    identities: Identities,
    median: Option<RunningMedian>,
    /// Pictures read ahead for the first median; `None` before they have been read.
    ahead: Option<VecDeque<Result<PictureFrame, PictureError>>>,
    /// Whether the source has ended.
    is_over: bool,
    /// Pictures traced side by side.
    at_once: usize,
    /// Pictures traced and not yet handed on.
    traced: VecDeque<Result<(PictureFrame, TracedObjects), PictureError>>,
    /// Of the last picture traced, which may come again.
    latest: Option<(View, TracedObjects)>,
}

/// What is traced in a picture.
pub(crate) type TracedObjects = Result<Vec<TracedOutline>, TraceError>;

/// What is looked at.
#[derive(Debug, Clone)]
pub(crate) struct View {
    pub(crate) picture: Arc<GrayImage>,
    /// What it is compared with, if with anything; of its own surface only where that is known.
    pub(crate) ground: Option<Arc<GrayImage>>,
}

/// The tracing of a picture.
enum Tracing<'a> {
    Done(TracedObjects),
    Begun(ScopedJoinHandle<'a, TracedObjects>),
    /// The picture before shows the same.
    AsBefore,
}

impl View {
    fn is_same_as(&self, other: &Self) -> bool {
        let is_same_ground = match (&self.ground, &other.ground) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        };
        is_same_ground && Arc::ptr_eq(&self.picture, &other.picture)
    }

    pub(crate) fn traced(&self, settings: &PictureSettings, limit: usize) -> TracedObjects {
        let (margins, rows) = (settings.trace.margins.unwrap_or_default(), self.picture.height());
        let picture = margins.within(&self.picture)?;
        let ground = match (&self.ground, &settings.background) {
            (Some(ground), _) => Some(margins.within(ground)?),
            (None, Some(Background::Surface)) => Some(Cow::Owned(ground_surface(&picture))),
            _ => None,
        };
        let Some(ground) = ground else {
            return trace_within(TracingInput::plain(&picture), rows, &settings.trace, limit);
        };
        let trace = TraceSettings { contrast: Contrast::LightOnDark, ..settings.trace };
        let comparison = GroundComparison { picture: &picture, ground: &ground, difference: settings.difference };
        let input = TracingInput { picture: &comparison.difference()?, comparison: Some(comparison) };
        trace_within(input, rows, &trace, limit)
    }
}

impl<S: Iterator<Item = Result<PictureFrame, PictureError>>> PictureOutlines<S> {
    /// Outlines of these pictures.
    ///
    /// # Errors
    /// A setting out of range.
    pub fn new(source: S, settings: PictureSettings) -> Result<Self, TraceError> {
        settings.trace.check()?;
        let median = match settings.background {
            Some(Background::RunningMedian(size)) if !(3..=255).contains(&size) => {
                let (name, value) = ("background", size as f64);
                return Err(TraceError::Setting { name, value, expected: "3 to 255 pictures" });
            }
            Some(Background::RunningMedian(size)) => Some((RunningMedian::new(size), size)),
            _ => None,
        };
        let ahead = if median.is_some() { None } else { Some(VecDeque::new()) };
        let identities = Identities::new(settings.selection);
        let (median, traced) = (median.map(|(median, _)| median), VecDeque::new());
        Ok(Self { source, settings, identities, median, ahead, is_over: false, at_once: 1, traced, latest: None })
    }

    /// Traces so many pictures side by side from now on, at least one, on threads of their own; fewer where they have more than 2^22 pixels
    /// together, or take long to be read. As many are read ahead, so that the pictures of a camera that runs come late. By default one.
    #[must_use]
    pub fn tracing_at_once(self, pictures: usize) -> Self {
        Self { at_once: pictures.max(1), ..self }
    }

    /// The source of the pictures.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// Marks an object as present in a picture, at most the last one, in which it was not traced: it keeps its name.
    pub fn keep(&mut self, name: u64, frame: u64) {
        self.identities.keep(name, frame);
    }

    /// As [`Identities::after_contact`](crate::Identities::after_contact).
    pub fn after_contact(&self) -> &[AfterContact] {
        self.identities.after_contact()
    }

    /// As [`Identities::among_alike`](crate::Identities::among_alike).
    pub fn among_alike(&self) -> &[AmongAlike] {
        self.identities.among_alike()
    }

    /// The next picture, which the median knows.
    fn next_picture(&mut self) -> Option<Result<PictureFrame, PictureError>> {
        let size = match self.settings.background {
            Some(Background::RunningMedian(size)) => size,
            _ => 0,
        };
        let ahead = match &mut self.ahead {
            Some(ahead) => ahead,
            None => {
                let mut first = VecDeque::new();
                let mut wanted = size;
                while first.len() < wanted
                    && let Some(item) = self.source.next()
                {
                    if let (Some(median), Ok(PictureFrame { picture, .. })) = (&mut self.median, &item) {
                        median.add(picture);
                        wanted = wanted.min(RunningMedian::kept(size, picture));
                    }
                    first.push_back(item);
                }
                self.is_over = first.len() < wanted;
                self.ahead.insert(first)
            }
        };
        if let Some(item) = ahead.pop_front() {
            return Some(item);
        }
        if self.is_over {
            return None;
        }
        let item = self.source.next();
        // The source is not asked again.
        self.is_over = item.is_none();
        let item = item?;
        if let (Some(median), Ok(frame)) = (&mut self.median, &item) {
            median.add(&frame.picture);
        }
        Some(item)
    }

    /// What the picture read last is compared with.
    fn ground(&mut self) -> Option<Arc<GrayImage>> {
        match (&self.settings.background, &mut self.median) {
            (Some(Background::Picture(ground)), _) => Some(ground),
            (Some(Background::RunningMedian(_)), Some(median)) => median.get(),
            _ => None,
        }
        .cloned()
    }

    /// Reads the next pictures and begins to trace them.
    fn begin_tracing<'a>(
        &mut self,
        scope: &'a Scope<'a, '_>,
        settings: &'a PictureSettings,
        limit: usize,
    ) -> Vec<Result<(PictureFrame, View, Tracing<'a>), PictureError>> {
        let mut begun = Vec::new();
        let mut view_before = self.latest.as_ref().map(|(view, _)| view.clone());
        let (mut room, began) = (PIXELS_AT_ONCE, Instant::now());
        while begun.len() < self.at_once
            && (begun.is_empty() || began.elapsed() < LONGEST_READING)
            && let Some(item) = self.next_picture()
        {
            let frame = match item {
                Ok(frame) => frame,
                Err(error) => {
                    begun.push(Err(error));
                    continue;
                }
            };
            let view = View { picture: Arc::clone(&frame.picture), ground: self.ground() };
            let pixels = view.picture.as_raw().len();
            let is_same = view_before.replace(view.clone()).is_some_and(|before| before.is_same_as(&view));
            if !is_same && begun.is_empty() {
                // Makes room before more is needed.
                self.latest = None;
            }
            let tracing = if is_same {
                Tracing::AsBefore
            } else if self.at_once == 1 {
                Tracing::Done(view.traced(settings, limit))
            } else {
                let on_thread = view.clone();
                let begun = thread::Builder::new().spawn_scoped(scope, move || on_thread.traced(settings, limit));
                // The system may have no more threads.
                begun.map_or_else(|_| Tracing::Done(view.traced(settings, limit)), Tracing::Begun)
            };
            begun.push(Ok((frame, view, tracing)));
            room = room.saturating_sub(pixels);
            if room < pixels {
                break;
            }
        }
        begun
    }

    /// Reads the next pictures and traces them.
    fn trace_next(&mut self) {
        let (settings, limit) = (self.settings.clone(), self.identities.limit());
        thread::scope(|scope| {
            for item in self.begin_tracing(scope, &settings, limit) {
                let item = item.map(|(frame, view, tracing)| {
                    let traced = match (tracing, &self.latest) {
                        (Tracing::Done(traced), _) => traced,
                        (Tracing::Begun(thread), _) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
                        (Tracing::AsBefore, Some((_, traced))) => traced.clone(),
                        (Tracing::AsBefore, None) => view.traced(&settings, limit),
                    };
                    self.latest = Some((view, traced.clone()));
                    (frame, traced)
                });
                self.traced.push_back(item);
            }
        });
    }
}

impl<S: Iterator<Item = Result<PictureFrame, PictureError>>> Iterator for PictureOutlines<S> {
    type Item = Result<TracedFrame, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.traced.is_empty() {
            self.trace_next();
        }
        let item = self.traced.pop_front()?;
        Some(item.map(|(frame, traced)| {
            self.identities.set_extent(self.settings.trace.extent(frame.picture.dimensions()));
            let objects = traced.and_then(|traced| self.identities.assign(frame.frame, traced));
            TracedFrame { frame, objects }
        }))
    }
}
