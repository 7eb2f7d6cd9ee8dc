//! What is looked at of pictures before they are traced, to choose how.
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use freeform_motion::outline_io::{
    Background, Channel, Difference, GrayImage, PictureError, PictureFrame, PictureOutlines, PictureSample,
    PictureSequence, PictureSettings, SamplePlan, Selection, SequenceSettings, Smoothing, Tracing, TracingChoice,
    TracingEvidence, TracingWay, choose_tracing, is_two_valued, median_picture, picture_files,
};

use crate::args::{ChannelChoice, ContoursChoice, ObjectsChoice, PictureOptions, RingChoice};
use crate::outline_error::OutlineError;
use crate::output::short;

/// Fewest pictures that tell how objects are best found.
const FEWEST_PICTURES: usize = 3;

/// Pictures whose edges tell how well outlines are known.
const EDGES_LOOKED_AT: usize = 6;

/// Most pixels of these pictures, all together: those of one of the largest.
const EDGE_PIXELS: usize = 1 << 26;

/// Pixels of all pictures that a ground is the median of.
const GROUND_PIXELS: usize = 1 << 28;

/// Where pictures can be looked at before they are read for good.
pub(crate) enum Preview {
    /// Files of one picture each.
    Pictures(Vec<PathBuf>),
    /// Files some of which hold several.
    Files(Vec<PathBuf>),
    /// The beginning of a stream.
    Beginning(Arc<[u8]>),
}

type Previewed = Box<dyn Iterator<Item = Result<PictureFrame, PictureError>>>;

impl Preview {
    pub(crate) fn of_paths(paths: &[PathBuf], sequence: &PictureSequence) -> Self {
        let files: Result<Vec<Vec<PathBuf>>, PictureError> = paths.iter().map(|path| picture_files(path)).collect();
        match files {
            Ok(files) if sequence.frame_count().is_some() => Self::Pictures(files.concat()),
            _ => Self::Files(paths.to_owned()),
        }
    }

    /// Whether nothing can be looked at before it is read for good, as what is no file can be read only once.
    pub(crate) fn is_read_once(&self) -> bool {
        let is_pipe = |path: &PathBuf| path.exists() && !path.is_file() && !path.is_dir();
        matches!(self, Self::Files(paths) if paths.iter().any(is_pipe))
    }

    fn plan(&self) -> SamplePlan {
        match self {
            Self::Pictures(files) => SamplePlan::Spread(files.len() as u64),
            _ => SamplePlan::Ahead,
        }
    }

