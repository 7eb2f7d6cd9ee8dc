//! Local quadratics of all points of a contour together, where no outlier is near: the powers of the numbers of the points have the same sums
//! in every window.
use std::sync::Arc;

use nalgebra::Point2;

use super::local_fit::LocalFit;
use crate::vectors::vectorised;

/// The regressions with one window.
#[derive(Debug, Clone, Default)]
pub(super) struct PlainRegression {
    half_window: usize,
    fits: Arc<Vec<LocalFit>>,
    /// Those with every window that has been asked for: they do not depend on which points are outliers.
    known: Vec<(usize, Arc<Vec<LocalFit>>)>,
    /// Outliers before each place of the window of the first point, and of those that follow.
    outliers: Vec<u32>,
}

impl PlainRegression {
    /// Fits all points of a contour.
    pub(super) fn prepare(&mut self, points: &[Point2<f64>], closed: bool, half_window: usize) {
        if self.half_window == half_window {
            return;
        }
        self.half_window = half_window;
        let known = self.known.iter().find(|(known, _)| *known == half_window);
        self.fits = known.map_or_else(|| Arc::new(Self::fitted(points, closed, half_window)), |(_, fits)| fits.clone());
        if known.is_none() {
            self.known.push((half_window, self.fits.clone()));
        }
    }

    /// Takes over the regressions that are known of the same points.
    pub(super) fn adopt(&mut self, other: &Self) {
        self.known.clone_from(&other.known);
    }

    /// None where the contour is shorter than a window.
    fn fitted(points: &[Point2<f64>], closed: bool, half_window: usize) -> Vec<LocalFit> {
        let count = points.len();
        if count < 2 * half_window + 1 || half_window < 2 {
            return Vec::new();
        }
        let moments = Moments::of(half_window);
        let (mut fits, residual_variance) = (vec![LocalFit::default(); count], 1.0 - moments.by_own);
        // The points around the contour, or along it where every window ends within.
        let reach = if closed { half_window } else { 0 };
        let mut places = Vec::with_capacity(count + 2 * reach);
        for points in [&points[count - reach..], points, &points[..reach]] {
            places.extend(points.iter().map(|p| [p.x, p.y]));
        }
        let first = if closed { 0 } else { half_window };
        vectorised(
            #[inline(always)]
            || {
                moments.for_each_window(
                    &places,
                    #[inline(always)]
                    |window, sums| {
                        let ([off, slope], own) = (moments.solve(sums), places[window + half_window]);
                        let point = Point2::new(own[0], own[1]);
                        fits[first + window] = LocalFit::at(point, off.into(), slope.into(), residual_variance);
                    },
                );
            },
        );
        fits
    }

    /// Counts the outliers of a contour.
    pub(super) fn count_outliers(&mut self, outlier: &[bool], closed: bool) {
        let (count, half_window) = (outlier.len(), self.half_window);
        self.outliers.clear();
        if self.fits.is_empty() {
            return;
        }
        let mut sum = 0;
        self.outliers.reserve(count + 2 * half_window + 1);
        self.outliers.push(sum);
        // Beyond the ends nothing is a plain window.
        let beyond = vec![true; half_window];
        let (before, after) =
            if closed { (&outlier[count - half_window..], &outlier[..half_window]) } else { (&*beyond, &*beyond) };
        for outlier in [before, outlier, after] {
            self.outliers.extend(outlier.iter().map(|is_outlier| {
                sum += u32::from(*is_outlier);
                sum
            }));
        }
    }

    /// That of a point, unless its window is another, reaches beyond an end or holds an outlier.
    #[inline(always)]
    pub(super) fn at(&self, i: usize, half_window: usize) -> Option<LocalFit> {
        let is_plain = self.half_window == half_window
            && !self.fits.is_empty()
            && self.outliers[i] == self.outliers[i + 2 * half_window + 1];
        is_plain.then(|| self.fits[i])
    }
}

/// A number for each of the two coordinates.
type Pair = [f64; 2];

/// Sums of the powers of the places of a window, which lie from -1 to 1.
struct Moments {
    half_window: usize,
    second: f64,
    /// Of the inverse of the normal equations of value and bend.
    by_own: f64,
    by_bend: f64,
}

