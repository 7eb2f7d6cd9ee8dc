//! Values of a binary form on the unit circle: what decides whether a curve is bounded.
use std::sync::LazyLock;

/// Directions looked at before the extrema are refined. A form of degree 8 has at most 16 extrema on half the circle
/// and none narrower than a few of these steps.
const DIRECTIONS: usize = 48;
const NEWTON_STEPS: usize = 4;

/// Extent of a binary form `h = sum_j c_j x^(n-j) y^j` of even degree over the unit circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircleRange {
    /// Smallest value. The level sets of a polynomial with this leading form are bounded if it is positive.
    pub minimum: f64,
    /// Root mean square value, which rotation leaves unchanged.
    pub rms: f64,
}

impl CircleRange {
    /// Range of the form with the coefficients `c_0, ..., c_n` of `x^n, x^(n-1) y, ..., y^n`, n even.
    #[must_use]
    pub fn of(form: &[f64]) -> Self {
        CircleSamples::of(form).range(form)
    }

    /// Minimum over root mean square: positive where bounded, 1 for a circle, 0 where it is undecided.
    #[must_use]
    pub fn margin(&self) -> f64 {
        if self.rms > 0.0 { self.minimum / self.rms } else { 0.0 }
    }
}

/// Directions in which a form is sampled, evenly spread over half the circle: their cosines, then their sines.
static SAMPLED: LazyLock<[[f64; DIRECTIONS]; 2]> = LazyLock::new(|| {
    let angle = |i: usize| std::f64::consts::PI * i as f64 / DIRECTIONS as f64;
    [std::array::from_fn(|i| angle(i).cos()), std::array::from_fn(|i| angle(i).sin())]
});

/// A direction and the value of a form there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DirectedValue {
    /// Cosine and sine of the direction.
    pub(crate) direction: [f64; 2],
    pub(crate) value: f64,
}

/// Values of a binary form all around the circle.
pub(crate) struct CircleSamples {
    values: [f64; DIRECTIONS],
}

impl CircleSamples {
    pub(crate) fn of(form: &[f64]) -> Self {
        let [cosines, sines] = &*SAMPLED;
        let mut values = [0.0; DIRECTIONS];
        let mut cosine_powers = [1.0; DIRECTIONS];
        // Horner in y for all directions at once, each coefficient with the power of x that makes it homogeneous.
        for &c in form.iter().rev() {
            let directions = cosines.iter().zip(sines);
            for ((value, power), (cos, sin)) in values.iter_mut().zip(&mut cosine_powers).zip(directions) {
                *value = *value * sin + c * *power;
                *power *= cos;
            }
        }
        Self { values }
    }

    /// The samples themselves.
    pub(crate) fn iter(&self) -> impl Iterator<Item = DirectedValue> + '_ {
        let [cosines, sines] = &*SAMPLED;
        let directions = cosines.iter().zip(sines).map(|(cos, sin)| [*cos, *sin]);
        directions.zip(&self.values).map(|(direction, &value)| DirectedValue { direction, value })
    }

    /// The local minima of the form, which must be that of the samples.
    pub(crate) fn minima<'a>(&'a self, form: &'a [f64]) -> impl Iterator<Item = DirectedValue> + 'a {
        let values = &self.values;
        let is_lowest = |i: usize| {
            let (before, after) = (values[(i + DIRECTIONS - 1) % DIRECTIONS], values[(i + 1) % DIRECTIONS]);
            values[i] <= before && values[i] <= after
        };
        self.iter().enumerate().filter(move |(i, _)| is_lowest(*i)).map(|(_, sample)| refined_minimum(form, sample))
    }

    /// Range of the form, which must be that of the samples.
    pub(crate) fn range(&self, form: &[f64]) -> CircleRange {
        self.range_above(self.minima(form).fold(f64::INFINITY, |lowest, minimum| lowest.min(minimum.value)))
    }

    /// Range of the form, whose smallest value is known.
    pub(crate) fn range_above(&self, minimum: f64) -> CircleRange {
        // Exact: the square is a trigonometric polynomial of fewer harmonics than there are directions.
        let squares: f64 = self.values.iter().map(|v| v * v).sum();
        CircleRange { minimum, rms: (squares / DIRECTIONS as f64).sqrt() }
    }
}

