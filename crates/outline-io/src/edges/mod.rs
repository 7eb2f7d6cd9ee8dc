//! Outlines moved onto the edges themselves.
//!
//! Along the normal of an outline the grey value is `m + c (Phi((s - e) / w) - 1/2)`: a step between the grey values of the two
//! sides, blurred by a Gaussian. With the place `e` of the step come its own height `c` and middle `m`, so that neither a threshold
//! nor a shading moves it. The width `w` is one for a contour, or goes with the direction of the edge where the body
//! moves while the shutter is open.
//!
//! | module | question |
//! |---|---|
//! | `sampler` | which grey values lie along a normal? |
//! | `step_fit` | which step does one profile show, to first order? |
//! | `fitting` | where is the edge on every normal, by the widest profile that shows it alone? |
//! | `blur_width` | how wide are the edges, by their direction? |
//! | `bends` | by how much does blur move the edges of bent outlines? |
//! | `systematic` | by how much may the edges of a side lie off together? |
//! | `on_pixels` | are the edges those of pixels? |
//! | `crossings` | which points have moved past each other? |
//! | `learnt_profile` | where is the edge of a known object, by what its edges looked like before? |
mod bends;
mod blur_width;
mod crossings;
mod fitting;
mod learnt_profile;
mod on_pixels;
mod sampler;
mod step_fit;
mod systematic;

use freeform_curve_fit::isoline::Crossing;
use image::GrayImage;
use nalgebra::{Point2, Vector2};

use crate::tracing::contrast::Contrast;
use crate::tracing::input::GroundComparison;
use crate::tracing::transfer::Transfer;
pub use learnt_profile::{EdgeProfile, SoughtEdges};

use bends::{bends, of_long_way};
use crossings::{Moved, undo_crossings};
use fitting::Fitted;
use sampler::Sampler;
use step_fit::StepFit;

/// Width of the edges before it is known, in pixels.
const FIRST_WIDTH: f64 = 1.2;

/// Crossings to either side that the direction of an outline is taken from.
const NEIGHBOURS: usize = 3;

/// An edge farther from the outline than this, and so many widths of the edge, is another edge, in pixels.
const FARTHEST: [f64; 2] = [1.2, 1.2];

/// Standard deviation of a point without an edge, in pixels: half of how far edges may lie from it.
pub(crate) const UNSEEN: f64 = 0.5 * (FARTHEST[0] + FARTHEST[1] * FIRST_WIDTH);

/// A step of less than this share of the median step of the contour is no edge of the object.
const SMALLEST_STEP: f64 = 0.3;

/// A step of less than so many standard deviations of its own is none.
const CLEAR_STEP: f64 = 3.0;

/// A fit that leaves so many times the median of the contour is that of something else.
const WORST_FIT: f64 = 3.5;

/// Least that fits leave, and least noise, in grey values, whatever is found: about what rounding to whole ones leaves.
const LEAST_RESIDUAL: f64 = 0.5;
const LEAST_NOISE: f64 = 0.3;

/// Farthest that an edge may lie from those of its neighbours, in pixels and in widths of the edge.
const FARTHEST_FROM_NEIGHBOURS: [f64; 2] = [0.7, 0.5];

/// Share of the standard deviation of noise that bilinear interpolation leaves, in the mean over all places.
const INTERPOLATED_NOISE: f64 = 2.0 / 3.0;

/// Part of the deviation of a single point beside its noise, in pixels: bends, corners and the grid. What a whole side is off by does not tell
/// which of its points count for more, and from picture to picture it is known too roughly to weigh one against the other.
pub(crate) const OF_POINT: f64 = 0.01;

/// Edges of one width whose residuals have a median of their own, to a fifth of it.
const FEWEST_OF_WIDTH: usize = 24;

/// Standard deviation of the Gaussian that heights of steps are smoothed by along the contour, in points.
const STEPS_TOGETHER: f64 = 4.0;

