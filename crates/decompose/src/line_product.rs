use freeform_curve_fit::{MAX_COEFFICIENTS, coefficient_count, exponents, monomial_index};
use nalgebra::Complex;

use crate::{
    error::DecompositionError,
    line::Line,
    roots::{MAX_DEGREE, binary_form_roots},
    rotation_chart::rotation_chart,
};

/// Leading coefficients below this fraction of the other coefficients count as zero.
pub(crate) const MIN_LEADING: f64 = 1e-10;

/// Two l whose chordal distance is below this count as one. At this distance about 4 digits are left of k.
pub(crate) const MIN_SEPARATION: f64 = 1e-6;

/// A double l with `|w|` below this in the rotation chart is reported as a circular leading form.
const CIRCULAR: f64 = 1e-3;

/// Coefficients of a bivariate polynomial in graded order, zero beyond its degree.
pub(crate) type Coefficients = [f64; MAX_COEFFICIENTS];

/// The lines of one level and the coefficient before their product.
pub(crate) struct LineProduct {
    level: usize,
    coefficient: f64,
    lines: [Line; MAX_DEGREE],
}

impl LineProduct {
    /// The line product that agrees with `remainder`, of degree `level`, in the parts of degree `level` and `level - 1`.
    ///
    /// `magnitude` is the size of the numbers that the part of degree `level` was computed from, 0 if it is as given.
    pub(crate) fn leading(remainder: &Coefficients, level: usize, magnitude: f64) -> Result<Self, DecompositionError> {
        let part = |d: usize| &remainder[d * (d + 1) / 2..coefficient_count(d)];
        let (leading, next) = (part(level), part(level - 1));
        let coefficient = leading[0];
        let size = leading.iter().fold(magnitude, |m, a| m.max(a.abs()));
        let relative = if size > 0.0 { coefficient.abs() / size } else { 0.0 };
        if relative <= MIN_LEADING {
            return Err(DecompositionError::VanishingLeadingCoefficient { level, relative });
        }
        let roots = binary_form_roots(leading).map_err(|source| DecompositionError::Roots { level, source })?;
        let mut lines = [Line::ZERO; MAX_DEGREE];
        for (line, z) in lines.iter_mut().zip(roots.as_slice()) {
            // The conjugate, so that the first line of a pair has the positive imaginary part.
            line.l = -z.conj();
        }
        let lines_here = &mut lines[..level];
        check_separation(lines_here, level)?;
        for i in 0..level {
            if i < 2 * roots.conjugate_pair_count() && i % 2 == 1 {
                lines_here[i] = lines_here[i - 1].conjugate();
                continue;
            }
            // Residue: h_(m-1)(-l, 1) = k prod (l_j - l), with the l as computed, so that the part of degree m - 1 is
            // reproduced whatever error they have.
            let l = lines_here[i].l;
            let numerator = next.iter().fold(Complex::ZERO, |sum, a| sum * -l + *a);
            let denominator = (0..level).filter(|&j| j != i).fold(Complex::ONE, |p, j| p * (lines_here[j].l - l));
            let k = numerator / coefficient / denominator;
            // The k of a real line is real but for the rounding of the conjugate pairs' product.
            lines_here[i].k = if l.im == 0.0 { Complex::new(k.re, 0.0) } else { k };
        }
        if !lines_here.iter().all(|line| line.l.is_finite() && line.k.is_finite()) {
            return Err(DecompositionError::NotFinite { level });
        }
        Ok(Self { level, coefficient, lines })
    }

    /// Takes the product off the polynomial that it was taken from, which leaves one of degree `level - 2`. Returns the
    /// size of the numbers that the part of that degree comes from.
    pub(crate) fn subtract_from(&self, remainder: &mut Coefficients) -> Result<f64, DecompositionError> {
        let product = expand(self.lines());
        let (next, level) = (self.level - 2, self.level);
        if !product.iter().all(|a| (a * self.coefficient).is_finite()) {
            return Err(DecompositionError::NotFinite { level });
        }
        let mut magnitude = 0.0_f64;
        for (index, (r, a)) in remainder.iter_mut().zip(&product).enumerate() {
            if index >= coefficient_count(next) {
                *r = 0.0;
                continue;
            }
            let term = self.coefficient * a;
            if index >= next * (next + 1) / 2 {
                magnitude = magnitude.max(r.abs()).max(term.abs());
            }
            *r -= term;
        }
        Ok(magnitude)
    }

    pub(crate) fn lines(&self) -> &[Line] {
        &self.lines[..self.level]
    }

    pub(crate) const fn coefficient(&self) -> f64 {
        self.coefficient
    }
}

/// Distance of two l on the Riemann sphere of diameter 1: at most 1, and the same in every orientation of the image.
pub(crate) fn chordal_distance(a: Complex<f64>, b: Complex<f64>) -> f64 {
    (a - b).norm_sqr().sqrt() / ((1.0 + a.norm_sqr()) * (1.0 + b.norm_sqr())).sqrt()
}

/// The smallest chordal distance between two lines and the position of the first of them.
pub(crate) fn smallest_separation(lines: &[Line]) -> (f64, usize) {
    let mut smallest = (f64::INFINITY, 0);
    for (i, a) in lines.iter().enumerate() {
        for b in &lines[i + 1..] {
            let distance = chordal_distance(a.l, b.l);
            if distance < smallest.0 {
                smallest = (distance, i);
            }
        }
    }
    smallest
}

pub(crate) fn check_separation(lines: &[Line], level: usize) -> Result<(), DecompositionError> {
    let (separation, index) = smallest_separation(lines);
    if separation >= MIN_SEPARATION {
        return Ok(());
    }
    let l = lines[index].l;
    if rotation_chart(Complex::new(l.re, l.im.abs())).norm() < CIRCULAR {
        return Err(DecompositionError::CircularLeadingForm { level, separation });
    }
    Err(DecompositionError::NearDoubleLines { level, separation, l })
}

/// Product of lines 2i and 2i + 1, conjugate or both real, in graded order.
fn conic(first: &Line, second: &Line) -> [f64; 6] {
    [
        (first.k * second.k).re,
        (first.k + second.k).re,
        (first.l * second.k + second.l * first.k).re,
        1.0,
        (first.l + second.l).re,
        (first.l * second.l).re,
    ]
}

/// Product of the lines of one level, an even number of them, conjugates beside each other.
pub(crate) fn expand(lines: &[Line]) -> Coefficients {
    let mut product = [0.0; MAX_COEFFICIENTS];
    product[0] = 1.0;
    for (i, pair) in lines.chunks_exact(2).enumerate() {
        let factor = conic(&pair[0], &pair[1]);
        let mut next = [0.0; MAX_COEFFICIENTS];
        for ((i, j), &a) in exponents(2 * i).zip(&product) {
            for ((k, l), &b) in exponents(2).zip(&factor) {
                next[monomial_index(i + k, j + l)] += a * b;
            }
        }
        product = next;
    }
    product
}
