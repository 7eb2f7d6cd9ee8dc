//! Local quadratics of all points of a contour together, where no outlier is near: the powers of the numbers of the points have the same sums
//! in every window.
use nalgebra::Point2;

use super::local_fit::LocalFit;
use crate::vectors::vectorised;

/// The regressions with one window.
#[derive(Debug, Clone, Default)]
pub(super) struct PlainRegression {
    half_window: usize,
    fits: Vec<LocalFit>,
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
        self.fits.clear();
        let count = points.len();
        if count < 2 * half_window + 1 || half_window < 2 {
            return;
        }
        self.fits.resize(count, LocalFit::default());
        // The points around the contour, or along it where every window ends within.
        let reach = if closed { half_window } else { 0 };
        let mut coordinates = [0, 1].map(|_| Vec::with_capacity(count + 2 * reach));
        for points in [&points[count - reach..], points, &points[..reach]] {
            coordinates[0].extend(points.iter().map(|p| p.x));
            coordinates[1].extend(points.iter().map(|p| p.y));
        }
        let first = if closed { 0 } else { half_window };
        let windows = coordinates[0].len() - 2 * half_window;
        let mut sums = vec![[0.0; 3]; windows];
        let moments = Moments::of(half_window);
        for (axis, values) in coordinates.iter().enumerate() {
            vectorised(
                #[inline(always)]
                || moments.add_windows(values, half_window, &mut sums),
            );
            let own = values[half_window..].iter();
            for (fit, (sums, own)) in self.fits[first..].iter_mut().zip(sums.iter().zip(own)) {
                let [off, slope] = moments.solve(sums);
                (fit.position.coords[axis], fit.tangent[axis]) = (own + off, slope);
            }
        }
        self.fits.iter_mut().for_each(|fit| fit.residual_variance = 1.0 - moments.by_own);
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
    pub(super) fn at(&self, i: usize, half_window: usize) -> Option<LocalFit> {
        let is_plain = self.half_window == half_window
            && !self.fits.is_empty()
            && self.outliers[i] == self.outliers[i + 2 * half_window + 1];
        is_plain.then(|| self.fits[i])
    }
}

/// Sums of the powers of the places of a window, which lie from -1 to 1.
struct Moments {
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
        Self { second, by_own: fourth / determinant, by_bend: -second / determinant }
    }

    /// Sums of the values of every window, less that in its middle, times the first three powers of their places.
    #[inline(always)]
    fn add_windows(&self, values: &[f64], half_window: usize, sums: &mut [[f64; 3]]) {
        const LANES: usize = 8;
        let unit = 1.0 / half_window as f64;
        for (chunk, sums) in sums.chunks_mut(LANES).enumerate() {
            let start = chunk * LANES + half_window;
            let mut of_lanes = [[0.0; LANES]; 3];
            if sums.len() == LANES {
                let mut middle = [0.0; LANES];
                middle.copy_from_slice(&values[start..start + LANES]);
                for place in 1..=half_window {
                    let u = place as f64 * unit;
                    let (before, after) = (&values[start - place..][..LANES], &values[start + place..][..LANES]);
                    for lane in 0..LANES {
                        let (even, odd) = (before[lane] + after[lane] - 2.0 * middle[lane], after[lane] - before[lane]);
                        of_lanes[0][lane] += even;
                        of_lanes[1][lane] += u * odd;
                        of_lanes[2][lane] += u * u * even;
                    }
                }
            } else {
                for (lane, _) in sums.iter().enumerate() {
                    let at = start + lane;
                    for place in 1..=half_window {
                        let u = place as f64 * unit;
                        let (before, after) = (values[at - place], values[at + place]);
                        let (even, odd) = (before + after - 2.0 * values[at], after - before);
                        of_lanes[0][lane] += even;
                        of_lanes[1][lane] += u * odd;
                        of_lanes[2][lane] += u * u * even;
                    }
                }
            }
            for (lane, sums) in sums.iter_mut().enumerate() {
                // A closure would be called.
                *sums = [of_lanes[0][lane], of_lanes[1][lane], of_lanes[2][lane]];
            }
        }
    }

    /// Value in the middle, less that of its point, and slope.
    fn solve(&self, [whole, first, second]: &[f64; 3]) -> [f64; 2] {
        [self.by_own * whole + self.by_bend * second, first / self.second]
    }
}
