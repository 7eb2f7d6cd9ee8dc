//! Outlines with their pictures, as a tracker takes them.
use crate::frame::OutlineFrame;
use crate::identity::contacts::AfterContact;
use crate::identity::identities::AmongAlike;
use crate::picture_file::error::{PictureError, TraceError};
use crate::picture_file::sequence::PictureFrame;
use crate::picture_file::source_picture::SourcePicture;
use crate::picture_outlines::{PictureOutlines, PictureSettings, TracedFrame};
use crate::pixel_aspect::PixelAspectCheck;
use crate::tracing::settings::TraceSettings;

/// The outlines of a sequence of pictures as a tracker takes them, with the pictures, and what the settings that were left open came to.
///
/// ```
/// use freeform_outline_io::{GrayImage, PictureFrame, PictureSettings, TracedPictures};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let disc = |x: u32, y: u32| image::Luma([if x.abs_diff(32).pow(2) + y.abs_diff(32).pow(2) < 144 { 200 } else { 20 }]);
/// let frames = (0..3_u64).map(|frame| {
///     let (picture, file) = (GrayImage::from_fn(64, 64, disc).into(), "memory".to_owned());
///     Ok(PictureFrame { frame, time: frame as f64 / 30.0, file, picture })
/// });
/// let mut pictures = TracedPictures::new(frames, PictureSettings::default())?;
/// for traced in pictures.by_ref() {
///     let traced = traced?;
///     assert_eq!((traced.outlines?.len(), traced.source.picture.width()), (1, 64));
/// }
/// assert_eq!(pictures.summary().size, Some((64, 64)));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct TracedPictures<I> {
    outlines: PictureOutlines<I>,
    trace: TraceSettings,
    summary: TracingSummary,
    /// Of the first object.
    aspect: PixelAspectCheck,
}

/// A picture and the outlines of its objects.
#[derive(Debug)]
pub struct TracedPicture {
    /// The picture.
    pub source: SourcePicture,
    /// The file that it was read from.
    pub file: String,
    /// The outlines, under the numbers of their objects as names; or why there are none.
    pub outlines: Result<Vec<OutlineFrame>, TraceError>,
}

/// What settings that were left open came to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TracingSummary {
    /// Lowest and highest grey value on an outline.
    pub thresholds: Option<(f64, f64)>,
    /// Columns and rows of the pictures.
    pub size: Option<(u32, u32)>,
    /// Of the last picture: its number and time in seconds.
    pub last: Option<(u64, f64)>,
}

impl<I: Iterator<Item = Result<PictureFrame, PictureError>>> TracedPictures<I> {
    /// The objects of pictures.
    ///
    /// # Errors
    ///
    /// A setting out of range.
    pub fn new(source: I, settings: PictureSettings) -> Result<Self, TraceError> {
        let trace = settings.trace;
        let outlines = PictureOutlines::new(source, settings)?;
        Ok(Self { outlines, trace, summary: TracingSummary::default(), aspect: PixelAspectCheck::default() })
    }

    /// Traces so many pictures side by side, as [`PictureOutlines::tracing_at_once`].
    #[must_use]
    pub fn tracing_at_once(self, pictures: usize) -> Self {
        Self { outlines: self.outlines.tracing_at_once(pictures), ..self }
    }

    /// Where the pictures come from.
    pub fn source(&self) -> &I {
        self.outlines.source()
    }

    /// How outlines are traced.
    pub const fn trace(&self) -> &TraceSettings {
        &self.trace
    }

    /// Marks an object as present in a picture in which it was not traced, so that it keeps its name.
    pub fn keep(&mut self, object: &str, frame: u64) {
        if let Ok(name) = object.parse() {
            self.outlines.keep(name, frame);
        }
    }

    /// As [`Identities::after_contact`](crate::Identities::after_contact).
    pub fn after_contact(&self) -> &[AfterContact] {
        self.outlines.after_contact()
    }

    /// As [`Identities::among_alike`](crate::Identities::among_alike).
    pub fn among_alike(&self) -> &[AmongAlike] {
        self.outlines.among_alike()
    }

    /// What the settings that were left open have come to so far.
    pub const fn summary(&self) -> TracingSummary {
        self.summary
    }

    /// The width of a pixel over its height with which the first object keeps its shape as it turns, where the one of the settings does not do
    /// that.
    pub fn better_pixel_aspect(&self) -> Option<f64> {
        Some(self.aspect.stretch()? * self.trace.pixel_aspect)
    }

    fn take(&mut self, TracedFrame { frame, objects }: TracedFrame) -> TracedPicture {
        if let Some((0, first)) = objects.as_ref().ok().and_then(|objects| objects.first()) {
            self.aspect.take(&first.outline);
        }
        self.summary.size.get_or_insert(frame.picture.dimensions());
        self.summary.last = Some((frame.frame, frame.time));
        for threshold in objects.iter().flatten().map(|(_, traced)| traced.threshold) {
            let (low, high) = self.summary.thresholds.unwrap_or((threshold, threshold));
            self.summary.thresholds = Some((low.min(threshold), high.max(threshold)));
        }
        let PictureFrame { frame, time, file, picture } = frame;
        let outlines = objects.map(|objects| {
            let outlines = objects.into_iter().map(|(name, traced)| (name.to_string(), traced.outline));
            outlines.map(|(object, outline)| OutlineFrame { frame, time, object, outline }).collect()
        });
        let source = SourcePicture { frame, time, grid: self.trace.pixel_grid(picture.height()), picture };
        TracedPicture { source, file, outlines }
    }
}

impl<I: Iterator<Item = Result<PictureFrame, PictureError>>> Iterator for TracedPictures<I> {
    type Item = Result<TracedPicture, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.outlines.next()?.map(|traced| self.take(traced)))
    }
}
