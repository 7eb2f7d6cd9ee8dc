//! A first look at pictures: how they are best traced, and how well their outlines are known.
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;

use image::GrayImage;

use crate::choice::{PictureSample, SamplePlan, TracingChoice, choose_tracing};
use crate::edges::{EdgeFit, median};
use crate::ground::background::Background;
use crate::ground::ground_picture::ground_picture;
use crate::identity::identities::Selection;
use crate::labels::evidence::LabelEvidence;
use crate::labels::pictures::LabelPicture;
use crate::picture_file::channel::Channel;
use crate::picture_file::error::PictureError;
use crate::picture_file::files::picture_files;
use crate::picture_file::picture::{read_picture_channel, read_picture_channels};
use crate::picture_file::sequence::{PictureFrame, PictureSequence, SequenceSettings};
use crate::picture_outlines::{PictureOutlines, PictureSettings, TracedFrame};
use crate::tracing::flat_bodies::level_of_missed;
use crate::tracing::settings::TraceSettings;
use crate::tracing::trace::is_two_valued;
use crate::whole_pixels;

/// Fewest pictures that tell how objects are best found.
const FEWEST_PICTURES: usize = 3;

/// Pictures whose edges tell how well outlines are known.
const EDGES_LOOKED_AT: usize = 6;

/// Share of those that are blurred by motion whose edges are no farther off than is said.
const BLURRED_UP_TO: f64 = 0.8;

/// Pictures whose edges and steps tell whether they are drawn on whole pixels: a speed that is off a whole number of pixels by a tenth shows a step
/// of another pixel in one picture of ten.
const STEPS_LOOKED_AT: usize = 12;

/// Pictures that tell whether they are label masks.
const LABELS_LOOKED_AT: usize = 12;

/// Pictures that tell whether bodies of other grey values are left out.
const FLAT_LOOKED_AT: usize = 4;

/// Most pixels of these pictures, all together: those of one of the largest.
const EDGE_PIXELS: usize = 1 << 26;

/// Pixels of all pictures that a ground is the median of.
const GROUND_PIXELS: usize = 1 << 28;

/// How far the outlines of a sequence may lie off, in their unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OutlineUncertainty {
    /// As far as their edges say.
    Edges(f64),
    /// As the rounding of masks whose pixels have this size.
    MaskPixel(f64),
}

/// Pictures that can be looked at before they are read for good, to choose how they are traced.
///
/// ```
/// use freeform_outline_io::{Channel, PicturePreview, PictureSequence, SequenceSettings};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("0.png");
/// # image::GrayImage::from_fn(40, 30, |x, y| image::Luma([if x.abs_diff(20) + y.abs_diff(15) < 9 { 255 } else { 0 }])).save(&path)?;
/// let paths = [path];
/// let sequence = PictureSequence::open(&paths, SequenceSettings::default())?;
/// let preview = PicturePreview::of_paths(&paths, &sequence);
/// let sample = preview.sample(&[Channel::Luminance]);
/// assert_eq!((sample.len(), preview.ground(Channel::Luminance).is_some()), (1, true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub enum PicturePreview {
    /// Files of one picture each.
    Pictures(Vec<PathBuf>),
    /// Files some of which hold several.
    Files(Vec<PathBuf>),
    /// The beginning of a stream.
    Beginning(Arc<[u8]>),
}

/// The files of these numbers that can be opened: to open a pipe among them is to wait for somebody who writes to it.
fn wanted_of(files: &[PathBuf], frames: Vec<u64>) -> impl Iterator<Item = (u64, PathBuf)> + use<> {
    let wanted: Vec<(u64, PathBuf)> = frames.into_iter().map(|k| (k, files[k as usize].clone())).collect();
    wanted.into_iter().filter(|(_, path)| path.is_file())
}

/// Pictures of a sample, one after the other.
type Previewed = Box<dyn Iterator<Item = Result<PictureFrame, PictureError>>>;

impl PicturePreview {
    /// That of files, folders and patterns, which have been opened as a sequence.
    #[must_use]
    pub fn of_paths(paths: &[PathBuf], sequence: &PictureSequence) -> Self {
        let files: Result<Vec<Vec<PathBuf>>, PictureError> = paths.iter().map(|path| picture_files(path)).collect();
        match files {
            Ok(files) if sequence.frame_count().is_some() => Self::Pictures(files.concat()),
            _ => Self::Files(paths.to_owned()),
        }
    }

