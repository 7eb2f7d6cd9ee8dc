use freeform_curve_fit::{Degree, ImplicitPolynomial, MAX_COEFFICIENTS};
use nalgebra::{Affine2, Point2};

#[cfg(feature = "serde")]
use crate::saved_decomposition::SavedDecomposition;
use crate::{
    error::DecompositionError,
    line::Line,
    line_product::{LineProduct, MIN_LEADING, check_separation, expand},
};

/// Largest condition number of a decomposition that is given out: about 6 digits are left of double precision.
const MAX_CONDITION: f64 = 1e10;

/// Number of lines over all levels of the largest degree: 8 + 6 + 4 + 2.
const MAX_LINES: usize = 20;

/// Decomposition of an implicit polynomial of even degree n into a sum of line products (equation 1 for n = 4):
/// `f = c_n prod (x + l_ni y + k_ni) + c_(n-2) prod (x + l_(n-2)i y + k_(n-2)i) + ... + c_0`.
///
/// The product of m lines is called level m here: n, n - 2, ..., 2. Within a level the lines stand in twos: first
/// the complex conjugate pairs, each with the line of positive `Im l` before its conjugate, then the real lines. Lines at
/// level n of a closed and bounded curve are all complex; those of lower levels may be real.
///
/// The polynomial need not be monic. Its leading coefficient `a_n0` is `c_n`, so that [`expand`](Self::expand) gives it back;
/// [`alpha`](Self::alpha) and [`beta`](Self::beta) are those of the monic polynomial that the paper writes down.
///
/// # Accuracy far from the origin
///
/// Decompose in coordinates that are centred on the object and scaled to its size, then map the lines to the image with
/// [`moved`](Self::moved), which is exact. A polynomial whose coefficients stand in image coordinates a thousand
/// object sizes from the origin has lost its shape to rounding before it gets here.
///
/// Source: M. Unel and W. A. Wolovich, On the construction of complete sets of geometric invariants for algebraic curves,
/// 2000.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "SavedDecomposition", into = "SavedDecomposition"))]
pub struct Decomposition {
    degree: Degree,
    /// Lines of level n, then of level n - 2, and so on.
    lines: [Line; MAX_LINES],
    /// `c_n, c_(n-2), ..., c_0`.
    coefficients: [f64; 5],
}

impl Decomposition {
    /// Takes a polynomial apart, level by level: the l of a level are the negative roots of its leading form, the k follow
    /// as residues, and what the product leaves is the next level. Without allocation.
    ///
    /// # Errors
    /// Where it does not exist or is not unique, or where too little of it would be left after rounding: a leading
    /// coefficient that vanishes, two lines of almost the same direction, a circular leading form, a condition number
    /// beyond 1e10, an overflow.
    pub fn of(polynomial: &ImplicitPolynomial) -> Result<Self, DecompositionError> {
        let degree = polynomial.degree();
        let mut result = Self { degree, lines: [Line::ZERO; MAX_LINES], coefficients: [0.0; 5] };
        let (mut remainder, scale) = normalised(polynomial);
        let mut magnitude = 0.0;
        for (position, level) in result.levels().enumerate() {
            let product = LineProduct::leading(&remainder, level, magnitude)?;
            magnitude = product.subtract_from(&mut remainder)?;
            result.coefficients[position] = product.coefficient() * scale;
            let start = offset(degree, level);
            result.lines[start..start + level].copy_from_slice(product.lines());
        }
        result.coefficients[degree.value() / 2] = remainder[0] * scale;
        let result = result.checked()?;
        let condition = result.condition().number();
        if condition > MAX_CONDITION {
            return Err(DecompositionError::IllConditioned { condition });
        }
        Ok(result)
    }

    /// Puts a decomposition together from its parts: lines of level n, then of level n - 2, and so on, and coefficients
    /// `c_n, c_(n-2), ..., c_0`. In each level the lines 2i and 2i + 1 are conjugate or both real; conjugate lines
    /// are told by the first of the two, the second is replaced by its exact conjugate.
    ///
    /// # Errors
    /// Wrong numbers of lines or coefficients, lines that are neither conjugate (to 1e-6 relative) nor both real, two
    /// lines of a level with almost the same direction, a coefficient other than `c_0` that is zero, a number that is not
    /// finite.
    pub fn from_parts(degree: Degree, lines: &[Line], coefficients: &[f64]) -> Result<Self, DecompositionError> {
        let result = Self::assembled(degree, lines, coefficients)?;
        result.levels().try_for_each(|level| check_separation(result.level(level), level))?;
        Ok(result)
    }

