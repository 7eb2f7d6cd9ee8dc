use freeform_curve_fit::ImplicitPolynomial;
use nalgebra::{Affine2, Matrix2, Point2, Vector2};

use crate::{
    decomposition::{Decomposition, normalised},
    error::DecompositionError,
    line::Line,
    line_product::{Coefficients, LineProduct},
};

/// Number of related points of the largest degree: 4 + 3 + 2 + 1.
pub(crate) const MAX_RELATED_POINTS: usize = 10;

/// A Hessian whose determinant is below this fraction of the square of its size has no centre.
const MIN_DETERMINANT: f64 = 1e-10;

/// A point that moves with the curve: the real intersection of two lines of a level. For the last level, that of the conic,
/// it is the conic's centre.
///
/// Under an affine map `p -> A p + b` of the curve it goes to `A d + b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelatedPoint {
    /// Level m of the two lines.
    pub level: usize,
    /// Which pair of the level, counted from 0: lines `2 pair` and `2 pair + 1`.
    pub pair: usize,
    /// The point d, in the unit of the outline.
    pub point: Point2<f64>,
    /// Value f(d) of the monic polynomial. Only ratios mean something: all values of one curve change by one common
    /// factor when the curve moves, a positive one if the curve is bounded.
    pub value: f64,
}

/// The related points of one curve, highest level first and in the order of the pairs: 3 for a quartic, `n (n + 2) / 8` for
/// degree n. Fewer where a level has four or more real lines, which do not fall into pairs, or where its conic has no
/// centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelatedPoints {
    points: [RelatedPoint; MAX_RELATED_POINTS],
    count: usize,
    /// Constant `c_0 / c_n` left by the decomposition; it takes part in the common factor of the values.
    beta: f64,
}

impl RelatedPoints {
    /// The related points of a decomposed curve. Those that overflow are left out.
    #[must_use]
    pub fn of(decomposition: &Decomposition) -> Self {
        let mut result = Self::empty(decomposition.beta());
        let n = decomposition.degree().value();
        for level in decomposition.levels() {
            result.push_level(level, decomposition.level(level));
        }
        result.evaluate(|d| decomposition.evaluate(d) / decomposition.coefficient(n));
        result
    }

    /// The related points of a polynomial, the conic of the last level left in one piece: its centre solves
    /// `grad r = 0`. So these exist in orientations where alpha vanishes and the conic has no lines of the form
    /// `x + l y + k`.
    ///
    /// # Errors
    /// As [`Decomposition::of`] for the levels above the conic, where no condition number is checked.
    pub fn of_polynomial(polynomial: &ImplicitPolynomial) -> Result<Self, DecompositionError> {
        let degree = polynomial.degree();
        let (mut remainder, scale) = normalised(polynomial);
        let leading = remainder[degree.value() * (degree.value() + 1) / 2];
        let mut result = Self::empty(0.0);
        let mut magnitude = 0.0;
        let mut level = degree.value();
        if leading == 0.0 {
            return Err(DecompositionError::VanishingLeadingCoefficient { level, relative: 0.0 });
        }
        while level > 2 {
            let product = LineProduct::leading(&remainder, level, magnitude)?;
            magnitude = product.subtract_from(&mut remainder)?;
            result.push_level(level, product.lines());
            level -= 2;
        }
        if let Some((point, value)) = centre(&remainder, magnitude) {
            result.push(RelatedPoint { level: 2, pair: 0, point, value: 0.0 });
            result.beta = value / leading;
        }
        result.evaluate(|d| polynomial.evaluate(d) / scale / leading);
        if result.beta.is_finite() { Ok(result) } else { Err(DecompositionError::NotFinite { level: 2 }) }
    }

    /// All of them.
    #[must_use]
    pub fn as_slice(&self) -> &[RelatedPoint] {
        &self.points[..self.count]
    }

    /// Those of level m.
    pub fn level(&self, m: usize) -> impl Iterator<Item = &RelatedPoint> + Clone {
        self.as_slice().iter().filter(move |d| d.level == m)
    }