/// Share of points between two pixels from which on edges are those of pixels: far beyond what random places have, and what is hidden by
/// details that are as small as pixels is left to the object.
const MOST_ON_PIXELS: f64 = 0.7;

/// Deviation of a number that is rounded to a whole one.
const ROUNDED_TO_PIXELS: f64 = 0.288_675;

/// What the edges of an outline are like, and how well they tell its place.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeFit {
    /// Standard deviation of each point of the outline along its normal, from contrast, blur and noise, in the unit of the outline: that
    /// of a place told by one pixel of contour. Of a point without an edge of its own, which lies between its neighbours', larger.
    pub deviations: Vec<f64>,
    /// Systematic uncertainty of the outline, in its unit: how far edges may lie off together along a side of it, by the grid of pixels, the
    /// rounding of grey values, and light that changes on one side of the edge; of edges that are [those of pixels](Self::is_on_pixels) their
    /// rounding too.
    pub systematic: f64,
    /// Median height of the step, in grey values; positive. Where edges are looked for in light, it is a height of the light, divided by how much
    /// light a grey value more is in the middle of the edges.
    pub contrast: f64,
    /// Width of the edges: the standard deviation of their Gaussian blur in the mean over all directions, in pixels.
    pub blur: f64,
    /// How far the object moves while the shutter is open, in pixels, up to a quarter too long: told by edges across its path, which are wider than
    /// those along it. From about 1.5 pixels on, up to 30; 0 where all are alike. Pictures that were filtered along their rows alone have such edges
    /// too.
    pub motion_blur: f64,
    /// How far edges may lie off together for that, in the unit of the outline. Not part of [`systematic`](Self::systematic).
    pub systematic_by_motion: f64,
    /// Standard deviation of the grey values about the fitted steps, in the unit of the contrast.
    pub noise: f64,
    /// Share of the points that have an edge of their own.
    pub clear_share: f64,
    /// Share of the points whose edge lies between two pixels, neither of which shows a part of the step: nearly all where the object is drawn
    /// without anti-aliasing, up to a third where it is drawn with it, hardly any in pictures of a camera.
    pub on_pixels: f64,
}

impl EdgeFit {
    /// Whether the edges are those of pixels: where they are rounded to, and not where the object has them.
    #[must_use]
    pub fn is_on_pixels(&self) -> bool {
        self.on_pixels > MOST_ON_PIXELS
    }

    /// With what such edges are off by, if they are: a side may lie off by half a pixel either way.
    fn with_rounding(self, on_pixels: f64) -> Self {
        let fit = Self { on_pixels, ..self };
        let rounding = if fit.is_on_pixels() { ROUNDED_TO_PIXELS } else { 0.0 };
        Self { systematic: fit.systematic.hypot(rounding), ..fit }
    }
}

/// What is looked at of a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeSource<'a> {
    /// In which objects are looked for: a picture, or its difference from what it is compared with.
    pub(crate) picture: &'a GrayImage,
    /// Of what it is the difference, if of anything.
    pub(crate) comparison: Option<GroundComparison<'a>>,
    pub(crate) contrast: Contrast,
    pub(crate) transfer: Transfer,
    /// Standard deviation of the smoothing along the contour, in points; 0 for none.
    pub(crate) along: f64,
}

/// Where an edge lies on the normal of a point.
#[derive(Debug, Clone, Copy, Default)]
struct Edge {
    /// From the point outwards, in pixels.
    place: f64,
    /// Height of the step, positive where the object is on its side of the contrast.
    height: f64,
    /// Root mean square of what the fit leaves.
    residual: f64,
    /// How much farther out the edge is seen as the light changes on one side of it more than on the other; `None` where its profile is too
    /// short to tell.
    one_sided: Option<f64>,
    /// Standard deviation of the place by its profile, of a pixel of contour where noise is as large as the step.
    deviation: f64,
}

