use std::sync::Arc;

use image::GrayImage;

use super::rest::{movement, rests};
use super::scaled::{factor_for, scaled};
use super::sight::Sight;
use super::{LINE, PictureSample, Tracing, TracingWay};
use crate::background::Background;
use crate::channel::Channel;
use crate::contrast::Contrast;
use crate::edges::median;
use crate::ground_picture::ground_picture;
use crate::ground_surface::ground_surface;
use crate::identity::Selection;
use crate::picture_outlines::PictureSettings;
use crate::ring::Ring;
use crate::trace::{TracedOutline, blurred, is_two_valued, trace_objects};
use crate::trace_settings::{Clipping, Contours, Edges, Smoothing, TraceSettings};

/// Most pixels of a picture where ways are tried for the first time.
const COARSE_PIXELS: u64 = 90_000;

/// Pictures looked at then.
const COARSE_PICTURES: usize = 9;

/// Pictures looked at of the best ways.
const FINE_PICTURES: usize = 15;

/// Objects looked at in a picture.
const OBJECTS: usize = 6;

/// A level lies so many standard deviations of the ground beyond it, and at least so many grey values.
const BEYOND_NOISE: f64 = 6.0;
const LEAST_LEVEL: f64 = 8.0;

/// What speaks for a way of tracing, and against it. Shares are from 0 to 1, 1 the best.
#[derive(Debug, Clone, PartialEq)]
pub struct TracingEvidence {
    /// The way.
    pub tracing: Tracing,
    /// Pictures looked at.
    pub pictures: usize,
    /// Pictures in which something was found.
    pub found: usize,
    /// How alike area and shape of what was found are over the sequence.
    pub steadiness: f64,
    /// How alike they are from one picture to the next.
    pub evenness: f64,
    /// How clear the contrast is along the edge.
    pub contrast: f64,
    /// How smooth the path is.
    pub smoothness: f64,
    /// Farthest movement seen, of the middle or of the outline, in pixels.
    pub movement: f64,
    /// Whether it rests: it moves no more from one picture to another far from it than its outline scatters.
    pub rests: bool,
    /// Share of the pictures in which the edge of the picture clips it.
    pub clipped: f64,
    /// Median share of the picture that it has.
    pub area_share: f64,
    /// Objects of at least half its area, in the median picture.
    pub objects: usize,
    /// Which objects are worth to be followed: all where several are of its size, those that move where it was chosen as it moves.
    pub selection: Selection,
    /// Share of its area that holes and marks have.
    pub inner_share: f64,
    /// Whether holes or marks within it, of less than half of its area, are the same all the time.
    pub has_steady_contours: bool,
    /// All of it together, 0 to 1.
    pub score: f64,
}

/// Pictures in one channel on which ways are tried.
pub(super) struct Trial {
    frames: Vec<u64>,
    pictures: Vec<Arc<GrayImage>>,
    /// What the ground is the median of.
    all: Vec<Arc<GrayImage>>,
    ground: std::cell::OnceCell<Option<Arc<GrayImage>>>,
    surfaces: std::cell::OnceCell<Vec<Arc<GrayImage>>>,
    last_shown: std::cell::RefCell<(Option<LookedAt>, Vec<Option<Shown>>)>,
    base: PictureSettings,
    /// Pixels of the sequence for one of these.
    factor: u32,
    /// Widest line expected, in pixels of the sequence.
    ring_width: f64,
}

impl Trial {
    /// A few pictures, scaled down.
    pub(super) fn coarse(sample: &PictureSample, base: &PictureSettings, channel: Channel) -> Self {
        Self::of(sample, base, channel, COARSE_PIXELS, COARSE_PICTURES)
    }

    /// More pictures as they are in the sample.
    pub(super) fn fine(sample: &PictureSample, base: &PictureSettings, channel: Channel) -> Self {
        Self::of(sample, base, channel, u64::MAX, FINE_PICTURES)
    }

