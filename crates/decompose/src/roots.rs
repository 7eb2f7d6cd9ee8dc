use nalgebra::Complex;

use crate::{companion::companion_eigenvalues, error::RootError};

/// Largest supported degree of a binary form.
pub(crate) const MAX_DEGREE: usize = 8;

/// Aberth's iteration takes 5 to 8 rounds on separate roots and about 30 on double ones.
const MAX_ITERATIONS: usize = 60;

/// Roots of a real binary form: complex conjugate pairs first, then the real ones.
///
/// A pair stands as `z` with a positive imaginary part followed by its exact conjugate. Pairs are in order of rising real
/// part, and so are the real roots. The number of real roots is even.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roots {
    values: [Complex<f64>; MAX_DEGREE],
    degree: usize,
    pairs: usize,
}

impl Roots {
    /// All roots, as many as the degree says.
    #[must_use]
    pub fn as_slice(&self) -> &[Complex<f64>] {
        &self.values[..self.degree]
    }

    /// Number of conjugate pairs; they stand at the front.
    #[must_use]
    pub const fn conjugate_pair_count(&self) -> usize {
        self.pairs
    }

    /// Joins approximate roots of the scaled form into exact conjugate pairs, polishes them and undoes the scaling.
    ///
    /// A root is real where its own conjugate is nearer than every other root's: no tolerance needed.
    fn paired(form: &ScaledForm, approximate: [Complex<f64>; MAX_DEGREE]) -> Self {
        let n = form.degree();
        let mut open = [true; MAX_DEGREE];
        let mut upper = [Complex::ZERO; MAX_DEGREE / 2];
        let mut real = [0.0; MAX_DEGREE];
        let (mut pairs, mut reals) = (0, 0);
        let farthest_from_axis = |open: &[bool; MAX_DEGREE]| {
            (0..n).filter(|&i| open[i]).max_by(|&i, &j| approximate[i].im.abs().total_cmp(&approximate[j].im.abs()))
        };
        while let Some(i) = farthest_from_axis(&open) {
            open[i] = false;
            let z = approximate[i];
            let distance = |j: usize| (approximate[j] - z.conj()).norm_sqr();
            let partner =
                (0..n).filter(|&j| open[j]).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).filter(|&j| {
                    let to_itself = 2.0 * z.im;
                    distance(j) < to_itself * to_itself
                });
            if let Some(j) = partner {
                open[j] = false;
                let mean = (z + approximate[j].conj()) * 0.5;
                let polished = form.polished(Complex::new(mean.re, mean.im.abs()));
                upper[pairs] = if polished.im > 0.0 { polished } else { Complex::new(mean.re, mean.im.abs()) };
                pairs += 1;
            } else {
                real[reals] = form.polished(Complex::new(z.re, 0.0)).re;
                reals += 1;
            }
        }
        upper[..pairs].sort_unstable_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        real[..reals].sort_unstable_by(f64::total_cmp);
        let mut values = [Complex::ZERO; MAX_DEGREE];
        for (slot, z) in values.chunks_exact_mut(2).zip(&upper[..pairs]) {
            slot.copy_from_slice(&[z * form.scale, z.conj() * form.scale]);
        }
        for (slot, x) in values[2 * pairs..].iter_mut().zip(&real[..reals]) {
            *slot = Complex::new(x * form.scale, 0.0);
        }
        Self { values, degree: n, pairs }
    }
}

