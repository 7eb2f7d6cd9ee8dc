//! From the noisy points of one frame to places and normals along the contour, robust against outliers.
use std::ops::RangeInclusive;

use nalgebra::{Point2, Vector2};

use super::{
    local_fit::{LocalFit, Sums, direction_variance, wider_if_alike},
    medians::{median, running_medians_of_nine},
    plain_regression::PlainRegression,
};
use crate::tuning::{contour as tuning, measurement::MEDIAN_TO_DEVIATION};

/// A place on the contour: position and unit normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) centre: Point2<f64>,
    pub(crate) normal: Vector2<f64>,
}

/// One connected piece of the contour, resampled.
#[derive(Debug, Clone)]
pub(crate) struct SmoothPiece {
    pub(crate) places: Vec<Place>,
    pub(crate) closed: bool,
}

/// Points of one piece with what is found of them.
#[derive(Debug, Clone)]
pub(crate) struct Contour {
    points: Vec<Point2<f64>>,
    closed: bool,
    outlier: Vec<bool>,
    /// Mean distance of points that follow each other, in the median; positive.
    median_step: f64,
    plain: PlainRegression,
}

impl Contour {
    pub(crate) fn new(points: Vec<Point2<f64>>, closed: bool) -> Self {
        let plain = PlainRegression::default();
        let mut contour = Self { outlier: vec![false; points.len()], points, closed, median_step: 0.0, plain };
        contour.median_step = contour.found_median_step();
        contour.mark_gross_outliers();
        contour
    }