    /// Whether nothing can be looked at before it is read for good, as what is no file can be read only once.
    #[must_use]
    pub fn is_read_once(&self) -> bool {
        let is_pipe = |path: &PathBuf| path.exists() && !path.is_file() && !path.is_dir();
        matches!(self, Self::Files(paths) if paths.iter().any(is_pipe))
    }

    fn plan(&self) -> SamplePlan {
        match self {
            Self::Pictures(files) => SamplePlan::Spread(files.len() as u64),
            _ => SamplePlan::Ahead,
        }
    }

    /// The pictures of a sample, in one channel; `None` where nothing can be looked at.
    #[must_use]
    pub fn pictures(&self, channel: Channel) -> Option<Previewed> {
        let settings = SequenceSettings { frames_per_second: None, channel };
        let frames = self.plan().frames();
        let sequence = match self {
            Self::Pictures(files) => {
                return Some(Box::new(wanted_of(files, frames).filter_map(move |(frame, path)| {
                    let picture = PictureSequence::open(&[path], settings).ok()?.next()?;
                    Some(picture.map(|picture| PictureFrame { frame, ..picture }))
                })));
            }
            Self::Files(_) if self.is_read_once() => return None,
            Self::Files(paths) => PictureSequence::open(paths, settings).ok()?,
            Self::Beginning(bytes) => {
                PictureSequence::from_stream(Cursor::new(Arc::clone(bytes)), "<preview>", settings).ok()?
            }
        };
        let last = frames.last().copied().unwrap_or(0);
        let is_ahead = move |picture: &Result<PictureFrame, PictureError>| {
            picture.as_ref().is_ok_and(|picture| picture.frame <= last)
        };
        let is_wanted = move |picture: &Result<PictureFrame, PictureError>| {
            picture.as_ref().is_ok_and(|picture| frames.binary_search(&picture.frame).is_ok())
        };
        Some(Box::new(sequence.take_while(is_ahead).filter(is_wanted)))
    }

    /// A sample in these channels.
    #[must_use]
    pub fn sample(&self, channels: &[Channel]) -> PictureSample {
        match self {
            // Colour pictures are decoded once for all channels.
            Self::Pictures(files) => {
                let wanted = wanted_of(files, self.plan().frames());
                PictureSample::read_at_once(channels, |channels| {
                    wanted.map(move |(frame, path)| Ok((frame, read_picture_channels(&path, &channels)?)))
                })
            }
            _ => PictureSample::read(channels, |channel| self.pictures(channel)),
        }
    }

    /// Chooses how objects are told from the ground, in one of these channels, by [`choose_tracing`](crate::choose_tracing); `None` where too few
    /// pictures can be looked at, or no way finds anything. What is not chosen is as in `base`.
    #[must_use]
    pub fn choose_tracing(&self, channels: &[Channel], base: &PictureSettings) -> Option<TracingChoice> {
        let sample = self.sample(channels);
        if sample.len() < FEWEST_PICTURES {
            return None;
        }
        Some(choose_tracing(&sample, base, &[])).filter(|choice| choice.best().is_some())
    }

    /// The files, where each holds one picture.
    #[must_use]
    pub fn single_files(&self) -> Option<&[PathBuf]> {
        match self {
            Self::Pictures(files) => Some(files),
            Self::Files(_) | Self::Beginning(_) => None,
        }
    }

    /// What speaks for it that the pictures are label masks, by some of them; `None` where they are none.
    #[must_use]
    pub fn label_evidence(&self) -> Option<LabelEvidence> {
        LabelEvidence::of(self.some_files(LABELS_LOOKED_AT)?.map(|path| LabelPicture::read_with_ground_around(path)))
    }

