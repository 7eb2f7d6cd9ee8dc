//! What an object looks like across its outline, and where that is seen near an outline that is expected.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline, Piece, PixelGrid};
use image::GrayImage;
use nalgebra::{Point2, Vector2};

use super::{interpolated, median};

/// Distance of the samples of a profile, in pixels.
const SPACING: f64 = 0.5;

/// Samples of the profile to either side of the outline: 6 pixels, so that a line that is drawn along the outline is seen as one.
const REACH: usize = 12;

/// Lines beside each other that are averaged for a profile, to either side, and their distance in pixels: against noise, and short against
/// bends.
const LINES: i32 = 2;
const LINES_APART: f64 = 0.8;

/// Distance of the profiles along the outline, in pixels, so that they share no line; closer where there would be fewer than the other number,
/// and farther apart where there would be more than the last, as along an outline that fills the picture.
const STEP: f64 = 4.0;
const FEWEST_PROFILES: f64 = 16.0;
const MOST_PROFILES: f64 = 512.0;

/// Pixels before and after a place that the direction of the outline is taken from.
const CHORD: f64 = 3.0;

/// Pictures that the profile is a mean of at least before it is looked for, and at most, so that it follows slow changes of the light.
const FEWEST_PICTURES: f64 = 3.0;
const MOST_PICTURES: f64 = 20.0;

/// Least correlation of a profile with the mean for it to be learnt from: the object may be hidden there.
const LEARNT_FROM: f64 = 0.5;

/// Least correlation of a profile with the mean for it to be the edge. Noise alone reaches 0.6 to 0.7 at the best of forty places.
const IS_EDGE: f64 = 0.8;

/// Least height of an edge over that of the mean, before the others of the picture are known; and how much lower than their median it may be
/// then, or higher by as much.
const LOWEST: f64 = 0.08;
const LOWER_THAN_OTHERS: f64 = 0.5;

/// Farthest that an edge may lie from where those around it are, in pixels, and how many these are to either side.
const FARTHEST_FROM_NEIGHBOURS: f64 = 1.5;
const NEIGHBOURS: usize = 3;

/// Profiles of an arc at least.
const SHORTEST_ARC: usize = 3;

/// Least share of the profiles that show the edge.
const SMALLEST_SHARE: f64 = 0.3;

/// Farthest that edges are looked for, in pixels: beyond it there are others.
const FARTHEST: f64 = 16.0;

/// Samples to either side within which the correlation has to fall by so much for its top to be a place: along a shading it is as high
/// everywhere, and a linear one correlates with a step by 0.88.
const NEAR_TOP: usize = 6;
const FALLS_BY: f64 = 0.1;

/// Another place farther off that is less worse than this leaves open which of them is the edge, as stripes do.
const RIVAL: f64 = 0.05;

/// Least share of what changes across the outline, in the mean square, that is alike everywhere along it. Where a grey object lies on black and
/// on white, the mean is what is left of both.
const ALIKE: f64 = 0.25;

/// The mean of the grey values along the normals of the outline of an object, as pictures have shown them so far.
///
/// Where an object cannot be told from its surroundings as a whole, as it touches another one or its contrast is low, its edges may still be
/// seen near the outline that is expected: where the grey values across it change as they did before.
///
/// ```
/// use freeform_curve_fit::{Piece, PixelGrid};
/// use freeform_outline_io::{EdgeProfile, GrayImage};
/// use nalgebra::{Point2, Vector2};
///
/// // A disc of radius 20 pixels at (x, 32).
/// let disc = |x: f64, light: f64| GrayImage::from_fn(96, 64, |column, row| {
///     let distance = (f64::from(column) + 0.5 - x).hypot(f64::from(row) + 0.5 - 32.0);
///     image::Luma([(40.0 + light * (20.5 - distance).clamp(0.0, 1.0)) as u8])
/// });
/// let grid = PixelGrid::new([0.0, 0.0], Point2::origin(), Vector2::new(1.0, 1.0));
/// let circle = |x: f64| -> Vec<_> {
///     (0..100).map(|i| f64::from(i) * std::f64::consts::TAU / 100.0)
///         .map(|t| Point2::new(x + 20.0 * t.cos(), 32.0 + 20.0 * t.sin()))
///         .collect()
/// };
/// let mut profile = EdgeProfile::default();
/// for _ in 0..5 {
///     profile.take(&disc(40.0, 160.0), &grid, [Piece { points: &circle(40.0), closed: true }]);
/// }
/// // It has moved by two pixels, and the light is a quarter of what it was.
/// let seen = profile.seek(&disc(42.0, 40.0), &grid, [Piece { points: &circle(40.0), closed: true }], 4.0);
/// let outline = seen.expect("all of it is there").outline;
/// assert!(outline.points().all(|p| ((p.x - 42.0).hypot(p.y - 32.0) - 20.0).abs() < 0.3));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EdgeProfile {
    /// Less their own mean; empty at first.
    mean: Vec<f64>,
    /// Mean square of the single profiles, less their own means, summed over the samples.
    square: f64,
    pictures: f64,
}

