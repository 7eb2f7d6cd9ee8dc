use nalgebra::{DMatrix, Point2};

use crate::{
    degree::{Degree, MAX_COEFFICIENTS},
    level_set_moments::LEVELS,
    monomials::{evaluate_monomials, exponents, monomial_index},
    polynomial::ImplicitPolynomial,
};

/// From the median of the absolute values to the standard deviation of Gaussian noise.
const MEDIAN_TO_SIGMA: f64 = 1.4826;
/// The differences that noise is told from skip this many points of the outline at least: points between them share their noise.
const SKIPPED: usize = 2;
/// A point between two others has on average two thirds of their variance.
const OF_INTERPOLATED: f64 = 2.0 / 3.0;
/// Weights of a fourth difference, in which a smooth outline cancels.
const FOURTH_DIFFERENCE: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];

/// How uncertain the coefficients of a fit are, as far as noise of the points goes that is independent from point to point.
#[derive(Debug, Clone, PartialEq)]
pub struct FitCovariance {
    per_unit_noise: DMatrix<f64>,
    noise: f64,
}

impl FitCovariance {
    /// Standard deviation of the noise along the normals in working coordinates, from the fourth differences of the outline along
    /// itself: what a smooth shape does not account for.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Covariance of the coefficients of the working polynomial, in graded order, for that noise.
    #[must_use]
    pub fn coefficients(&self) -> DMatrix<f64> {
        self.coefficients_for(self.noise)
    }

    /// Covariance of the coefficients for another standard deviation of the noise, in working coordinates.
    #[must_use]
    pub fn coefficients_for(&self, noise: f64) -> DMatrix<f64> {
        &self.per_unit_noise * (noise * noise)
    }
}

/// Points in working coordinates with their normals, and what they were fitted with.
pub(crate) struct Fitted<'a> {
    pub(crate) points: [&'a [f64]; 2],
    pub(crate) normals: [&'a [f64]; 2],
    /// Number of points of the outline where those fitted are between them, so that neighbours share noise.
    pub(crate) interpolated_from: Option<usize>,
    /// Standard deviation of the noise along the normals.
    pub(crate) noise: f64,
    pub(crate) offset: f64,
    pub(crate) polynomial: &'a ImplicitPolynomial,
    /// Inverse of the Gram matrix, ridge included.
    pub(crate) inverse: &'a DMatrix<f64>,
}

impl Fitted<'_> {
    /// The score of a point is how its rows `m (d - m' a)` change as it moves along its normal; the covariance is
    /// `s^2 G^-1 (sum of scores by their transposes) G^-1`.
    pub(crate) fn covariance(&self) -> FitCovariance {
        let degree = self.polynomial.degree();
        let size = degree.coefficient_count();
        let a = self.polynomial.coefficients();
        let mut scores = DMatrix::<f64>::zeros(size, self.points[0].len());
        let (mut monomials, mut slopes) = ([0.0; MAX_COEFFICIENTS], [0.0; MAX_COEFFICIENTS]);
        for (i, mut score) in scores.column_iter_mut().enumerate() {
            let [[x, y], [nx, ny]] = [self.points, self.normals].map(|pair| pair.map(|values| values[i]));
            for level in LEVELS {
                let p = Point2::new(x + level * self.offset * nx, y + level * self.offset * ny);
                evaluate_monomials(degree.value(), p.x, p.y, &mut monomials);
                derive_monomials(degree, &monomials, [nx, ny], &mut slopes);
                let dot = |m: &[f64]| m.iter().zip(a).map(|(m, a)| m * a).sum::<f64>();
                let (residual, slope) = (level - dot(&monomials[..size]), dot(&slopes[..size]));
                let terms = slopes.iter().zip(&monomials).map(|(s, m)| s * residual - m * slope);
                score.iter_mut().zip(terms).for_each(|(to, term)| *to += term);
            }
        }
        // Sums over more points than there were have the noise of those that there were.
        let shared = self.interpolated_from.map_or(1.0, |from| self.points[0].len() as f64 / from as f64);
        let middle = &scores * scores.transpose() * shared;
        FitCovariance { per_unit_noise: self.inverse * middle * self.inverse, noise: self.noise }
    }
}

/// Standard deviation of the noise of points along their normals, in their units, from the fourth differences along the outline.
/// `interpolated_from` is the number of points of the outline where these are between them, so that neighbours share noise.
pub(crate) fn noise_along(points: [&[f64]; 2], normals: [&[f64]; 2], interpolated_from: Option<usize>) -> f64 {
    let ([xs, ys], [nx, ny]) = (points, normals);
    let count = xs.len();
    let (lag, kept) =
        interpolated_from.map_or((SKIPPED, 1.0), |from| ((SKIPPED * count).div_ceil(from.max(1)), OF_INTERPOLATED));
    let norm = (kept * FOURTH_DIFFERENCE.iter().map(|w| w * w).sum::<f64>()).sqrt();
    let mut differences: Vec<f64> = (0..count)
        .map(|i| {
            let along = |values: &[f64]| {
                let terms = FOURTH_DIFFERENCE.iter().enumerate();
                terms.map(|(k, w)| w * values[(i + k * lag) % count]).sum::<f64>()
            };
            let middle = (i + 2 * lag) % count;
            (along(xs) * nx[middle] + along(ys) * ny[middle]).abs() / norm
        })
        .collect();
    if count == 0 {
        return 0.0;
    }
    MEDIAN_TO_SIGMA * *differences.select_nth_unstable_by(count / 2, f64::total_cmp).1
}

/// Derivatives of the monomials at a point in a direction.
fn derive_monomials(degree: Degree, monomials: &[f64], [nx, ny]: [f64; 2], out: &mut [f64]) {
    for (slot, (i, j)) in out.iter_mut().zip(exponents(degree.value())) {
        let by_x = if i > 0 { i as f64 * monomials[monomial_index(i - 1, j)] } else { 0.0 };
        let by_y = if j > 0 { j as f64 * monomials[monomial_index(i, j - 1)] } else { 0.0 };
        *slot = nx * by_x + ny * by_y;
    }
}