    /// All pictures of the sample, as they are in it.
    pub(super) fn whole(sample: &PictureSample, base: &PictureSettings, channel: Channel) -> Self {
        Self::of(sample, base, channel, u64::MAX, usize::MAX)
    }

    fn of(sample: &PictureSample, base: &PictureSettings, channel: Channel, most: u64, count: usize) -> Self {
        let (frames, pictures) = sample.of(channel);
        let (columns, rows) = sample.size();
        let of_sample = pictures.first().map_or((1, 1), |picture| picture.dimensions());
        let further = factor_for(of_sample.0, of_sample.1, most);
        let all: Vec<Arc<GrayImage>> = pictures
            .iter()
            .map(|picture| if further == 1 { Arc::clone(picture) } else { Arc::new(scaled(picture, further)) })
            .collect();
        // Whole bursts, from first to last.
        let bursts: Vec<usize> = (0..all.len()).step_by(3).collect();
        let wanted = (count / 3).min(bursts.len()).max(1);
        let mut chosen: Vec<usize> = if count >= all.len() {
            (0..all.len()).collect()
        } else {
            (0..wanted)
                .map(|k| bursts[k * (bursts.len() - 1) / (wanted - 1).max(1)])
                .flat_map(|b| b..(b + 3).min(all.len()))
                .collect()
        };
        chosen.dedup();
        let ring_width = Ring { contrast: Contrast::DarkOnLight, width: base.trace.ring.and_then(|ring| ring.width) };
        Self {
            frames: chosen.iter().map(|&k| frames[k]).collect(),
            pictures: chosen.iter().map(|&k| Arc::clone(&all[k])).collect(),
            all,
            ground: std::cell::OnceCell::new(),
            surfaces: std::cell::OnceCell::new(),
            last_shown: std::cell::RefCell::default(),
            base: base.clone(),
            factor: sample.factor() * further,
            ring_width: ring_width.widest(columns, rows),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.pictures.len()
    }

    /// Pixels of a picture.
    pub(super) fn picture_area(&self) -> f64 {
        self.pictures.first().map_or(0.0, |picture| picture.as_raw().len() as f64)
    }

    fn settings(&self, tracing: &Tracing) -> PictureSettings {
        let ground = match tracing.way {
            TracingWay::Median(_) => self.ground.get_or_init(|| ground_picture(&self.all)).clone(),
            _ => None,
        };
        let mut settings = tracing.settings(&self.base, ground);
        let factor = f64::from(self.factor);
        let trace = &mut settings.trace;
        trace.minimum_area = (trace.minimum_area / u64::from(self.factor).pow(2)).max(4);
        trace.ring = trace.ring.map(|ring| Ring { width: Some((self.ring_width / factor).max(2.0)), ..ring });
        trace.smoothing = match trace.smoothing {
            Smoothing::Gaussian(sigma) => Smoothing::Gaussian(sigma / factor),
            Smoothing::Automatic => Smoothing::Automatic,
        };
        *trace = TraceSettings {
            edges: Edges::Isoline,
            contours: Contours::All,
            clipping: Clipping::Close,
            y_up: false,
            pixel_size: 1.0,
            pixel_aspect: 1.0,
            margins: None,
            ..*trace
        };
        settings
    }

    /// A difference from the ground that its noise does not reach, for the ways by a difference.
    pub(super) fn noise_level(&self, tracing: &Tracing) -> Option<f64> {
        if !matches!(tracing.way, TracingWay::Median(_) | TracingWay::Surface(_)) {
            return None;
        }
        let settings = self.settings(tracing);
        let step = (self.count() / 5).max(1);
        let levels = (0..self.count()).step_by(step).filter_map(|k| {
            self.ground(tracing, &settings, k)?;
            let Shown { picture, smooth } = self.shown(tracing, &settings, k);
            let shown = smooth.unwrap_or(picture);
            let mut counts = [0_usize; 256];
            shown.as_raw().iter().step_by(7).for_each(|value| counts[usize::from(*value)] += 1);
            let middle = median_of_counts(&counts)?;
            let mut deviations = [0_usize; 256];
            counts.iter().enumerate().for_each(|(value, count)| deviations[value.abs_diff(middle)] += count);
            let spread = 1.4826 * (median_of_counts(&deviations)? as f64 + 0.5);
            Some((middle as f64 + BEYOND_NOISE * spread).max(LEAST_LEVEL).round())
        });
        median(levels)
    }

    /// What a way looks at of a picture. What it showed last is kept: a way is tried with several levels, and lighter and darker things are looked for
    /// in the same picture.
    fn shown(&self, tracing: &Tracing, settings: &PictureSettings, k: usize) -> Shown {
        let is_plain = matches!(
            tracing.way,
            TracingWay::Lighter | TracingWay::Darker | TracingWay::DarkRing | TracingWay::LightRing
        );
        let key = ((!is_plain).then_some(tracing.way), tracing.smoothing);
        let mut last = self.last_shown.borrow_mut();
        if last.0 != Some(key) {
            *last = (Some(key), vec![None; self.count()]);
        }
        let known = &mut last.1[k];
        let shown = known.get_or_insert_with(|| {
            let difference =
                self.ground(tracing, settings, k).map(|ground| settings.difference.of(&self.pictures[k], ground));
            let picture = difference.map_or_else(|| Arc::clone(&self.pictures[k]), Arc::new);
            Shown { picture, smooth: None }
        });
        let sigma = match settings.trace.smoothing {
            Smoothing::Gaussian(sigma) => sigma,
            Smoothing::Automatic => 0.0,
        };
        // Rings smooth for themselves.
        if sigma > 0.0 && settings.trace.ring.is_none() && shown.smooth.is_none() {
            shown.smooth = Some(Arc::new(blurred(&shown.picture, sigma)));
        }
        shown.clone()
    }

    /// What a picture is compared with, if with anything.
    fn ground<'a>(&'a self, tracing: &Tracing, settings: &'a PictureSettings, k: usize) -> Option<&'a Arc<GrayImage>> {
        match (&settings.background, tracing.way) {
            (Some(Background::Picture(ground)), _) => Some(ground),
            (_, TracingWay::Surface(_)) => {
                let surfaces = || self.pictures.iter().map(|picture| Arc::new(ground_surface(picture))).collect();
                self.surfaces.get_or_init(surfaces).get(k)
            }
            _ => None,
        }
    }

    /// What a way finds in each picture.
    fn sights(&self, tracing: &Tracing) -> Vec<Sight> {
        let settings = self.settings(tracing);
        let mut sights = Vec::new();
        for k in 0..self.count() {
            let Some(Seen { frame, traced, picture, contrast, reach }) = self.seen(tracing, &settings, k, OBJECTS)
            else {
                continue;
            };
            sights.extend(Sight::of(frame, &traced, &picture, contrast, reach, sights.last()));
        }
        sights
    }

    /// What a way finds in the first picture in which it finds something.
    pub(super) fn first_sight(&self, tracing: &Tracing) -> Option<Sight> {
        let settings = self.settings(tracing);
        let seen = (0..self.count()).find_map(|k| self.seen(tracing, &settings, k, OBJECTS))?;
        Sight::of(seen.frame, &seen.traced, &seen.picture, seen.contrast, seen.reach, None)
    }

    /// All that a way finds, picture for picture.
    pub(super) fn all_sights(&self, tracing: &Tracing, most: usize) -> Vec<Vec<Sight>> {
        let settings = self.settings(tracing);
        let all = |Seen { frame, traced, picture, contrast, reach }: Seen| {
            traced.iter().map(|one| Sight::of_one(frame, one, &traced, &picture, contrast, reach)).collect()
        };
        (0..self.count()).map(|k| self.seen(tracing, &settings, k, most).map_or_else(Vec::new, all)).collect()
    }

    fn seen(&self, tracing: &Tracing, settings: &PictureSettings, k: usize, most: usize) -> Option<Seen> {
        let frame = self.frames[k];
        let Shown { picture, smooth } = self.shown(tracing, settings, k);
        // Pictures of two values are smoothed where their outlines are traced.
        let smooth = smooth.filter(|smooth| !is_two_valued(&picture) && !is_two_valued(smooth));
        let traced = match smooth {
            Some(smooth) => {
                let trace = TraceSettings { smoothing: Smoothing::Gaussian(0.0), ..settings.trace };
                trace_objects(&smooth, &trace, most)
            }
            None => trace_objects(&picture, &settings.trace, most),
        };
        let traced = traced.ok()?;
        let line = settings.trace.ring.map(|ring| ring.contrast);
        let contrast = line.unwrap_or(settings.trace.contrast);
        let reach = if line.is_some() { 1.5 } else { 2.0 };
        Some(Seen { frame, traced, picture, contrast, reach })
    }
}

/// What a way shows of a picture.
#[derive(Clone)]
struct Shown {
    /// The picture, or its difference from the ground.
    picture: Arc<GrayImage>,
    /// The same, smoothed, where it is smoothed before objects are looked for.
    smooth: Option<Arc<GrayImage>>,
}

/// A way but for its level and which side of it is an object, with a smoothing.
type LookedAt = (Option<TracingWay>, Smoothing);

/// The value that half of those counted are below, the upper one of two.
fn median_of_counts(counts: &[usize; 256]) -> Option<usize> {
    let middle = counts.iter().sum::<usize>() / 2;
    let mut seen = 0;
    counts.iter().position(|count| {
        seen += count;
        seen > middle
    })
}

/// What is seen in one picture.
struct Seen {
    frame: u64,
    traced: Vec<TracedOutline>,
    /// What was traced: the picture, or its difference from the ground.
    picture: Arc<GrayImage>,
    contrast: Contrast,
    /// Distance from the outline at which its sides are looked at.
    reach: f64,
}

/// Tries a way; `None` where it finds nothing.
pub(super) fn judged(trial: &Trial, tracing: Tracing) -> Option<TracingEvidence> {
    evidence_of(trial, tracing, &trial.sights(&tracing))
}

/// What speaks for a way by what it finds; `None` where that is nothing.
pub(super) fn evidence_of(trial: &Trial, tracing: Tracing, sights: &[Sight]) -> Option<TracingEvidence> {
    let factor = f64::from(trial.factor);
    let (found, pictures) = (sights.len(), trial.count());
    let picture_area = trial.picture_area();
    let of = |value: &dyn Fn(&Sight) -> f64| median(sights.iter().map(value));
    let area = of(&|sight| sight.area)?;
    let contrast = of(&|sight| sight.contrast)?;
    let objects = of(&|sight| sight.objects[0] as f64)? as usize;
    let all_objects = of(&|sight| sight.objects[1] as f64)?;
    let second = of(&|sight| sight.second)?;
    let clipped = sights.iter().filter(|sight| sight.is_clipped).count() as f64 / found as f64;

    let whole: Vec<&Sight> = sights.iter().filter(|sight| !sight.is_clipped).collect();
    let steadiness = steadiness(&whole);
    let pairs: Vec<(&Sight, &Sight)> =
        sights.windows(2).filter(|w| w[0].frame + 1 == w[1].frame).map(|w| (&w[0], &w[1])).collect();
    let evenness = if pairs.is_empty() && pictures < 2 { 1.0 } else { evenness(&pairs, factor) };
    let smoothness = if pictures < 3 { 1.0 } else { smoothness(sights) };
    let movement = factor * movement(sights);
    let area_share = area / picture_area;

    let moves = if pictures < 3 || movement > 1.5 { 1.0 } else { 0.35 };
    let is_ground = if area_share > 0.55 { 0.05 } else { 1.0 };
    // Many small things do no harm where one is much larger than all.
    let many = (1.0 + (all_objects - 12.0).max(0.0) / 12.0).powf(-(5.0 * second).min(1.0));
    let size = area * factor * factor / (area * factor * factor + 120.0);
    let share = (found as f64 / pictures as f64).powf(0.7);
    let score = share
        * steadiness
        * evenness
        * contrast
        * smoothness
        * moves
        * is_ground
        * many
        * size
        * (1.0 - 0.7 * clipped * clipped);
    Some(TracingEvidence {
        tracing,
        pictures,
        found,
        steadiness,
        evenness,
        contrast,
        smoothness,
        movement,
        rests: rests(sights, factor),
        clipped,
        area_share,
        objects,
        selection: if objects > 1 { Selection::All } else { Selection::Largest },
        inner_share: of(&|sight| sight.inner.0)?,
        has_steady_contours: has_steady_contours(&whole),
        score,
    })
}

/// Whether nearly all show the same number of holes and marks, of the same area together.
fn has_steady_contours(whole: &[&Sight]) -> bool {
    let Some(count) = median(whole.iter().map(|sight| sight.inner.1 as f64)) else { return false };
    let Some(area) = median(whole.iter().map(|sight| sight.inner.0)) else { return false };
    let is_same = |sight: &&&Sight| sight.inner.1 as f64 == count && (sight.inner.0 / area).ln().abs() < 0.1;
    whole.len() > 2 && count > 0.0 && area < LINE && whole.iter().filter(is_same).count() * 10 >= whole.len() * 8
}

/// How many of the sights are like the one that most are like.
fn steadiness(whole: &[&Sight]) -> f64 {
    if whole.is_empty() {
        return 0.3;
    }
    let alike = |a: &Sight, b: &Sight| {
        let growth = (a.area / b.area).ln() / 0.12;
        let shape = a.invariants.zip(b.invariants).map_or(1.0, |(a, b)| a.distance(&b) / 0.2);
        (-0.5 * (growth * growth + shape * shape)).exp()
    };
    let mean = |a: &&Sight| whole.iter().map(|b| alike(a, b)).sum::<f64>() / whole.len() as f64;
    whole.iter().map(mean).fold(0.0, f64::max)
}

/// How little area and shape change from one picture to the next.
fn evenness(pairs: &[(&Sight, &Sight)], factor: f64) -> f64 {
    let whole = || pairs.iter().filter(|(a, b)| !a.is_clipped && !b.is_clipped);
    // What the rounding of a small outline to pixels may do.
    let growth = median(
        whole().map(|(a, b)| (a.area / b.area).ln().abs() / (0.02 + 0.3 * factor.min(2.0) / a.area.max(1.0).sqrt())),
    );
    let shape = median(whole().filter_map(|(a, b)| Some(a.invariants?.distance(&b.invariants?))));
    match (growth, shape) {
        (Some(growth), Some(shape)) => 1.0 / (1.0 + (growth / 2.0).powi(2)) / (1.0 + (shape / 0.1).powi(2)),
        _ if pairs.is_empty() => 0.3,
        _ => 0.5,
    }
}

/// How little the path bends within three pictures, in sizes of the object, and in steps where those are longer.
fn smoothness(sights: &[Sight]) -> f64 {
    let bends = sights.windows(3).filter(|w| w[0].frame + 2 == w[2].frame && w.iter().all(|sight| !sight.is_clipped));
    let bend = median(bends.map(|w| {
        let step = (w[1].centre - w[0].centre).norm();
        (w[0].centre.coords - 2.0 * w[1].centre.coords + w[2].centre.coords).norm() / (w[1].size() + 2.0 * step)
    }));
    bend.map_or(0.5, |bend| 1.0 / (1.0 + (bend / 0.05).powi(2)))
}