impl EdgeSource<'_> {
    /// Moves a closed line of crossings, given from the left upper pixel of a window, onto the edges. `None`, and the line as it was, where
    /// it has no edges.
    pub(crate) fn refine(&self, line: &mut [Crossing], place: [usize; 2]) -> Option<EdgeFit> {
        let on_pixels = on_pixels::share(self.picture, line, place);
        let (fit, moved) = self.move_onto_edges(line, place)?;
        // The normals of a ragged line that is far from the edges are not those of the edges.
        let again = if moved == Moved::NotEverywhere { self.move_onto_edges(line, place) } else { None };
        Some(again.map_or(fit, |(fit, _)| fit).with_rounding(on_pixels))
    }

    /// As [`refine`](Self::refine), along the normals that the line has.
    fn move_onto_edges(&self, line: &mut [Crossing], [left, top]: [usize; 2]) -> Option<(EdgeFit, Moved)> {
        let at = |c: &Crossing| Point2::new(left as f64 + c.x, top as f64 + c.y);
        let points: Vec<Point2<f64>> = line.iter().map(at).collect();
        let normals: Vec<Option<Vector2<f64>>> = (0..line.len()).map(|i| outward(line, i)).collect();
        let Fitted { edges, blur, fits, fit_of } = Sampler::new(self, &points).fitted(&points, &normals)?;
        let all: Vec<usize> = (0..line.len()).filter(|&i| normals[i].is_some()).collect();
        let contrast = median(all.iter().map(|&i| edges[i].height))?;
        let residuals = residuals_of(&edges, &fit_of, fits.len(), &all)?;
        if contrast <= 0.0 {
            return None;
        }
        let noise = residuals.iter().copied().fold(f64::INFINITY, f64::min) / INTERPOLATED_NOISE;
        let limits: Vec<Limits> =
            fits.iter().zip(&residuals).map(|(fit, left)| Limits::of(fit, *left, contrast)).collect();
        let of_edge = |i: usize| &limits[fit_of[i]];
        let mut is_clear: Vec<bool> =
            (0..line.len()).map(|i| normals[i].is_some() && of_edge(i).are_kept_by(&edges[i])).collect();
        leave_out_strays(&edges, &mut is_clear, |i| of_edge(i).from_neighbours);
        let clear_share = is_clear.iter().filter(|clear| **clear).count() as f64 / all.len().max(1) as f64;
        let places = smoothed(&bridged(&edges, &is_clear)?, self.along);
        let (bends, of_motion) = bends(&points, &normals, &places, &blur);
        let shifts = edges.iter().zip(&is_clear).filter(|(_, clear)| **clear).filter_map(|(edge, _)| edge.one_sided);
        let systematic = systematic::of(&fits, noise, contrast, shifts);
        let steps = steps_around(&edges, &is_clear);
        let deviation = |i: usize| {
            let height = if is_clear[i] { steps[i] } else { contrast };
            let random = noise.max(LEAST_NOISE) * edges[i].deviation / height;
            if is_clear[i] { random } else { random.max(0.5 * of_edge(i).farthest) }
        };
        let mut deviations: Vec<f64> = (0..line.len()).map(deviation).collect();
        let shift = |i: usize| (places[i] + bends[i]) * normals[i].unwrap_or_default();
        // Nothing is seen beyond the picture.
        let [right, lower] = [self.picture.width(), self.picture.height()].map(|size| f64::from(size) - 0.5);
        let within = |p: Point2<f64>| Point2::new(p.x.clamp(-0.5, right), p.y.clamp(-0.5, lower));
        let mut moved: Vec<Point2<f64>> = (0..line.len()).map(|i| within(points[i] + shift(i))).collect();
        let on_edges = moved.clone();
        let result = undo_crossings(&points, &mut moved);
        for ((deviation, moved), on_edge) in deviations.iter_mut().zip(&moved).zip(&on_edges) {
            // A point that is not where its edge was found is off by as much.
            *deviation = deviation.hypot((moved - on_edge).norm());
        }
        for (crossing, (moved, before)) in line.iter_mut().zip(moved.iter().zip(&points)) {
            // The difference is rounded.
            crossing.x = (crossing.x + (moved.x - before.x)).clamp(-0.5 - left as f64, right - left as f64);
            crossing.y = (crossing.y + (moved.y - before.y)).clamp(-0.5 - top as f64, lower - top as f64);
        }
        let motion_blur = blur.motion_blur();
        let fit = EdgeFit {
            deviations,
            systematic,
            contrast,
            blur: blur.mean_width(),
            motion_blur,
            systematic_by_motion: of_motion.hypot(of_long_way(motion_blur, blur.extent_along(&points))),
            noise,
            clear_share,
            on_pixels: 0.0,
        };
        Some((fit, result))
    }
}

