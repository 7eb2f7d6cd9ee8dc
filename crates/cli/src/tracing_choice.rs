//! How pictures are traced, where the options leave it open.
use std::path::{Path, PathBuf};

use freeform_motion::outline_io::{
    Channel, Difference, Margins, OriginWarning, PicturePreview, PictureSettings, Selection, Smoothing, Tracing,
    TracingChoice, TracingEvidence, TracingWarning, TracingWay, Transfer,
};
use freeform_motion::short;

use crate::args::{ChannelChoice, ContoursChoice, ObjectsChoice, PictureOptions, RingChoice, TransferChoice};
use crate::progress::{Progress, Verbosity};

/// Area of another object over that of the one which is followed, from which on it is told that it is not: specks are smaller.
const WORTH_TELLING: f64 = 0.1;

/// The options that look for what moves.
const MOVING: &str = "--background whole --objects moving --min-area PIXELS";

/// How tracing was chosen.
#[derive(Debug)]
pub(crate) struct Chosen {
    pub(crate) choice: TracingChoice,
    /// The options that give it again.
    pub(crate) options: String,
    /// Area of another object over that of the largest, which alone is followed, where that is worth telling.
    left_out: Option<f64>,
    /// Whether all are followed although no other one is of its size, since another one moves.
    follows_another: bool,
}

impl Chosen {
    /// What is said of it.
    pub(crate) fn note(&self) -> String {
        let best = self.choice.best();
        let found = best.map_or_else(String::new, |TracingEvidence { found, pictures, score, .. }| {
            let score = (score * 1000.0).round() / 1000.0;
            let score = if score > 0.0 { short(score) } else { "below 0.001".to_owned() };
            format!(", {found} of {pictures} pictures tried show an object, score {score} of 1")
        });
        let is_warned =
            || self.choice.warnings().any(|warning| matches!(warning, TracingWarning::MovesBesideRest { .. }));
        let still = match best {
            Some(best) if best.rests && !self.follows_another && !is_warned() => {
                format!("; its middle rests: what moves and is smaller may be found by {MOVING}")
            }
            _ => String::new(),
        };
        let beside = self.left_out.map_or_else(String::new, |share| {
            format!("; another object, of {:.0} % of its area, is not followed: --objects all does", 100.0 * share)
        });
        let ways = self.choice.candidates.len();
        format!("traced with {} (chosen among {ways} ways{found}){still}{beside}", self.options)
    }

    /// What is said of it where it is not to be trusted, by the codes.
    pub(crate) fn warnings(&self, drawn: Option<&Path>) -> Vec<(OriginWarning, String)> {
        // The first is taken; a simpler way may be preferred to one of a higher score.
        let ranked = TracingEvidence::by_score(&self.choice.candidates);
        let others = ranked.into_iter().filter(|(place, _)| *place > 0).take(2);
        let others: Vec<String> = others.map(|(_, other)| options_of(&other.tracing).join(" ")).collect();
        let next = if others.is_empty() { String::new() } else { format!("; next best: {}", others.join(", or ")) };
        let told = |warning: TracingWarning| match (warning, drawn) {
            (TracingWarning::Doubtful, Some(path)) => {
                format!("{warning}; choose one by {}, where they are drawn{next}", path.display())
            }
            (TracingWarning::Doubtful, None) => {
                format!("{warning}; draw them with --candidates FILE.png and choose one{next}")
            }
            (TracingWarning::MovesBesideRest { .. } | TracingWarning::MovesBeside { .. }, _) => {
                format!("{warning}; {MOVING} may find it")
            }
        };
        self.choice.warnings().map(|warning| (warning.into(), told(warning))).collect()
    }
}

/// Chooses how pictures are traced, where the options leave it open; gives the options with what was chosen.
pub(crate) fn choose(
    preview: &PicturePreview,
    base: &PictureSettings,
    given: &PictureOptions,
    verbosity: Verbosity,
) -> (PictureOptions, Option<Chosen>) {
    let unchanged = (given.clone(), None);
    if given.has_way() {
        return unchanged;
    }
    let all = [Channel::Luminance, Channel::Red, Channel::Green, Channel::Blue, Channel::Saturation];
    let channels = given.channel.map_or(all.to_vec(), |channel| vec![channel.channel()]);
    let progress = Progress::of_choice(verbosity);
    let choice = preview.choose_tracing(&channels, base);
    drop(progress);
    let Some(choice) = choice else { return unchanged };
    let Some(best) = choice.best() else { return unchanged };
    let mut options = given.clone();
    take(&mut options, &best.tracing);
    let mut parts = options_of(&best.tracing);
    let margins = choice.margins;
    if given.margins.is_none() && !margins.are_none() {
        options.margins = Some(margins);
        let Margins { left, top, right, bottom } = margins;
        parts.push(format!("--margins {left},{top},{right},{bottom}"));
    }
    let objects = match best.selection {
        Selection::All => Some((ObjectsChoice::All, "--objects all")),
        Selection::Moving => Some((ObjectsChoice::Moving, "--objects moving")),
        Selection::Largest | Selection::Nearest => None,
    };
    if let (Some((objects, option)), None) = (objects, given.objects) {
        options.objects = Some(objects);
        parts.push(option.to_owned());
    }
    if best.has_steady_contours && given.contours.is_none() {
        options.contours = Some(ContoursChoice::All);
        parts.push("--contours all".to_owned());
    }
    if given.channel.is_some() {
        parts.retain(|part| !part.starts_with("--channel"));
    }
    if choice.transfer == Transfer::Srgb && given.transfer.is_none() {
        options.transfer = Some(TransferChoice::Srgb);
        parts.push("--transfer srgb".to_owned());
    }
    let follows_one = objects.is_none() && given.objects.is_none();
    let left_out = Some(best.second).filter(|share| follows_one && *share >= WORTH_TELLING);
    let follows_another = given.objects.is_none() && best.selection == Selection::All && best.objects <= 1;
    (options, Some(Chosen { choice, options: parts.join(" "), left_out, follows_another }))
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
