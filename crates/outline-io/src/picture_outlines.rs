use std::collections::VecDeque;
use std::sync::Arc;

use image::GrayImage;

use crate::background::{Background, Difference, RunningMedian};
use crate::contrast::Contrast;
use crate::ground_surface::ground_surface;
use crate::identity::{Identities, Selection};
use crate::picture_error::{PictureError, TraceError};
use crate::picture_sequence::PictureFrame;
use crate::trace::{TracedOutline, trace_objects};
use crate::trace_settings::TraceSettings;

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
    latest: Option<Latest>,
}

/// What was seen in a picture, which may come again.
#[derive(Debug)]
struct Latest {
    picture: Arc<GrayImage>,
    /// What it was compared with.
    ground: Option<Arc<GrayImage>>,
    traced: Result<Vec<TracedOutline>, TraceError>,
}

impl Latest {
    fn is_of(&self, picture: &Arc<GrayImage>, ground: Option<&Arc<GrayImage>>) -> bool {
        let is_same_ground = match (&self.ground, ground) {
            (Some(before), Some(now)) => Arc::ptr_eq(before, now),
            (before, now) => before.is_none() && now.is_none(),
        };
        is_same_ground && Arc::ptr_eq(&self.picture, picture)
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
        Ok(Self { source, settings, identities, median: median.map(|(median, _)| median), ahead, latest: None })
    }

    /// The source of the pictures.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// Takes it that an object was in a picture, at most the last one, although it was not traced there: it keeps its name.
    pub fn keep(&mut self, name: u64, frame: u64) {
        self.identities.keep(name, frame);
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
                self.ahead.insert(first)
            }
        };
        if let Some(item) = ahead.pop_front() {
            return Some(item);
        }
        let item = self.source.next()?;
        if let (Some(median), Ok(frame)) = (&mut self.median, &item) {
            median.add(&frame.picture);
        }
        Some(item)
    }

    fn objects(&mut self, frame: &PictureFrame) -> Result<Vec<(u64, TracedOutline)>, TraceError> {
        let ground = match (&self.settings.background, &mut self.median) {
            (Some(Background::Picture(ground)), _) => Some(ground),
            (Some(Background::RunningMedian(_)), Some(median)) => median.get(),
            _ => None,
        };
        let picture = &frame.picture;
        if let Some(latest) = self.latest.as_ref().filter(|latest| latest.is_of(picture, ground)) {
            return self.identities.assign(frame.frame, latest.traced.clone()?);
        }
        // Makes room before more is needed.
        self.latest = None;
        let limit = self.identities.limit();
        let surface = match self.settings.background {
            Some(Background::Surface) => Some(Arc::new(ground_surface(picture))),
            _ => None,
        };
        let traced = match surface.as_ref().or(ground) {
            None => trace_objects(picture, &self.settings.trace, limit),
            Some(ground) => {
                let settings = TraceSettings { contrast: Contrast::LightOnDark, ..self.settings.trace };
                let difference = checked_difference(self.settings.difference, picture, ground);
                difference.and_then(|difference| trace_objects(&difference, &settings, limit))
            }
        };
        self.latest = Some(Latest { picture: Arc::clone(picture), ground: ground.cloned(), traced: traced.clone() });
        self.identities.assign(frame.frame, traced?)
    }
}

fn checked_difference(
    difference: Difference,
    picture: &GrayImage,
    ground: &GrayImage,
) -> Result<GrayImage, TraceError> {
    let (width, height) = picture.dimensions();
    let (background_width, background_height) = ground.dimensions();
    if (width, height) != (background_width, background_height) {
        return Err(TraceError::BackgroundSize { width, height, background_width, background_height });
    }
    Ok(difference.of(picture, ground))
}

impl<S: Iterator<Item = Result<PictureFrame, PictureError>>> Iterator for PictureOutlines<S> {
    type Item = Result<TracedFrame, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.next_picture()?.map(|frame| {
            let objects = self.objects(&frame);
            TracedFrame { frame, objects }
        }))
    }
}