/// What edges of one width have to keep to be edges of the object.
struct Limits {
    /// Least height of the step, in grey values.
    height: f64,
    /// Most that the fit may leave, in grey values.
    residual: f64,
    /// Farthest from the outline, and from the edges around, in pixels.
    farthest: f64,
    from_neighbours: f64,
}

impl Limits {
    /// Of edges that were fitted so, of which fits leave this in the median, on a contour of this contrast.
    fn of(fit: &StepFit, residual: f64, contrast: f64) -> Self {
        let within = |[pixels, widths]: [f64; 2]| pixels + widths * fit.width();
        Self {
            height: (SMALLEST_STEP * contrast).max(CLEAR_STEP * fit.deviation_of_height(residual)),
            residual: WORST_FIT * residual.max(LEAST_RESIDUAL),
            farthest: within(FARTHEST),
            from_neighbours: within(FARTHEST_FROM_NEIGHBOURS),
        }
    }

    fn are_kept_by(&self, edge: &Edge) -> bool {
        edge.place.abs() <= self.farthest && edge.height >= self.height && edge.residual <= self.residual
    }
}

/// A value between the pixels of a picture of this size, whose centres are at whole numbers, by bilinear interpolation of those of the pixels around,
/// which are numbered row by row. Beyond the picture its edge goes on.
#[inline]
fn interpolated((width, height): (u32, u32), place: Point2<f64>, pixel: impl Fn(usize) -> f64) -> f64 {
    let (width, height) = (width as usize, height as usize);
    let (x, y) = (place.x.clamp(0.0, (width - 1) as f64), place.y.clamp(0.0, (height - 1) as f64));
    let (column, row) = ((x as usize).min(width.saturating_sub(2)), (y as usize).min(height.saturating_sub(2)));
    let (u, v) = (x - column as f64, y - row as f64);
    let (right, below) = (usize::from(width > 1), if height > 1 { width } else { 0 });
    let at = row * width + column;
    let upper = pixel(at) + u * (pixel(at + right) - pixel(at));
    let lower = pixel(at + below) + u * (pixel(at + below + right) - pixel(at + below));
    upper + v * (lower - upper)
}

/// The unit normal outwards at a crossing, in columns and rows; `None` on the edge of the picture.
fn outward(line: &[Crossing], index: usize) -> Option<Vector2<f64>> {
    let count = line.len();
    if line[index].at_edge {
        return None;
    }
    let reach = NEIGHBOURS.min(count / 8).max(1);
    let last =
        |step: &dyn Fn(usize) -> usize| (1..=reach).map(step).take_while(|&i| !line[i].at_edge).last().unwrap_or(index);
    let (before, after) = (&line[last(&|k| (index + count - k) % count)], &line[last(&|k| (index + k) % count)]);
    // What is at or above the level is on the left, seen with rows downwards.
    Vector2::new(before.y - after.y, after.x - before.x).try_normalize(1e-9)
}

