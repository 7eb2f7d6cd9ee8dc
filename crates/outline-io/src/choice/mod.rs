//! How objects are best found in a sequence: every way is tried on some of its pictures and judged by what tells a body from ground.
mod beside;
mod chains;
mod evidence;
mod light;
mod moving;
mod preference;
mod rest;
mod sample;
mod scaled;
mod sight;
mod ties;
mod trial;
mod tuning;
mod turning;
mod warning;

use std::sync::Arc;

use image::GrayImage;

use crate::ground::background::{Background, Difference};
use crate::picture_file::channel::Channel;
use crate::picture_outlines::PictureSettings;
use crate::tracing::contrast::Contrast;
use crate::tracing::margins::Margins;
use crate::tracing::ring::Ring;
use crate::tracing::settings::{Smoothing, TraceSettings};
use crate::tracing::threshold::Threshold;
use crate::tracing::transfer::Transfer;
pub use evidence::TracingEvidence;
use evidence::judged;
use light::transfer_of;
use preference::{motion_beside, preferring_what_moves};
pub(crate) use sample::BURST;
pub use sample::{PictureSample, SamplePlan};
use ties::settle_ties;
use trial::Trial;
pub use warning::TracingWarning;

/// A way to tell objects from the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TracingWay {
    /// They are lighter.
    Lighter,
    /// They are darker.
    Darker,
    /// A dark line is around them.
    DarkRing,
    /// A light line is around them.
    LightRing,
    /// They differ from the ground of the whole sequence: the median of pictures of it, without what rests in most of these and leaves or comes
    /// ([`ground_picture`](crate::ground_picture)).
    Median(Difference),
    /// They differ from a smooth surface through the ground of each picture.
    Surface(Difference),
}

/// A way, in a channel, with a smoothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracing {
    /// How objects are told from the ground.
    pub way: TracingWay,
    /// What is looked at of a colour picture.
    pub channel: Channel,
    /// Smoothing before objects are looked for.
    pub smoothing: Smoothing,
    /// A difference from the ground beyond its noise, in grey values, instead of Otsu's threshold; of the ways by a difference only.
    pub level: Option<f64>,
}

/// The ways that were tried, with what speaks for them, the best first; in front of them a way that shows what moves, where that is preferred,
/// whatever its score.
#[derive(Debug, Clone, PartialEq)]
pub struct TracingChoice {
    /// All that found something in at least one picture.
    pub candidates: Vec<TracingEvidence>,
    /// What moves beside what the best finds, where that has been looked for.
    beside: Option<TracingWarning>,
    /// What of the pictures is not looked at: the margins given, or else even bars at their sides.
    pub margins: Margins,
    /// How grey values stand for light: what is given, and else what leaves the sizes of bodies the same that the best shows, and their edges even.
    pub transfer: Transfer,
}

/// Ways that are looked at once more, in all pictures of the sample and with their variants.
const SHORT_LIST: usize = 3;

/// A way in the luminance that does as well as this needs no other channel.
const GOOD: f64 = 0.5;

/// Below this, speckles may spoil it.
const WEAK: f64 = 0.2;

/// A hole of more than this share of an object leaves no more than a line of it; the spokes of a wheel are between several.
pub(crate) const LINE: f64 = 0.5;

/// Score that another channel than the luminance must be better by.
const WORTH_OF_LUMINANCE: f64 = 0.03;

/// Smoothing tried against speckles, in pixels.
const AGAINST_SPECKLES: f64 = 2.5;

/// Smoothing tried against noise that hides what can be seen where a picture is scaled down, in pixels.
const AGAINST_NOISE: f64 = 1.5;

/// Fewest pictures of a sample whose median may be the ground.
const FEWEST_FOR_MEDIAN: usize = 8;

impl TracingWay {
    const PLAIN: [Self; 6] = [
        Self::Lighter,
        Self::Darker,
        Self::DarkRing,
        Self::LightRing,
        Self::Median(Difference::Either),
        Self::Surface(Difference::Either),
    ];

    fn is_ring(self) -> bool {
        matches!(self, Self::DarkRing | Self::LightRing)
    }