    /// As [`Self::from_parts`], however near to each other two lines of a level are.
    pub(crate) fn assembled(degree: Degree, lines: &[Line], coefficients: &[f64]) -> Result<Self, DecompositionError> {
        let n = degree.value();
        let (lines_needed, coefficients_needed) = (offset(degree, 0), n / 2 + 1);
        if lines.len() != lines_needed || coefficients.len() != coefficients_needed {
            return Err(DecompositionError::WrongCount {
                degree: n,
                lines: lines.len(),
                lines_needed,
                coefficients: coefficients.len(),
                coefficients_needed,
            });
        }
        let mut result = Self { degree, lines: [Line::ZERO; MAX_LINES], coefficients: [0.0; 5] };
        result.coefficients[..coefficients_needed].copy_from_slice(coefficients);
        for (position, level) in result.levels().enumerate() {
            if coefficients[position] == 0.0 {
                return Err(DecompositionError::VanishingLeadingCoefficient { level, relative: 0.0 });
            }
            let start = offset(degree, level);
            let given = &lines[start..start + level];
            let is_complex = |i: usize| given[i].l.im != 0.0;
            let (mut complex_end, mut real_end) =
                (0, 2 * given.chunks_exact(2).filter(|pair| pair[0].l.im != 0.0).count());
            for index in (0..level).step_by(2) {
                let (first, second) = (given[index], given[index + 1]);
                if is_complex(index) {
                    if !nearly_conjugate(&first, &second) {
                        return Err(DecompositionError::NotConjugate { level, index });
                    }
                    result.write_pair(start + complex_end, &first);
                    complex_end += 2;
                } else {
                    if is_complex(index + 1) || first.k.im != 0.0 || second.k.im != 0.0 {
                        return Err(DecompositionError::NotConjugate { level, index });
                    }
                    result.lines[start + real_end] = first;
                    result.lines[start + real_end + 1] = second;
                    real_end += 2;
                }
            }
        }
        result.checked()
    }

    /// Degree n.
    #[must_use]
    pub const fn degree(&self) -> Degree {
        self.degree
    }

    /// The levels `n, n - 2, ..., 2`, highest first.
    pub fn levels(&self) -> impl Iterator<Item = usize> + Clone + use<> {
        let n = self.degree.value();
        (1..=n / 2).rev().map(|half| 2 * half)
    }

    /// The m lines of level m; empty where m is not one of `n, n - 2, ..., 2`.
    #[must_use]
    pub fn level(&self, m: usize) -> &[Line] {
        if !m.is_multiple_of(2) || m > self.degree.value() {
            return &[];
        }
        let start = offset(self.degree, m);
        &self.lines[start..start + m]
    }

    /// Coefficient `c_m` of level m; `c_0` is the constant left at the end. Zero where m is not one of `n, n - 2, ..., 0`.
    #[must_use]
    pub fn coefficient(&self, m: usize) -> f64 {
        let n = self.degree.value();
        if !m.is_multiple_of(2) || m > n { 0.0 } else { self.coefficients[(n - m) / 2] }
    }

    /// Coefficient of the second level of the monic polynomial, `c_(n-2) / c_n`: the paper's alpha for a quartic.
    #[must_use]
    pub fn alpha(&self) -> f64 {
        self.coefficients[1] / self.coefficients[0]
    }

    /// Constant of the monic polynomial, `c_0 / c_n`: the paper's beta for a quartic.
    #[must_use]
    pub fn beta(&self) -> f64 {
        self.coefficient(0) / self.coefficients[0]
    }

    /// One line of every complex conjugate pair of level m: that with the positive imaginary part of l. In order.
    pub fn conjugate_pairs(&self, m: usize) -> impl Iterator<Item = &Line> + Clone {
        self.level(m).iter().step_by(2).filter(|line| line.l.im > 0.0)
    }

    /// Value f(p), from the lines. Far from the origin this keeps the digits that coefficients of powers would lose.
    #[must_use]
    pub fn evaluate(&self, p: &Point2<f64>) -> f64 {
        let products = self.levels().map(|m| {
            let product = |pair: &[Line]| (pair[0].evaluate(p) * pair[1].evaluate(p)).re;
            self.coefficient(m) * self.level(m).chunks_exact(2).map(product).product::<f64>()
        });
        products.sum::<f64>() + self.coefficient(0)
    }

    /// The polynomial itself, multiplied out.
    ///
    /// # Panics
    /// Never: a decomposition whose expansion overflows cannot be made.
    #[must_use]
    pub fn expand(&self) -> ImplicitPolynomial {
        let count = self.degree.coefficient_count();
        ImplicitPolynomial::new(self.degree, &self.expanded()[..count]).expect("finite when it was made")
    }