/// What fits leave of edges of each width, in the median: what is not quite a Gaussian leaves more where it is wide. Of a few edges, what they leave
/// of all. `None` where there are none.
fn residuals_of(edges: &[Edge], fit_of: &[usize], fits: usize, all: &[usize]) -> Option<Vec<f64>> {
    let of_all = median(all.iter().map(|&i| edges[i].residual))?;
    let of_fit = |fit: usize| {
        let own = || all.iter().filter(move |&&i| fit_of[i] == fit);
        let known = (own().count() >= FEWEST_OF_WIDTH).then(|| median(own().map(|&i| edges[i].residual)));
        known.flatten().unwrap_or(of_all)
    };
    Some((0..fits).map(of_fit).collect())
}

/// Takes out edges that lie elsewhere than those around them.
fn leave_out_strays(edges: &[Edge], is_clear: &mut [bool], farthest: impl Fn(usize) -> f64) {
    let count = edges.len();
    let reach = (2 * NEIGHBOURS).min(count / 4);
    let strays: Vec<usize> = (0..count)
        .filter(|&i| is_clear[i])
        .filter(|&i| {
            let first = i + count - reach;
            let around =
                (first..=first + 2 * reach).map(|k| k % count).filter(|&j| is_clear[j]).map(|j| edges[j].place);
            // Where they lie no farther apart than that, none does from the one in the middle.
            let [low, high] =
                around.clone().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
            high - low > farthest(i) && (edges[i].place - median(around).unwrap_or(0.0)).abs() > farthest(i)
        })
        .collect();
    strays.into_iter().for_each(|i| is_clear[i] = false);
}

/// The places of all edges, of those that are not clear between their neighbours; `None` where less than a tenth is clear.
fn bridged(edges: &[Edge], is_clear: &[bool]) -> Option<Vec<f64>> {
    let count = edges.len();
    let known: Vec<usize> = (0..count).filter(|&i| is_clear[i]).collect();
    if known.len() < 3 || 10 * known.len() < count {
        return None;
    }
    let mut places: Vec<f64> = edges.iter().map(|edge| edge.place).collect();
    for (k, &from) in known.iter().enumerate() {
        let to = known[(k + 1) % known.len()];
        let gap = (to + count - from) % count;
        for step in 1..gap {
            let share = step as f64 / gap as f64;
            places[(from + step) % count] = edges[from].place + share * (edges[to].place - edges[from].place);
        }
    }
    Some(places)
}

/// The heights of the clear steps, each the mean over those around it: a height has noise of its own, which is not to say how well a
/// place is known. Those of others as they are.
fn steps_around(edges: &[Edge], is_clear: &[bool]) -> Vec<f64> {
    let of_clear = |value: &dyn Fn(&Edge) -> f64| {
        let values = edges.iter().zip(is_clear).map(|(edge, clear)| if *clear { value(edge) } else { 0.0 });
        smoothed(&values.collect::<Vec<_>>(), STEPS_TOGETHER)
    };
    let (sums, weights) = (of_clear(&|edge| edge.height), of_clear(&|_| 1.0));
    let means = sums.into_iter().zip(weights).zip(edges.iter().zip(is_clear));
    means.map(|((sum, weight), (edge, clear))| if *clear { sum / weight } else { edge.height }).collect()
}

/// Smoothed along the contour by a Gaussian.
fn smoothed(places: &[f64], sigma: f64) -> Vec<f64> {
    let count = places.len();
    let reach = ((3.0 * sigma) as usize).min(count / 4);
    if reach == 0 {
        return places.to_vec();
    }
    let weights: Vec<f64> =
        (0..=2 * reach).map(|k| (-0.5 * ((k as f64 - reach as f64) / sigma).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    // All the way round and on, as far as windows reach.
    let (before, after) = (&places[count - reach..], &places[..reach]);
    let around: Vec<f64> = before.iter().chain(places).chain(after).copied().collect();
    let mean = |window: &[f64]| window.iter().zip(&weights).map(|(place, weight)| weight * place).sum::<f64>() / total;
    around.windows(weights.len()).map(mean).collect()
}

/// Median; `None` of nothing.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    let middle = values.len() / 2;
    if values.is_empty() { None } else { Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1) }
}