    /// How much a way is preferred to others that do as well: what is simple, and takes nothing for granted, first.
    fn preference(self) -> f64 {
        match self {
            Self::Lighter | Self::Darker => 1.0,
            Self::Median(Difference::Either) => 0.97,
            Self::DarkRing | Self::LightRing => 0.95,
            Self::Surface(Difference::Either) => 0.95,
            Self::Median(_) | Self::Surface(_) => 0.93,
        }
    }
}

impl Tracing {
    fn preference(&self) -> f64 {
        let channel = if self.channel == Channel::Luminance { 1.0 } else { 0.95 };
        let smoothing = match self.smoothing {
            Smoothing::Automatic => 1.0,
            Smoothing::Gaussian(sigma) if sigma < AGAINST_SPECKLES => 0.85,
            Smoothing::Gaussian(_) => 0.7,
        };
        let level = if self.level.is_none() { 1.0 } else { 0.95 };
        self.way.preference() * channel * smoothing * level
    }

    /// Whether both are one way, with whatever levels.
    fn is_like(&self, other: &Self) -> bool {
        let rest = |tracing: &Self| (tracing.way, tracing.channel, tracing.level.is_some());
        rest(self) == rest(other) && self.smoothing == other.smoothing
    }

    /// The settings of this way. `ground` is what [`TracingWay::Median`] compares pictures with, as
    /// [`PicturePreview::ground`](crate::PicturePreview::ground) gives it; other ways do without.
    #[must_use]
    pub fn settings(&self, base: &PictureSettings, ground: Option<Arc<GrayImage>>) -> PictureSettings {
        let ring = |contrast| Some(Ring { contrast, width: base.trace.ring.and_then(|ring| ring.width) });
        let (contrast, ring, background, difference) = match self.way {
            TracingWay::Lighter => (Contrast::LightOnDark, None, None, Difference::Either),
            TracingWay::Darker => (Contrast::DarkOnLight, None, None, Difference::Either),
            TracingWay::DarkRing => (Contrast::LightOnDark, ring(Contrast::DarkOnLight), None, Difference::Either),
            TracingWay::LightRing => (Contrast::LightOnDark, ring(Contrast::LightOnDark), None, Difference::Either),
            TracingWay::Median(d) => (Contrast::LightOnDark, None, ground.map(Background::Picture), d),
            TracingWay::Surface(d) => (Contrast::LightOnDark, None, Some(Background::Surface), d),
        };
        let smoothing = self.smoothing;
        let threshold = self.level.map_or(Threshold::Automatic, Threshold::Level);
        let trace = TraceSettings { contrast, ring, smoothing, threshold, ..base.trace };
        PictureSettings { trace, background, difference, ..base.clone() }
    }
}

impl TracingChoice {
    /// Score that a way needs not to be in doubt: of 662 simulated sequences 20 were below it, 8 of them right, and of those above it 1 % wrong.
    pub const CONVINCING: f64 = 0.12;

    /// The best way, if any found something.
    #[must_use]
    pub fn best(&self) -> Option<&TracingEvidence> {
        self.candidates.first()
    }

    /// Whether the best way tells an object from the ground beyond doubt.
    #[must_use]
    pub fn is_convincing(&self) -> bool {
        self.best().is_some_and(|best| best.score >= TracingChoice::CONVINCING)
    }

    /// These settings with what was found of the pictures whatever the way: margins and transfer function. [`Tracing::settings`] puts a way into
    /// them.
    #[must_use]
    pub fn base(&self, settings: &PictureSettings) -> PictureSettings {
        let trace = TraceSettings { margins: Some(self.margins), transfer: self.transfer, ..settings.trace };
        PictureSettings { trace, ..settings.clone() }
    }

    /// What should be known of the best way.
    pub fn warnings(&self) -> impl Iterator<Item = TracingWarning> {
        let doubtful = (!self.is_convincing()).then_some(TracingWarning::Doubtful);
        doubtful.into_iter().chain(self.beside)
    }
}

