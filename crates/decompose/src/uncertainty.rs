use freeform_curve_fit::ImplicitPolynomial;
use nalgebra::{DMatrix, Matrix2, Point2};

use crate::{
    decomposition::Decomposition, error::DecompositionError, invariants::AffineInvariants, related_point::RelatedPoints,
};

/// Step of the differences that derivatives are taken from, relative to the largest coefficient: the best for central differences
/// in double precision, where curvature and rounding leave about ten digits.
const STEP: f64 = 6e-6;

/// How uncertain the related points and the invariants of a fitted curve are.
///
/// The covariance of the coefficients is carried to them by first derivatives, `J C J'`, with J from central differences of the
/// whole way: coefficients, lines, related points, their values, the unit vector of the invariants. It is as good as its first order:
/// where lines nearly coincide related points swing out further than it says.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveUncertainty {
    points: Vec<Matrix2<f64>>,
    invariants: Option<DMatrix<f64>>,
}

impl CurveUncertainty {
    /// Carries the covariance of the coefficients of a polynomial (in graded order, as of
    /// [`FitCovariance`](freeform_curve_fit::FitCovariance)) to its related points and invariants.
    ///
    /// # Errors
    /// The polynomial, or one a small step from it, has no decomposition.
    ///
    /// # Panics
    /// If the covariance is not square, or not of the size of the coefficients.
    pub fn carried(polynomial: &ImplicitPolynomial, coefficients: &DMatrix<f64>) -> Result<Self, DecompositionError> {
        let count = polynomial.coefficients().len();
        assert_eq!(coefficients.shape(), (count, count), "a covariance of the coefficients");
        let at = Derived::of(polynomial)?;
        let largest = polynomial.coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let step = STEP * largest;
        let mut derivatives = DMatrix::zeros(at.len(), count);
        for k in 0..count {
            let beside = |sign: f64| {
                let mut moved = polynomial.coefficients().to_vec();
                moved[k] += sign * step;
                let moved = ImplicitPolynomial::new(polynomial.degree(), &moved).map_err(|_| OVERFLOW)?;
                Derived::of(&moved)?.in_order_of(&at)
            };
            let (up, down) = (beside(1.0)?, beside(-1.0)?);
            let rows = up.flat().zip(down.flat()).map(|(u, d)| (u - d) / (2.0 * step));
            derivatives.column_mut(k).iter_mut().zip(rows).for_each(|(to, d)| *to = d);
        }
        let carried = &derivatives * coefficients * derivatives.transpose();
        let points = (0..at.points.len()).map(|i| carried.fixed_view::<2, 2>(2 * i, 2 * i).into_owned()).collect();
        let first = 2 * at.points.len();
        let size = at.invariants.len();
        let invariants = (size > 0).then(|| carried.view((first, first), (size, size)).into_owned());
        Ok(Self { points, invariants })
    }

    /// Covariances of the related points, in squared units of the coordinates of the polynomial, in the order of
    /// [`RelatedPoints`].
    #[must_use]
    pub fn points(&self) -> &[Matrix2<f64>] {
        &self.points
    }

    /// Covariance of the [`values`](AffineInvariants::values) of the invariants; `None` where there are none.
    #[must_use]
    pub fn invariants(&self) -> Option<&DMatrix<f64>> {
        self.invariants.as_ref()
    }
}

/// What a coefficient that overflows stands for.
const OVERFLOW: DecompositionError = DecompositionError::NotFinite { level: 0 };

/// What is derived from the coefficients.
struct Derived {
    /// With their levels.
    points: Vec<(usize, Point2<f64>)>,
    invariants: Vec<f64>,
}

impl Derived {
    fn of(polynomial: &ImplicitPolynomial) -> Result<Self, DecompositionError> {
        let decomposition = Decomposition::of(polynomial)?;
        let points = RelatedPoints::of(&decomposition).as_slice().iter().map(|d| (d.level, d.point)).collect();
        let invariants = AffineInvariants::of(&decomposition).map_or_else(Vec::new, |found| found.values().to_vec());
        Ok(Self { points, invariants })
    }

    fn len(&self) -> usize {
        2 * self.points.len() + self.invariants.len()
    }

    fn flat(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().flat_map(|(_, p)| [p.x, p.y]).chain(self.invariants.iter().copied())
    }

    /// Reorders the points of each level: each is put where the nearest point of a neighbour stands.
    fn in_order_of(mut self, other: &Self) -> Result<Self, DecompositionError> {
        if self.len() != other.len() {
            return Err(OVERFLOW);
        }
        for i in 0..self.points.len() {
            let (level, wanted) = other.points[i];
            let distance = |&j: &usize| (self.points[j].1 - wanted).norm_squared();
            let candidates = (i..self.points.len()).filter(|&j| self.points[j].0 == level);
            let nearest = candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))).ok_or(OVERFLOW)?;
            self.points.swap(i, nearest);
        }
        Ok(self)
    }
}