    /// The decomposition of the curve moved by an affine map T, exactly and without taking a polynomial apart: every
    /// line is moved, and what the chart `x + l y + k` divides out goes into the coefficients (equations 5 to 8, with the
    /// ratio of equation 7 the right way up). The moved polynomial satisfies `f'(T p) = f(p)`.
    ///
    /// Levels and the order of the pairs stay as they are.
    ///
    /// # Errors
    /// T is singular, turns a real line parallel to the x axis, or overflows.
    pub fn moved(&self, map: &Affine2<f64>) -> Result<Self, DecompositionError> {
        let matrix = map.matrix();
        let determinant = matrix.determinant();
        let inverse = matrix.try_inverse().ok_or(DecompositionError::SingularMap { determinant })?;
        let mut result = *self;
        for (position, level) in self.levels().enumerate() {
            let start = offset(self.degree, level);
            let move_line = |line: &Line| {
                let unusable = DecompositionError::LineLeavesChart { level, relative: 0.0 };
                let (moved, factor) = line.moved(map).ok_or(unusable)?;
                let size = inverse[(0, 0)].abs() + line.l.norm() * inverse[(1, 0)].abs();
                let relative = factor.norm() / size;
                if relative < MIN_LEADING {
                    return Err(DecompositionError::LineLeavesChart { level, relative });
                }
                Ok((moved, factor))
            };
            for index in (start..start + level).step_by(2) {
                let (first, first_factor) = move_line(&self.lines[index])?;
                if self.lines[index].l.im == 0.0 {
                    let (second, second_factor) = move_line(&self.lines[index + 1])?;
                    result.lines[index] = first;
                    result.lines[index + 1] = second;
                    result.coefficients[position] *= first_factor.re * second_factor.re;
                } else {
                    result.write_pair(index, &first);
                    result.coefficients[position] *= first_factor.norm_sqr();
                }
            }
        }
        result.checked()
    }

    /// Writes a conjugate pair, the line with the positive imaginary part of l first.
    fn write_pair(&mut self, index: usize, line: &Line) {
        let upper = if line.l.im < 0.0 { line.conjugate() } else { *line };
        self.lines[index] = upper;
        self.lines[index + 1] = upper.conjugate();
    }

    fn expanded(&self) -> [f64; MAX_COEFFICIENTS] {
        let mut sum = [0.0; MAX_COEFFICIENTS];
        sum[0] = self.coefficient(0);
        for level in self.levels() {
            let c = self.coefficient(level);
            sum.iter_mut().zip(&expand(self.level(level))).for_each(|(s, a)| *s += c * a);
        }
        sum
    }

    /// Refuses lines, coefficients or expansions that are not finite, and coefficients that vanished by underflow.
    fn checked(self) -> Result<Self, DecompositionError> {
        for level in self.levels() {
            let c = self.coefficient(level);
            let finite = self.level(level).iter().all(|line| line.l.is_finite() && line.k.is_finite());
            if !(finite && c.is_finite() && c != 0.0) {
                return Err(DecompositionError::NotFinite { level });
            }
        }
        let ratios_are_finite = self.alpha().is_finite() && self.beta().is_finite();
        if ratios_are_finite && self.expanded().iter().all(|a| a.is_finite()) {
            Ok(self)
        } else {
            Err(DecompositionError::NotFinite { level: self.degree.value() })
        }
    }
}

/// The coefficients divided by the largest absolute one, and that one.
pub(crate) fn normalised(polynomial: &ImplicitPolynomial) -> ([f64; MAX_COEFFICIENTS], f64) {
    let largest = polynomial.coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
    let scale = if largest > 0.0 { largest } else { 1.0 };
    let mut coefficients = [0.0; MAX_COEFFICIENTS];
    for (to, a) in coefficients.iter_mut().zip(polynomial.coefficients()) {
        *to = a / scale;
    }
    (coefficients, scale)
}

/// Where the lines of level m start; for m = 0, how many there are.
const fn offset(degree: Degree, m: usize) -> usize {
    let (half, below) = (degree.value() / 2, m / 2);
    half * (half + 1) - below * (below + 1)
}

fn nearly_conjugate(first: &Line, second: &Line) -> bool {
    let near = |a: nalgebra::Complex<f64>, b: nalgebra::Complex<f64>| (a - b.conj()).norm() <= 1e-6 * (1.0 + a.norm());
    near(first.l, second.l) && near(first.k, second.k)
}