/// `h(x, y)`.
fn evaluate(form: &[f64], x: f64, y: f64) -> f64 {
    let mut x_power = 1.0;
    // Horner in y, each coefficient with the power of x that makes it homogeneous.
    form.iter().rev().fold(0.0, |sum, c| {
        let result = sum * y + c * x_power;
        x_power *= x;
        result
    })
}

/// Newton's method on the derivative along the circle, from a sampled minimum and within one step of it.
fn refined_minimum(form: &[f64], sampled: DirectedValue) -> DirectedValue {
    let n = form.len() - 1;
    let mut lowest = sampled;
    let [mut x, mut y] = sampled.direction;
    let mut turned: f64 = 0.0;
    for _ in 0..NEWTON_STEPS {
        let (_, slope, curvature) = along_circle(form, n, x, y);
        let turn = -slope / curvature;
        turned += turn;
        if curvature <= 0.0 || turned.abs() > std::f64::consts::PI / DIRECTIONS as f64 {
            break;
        }
        [x, y] = turned_by([x, y], turn);
        let value = evaluate(form, x, y);
        if value < lowest.value {
            lowest = DirectedValue { direction: [x, y], value };
        }
    }
    lowest
}

/// A direction turned by a small angle in radians, to first order.
pub(crate) fn turned_by([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (x, y) = (x - angle * y, y + angle * x);
    let norm = (x * x + y * y).sqrt();
    [x / norm, y / norm]
}

/// Value and first two derivatives by angle of `h(cos t, sin t)`.
fn along_circle(form: &[f64], n: usize, x: f64, y: f64) -> (f64, f64, f64) {
    let mut xs = [1.0; 9];
    let mut ys = [1.0; 9];
    for k in 1..=n {
        xs[k] = xs[k - 1] * x;
        ys[k] = ys[k - 1] * y;
    }
    let (mut value, mut fx, mut fy) = (0.0, 0.0, 0.0);
    let (mut fxx, mut fxy, mut fyy) = (0.0, 0.0, 0.0);
    for (j, &c) in form.iter().enumerate() {
        let i = n - j;
        let (fi, fj) = (i as f64, j as f64);
        value += c * xs[i] * ys[j];
        if i > 0 {
            fx += c * fi * xs[i - 1] * ys[j];
        }
        if j > 0 {
            fy += c * fj * xs[i] * ys[j - 1];
        }
        if i > 1 {
            fxx += c * fi * (fi - 1.0) * xs[i - 2] * ys[j];
        }
        if i > 0 && j > 0 {
            fxy += c * fi * fj * xs[i - 1] * ys[j - 1];
        }
        if j > 1 {
            fyy += c * fj * (fj - 1.0) * xs[i] * ys[j - 2];
        }
    }
    let slope = -y * fx + x * fy;
    let curvature = y * y * fxx - 2.0 * x * y * fxy + x * x * fyy - x * fx - y * fy;
    (value, slope, curvature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_narrow_valley_between_two_directions_is_found() {
        // ((x - a y)^2 + d y^2) (x^2 + y^2): close to a real double line of slope a.
        for k in 0..200 {
            let a = -3.0 + 0.03 * f64::from(k);
            let d = 1e-4;
            let q = [1.0, -2.0 * a, a * a + d];
            let form = [q[0], q[1], q[2] + q[0], q[1], q[2]];
            let found = CircleRange::of(&form).minimum;
            let dense = (0..200_000)
                .map(|i| (std::f64::consts::PI * f64::from(i) / 200_000.0).sin_cos())
                .map(|(s, c)| evaluate(&form, c, s))
                .fold(f64::INFINITY, f64::min);
            assert!((found - dense).abs() < 1e-6 && found <= dense + 1e-12, "{a}: {found} {dense}");
        }
    }

    #[test]
    fn a_circular_form_has_margin_one() {
        let range = CircleRange::of(&[2.0, 0.0, 4.0, 0.0, 2.0]);
        assert!((range.margin() - 1.0).abs() < 1e-12);
        assert!((range.rms - 2.0).abs() < 1e-12);
    }
}
