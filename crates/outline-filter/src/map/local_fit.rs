//! Local quadratics along a contour: position by the number of the point, over the points beside one.
use nalgebra::{Matrix3, Point2, Vector2, Vector3};

use crate::tuning::contour as tuning;

/// Local quadratic at one point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct LocalFit {
    pub(super) position: Point2<f64>,
    pub(super) tangent: Vector2<f64>,
    /// Variance of the point's residual in units of the noise: below one if the point took part.
    pub(super) residual_variance: f64,
    /// Distance of the point from the line, in units that make its variance that of the noise; negative where the line has no direction.
    residual: f64,
}

impl LocalFit {
    /// Of a place `off` from the point, and a tangent of any length.
    #[inline(always)]
    pub(super) fn at(point: Point2<f64>, off: Vector2<f64>, tangent: Vector2<f64>, residual_variance: f64) -> Self {
        let (position, length) = (point + off, (tangent.x * tangent.x + tangent.y * tangent.y).sqrt());
        let from = point - position;
        let distance = (tangent.x / length * from.y - tangent.y / length * from.x).abs();
        let residual = distance / residual_variance.max(tuning::LEAST_RESIDUAL_VARIANCE).sqrt();
        Self {
            position,
            tangent,
            residual_variance,
            residual: if length <= tuning::NO_DIRECTION { -1.0 } else { residual },
        }
    }

    /// Distance of the point from the line of its neighbours, in units that make its variance that of the noise; `None` where it has no direction.
    #[inline(always)]
    pub(super) fn residual(&self) -> Option<f64> {
        // No number is no direction's.
        (self.residual >= 0.0 || self.residual.is_nan()).then_some(self.residual)
    }
}

/// The regression over the wider window if its place is that of the narrower one as far as noise goes.
pub(super) fn wider_if_alike(wide: LocalFit, narrow: Option<LocalFit>, sigma: f64) -> Option<LocalFit> {
    let Some(narrow) = narrow else { return Some(wide) };
    let noise = sigma * (1.0 - narrow.residual_variance).max(0.0).sqrt();
    let apart = narrow.tangent.try_normalize(tuning::NO_DIRECTION)?.perp(&(wide.position - narrow.position)).abs();
    Some(if apart <= tuning::OUTLYING * noise { wide } else { narrow })
}

/// Sums over the points of a local regression.
#[derive(Debug, Default)]
pub(super) struct Sums {
    count: usize,
    /// Of the first four powers of the number of the point.
    powers: [f64; 4],
    /// Of the coordinates times its powers from 0 on.
    x: Vector3<f64>,
    y: Vector3<f64>,
}

impl Sums {
    #[inline(always)]
    pub(super) fn add(&mut self, u: f64, p: Vector2<f64>) {
        let square = u * u;
        self.count += 1;
        self.powers[0] += u;
        self.powers[1] += square;
        self.powers[2] += u * square;
        self.powers[3] += square * square;
        self.x.x += p.x;
        self.x.y += u * p.x;
        self.x.z += square * p.x;
        self.y.x += p.y;
        self.y.y += u * p.y;
        self.y.z += square * p.y;
    }

    /// Places are counted from `origin`, the point that the numbers are counted from too; it may be an outlier, which has taken no part.
    pub(super) fn fit(&self, origin: Point2<f64>, is_outlier: bool) -> Option<LocalFit> {
        if self.count < tuning::FEWEST_FITTED {
            return None;
        }
        let inverse = self.gram().try_inverse()?;
        let (x, y) = (inverse * self.x, inverse * self.y);
        // An outlier stays one unless it lies within the noise of its neighbours' line as if that were exact.
        let residual_variance = if is_outlier { 1.0 } else { 1.0 - inverse[(0, 0)] };
        Some(LocalFit::at(origin, Vector2::new(x[0], y[0]), Vector2::new(x[1], y[1]), residual_variance))
    }

    fn gram(&self) -> Matrix3<f64> {
        let [first, second, third, fourth] = self.powers;
        Matrix3::new(self.count as f64, first, second, first, second, third, second, third, fourth)
    }
}

/// Variance of the direction of a local regression over so many points to either side, in rad squared, for noise in units of their distance.
pub(super) fn direction_variance(noise: f64, half_window: usize) -> f64 {
    let w = half_window as f64;
    3.0 * noise * noise / (w * (w + 1.0) * (2.0 * w + 1.0))
}