/// Edges that were looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct SoughtEdges {
    /// The arcs where they are seen.
    pub outline: Outline,
    /// Share of the outline expected that they are.
    pub share: f64,
}

/// A place on an outline with its normal, in pixels; the picture may end near it.
#[derive(Debug, Clone, Copy)]
struct Station {
    place: Point2<f64>,
    normal: Vector2<f64>,
}

/// Where an edge was found.
#[derive(Debug, Clone, Copy)]
struct Found {
    /// Along the normal, in pixels.
    shift: f64,
    /// Height over that of the mean.
    gain: f64,
}

impl EdgeProfile {
    /// Whether enough pictures have been taken for edges to be looked for, and the object looks alike along its outline.
    #[must_use]
    pub fn is_known(&self) -> bool {
        let height = self.height();
        self.pictures >= FEWEST_PICTURES && height > 0.0 && height * height >= ALIKE * self.square
    }

    /// Takes a picture in which the outline was found there; `grid` leads from the picture to the coordinates of the outline.
    pub fn take<'a>(&mut self, picture: &GrayImage, grid: &PixelGrid, outline: impl IntoIterator<Item = Piece<'a>>) {
        let mut sum = vec![0.0; 2 * REACH + 1];
        let (mut count, mut square, mut values) = (0.0, 0.0, Vec::new());
        for station in stations_of(outline, grid).into_iter().flat_map(|(stations, _)| stations) {
            if !station.sample(picture, REACH, &mut values) {
                continue;
            }
            let fit = self.is_known().then(|| self.compare(&values));
            if fit.is_none_or(|(correlation, _)| correlation > LEARNT_FROM) {
                sum.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value);
                let level = values.iter().sum::<f64>() / values.len() as f64;
                square += values.iter().map(|value| (value - level).powi(2)).sum::<f64>();
                count += 1.0;
            }
        }
        if count == 0.0 {
            return;
        }
        let level = sum.iter().sum::<f64>() / sum.len() as f64;
        self.mean.resize(sum.len(), 0.0);
        self.pictures = (self.pictures + 1.0).min(MOST_PICTURES);
        self.square += (square / count - self.square) / self.pictures;
        for (mean, sum) in self.mean.iter_mut().zip(&sum) {
            *mean += ((sum - level) / count - *mean) / self.pictures;
        }
    }

    /// The edges within `reach`, in the unit of the outline and of a pixel at least, of an outline that is expected in a picture, as far as they
    /// are seen. `None` where less than three tenths of them are, where the reach is no number or more than 16 pixels, so that the object
    /// may well be elsewhere, and before the profile is [known](Self::is_known).
    #[must_use]
    pub fn seek<'a>(
        &self,
        picture: &GrayImage,
        grid: &PixelGrid,
        expected: impl IntoIterator<Item = Piece<'a>>,
        reach: f64,
    ) -> Option<SoughtEdges> {
        let pixel = grid.pixel_size().min();
        let pixels = reach / pixel;
        if !self.is_known() || pixels.is_nan() || pixels > FARTHEST {
            return None;
        }
        let shifts = (pixels.max(1.0) / SPACING).ceil() as usize;
        let pieces = stations_of(expected, grid);
        let mut values = Vec::new();
        let mut looked = |station: &Station, gains: [f64; 2]| {
            let is_within = station.sample(picture, REACH + shifts + NEAR_TOP, &mut values);
            if is_within { self.best(&values, gains) } else { None }
        };
        let mut look = |gains: [f64; 2]| -> Vec<Vec<Option<Found>>> {
            let all = pieces.iter();
            all.map(|(stations, _)| stations.iter().map(|station| looked(station, gains)).collect()).collect()
        };
        let first = look([LOWEST, f64::INFINITY]);
        let typical = median(first.iter().flatten().flatten().map(|found| found.gain))?;
        let found = look([LOWER_THAN_OTHERS * typical, typical / LOWER_THAN_OTHERS]);
        let (mut arcs, mut seen, mut all) = (Vec::new(), 0, 0);
        for ((stations, closed), found) in pieces.iter().zip(found) {
            let found = without_strays(&found, *closed);
            all += found.len();
            for run in runs(&found, *closed).into_iter().filter(|run| run.len() >= SHORTEST_ARC) {
                seen += run.len();
                let is_whole = *closed && run.len() == found.len();
                let again = is_whole.then(|| run[0]);
                let points = run.into_iter().chain(again).filter_map(|i| {
                    let place = stations[i].place + found[i]?.shift * stations[i].normal;
                    Some(grid.to_plane(place.x, place.y))
                });
                arcs.push(OpenArc::new(points.collect()).ok()?);
            }
        }
        let share = seen as f64 / all as f64;
        let outline = OpenOutline::in_sequence(arcs).ok()?.into();
        (share >= SMALLEST_SHARE).then_some(SoughtEdges { outline, share })
    }

    fn height(&self) -> f64 {
        self.mean.iter().map(|value| value * value).sum::<f64>().sqrt()
    }

    /// Correlation of the mean with as many values, and their height over it.
    fn compare(&self, values: &[f64]) -> (f64, f64) {
        let level = values.iter().sum::<f64>() / values.len() as f64;
        let (mut along, mut squares) = (0.0, 0.0);
        for (mean, value) in self.mean.iter().zip(values) {
            along += mean * value;
            squares += (value - level).powi(2);
        }
        let height = self.height();
        (if squares > 0.0 { along / (height * squares.sqrt()) } else { 0.0 }, along / (height * height))
    }

    /// Where in a longer profile the mean is seen best, of a height within limits; not near its ends, where it is not seen how the correlation
    /// falls.
    fn best(&self, values: &[f64], [lowest, highest]: [f64; 2]) -> Option<Found> {
        let fits: Vec<(f64, f64)> = values.windows(self.mean.len()).map(|window| self.compare(window)).collect();
        let inner = NEAR_TOP..fits.len() - NEAR_TOP;
        let is_allowed = |k: &usize| fits[*k].0 >= IS_EDGE && (lowest..=highest).contains(&fits[*k].1);
        let k = inner.filter(is_allowed).max_by(|a, b| fits[*a].0.total_cmp(&fits[*b].0))?;
        let [before, here, after] = [fits[k - 1].0, fits[k].0, fits[k + 1].0];
        let bend = before - 2.0 * here + after;
        // The top of the parabola through the three; no top where the next is as good, or where it is as good all around.
        let falls = |mut side: std::ops::Range<usize>| side.any(|j| fits[j].0 <= here - FALLS_BY);
        let is_top = falls(k - NEAR_TOP..k) && falls(k + 1..k + 1 + NEAR_TOP);
        let is_rival = |j: &usize| j.abs_diff(k) > NEAR_TOP && fits[*j].0 >= here - RIVAL && is_allowed(j);
        if bend >= 0.0 || before > here || after > here || !is_top || (0..fits.len()).any(|j| is_rival(&j)) {
            return None;
        }
        let shift = k as f64 - (fits.len() / 2) as f64 + 0.5 * (before - after) / bend;
        Some(Found { shift: SPACING * shift, gain: fits[k].1 })
    }
}