    /// Difference from the ground, in grey values, by which the bodies of drawn pictures are told from it where these settings, which compare with no
    /// background, leave some of them out in most pictures; `None` where they do not, or the pictures are no drawings.
    #[must_use]
    pub fn level_of_missed(&self, trace: &TraceSettings, channel: Channel) -> Option<f64> {
        let mut levels = Vec::new();
        let mut pictures = 0;
        for path in self.some_files(FLAT_LOOKED_AT)? {
            pictures += 1;
            levels
                .extend(read_picture_channel(path, channel).ok().and_then(|picture| level_of_missed(&picture, trace)));
            if 2 * levels.len() < pictures {
                return None;
            }
        }
        levels.into_iter().min_by(f64::total_cmp)
    }

    /// Some files of single pictures, spread over all of them.
    fn some_files(&self, count: usize) -> Option<impl Iterator<Item = &PathBuf>> {
        let files = self.single_files()?;
        let step = files.len().div_ceil(count).max(1);
        Some(files.iter().step_by(step).filter(|path| path.is_file()))
    }

    /// How far outlines that are traced with these settings may lie off, by some of the pictures; `None` where nothing tells.
    #[must_use]
    pub fn outline_uncertainty(&self, settings: &PictureSettings, channel: Channel) -> Option<OutlineUncertainty> {
        let mut pixels = 0;
        let is_looked_at = |frame: &PictureFrame| {
            pixels += frame.picture.as_raw().len();
            pixels <= EDGE_PIXELS
        };
        let pictures: Vec<PictureFrame> =
            self.pictures(channel)?.flatten().take(STEPS_LOOKED_AT).take_while(is_looked_at).collect();
        if !pictures.is_empty() && pictures.iter().all(|frame| is_two_valued(&frame.picture)) {
            return Some(OutlineUncertainty::MaskPixel(settings.trace.pixel()));
        }
        if matches!(settings.background, Some(Background::RunningMedian(_))) || settings.trace.ring.is_some() {
            return None;
        }
        let traced = |count: usize, selection: Selection| {
            let pictures = pictures.iter().take(count).cloned().map(Ok);
            let traced = PictureOutlines::new(pictures, PictureSettings { selection, ..settings.clone() }).ok()?;
            Some(traced.flatten().collect::<Vec<TracedFrame>>())
        };
        let selection = match settings.selection {
            Selection::Largest | Selection::Nearest => Selection::Largest,
            Selection::All | Selection::Moving => Selection::All,
        };
        // What is drawn on whole pixels is off as masks are.
        let objects = traced(STEPS_LOOKED_AT, selection)?;
        if whole_pixels::are_drawn_on(&objects, &settings.trace) {
            return Some(OutlineUncertainty::MaskPixel(settings.trace.pixel()));
        }
        let largest = match selection {
            Selection::Largest => objects,
            _ => traced(EDGES_LOOKED_AT, Selection::Largest)?,
        };
        let outlines = largest.iter().take(EDGES_LOOKED_AT).flat_map(|traced| traced.objects.iter().flatten());
        let edges: Vec<&EdgeFit> = outlines.filter_map(|(_, traced)| traced.edges.as_ref()).collect();
        let usual = median(edges.iter().map(|fit| fit.systematic))?;
        // Blur by motion comes and goes with the speed: what it makes of edges is there for the pictures that have it, if it is seen in some.
        let mut by_motion: Vec<f64> =
            edges.iter().filter(|fit| fit.motion_blur > 0.0).map(|fit| fit.systematic_by_motion).collect();
        if 3 * by_motion.len() < edges.len() {
            by_motion.clear();
        }
        by_motion.sort_by(f64::total_cmp);
        let by_motion = by_motion.get((BLURRED_UP_TO * by_motion.len() as f64) as usize).copied().unwrap_or(0.0);
        Some(OutlineUncertainty::Edges(usual.hypot(by_motion)))
    }

    /// The [ground](ground_picture) by the pictures of the sample, at their full size; `None` where nothing can be looked at.
    #[must_use]
    pub fn ground(&self, channel: Channel) -> Option<Arc<GrayImage>> {
        let mut pictures = Vec::new();
        let mut pixels = 0;
        for PictureFrame { picture, .. } in self.pictures(channel)?.flatten() {
            pixels += picture.as_raw().len();
            if pictures.len() >= 3 && pixels > GROUND_PIXELS {
                break;
            }
            pictures.push(picture);
        }
        // Bursts show nearly the same three times: one of each is as good, and the others make the median no worse.
        ground_picture(&pictures)
    }
}