    /// Constant of the monic polynomial, which changes by the same factor as the values.
    #[must_use]
    pub const fn beta(&self) -> f64 {
        self.beta
    }

    /// The points moved by an affine map. Their values are kept: right up to the common factor, which
    /// [`scaled`](Self::scaled) puts in.
    #[must_use]
    pub fn moved(&self, map: &Affine2<f64>) -> Self {
        let mut result = *self;
        result.points[..self.count].iter_mut().for_each(|d| d.point = map * d.point);
        result
    }

    /// These points with their values and [`beta`](Self::beta) multiplied by a factor. Points whose values overflow are left
    /// out. The values of the monic polynomial of a moved curve are the old ones times `c_n(before) / c_n(after)`, with
    /// the leading coefficients `c_n` of [`Decomposition`] before and after [`Decomposition::moved`].
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut result = *self;
        result.beta *= factor;
        result.points[..self.count].iter_mut().for_each(|d| d.value *= factor);
        result.drop_overflowed();
        result
    }

    fn empty(beta: f64) -> Self {
        let nothing = RelatedPoint { level: 0, pair: 0, point: Point2::origin(), value: 0.0 };
        Self { points: [nothing; MAX_RELATED_POINTS], count: 0, beta }
    }

    fn push(&mut self, point: RelatedPoint) {
        self.points[self.count] = point;
        self.count += 1;
    }

    fn push_level(&mut self, level: usize, lines: &[Line]) {
        let pairs = || lines.chunks_exact(2).enumerate();
        let real_pairs = pairs().filter(|(_, pair)| pair[0].l.im == 0.0).count();
        for (pair, two) in pairs() {
            if two[0].l.im == 0.0 && real_pairs > 1 {
                continue;
            }
            let point = intersection(&two[0], &two[1]);
            self.push(RelatedPoint { level, pair, point, value: 0.0 });
        }
    }

    /// Fills in the values and drops points that are not finite.
    fn evaluate(&mut self, value: impl Fn(&Point2<f64>) -> f64) {
        self.points[..self.count].iter_mut().for_each(|d| d.value = value(&d.point));
        self.drop_overflowed();
    }

    fn drop_overflowed(&mut self) {
        let mut kept = 0;
        for index in 0..self.count {
            let d = self.points[index];
            if d.point.coords.iter().all(|c| c.is_finite()) && d.value.is_finite() {
                self.points[kept] = d;
                kept += 1;
            }
        }
        let nothing = Self::empty(0.0).points;
        self.points[kept..].copy_from_slice(&nothing[kept..]);
        self.count = kept;
    }
}

/// Real intersection of two lines, conjugate or both real. For a conjugate pair with `l = e1 + j e2`, `k = e3 + j e4` it is
/// `y = -e4 / e2`, `x = -e3 + e1 e4 / e2`.
pub(crate) fn intersection(first: &Line, second: &Line) -> Point2<f64> {
    let y = if first.l.im == 0.0 {
        -(first.k.re - second.k.re) / (first.l.re - second.l.re)
    } else {
        -first.k.im / first.l.im
    };
    Point2::new(-first.k.re - first.l.re * y, y)
}

/// Where the gradient of a conic vanishes, and what is left of it after its line product: its value there. `magnitude` is
/// the size of the numbers that its quadratic part was computed from.
fn centre(conic: &Coefficients, magnitude: f64) -> Option<(Point2<f64>, f64)> {
    let [c, dx, dy, xx, xy, yy, ..] = *conic;
    let hessian = Matrix2::new(2.0 * xx, xy, xy, 2.0 * yy);
    let gradient = Vector2::new(dx, dy);
    let size = hessian.abs().max().max(magnitude);
    if hessian.determinant().abs() <= MIN_DETERMINANT * size * size {
        return None;
    }
    let point = Point2::from(-(hessian.try_inverse()? * gradient));
    Some((point, c + 0.5 * gradient.dot(&point.coords)))
}