impl Station {
    /// The grey values along its normal, so many samples to either side, each the mean of some lines beside each other; whether all of them
    /// are in the picture.
    fn sample(&self, picture: &GrayImage, reach: usize, values: &mut Vec<f64>) -> bool {
        let Self { place, normal } = self;
        let along = Vector2::new(-normal.y, normal.x);
        let end = SPACING * reach as f64;
        let aside = LINES_APART * f64::from(LINES);
        let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
        let is_within = [[end, aside], [end, -aside], [-end, aside], [-end, -aside]].into_iter().all(|[out, side]| {
            let p = place + out * normal + side * along;
            (0.5..width - 0.5).contains(&p.x) && (0.5..height - 0.5).contains(&p.y)
        });
        values.clear();
        let pixels = picture.as_raw();
        if is_within {
            values.extend((0..=2 * reach).map(|k| {
                let at = place + SPACING * (k as f64 - reach as f64) * normal;
                let line = |line: i32| {
                    // Places are told from the corner of the picture here.
                    let beside = at + LINES_APART * f64::from(line) * along - Vector2::repeat(0.5);
                    interpolated(picture.dimensions(), beside, |pixel| f64::from(pixels[pixel]))
                };
                (-LINES..=LINES).map(line).sum::<f64>() / f64::from(2 * LINES + 1)
            }));
        }
        is_within
    }
}