/// Tries the ways on a sample of a sequence. `channels` are those to look at, all that the sample has if empty; smoothing and smallest area are
/// those of `base`, variants of the smoothing are tried where it is automatic.
///
/// A way is judged by the share of pictures in which it finds something, by how steady area and affine moment invariants (Flusser and Suk,
/// 1993) of what it finds are from picture to picture and over the sequence, by the contrast along its edge, by how smoothly it moves, by
/// whether it moves at all, and by how much of it the edge of the picture clips.
///
/// Where what the best way finds rests, or is in doubt, a way that shows something that moves is preferred to it, even if its score is less. It
/// is looked for in the first channel, where the pictures are not two-valued and at least eight.
///
/// Even bars at the sides of the pictures are no bodies, and are left out, unless `base` has margins.
#[must_use]
pub fn choose_tracing(sample: &PictureSample, base: &PictureSettings, channels: &[Channel]) -> TracingChoice {
    let margins = match base.trace.margins {
        Some(given) => given,
        None if sample.is_two_valued() => Margins::default(),
        None => sample.bars(),
    };
    let within = (!margins.are_none()).then(|| sample.within(margins));
    let sample = within.as_ref().unwrap_or(sample);
    let (candidates, beside) = choose_within(sample, base, channels);
    let transfer = candidates.first().map_or_else(Transfer::default, |best| transfer_of(sample, base, &best.tracing));
    TracingChoice { candidates, beside, margins, transfer }
}

/// The ways, the best first, in pictures without margins, and what moves besides.
fn choose_within(
    sample: &PictureSample,
    base: &PictureSettings,
    channels: &[Channel],
) -> (Vec<TracingEvidence>, Option<TracingWarning>) {
    let channels: Vec<Channel> =
        sample.channels().filter(|channel| channels.is_empty() || channels.contains(channel)).collect();
    let Some((first, others)) = channels.split_first() else {
        return (Vec::new(), None);
    };
    let mut coarse = tried(sample, base, *first);
    let (mut fine, mut looked_at) = (Vec::new(), Vec::new());
    let is_good = |candidates: &[TracingEvidence]| candidates.iter().any(|candidate| candidate.score >= GOOD);
    if is_good(&coarse) {
        fine = looked_closer(sample, base, &mut coarse, &mut looked_at);
    }
    // Where the best rests beyond doubt, other channels would show that it rests.
    let best = if is_good(&fine) { fine.iter() } else { coarse.iter() }.max_by(|a, b| a.score.total_cmp(&b.score));
    let resting = best.filter(|best| best.rests && best.score >= TracingChoice::CONVINCING).map(|best| best.tracing);
    let mut early = resting.and_then(|tracing| motion_beside(sample, base, *first, Some(&tracing), None));
    if let Some(moving) =
        early.as_mut().and_then(|early| early.moving.take_if(|moving| moving.score >= TracingChoice::CONVINCING))
    {
        sort(&mut coarse);
        coarse.retain(|candidate| candidate.tracing != moving.tracing);
        coarse.insert(0, moving);
        return (coarse, None);
    }
    // Scaled down, a picture has less noise than as it is.
    if !is_good(&fine) && !others.is_empty() {
        coarse.extend(in_threads(others.iter().map(|channel| move || tried(sample, base, *channel))));
    }
    if !is_good(&fine) {
        fine.extend(looked_closer(sample, base, &mut coarse, &mut looked_at));
    }
    sort(&mut fine);
    coarse.retain(|candidate| !looked_at.iter().any(|tracing| tracing.is_like(&candidate.tracing)));
    settle_ties(sample, base, &mut fine);
    let closely = fine.len();
    fine.extend(coarse);
    let beside = preferring_what_moves(sample, base, *first, (&mut fine, closely), resting.zip(early));
    (fine, beside)
}

/// The best ways once more, in more pictures as they are, with their variants. `looked_at` are those that have been looked at so.
fn looked_closer(
    sample: &PictureSample,
    base: &PictureSettings,
    coarse: &mut [TracingEvidence],
    looked_at: &mut Vec<Tracing>,
) -> Vec<TracingEvidence> {
    sort(coarse);
    let mut wanted = Vec::new();
    for (rank, candidate) in coarse.iter().take(SHORT_LIST).enumerate() {
        if !looked_at.iter().any(|known| known.is_like(&candidate.tracing)) {
            wanted.push((rank, candidate));
            looked_at.push(candidate.tracing);
        }
    }
    in_threads(wanted.into_iter().map(|(rank, candidate)| move || closer_look(sample, base, candidate, rank == 0)))
}