    /// Takes over what has been worked out of the same points, whichever of them were outliers.
    pub(super) fn adopt_regressions(&mut self, other: &Self) {
        self.plain.adopt(&other.plain);
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Standard deviation of the noise along the normal, from the residuals of a pilot regression; marks outliers on the way.
    pub(crate) fn noise(&mut self) -> Option<f64> {
        let mut sigma = self.residual_scale(tuning::PILOT_HALF_WINDOW)?;
        let mut before: Option<(usize, Vec<bool>)> = None;
        for _ in 0..2 {
            // Along a line whose direction is noise, residuals are too small.
            let window = self.half_window_for(sigma, tuning::PILOT_NORMAL_NOISE).max(tuning::PILOT_HALF_WINDOW);
            self.mark_outliers(window, sigma);
            // With the same window and the same outliers it would be found again.
            if before.is_none_or(|(last, outlier)| last != window || outlier != self.outlier) {
                sigma = self.residual_scale(window)?;
            }
            before = Some((window, self.outlier.clone()));
        }
        Some(sigma)
    }

    /// Scatter of the points along the normal about local quadratics that reach as far as `reach` along the contour, either way: noise, and
    /// what else is shorter than that. `None` for a contour of few points.
    pub(crate) fn scatter_over(&self, reach: f64) -> Option<f64> {
        let points = reach / self.median_step;
        let mut contour = self.clone();
        contour.residual_scale((points.round() as usize).min(self.widest_usual()).max(*tuning::HALF_WINDOWS.start()))
    }

    /// Smallest window that gives normals a direction with a deviation of no more than `normal_noise`, in rad, for noise `sigma`: as far as
    /// a sixth of the contour allows where that is less than normals usually need.
    pub(super) fn half_window(&self, sigma: f64, normal_noise: f64) -> usize {
        let usual = self.half_window_for(sigma, tuning::NORMAL_NOISE);
        if normal_noise < tuning::NORMAL_NOISE {
            let largest = (self.points.len() / tuning::FINE_PARTS).min(tuning::LARGEST_FINE);
            self.narrowest(sigma, normal_noise, largest).max(usual)
        } else {
            usual
        }
    }

    fn half_window_for(&self, sigma: f64, normal_noise: f64) -> usize {
        self.narrowest(sigma, normal_noise, self.widest_usual())
    }

    /// Widest window that is usual, as far as the contour allows.
    fn widest_usual(&self) -> usize {
        (self.points.len() / tuning::PARTS).min(*tuning::HALF_WINDOWS.end())
    }

    fn narrowest(&self, sigma: f64, normal_noise: f64, largest: usize) -> usize {
        let noise = sigma / self.median_step;
        let smallest = *tuning::HALF_WINDOWS.start();
        let is_enough = |w: &usize| direction_variance(noise, *w) <= normal_noise * normal_noise;
        (smallest..=largest).find(is_enough).unwrap_or(largest.max(smallest))
    }

    /// A window that was chosen for another contour, no wider than this one allows where it is wider than windows usually are.
    fn no_wider(&self, half_window: usize) -> usize {
        half_window.min((self.points.len() / tuning::PARTS).max(*tuning::HALF_WINDOWS.end()))
    }

    /// Places every `spacing` along the smoothed contour. Windows that are wider than normals usually need are narrower where they would cut
    /// off what stands out, such as the pin of a disc, which alone shows its turn.
    pub(crate) fn resampled(&mut self, sigma: f64, half_window: usize, spacing: f64) -> Option<SmoothPiece> {
        let half_window = self.no_wider(half_window);
        let usual = self.half_window_for(sigma, tuning::NORMAL_NOISE).min(half_window);
        self.mark_outliers(usual, sigma);
        let mut fits = Vec::with_capacity(self.points.len() + 1);
        fits.extend(self.widest_fits(usual..=half_window, sigma).into_iter().flatten());
        if fits.len() < tuning::FEWEST_RESAMPLED {
            return None;
        }
        if self.closed {
            fits.push(fits[0]);
        }
        let mut along = Vec::with_capacity(fits.len());
        let mut length = 0.0;
        for (i, fit) in fits.iter().enumerate() {
            if i > 0 {
                length += (fit.position - fits[i - 1].position).norm();
            }
            along.push(length);
        }
        let count = (length / spacing).round().max(1.0);
        if length <= 0.0 || !length.is_finite() || count > tuning::MOST_PLACES {
            return None;
        }
        let step = length / count;
        let mut places = Vec::with_capacity(count as usize);
        let mut i = 0;
        for k in 0..count as usize {
            let s = (k as f64 + 0.5) * step;
            while i + 2 < along.len() && along[i + 1] < s {
                i += 1;
            }
            let width = along[i + 1] - along[i];
            let t = if width > 0.0 { ((s - along[i]) / width).clamp(0.0, 1.0) } else { 0.5 };
            let centre = fits[i].position + t * (fits[i + 1].position - fits[i].position);
            let tangent = (1.0 - t) * fits[i].tangent + t * fits[i + 1].tangent;
            if let Some(tangent) = tangent.try_normalize(tuning::NO_DIRECTION) {
                places.push(Place { centre, normal: Vector2::new(tangent.y, -tangent.x) });
            }
        }
        (!places.is_empty()).then_some(SmoothPiece { places, closed: self.closed })
    }

    /// Length of the contour, smoothed.
    pub(crate) fn smooth_length(&mut self, half_window: usize) -> f64 {
        let half_window = self.no_wider(half_window);
        self.prepare(half_window);
        let fits = (0..self.points.len()).filter(|i| !self.outlier[*i]).filter_map(|i| self.local_fit(i, half_window));
        let (mut length, mut before, mut first) = (0.0, None, None);
        for LocalFit { position, .. } in fits {
            if let Some(before) = before {
                length += (position - before as Point2<f64>).norm();
            }
            first = first.or(Some(position));
            before = Some(position);
        }
        if let (true, Some(first), Some(last)) = (self.closed, first, before) {
            length += (last - first).norm();
        }
        length
    }

    /// Index of the point `offset` places from point i, if there is one.
    fn neighbour(&self, i: usize, offset: isize) -> Option<usize> {
        let n = self.points.len() as isize;
        let k = i as isize + offset;
        if (0..n).contains(&k) {
            return Some(k as usize);
        }
        // Less than a round off, where a remainder would be most of the work.
        let k = if k < 0 { k + n } else { k - n };
        self.closed.then(|| if (0..n).contains(&k) { k as usize } else { k.rem_euclid(n) as usize })
    }

    fn found_median_step(&self) -> f64 {
        let chord = tuning::STEPS_OF_CHORD.min(self.points.len() / 3).max(1);
        let steps = (0..self.points.len()).filter_map(|i| {
            let j = self.neighbour(i, chord as isize)?;
            Some((self.points[j] - self.points[i]).norm() / chord as f64)
        });
        median(&mut steps.collect::<Vec<_>>()).unwrap_or(0.0).max(f64::MIN_POSITIVE)
    }

    fn mark_gross_outliers(&mut self) {
        let n = self.points.len();
        if n < 4 * tuning::MEDIAN_HALF_WINDOW {
            return;
        }
        let m = tuning::MEDIAN_HALF_WINDOW;
        // Around a closed contour; along an open one those whose windows end within.
        let ends = if self.closed { (n - m..n, 0..m) } else { (0..0, 0..0) };
        let around = || ends.0.clone().chain(0..n).chain(ends.1.clone());
        let coordinates: [Vec<f64>; 2] =
            [around().map(|i| self.points[i].x).collect(), around().map(|i| self.points[i].y).collect()];
        let [xs, ys] = coordinates.map(|numbers| running_medians_of_nine(&numbers));
        let first = if self.closed { 0 } else { m };
        let mut distances = Vec::with_capacity(n);
        for (i, p) in self.points.iter().enumerate() {
            let middle = match i.checked_sub(first).filter(|at| *at < xs.len()) {
                Some(at) => Point2::new(xs[at], ys[at]),
                None => self.median_at_end(i),
            };
            distances.push((p - middle).norm());
        }
        let scale = median(&mut distances.clone()).unwrap_or(0.0);
        for (outlier, distance) in self.outlier.iter_mut().zip(distances) {
            *outlier = distance > tuning::GROSS * scale;
        }
    }

    /// At an open end the window of the median slides inwards; its median stands off along the contour, which the scale allows for.
    fn median_at_end(&self, i: usize) -> Point2<f64> {
        let m = tuning::MEDIAN_HALF_WINDOW as isize;
        let near = || (-m..=m).filter_map(|offset| self.neighbour(i, offset)).map(|j| &self.points[j]);
        let [mut xs, mut ys]: [Vec<f64>; 2] = [near().map(|p| p.x).collect(), near().map(|p| p.y).collect()];
        Point2::new(median(&mut xs).unwrap_or(0.0), median(&mut ys).unwrap_or(0.0))
    }

    fn residual_scale(&mut self, half_window: usize) -> Option<f64> {
        self.prepare(half_window);
        let mut residuals = Vec::with_capacity(self.points.len());
        residuals.extend((0..self.points.len()).filter(|i| !self.outlier[*i]).filter_map(|i| {
            let fit = self.local_fit(i, half_window)?;
            (fit.residual_variance > tuning::TELLING_RESIDUAL_VARIANCE).then(|| fit.residual()).flatten()
        }));
        median(&mut residuals).map(|m| MEDIAN_TO_DEVIATION * m)
    }

    fn mark_outliers(&mut self, half_window: usize, sigma: f64) {
        self.prepare(half_window);
        let marks: Vec<bool> = (0..self.points.len())
            .map(|i| {
                let residual = self.local_fit(i, half_window).and_then(|fit| fit.residual());
                residual.is_none_or(|r| r > tuning::OUTLYING * sigma)
            })
            .collect();
        let marks = self.without_long_runs(marks);
        if marks.iter().filter(|mark| **mark).count() * tuning::MOST_MARKED < marks.len() {
            self.outlier = marks;
        }
    }

    /// Marks but those of more points in a row than outliers are found in, that are as close together as others: what stands out sharply, such
    /// as a pin, is off every line through the points beside it.
    fn without_long_runs(&self, mut marks: Vec<bool>) -> Vec<bool> {
        let n = marks.len();
        let Some(first) = (0..n).find(|i| !marks[*i]) else { return marks };
        let farthest = tuning::OF_RUN * self.median_step;
        let mut run = Vec::new();
        for i in (first..=first + n).map(|i| i % n) {
            if marks[i] {
                run.push(i);
                continue;
            }
            let is_close = |i: &usize| {
                self.neighbour(*i, 1).is_none_or(|next| (self.points[next] - self.points[*i]).norm() <= farthest)
            };
            let close = run.iter().filter(|i| is_close(i)).count();
            if run.len() > tuning::MEDIAN_HALF_WINDOW && close as f64 > tuning::CLOSE_OF_RUN * run.len() as f64 {
                run.iter().for_each(|i| marks[*i] = false);
            }
            run.clear();
        }
        marks
    }

    /// Local quadratics at the points that are no outliers, over the wider of two windows where the place agrees with that over the narrower
    /// one (Lepski 1991).
    fn widest_fits(&mut self, half_windows: RangeInclusive<usize>, sigma: f64) -> Vec<Option<LocalFit>> {
        let (narrowest, widest) = half_windows.into_inner();
        let mut fits_over = |half_window| -> Vec<Option<LocalFit>> {
            self.prepare(half_window);
            let inliers = (0..self.points.len()).filter(|i| !self.outlier[*i]);
            let mut fits = Vec::with_capacity(self.points.len());
            fits.extend(inliers.map(|i| self.local_fit(i, half_window)));
            fits
        };
        // Outliers have just been marked by the narrower one.
        let narrow = fits_over(narrowest);
        if narrowest == widest {
            return narrow;
        }
        let wide = fits_over(widest);
        wide.into_iter().zip(narrow).map(|(wide, narrow)| wider_if_alike(wide?, narrow, sigma)).collect()
    }

    /// Prepares the regressions with a window, which [`local_fit`](Self::local_fit) is to be asked for next.
    fn prepare(&mut self, half_window: usize) {
        self.plain.prepare(&self.points, self.closed, half_window);
        self.plain.count_outliers(&self.outlier, self.closed);
    }

    /// Least-squares quadratic of position against the number of the point, over the point and the nearest neighbours on either side that
    /// are not outliers.
    #[inline(always)]
    fn local_fit(&self, i: usize, half_window: usize) -> Option<LocalFit> {
        self.plain.at(i, half_window).or_else(|| self.fit_of_inliers(i, half_window))
    }

    /// As [`local_fit`](Self::local_fit), whatever is in the window.
    #[inline(never)]
    fn fit_of_inliers(&self, i: usize, half_window: usize) -> Option<LocalFit> {
        let w = half_window as isize;
        let (origin, width) = (self.points[i], w as f64);
        let mut sums = Sums::default();
        if !self.outlier[i] {
            sums.add(0.0, Vector2::zeros());
        }
        for side in [-1, 1] {
            let farthest = w.max((self.points.len() / tuning::PARTS) as isize);
            let mut left = half_window;
            for distance in 1..=farthest {
                if left == 0 {
                    break;
                }
                let offset = side * distance;
                let Some(j) = self.neighbour(i, offset) else { break };
                if !self.outlier[j] {
                    sums.add(offset as f64 / width, self.points[j] - origin);
                    left -= 1;
                }
            }
        }
        sums.fit(origin, self.outlier[i])
    }
}

/// Whether a contour may be smoothed over so many points to either side.
#[cfg(feature = "serde")]
pub(super) fn is_half_window(points: usize) -> bool {
    (*tuning::HALF_WINDOWS.start()..=tuning::LARGEST_FINE).contains(&points)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    #[test]
    fn regressions_of_all_points_together_are_those_of_single_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for (count, closed, half_window) in
            [(200, true, 4), (203, false, 9), (9, true, 4), (401, true, 30), (70, false, 2)]
        {
            let points = (0..count).map(|i| {
                let t = std::f64::consts::TAU * 0.9 * f64::from(i) / f64::from(count);
                let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
                let far = if i % 97 == 30 { 0.3 } else { 0.01 };
                Point2::new(t.cos() + far * noise(), 0.7 * t.sin() + far * noise())
            });
            let mut together = Contour::new(points.collect(), closed);
            let alone = together.clone();
            together.prepare(half_window);
            let mut compared = 0;
            for i in 0..together.len() {
                let (Some(found), Some(expected)) =
                    (together.local_fit(i, half_window), alone.local_fit(i, half_window))
                else {
                    assert_eq!(together.local_fit(i, half_window), alone.local_fit(i, half_window));
                    continue;
                };
                assert!((found.position - expected.position).norm() < 1e-12, "{count} {i}");
                assert!((found.tangent - expected.tangent).norm() < 1e-12, "{count} {i}");
                assert!((found.residual_variance - expected.residual_variance).abs() < 1e-12, "{count} {i}");
                compared += usize::from(together.plain.at(i, half_window).is_some());
            }
            // An outlier is in the windows of many.
            assert!(8 * compared > together.len() || count < 10, "{count}: {compared}");
        }
    }
}