/// Places at even distances along the pieces of an outline, with the normal on their right, piece by piece; and whether that is closed. Pieces that
/// are too short to have a direction have none.
fn stations_of<'a>(outline: impl IntoIterator<Item = Piece<'a>>, grid: &PixelGrid) -> Vec<(Vec<Station>, bool)> {
    let lines: Vec<Line> = outline.into_iter().map(|piece| Line::of(&piece, grid)).collect();
    let total: f64 = lines.iter().map(Line::length).sum();
    let step = STEP.min(total / FEWEST_PROFILES).max(total / MOST_PROFILES);
    lines.iter().map(|line| (line.stations(step), line.closed)).collect()
}

/// A line in a picture, in pixels.
struct Line {
    points: Vec<Point2<f64>>,
    /// From the first point to each.
    lengths: Vec<f64>,
    closed: bool,
}

impl Line {
    fn of(piece: &Piece<'_>, grid: &PixelGrid) -> Self {
        let mut points: Vec<Point2<f64>> = piece.points.iter().map(|p| Point2::from(grid.to_pixels(p))).collect();
        if piece.closed {
            points.extend(points.first().copied());
        }
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
        }
        Self { points, lengths, closed: piece.closed }
    }

    fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The place so far along it; it goes on where it is closed.
    fn at(&self, s: f64) -> Point2<f64> {
        let Self { points, lengths, closed } = self;
        let length = self.length();
        let s = if *closed { s.rem_euclid(length) } else { s.clamp(0.0, length) };
        let i = lengths.partition_point(|l| *l <= s).clamp(1, points.len() - 1);
        let share = ((s - lengths[i - 1]) / (lengths[i] - lengths[i - 1])).clamp(0.0, 1.0);
        points[i - 1] + if share.is_finite() { share } else { 0.0 } * (points[i] - points[i - 1])
    }

    fn stations(&self, step: f64) -> Vec<Station> {
        let length = self.length();
        if !length.is_finite() || length <= 2.0 * CHORD || self.points.len() < 2 {
            return Vec::new();
        }
        let count = (length / step) as usize;
        let station = |i: usize| {
            let s = length * (i as f64 + 0.5) / count as f64;
            let chord = (self.at(s + CHORD) - self.at(s - CHORD)).try_normalize(1e-9)?;
            Some(Station { place: self.at(s), normal: Vector2::new(chord.y, -chord.x) })
        };
        (0..count).filter_map(station).collect()
    }
}

/// What was found, without what lies elsewhere than that around it, or has none around it.
fn without_strays(found: &[Option<Found>], closed: bool) -> Vec<Option<Found>> {
    let count = found.len();
    let around = |i: usize| {
        (1..=NEIGHBOURS).flat_map(move |k| {
            let before = if i >= k { Some(i - k) } else { closed.then(|| (i + k * count - k) % count) };
            let after = if i + k < count { Some(i + k) } else { closed.then(|| (i + k) % count) };
            [before, after].into_iter().flatten().filter(move |j| *j != i)
        })
    };
    let keep = |i: usize| {
        let here = found[i]?;
        let shifts: Vec<f64> = around(i).filter_map(|j| Some(found[j]?.shift)).collect();
        let middle = median(shifts.iter().copied()).filter(|_| shifts.len() > 1)?;
        ((here.shift - middle).abs() <= FARTHEST_FROM_NEIGHBOURS).then_some(here)
    };
    (0..count).map(keep).collect()
}

/// Numbers of those found that follow each other, run by run.
fn runs(found: &[Option<Found>], closed: bool) -> Vec<Vec<usize>> {
    let count = found.len();
    // One that goes on over the end begins after a gap.
    let start = found.iter().position(Option::is_none).filter(|_| closed).unwrap_or(0);
    let order: Vec<usize> = (0..count).map(|k| (start + k) % count).collect();
    order.split(|i| found[*i].is_none()).filter(|run| !run.is_empty()).map(<[usize]>::to_vec).collect()
}