    /// The pictures of a sample, in one channel.
    pub(crate) fn pictures(&self, channel: Channel) -> Option<Previewed> {
        let settings = SequenceSettings { frames_per_second: None, channel };
        let frames = self.plan().frames();
        let sequence = match self {
            Self::Pictures(files) => {
                let wanted: Vec<(u64, PathBuf)> = frames.into_iter().map(|k| (k, files[k as usize].clone())).collect();
                // To open a pipe among them is to wait for somebody who writes to it.
                let wanted = wanted.into_iter().filter(|(_, path)| path.is_file());
                return Some(Box::new(wanted.filter_map(move |(frame, path)| {
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
    fn sample(&self, channels: &[Channel]) -> PictureSample {
        PictureSample::read(channels, |channel| self.pictures(channel))
    }

    /// How far outlines that are traced with these settings may lie off, by some of the pictures.
    pub(crate) fn outline_error(&self, settings: &PictureSettings, channel: Channel) -> Option<OutlineError> {
        let mut pixels = 0;
        let is_looked_at = |frame: &PictureFrame| {
            pixels += frame.picture.as_raw().len();
            pixels <= EDGE_PIXELS
        };
        let pictures: Vec<PictureFrame> =
            self.pictures(channel)?.flatten().take(EDGES_LOOKED_AT).take_while(is_looked_at).collect();
        if !pictures.is_empty() && pictures.iter().all(|frame| is_two_valued(&frame.picture)) {
            return Some(OutlineError::MaskPixel(settings.trace.pixel()));
        }
        if matches!(settings.background, Some(Background::RunningMedian(_))) || settings.trace.ring.is_some() {
            return None;
        }
        let settings = PictureSettings { selection: Selection::Largest, ..settings.clone() };
        let traced = PictureOutlines::new(pictures.into_iter().map(Ok), settings).ok()?.flatten();
        let edges = traced.flat_map(|traced| traced.objects.unwrap_or_default()).filter_map(|(_, traced)| traced.edges);
        let mut lengths: Vec<f64> = edges.map(|edges| edges.systematic).collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).copied().map(OutlineError::Edges)
    }

    /// The median of the pictures of the sample, at their full size.
    pub(crate) fn ground(&self, channel: Channel) -> Option<Arc<GrayImage>> {
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
        median_picture(&pictures)
    }
}

/// How tracing was chosen.
#[derive(Debug)]
pub(crate) struct Chosen {
    pub(crate) choice: TracingChoice,
    /// The options that give it again.
    pub(crate) options: String,
}

impl Chosen {
    /// What is said of it.
    pub(crate) fn note(&self) -> String {
        let best = self.choice.best();
        let found = best.map_or_else(String::new, |TracingEvidence { found, pictures, score, .. }| {
            format!(", {found} of {pictures} pictures tried show an object, score {}", short(*score))
        });
        format!("traced with {} (chosen among {} ways{found})", self.options, self.choice.candidates.len())
    }

    /// What is said where nothing stands out.
    pub(crate) fn warning(&self, drawn: Option<&Path>) -> Option<String> {
        if self.choice.is_convincing() {
            return None;
        }
        let others = self.choice.candidates.iter().skip(1).take(2).map(|other| options_of(&other.tracing).join(" "));
        let others: Vec<String> = others.collect();
        let next = if others.is_empty() { String::new() } else { format!("; next best: {}", others.join(", or ")) };
        let doubt = "no way of tracing tells an object from the ground beyond doubt";
        Some(match drawn {
            Some(path) => format!("{doubt}; choose one by {}, where they are drawn{next}", path.display()),
            None => format!("{doubt}; draw them with --candidates FILE.png and choose one{next}"),
        })
    }
}

/// Chooses how pictures are traced, where the options leave it open; gives the options with what was chosen.
pub(crate) fn choose(
    preview: &Preview,
    base: &PictureSettings,
    given: &PictureOptions,
) -> (PictureOptions, Option<Chosen>) {
    let unchanged = (given.clone(), None);
    if given.has_way() {
        return unchanged;
    }
    let all = [Channel::Luminance, Channel::Red, Channel::Green, Channel::Blue, Channel::Saturation];
    let channels = match given.channel {
        Some(channel) => vec![channel.channel()],
        None => all.to_vec(),
    };
    let sample = preview.sample(&channels);
    if sample.len() < FEWEST_PICTURES {
        return unchanged;
    }
    let choice = choose_tracing(&sample, base, &[]);
    let Some(best) = choice.best() else { return unchanged };
    let mut options = given.clone();
    take(&mut options, &best.tracing);
    let mut parts = options_of(&best.tracing);
    if best.objects > 1 && given.objects.is_none() {
        options.objects = Some(ObjectsChoice::All);
        parts.push("--objects all".to_owned());
    }
    if best.has_steady_contours && given.contours.is_none() {
        options.contours = Some(ContoursChoice::All);
        parts.push("--contours all".to_owned());
    }
    if given.channel.is_some() {
        parts.retain(|part| !part.starts_with("--channel"));
    }
    (options, Some(Chosen { choice, options: parts.join(" ") }))
}

/// Puts a way into options.
fn take(options: &mut PictureOptions, tracing: &Tracing) {
    let mut background = |name: &str, difference| {
        options.background = Some(PathBuf::from(name));
        (options.light, options.dark) = (difference == Difference::Lighter, difference == Difference::Darker);
    };
    match tracing.way {
        TracingWay::Lighter => options.light = true,
        TracingWay::Darker => options.dark = true,
        TracingWay::DarkRing => options.ring = Some(RingChoice::Dark),
        TracingWay::LightRing => options.ring = Some(RingChoice::Light),
        TracingWay::Median(difference) => background("whole", difference),
        TracingWay::Surface(difference) => background("surface", difference),
    }
    options.channel = Some(ChannelChoice::of(tracing.channel));
    options.threshold = tracing.level;
    if let Smoothing::Gaussian(sigma) = tracing.smoothing {
        options.smoothing = Some(sigma);
    }
}

/// A way as options.
pub(crate) fn options_of(tracing: &Tracing) -> Vec<String> {
    let background = |name: &str, difference| {
        let side = match difference {
            Difference::Either => "",
            Difference::Lighter => " --light",
            Difference::Darker => " --dark",
        };
        format!("--background {name}{side}")
    };
    let way = match tracing.way {
        TracingWay::Lighter => "--light".to_owned(),
        TracingWay::Darker => "--dark".to_owned(),
        TracingWay::DarkRing => "--ring dark".to_owned(),
        TracingWay::LightRing => "--ring light".to_owned(),
        TracingWay::Median(difference) => background("whole", difference),
        TracingWay::Surface(difference) => background("surface", difference),
    };
    let mut options = vec![way];
    options.extend(tracing.level.map(|level| format!("--threshold {level}")));
    if tracing.channel != Channel::Luminance {
        options.push(format!("--channel {}", ChannelChoice::of(tracing.channel).name()));
    }
    if let Smoothing::Gaussian(sigma) = tracing.smoothing {
        options.push(format!("--smoothing {sigma}"));
    }
    options
}