/// All roots z of `h(z, 1)` for the real binary form `h(x, y) = a_0 x^n + a_1 x^(n-1) y + ... + a_n y^n`, n = 2, 4, 6 or 8,
/// given as `[a_0, ..., a_n]`: the order in which [`ImplicitPolynomial`](freeform_curve_fit::ImplicitPolynomial) keeps its
/// leading form. Without allocation.
///
/// O. Aberth, Iteration methods for finding all zeros of a polynomial simultaneously, 1973, on the variable scaled by
/// `max |a_k / a_0|^(1/k)`. Should it not converge, the eigenvalues of the companion matrix take its place.
///
/// # Errors
/// An unsupported degree, a coefficient that is not finite, a vanishing leading one, or no convergence.
pub fn binary_form_roots(coefficients: &[f64]) -> Result<Roots, RootError> {
    check_form(coefficients)?;
    let form = ScaledForm::of(coefficients)?;
    let approximate = match form.aberth() {
        Ok(values) => values,
        Err(residual) => {
            let degree = form.degree();
            let failure = RootError::NoConvergence { degree, iterations: MAX_ITERATIONS, residual };
            form.eigenvalues().ok_or(failure)?
        }
    };
    Ok(Roots::paired(&form, approximate))
}

/// Roots of a binary form as eigenvalues of the companion matrix of the scaled polynomial. The result agrees with
/// [`binary_form_roots`], which is tested against this function and falls back on it. This function is slower and allocates.
///
/// # Errors
/// Those of [`binary_form_roots`].
pub fn companion_roots(coefficients: &[f64]) -> Result<Roots, RootError> {
    check_form(coefficients)?;
    let form = ScaledForm::of(coefficients)?;
    let Some(values) = form.eigenvalues() else {
        return Err(RootError::NoConvergence { degree: form.degree(), iterations: 0, residual: f64::NAN });
    };
    Ok(Roots::paired(&form, values))
}

fn check_form(coefficients: &[f64]) -> Result<(), RootError> {
    if !matches!(coefficients.len(), 3 | 5 | 7 | 9) {
        return Err(RootError::UnsupportedDegree { count: coefficients.len() });
    }
    coefficients.iter().position(|a| !a.is_finite()).map_or(Ok(()), |index| Err(RootError::NotFinite { index }))
}

/// Monic polynomial in `u = z / scale` whose largest coefficient has the absolute value 1, so that all its roots lie
/// within `|u| < 2`.
struct ScaledForm {
    /// `1, b_1, ..., b_n`, the coefficient of `u^n` first.
    b: [f64; MAX_DEGREE + 1],
    degree: usize,
    scale: f64,
}

impl ScaledForm {
    /// The roots in u as eigenvalues of the companion matrix; `None` where their iteration fails.
    fn eigenvalues(&self) -> Option<[Complex<f64>; MAX_DEGREE]> {
        let mut values = [Complex::ZERO; MAX_DEGREE];
        companion_eigenvalues(&self.b[..=self.degree], &mut values[..self.degree]).then_some(values)
    }

    fn of(coefficients: &[f64]) -> Result<Self, RootError> {
        let degree = coefficients.len() - 1;
        let largest = coefficients.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let leading = coefficients[0];
        let mut b = [0.0; MAX_DEGREE + 1];
        for (to, a) in b.iter_mut().zip(coefficients) {
            *to = a / leading;
        }
        let size = |(k, x): (usize, &f64)| x.abs().powf(1.0 / k as f64);
        let bound = b.iter().enumerate().skip(1).map(size).fold(0.0, f64::max);
        if !(b.iter().all(|x| x.is_finite()) && (2.0 * bound).is_finite()) {
            return Err(RootError::VanishingLeadingCoefficient { leading, largest });
        }
        let scale = if bound > 0.0 { bound } else { 1.0 };
        for k in 1..=degree {
            // One division at a time: scale^k may overflow where the quotient does not.
            b[k..=degree].iter_mut().for_each(|x| *x /= scale);
        }
        Ok(Self { b, degree, scale })
    }

    const fn degree(&self) -> usize {
        self.degree
    }

    /// Value, derivative, and a bound of the value's rounding error, by Horner's rule.
    fn evaluate(&self, z: Complex<f64>) -> (Complex<f64>, Complex<f64>, f64) {
        let radius = z.norm_sqr().sqrt();
        let (mut value, mut derivative, mut absolute) = (Complex::new(1.0, 0.0), Complex::ZERO, 1.0);
        for &b in &self.b[1..=self.degree] {
            derivative = derivative * z + value;
            value = value * z + b;
            absolute = absolute * radius + b.abs();
        }
        (value, derivative, 2.0 * self.degree as f64 * f64::EPSILON * absolute)
    }