/// A way in more pictures as they are, and with its variants where it is the best so far.
fn closer_look(
    sample: &PictureSample,
    base: &PictureSettings,
    candidate: &TracingEvidence,
    is_best: bool,
) -> Vec<TracingEvidence> {
    let tracing = candidate.tracing;
    let trial = Trial::fine(sample, base, tracing.channel);
    let with_level = |tracing: Tracing| Tracing {
        level: tracing.level.and_then(|_| trial.noise_level(&tracing)).map(|level| level * f64::from(sample.factor())),
        ..tracing
    };
    let found = judged(&trial, with_level(tracing));
    // What stands out where noise is averaged away may do so where it is smoothed.
    let is_lost = found.as_ref().is_none_or(|found| found.score < 0.6 * candidate.score);
    let mut fine: Vec<TracingEvidence> = found.into_iter().collect();
    if is_lost && tracing.smoothing == Smoothing::Automatic && !sample.is_two_valued() {
        let smooth = Tracing { smoothing: Smoothing::Gaussian(AGAINST_NOISE), ..tracing };
        fine.extend(judged(&trial, with_level(smooth)));
    }
    let variants: &[TracingWay] = match tracing.way {
        TracingWay::Median(_) if is_best => {
            &[TracingWay::Median(Difference::Lighter), TracingWay::Median(Difference::Darker)]
        }
        TracingWay::Surface(_) if is_best => {
            &[TracingWay::Surface(Difference::Lighter), TracingWay::Surface(Difference::Darker)]
        }
        _ => &[],
    };
    let variants = variants.iter().map(|way| with_level(Tracing { way: *way, ..tracing }));
    fine.extend(variants.filter_map(|tracing| judged(&trial, tracing)));
    fine
}

/// What all of these find, one after the other, each looked for in a thread of its own.
fn in_threads<F: FnOnce() -> Vec<TracingEvidence> + Send>(looks: impl Iterator<Item = F>) -> Vec<TracingEvidence> {
    std::thread::scope(|scope| {
        let threads: Vec<_> = looks.map(|look| scope.spawn(look)).collect();
        threads
            .into_iter()
            .flat_map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

/// The plain ways in a channel, on a few pictures, scaled down.
fn tried(sample: &PictureSample, base: &PictureSettings, channel: Channel) -> Vec<TracingEvidence> {
    let trial = Trial::coarse(sample, base, channel);
    let is_mask = sample.is_two_valued();
    let is_possible = |way: &TracingWay| match way {
        TracingWay::Lighter | TracingWay::Darker => true,
        TracingWay::Median(_) => !is_mask && sample.len() >= FEWEST_FOR_MEDIAN,
        _ => !is_mask,
    };
    let all = |smoothing: Smoothing| {
        let ways = TracingWay::PLAIN.into_iter().filter(is_possible);
        let otsu = ways.map(|way| Tracing { way, channel, smoothing, level: None });
        let with_levels = otsu.flat_map(|tracing| {
            let level = trial.noise_level(&tracing);
            [Some(tracing), level.map(|level| Tracing { level: Some(level), ..tracing })].into_iter().flatten()
        });
        with_levels.filter_map(|tracing| judged(&trial, tracing)).collect::<Vec<_>>()
    };
    let smoothing = base.trace.smoothing;
    let mut candidates = all(smoothing);
    if smoothing == Smoothing::Automatic && !is_mask && candidates.iter().all(|candidate| candidate.score < WEAK) {
        candidates.extend(all(Smoothing::Gaussian(AGAINST_SPECKLES)));
    }
    candidates
}

/// What a way is sorted by.
fn worth(candidate: &TracingEvidence) -> f64 {
    // Where a line is all that is seen, the rings are made for it: they do without a threshold, and take no gap for an opening.
    let line = if candidate.largest_hole > LINE && !candidate.tracing.way.is_ring() { 0.85 } else { 1.0 };
    // Another channel is to be worth it: compression spoils what is not luminance.
    let channel = if candidate.tracing.channel == Channel::Luminance { 0.0 } else { WORTH_OF_LUMINANCE };
    (candidate.score * candidate.tracing.preference() - channel) * line
}

fn sort(candidates: &mut [TracingEvidence]) {
    candidates.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
}
