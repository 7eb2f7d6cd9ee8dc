//! Pictures of a sequence, and what ways of tracing find in them.
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

use image::GrayImage;

use super::scaled::{factor_for, scaled};
use super::sight::Sight;
use super::{BURST, PictureSample, Tracing, TracingWay};
use crate::edges::median;
use crate::ground::background::Background;
use crate::ground::ground_picture::ground_picture;
use crate::ground::ground_surface::ground_surface;
use crate::picture_file::channel::Channel;
use crate::picture_outlines::{PictureSettings, View};
use crate::tracing::contrast::Contrast;
use crate::tracing::ring::Ring;
use crate::tracing::settings::{Clipping, Contours, Edges, Smoothing, TraceSettings};
use crate::tracing::threshold::{beyond_noise, counted};
use crate::tracing::trace::{TracedOutline, blurred, is_two_valued, trace_objects};
use crate::tracing::transfer::Transfer;

/// Most pixels of a picture where ways are tried for the first time.
const COARSE_PIXELS: u64 = 90_000;

/// Pictures looked at then.
const COARSE_PICTURES: usize = 9;

/// Pictures looked at of the best ways.
const FINE_PICTURES: usize = 15;

/// Objects looked at in a picture.
pub(super) const OBJECTS: usize = 6;

/// A level beyond the noise of the ground is at least so many grey values.
const LEAST_LEVEL: f64 = 8.0;

/// Every so many pixels of a picture tell that noise.
const NOISE_STEP: usize = 7;

/// Pictures in one channel on which ways are tried.
pub(super) struct Trial {
    frames: Vec<u64>,
    pictures: Vec<Arc<GrayImage>>,
    /// What the ground is the median of.
    all: Vec<Arc<GrayImage>>,
    ground: OnceCell<Option<Arc<GrayImage>>>,
    surfaces: OnceCell<Vec<Arc<GrayImage>>>,
    last_shown: RefCell<(Option<LookedAt>, Vec<Option<Shown>>)>,
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
        let burst = BURST as usize;
        let bursts: Vec<usize> = (0..all.len()).step_by(burst).collect();
        let wanted = (count / burst).min(bursts.len()).max(1);
        let mut chosen: Vec<usize> = if count >= all.len() {
            (0..all.len()).collect()
        } else {
            (0..wanted)
                .map(|k| bursts[k * (bursts.len() - 1) / (wanted - 1).max(1)])
                .flat_map(|b| b..(b + burst).min(all.len()))
                .collect()
        };
        chosen.dedup();
        let ring_width = Ring { contrast: Contrast::DarkOnLight, width: base.trace.ring.and_then(|ring| ring.width) };
        Self {
            frames: chosen.iter().map(|&k| frames[k]).collect(),
            pictures: chosen.iter().map(|&k| Arc::clone(&all[k])).collect(),
            all,
            ground: OnceCell::new(),
            surfaces: OnceCell::new(),
            last_shown: RefCell::default(),
            base: base.clone(),
            factor: sample.factor() * further,
            ring_width: ring_width.widest(columns, rows),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.pictures.len()
    }

    /// Pixels of the sequence for one of these, along rows and columns.
    pub(super) fn factor(&self) -> f64 {
        f64::from(self.factor)
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
            transfer: Transfer::Linear,
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
            let counts = counted(shown.as_raw().iter().copied().step_by(NOISE_STEP));
            beyond_noise(&counts, LEAST_LEVEL).map(f64::round)
        });
        median(levels)
    }

    /// What a way looks at of a picture. What was shown last is kept: a way is tried with several levels, and lighter and darker things are looked
    /// for in the same picture.
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
        if settings.trace.ring.is_some() {
            return Shown { smooth: None, ..shown.clone() };
        }
        if sigma > 0.0 && shown.smooth.is_none() {
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
    pub(super) fn sights(&self, tracing: &Tracing) -> Vec<Sight> {
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

    /// How well the contour of the largest object that a way finds is known as a whole, in pixels of the sample: the part of its edges' error that
    /// all points have in common, and that of the mean of all points; the median over some of the pictures.
    pub(super) fn deviation_of_contour(&self, tracing: &Tracing) -> Option<f64> {
        let mut settings = self.settings(tracing);
        settings.trace.edges = Edges::Refined;
        let deviations = (0..self.count()).step_by(BURST as usize).filter_map(|k| {
            let seen = self.seen(tracing, &settings, k, 1)?;
            let edges = seen.traced.first()?.edges.as_ref()?;
            let of_points = edges.deviations.iter().map(|deviation| deviation.powi(2)).sum::<f64>().sqrt();
            Some(edges.systematic.hypot(of_points / edges.deviations.len() as f64))
        });
        median(deviations)
    }

    /// What a way looks at in each picture, and how.
    pub(super) fn views(&self, tracing: &Tracing) -> (PictureSettings, Vec<View>) {
        let settings = self.settings(tracing);
        let view = |(k, picture): (usize, &Arc<GrayImage>)| {
            let ground = self.ground(tracing, &settings, k).cloned();
            View { picture: Arc::clone(picture), ground }
        };
        let views = self.pictures.iter().enumerate().map(view).collect();
        (settings, views)
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

/// What decides which picture a way looks at: the way, or `None` for all those that look at the picture itself, and the smoothing. The threshold
/// does not, nor whether what is lighter or what is darker than it is an object.
type LookedAt = (Option<TracingWay>, Smoothing);

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