    /// One or two Newton steps, each taken only where it makes the value smaller.
    fn polished(&self, start: Complex<f64>) -> Complex<f64> {
        let mut z = start;
        let (mut value, mut derivative, _) = self.evaluate(z);
        for _ in 0..2 {
            let next = z - value / derivative;
            let (next_value, next_derivative, _) = self.evaluate(next);
            if !(next.is_finite() && next_value.norm_sqr() < value.norm_sqr()) {
                break;
            }
            (z, value, derivative) = (next, next_value, next_derivative);
        }
        z
    }

    /// All roots at once; the largest remaining absolute value where the iteration cap is met.
    fn aberth(&self) -> Result<[Complex<f64>; MAX_DEGREE], f64> {
        let mut z = [Complex::ZERO; MAX_DEGREE];
        // Roots at zero are known; the iteration would only creep towards several of them.
        let n = self.degree - self.b[..=self.degree].iter().rev().take_while(|b| **b == 0.0).count();
        let reduced = Self { b: self.b, degree: n, scale: self.scale };
        if n == 2 {
            [z[0], z[1]] = quadratic_roots(self.b[1], self.b[2]);
            return Ok(z);
        }
        reduced.start(&mut z[..n]);
        let mut settled = [false; MAX_DEGREE];
        for _ in 0..MAX_ITERATIONS {
            for i in 0..n {
                if settled[i] {
                    continue;
                }
                let (value, derivative, rounding) = reduced.evaluate(z[i]);
                if value.norm_sqr() <= rounding * rounding {
                    settled[i] = true;
                    continue;
                }
                let mut repulsion = Complex::ZERO;
                for j in (0..n).filter(|&j| j != i) {
                    let apart = z[i] - z[j];
                    repulsion += apart.conj() / apart.norm_sqr().max(f64::MIN_POSITIVE);
                }
                let step = value / (derivative - value * repulsion);
                if step.is_finite() {
                    z[i] -= step;
                    settled[i] = step.norm_sqr() <= f64::EPSILON * f64::EPSILON * z[i].norm_sqr();
                } else {
                    z[i] *= Complex::new(1.0, 1e-3);
                }
            }
            if settled[..n].iter().all(|&done| done) {
                return Ok(z);
            }
        }
        Err(z[..n].iter().map(|&z| reduced.evaluate(z).0.norm_sqr().sqrt()).fold(0.0, f64::max))
    }

    /// Points on a circle about the mean of the roots with the geometric mean of their distances from it as the radius,
    /// turned so that they are not symmetric about the real axis.
    fn start(&self, z: &mut [Complex<f64>]) {
        let n = self.degree as f64;
        let centre = Complex::new(-self.b[1] / n, 0.0);
        let distance = self.evaluate(centre).0.norm_sqr().sqrt().powf(1.0 / n);
        let radius = if distance > 1e-8 { distance } else { 1.0 };
        for (i, z) in z.iter_mut().enumerate() {
            *z = centre + Complex::from_polar(radius, std::f64::consts::TAU * i as f64 / n + 0.4);
        }
    }
}

/// Roots of `u^2 + b u + c` without cancellation.
fn quadratic_roots(b: f64, c: f64) -> [Complex<f64>; 2] {
    let half = -0.5 * b;
    let discriminant = half * half - c;
    if discriminant < 0.0 {
        let root = Complex::new(half, (-discriminant).sqrt());
        return [root, root.conj()];
    }
    let larger = half + discriminant.sqrt().copysign(half);
    let smaller = if larger == 0.0 { 0.0 } else { c / larger };
    [Complex::new(larger, 0.0), Complex::new(smaller, 0.0)]
}