impl Moments {
    fn of(half_window: usize) -> Self {
        let places = || (1..=half_window).map(|place| place as f64 / half_window as f64);
        let second = 2.0 * places().map(|u| u * u).sum::<f64>();
        let fourth = 2.0 * places().map(|u| u.powi(4)).sum::<f64>();
        let count = (2 * half_window + 1) as f64;
        let determinant = count * fourth - second * second;
        Self { half_window, second, by_own: fourth / determinant, by_bend: -second / determinant }
    }

    /// Sums of the values of every window, less that in its middle, times the first three powers of their places.
    ///
    /// A window holds one place whose number is a multiple of its length. What lies before that and what follows it are sums of earlier ones with one
    /// value more (van Herk 1992), about that place and its value, and are then taken to the middle. Only values of the window ever enter: with sums
    /// that run on, a far outlier would leave its rounding in all windows after it.
    #[inline(always)]
    fn for_each_window(&self, values: &[Pair], mut visit: impl FnMut(usize, &[Pair; 3])) {
        let (half_window, length) = (self.half_window, 2 * self.half_window + 1);
        let (count, unit) = (length as f64, 1.0 / self.half_window as f64);
        let Some(last_window) = values.len().checked_sub(length) else { return };
        let mut following = vec![[[0.0; 2]; 3]; length];
        for middle in (0..values.len()).step_by(length) {
            let windows = (middle + 1).saturating_sub(length)..=middle.min(last_window);
            if windows.is_empty() {
                break;
            }
            let about = values[middle];
            let mut sums = [[0.0; 2]; 3];
            let last = (windows.end() + length).min(values.len());
            for (number, (value, following)) in values[middle..last].iter().zip(&mut following).enumerate() {
                add_value(&mut sums, number as f64 * unit, value, &about);
                *following = sums;
            }
            let mut before = [[0.0; 2]; 3];
            for window in (*windows.start()..=middle).rev() {
                let from_middle = middle as f64 - window as f64;
                if window < middle {
                    add_value(&mut before, -from_middle * unit, &values[window], &about);
                }
                if window > last_window {
                    continue;
                }
                let following = &following[window + length - 1 - middle];
                let (own, shift) = (values[window + half_window], from_middle * unit - 1.0);
                let mut sums = [[0.0; 2]; 3];
                for axis in 0..2 {
                    // Written one by one: a closure would be called.
                    let whole = before[0][axis] + following[0][axis];
                    let first = before[1][axis] + following[1][axis];
                    let second = before[2][axis] + following[2][axis];
                    let own = own[axis] - about[axis];
                    sums[0][axis] = whole - count * own;
                    sums[1][axis] = first + shift * whole;
                    sums[2][axis] = second + shift * (2.0 * first + shift * whole) - self.second * own;
                }
                visit(window, &sums);
            }
        }
    }

    /// Value in the middle, less that of its point, and slope.
    #[inline(always)]
    fn solve(&self, [whole, first, second]: &[Pair; 3]) -> [Pair; 2] {
        let Self { by_own, by_bend, second: square, .. } = self;
        let off = [by_own * whole[0] + by_bend * second[0], by_own * whole[1] + by_bend * second[1]];
        [off, [first[0] / square, first[1] / square]]
    }
}

/// Adds a value at a place, less another, to sums of values times powers of their places.
#[inline(always)]
fn add_value(sums: &mut [Pair; 3], place: f64, value: &Pair, about: &Pair) {
    for axis in 0..2 {
        let value = value[axis] - about[axis];
        sums[0][axis] += value;
        sums[1][axis] += place * value;
        sums[2][axis] += place * place * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_however_far_leaves_no_rounding_in_windows_without_it() {
        for (count, closed, half_window) in [(130, true, 9), (77, false, 4), (401, true, 30)] {
            let place = |i: u32| {
                let t = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                Point2::new(3.0 + t.cos(), t.sin() + 0.1 * (7.0 * t).sin())
            };
            let points: Vec<_> = (0..count).map(place).collect();
            let expected = PlainRegression::fitted(&points, closed, half_window);
            for far in [1e3, 1e100] {
                let mut spoilt = points.clone();
                spoilt[41] *= far;
                let found = PlainRegression::fitted(&spoilt, closed, half_window);
                let around = |i: usize| i.abs_diff(41).min(count as usize - i.abs_diff(41));
                for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                    let apart = (found.position - expected.position).norm() + (found.tangent - expected.tangent).norm();
                    assert_eq!(around(i) > half_window, apart < 1e-13, "{count} {i} {far}: {apart}");
                }
            }
        }
    }
}
