use freeform_curve_fit::Degree;
use nalgebra::{DMatrix, DVector};

use crate::{
    decomposition::Decomposition,
    related_point::{MAX_RELATED_POINTS, RelatedPoints},
};

/// Variances below this fraction of the largest are those along the unit vectors, and rounding.
const SINGULAR: f64 = 1e-9;

/// Affine invariants of a curve: the ratios of the values f(d) at its related points, and of the constant `c_0`, to
/// each other. All of them change by one common factor when the curve moves, so what they have in common identifies the
/// curve (M. Unel and W. A. Wolovich, 2000).
///
/// Kept as a vector of unit length, so that no value that happens to be small is divided by. Within a level the values
/// stand in rising order: pairs have no order of their own. A conic has none: its single ratio is 1.
///
/// The common factor of the monic polynomial is positive for a bounded curve alone: the coefficient of `x^n` of an unbounded one
/// takes either sign as the curve turns, and the monic polynomial, its values and their order with it. So the values are
/// those of the polynomial as it is, which a fit makes negative inside and positive outside. Curves that have four or more real
/// lines in a level, which do not fall into pairs, have no invariants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AffineInvariants {
    degree: Degree,
    values: [f64; MAX_RELATED_POINTS + 1],
    count: usize,
}

impl AffineInvariants {
    /// The invariants of a decomposed curve. `None` where all values vanish or overflow, or a related point is missing.
    #[must_use]
    pub fn of(decomposition: &Decomposition) -> Option<Self> {
        let degree = decomposition.degree();
        let points = RelatedPoints::of(decomposition);
        let count = degree.value() * (degree.value() + 2) / 8 + 1;
        if points.as_slice().len() + 1 != count {
            return None;
        }
        let sign = 1.0_f64.copysign(decomposition.coefficient(degree.value()));
        let mut values = [0.0; MAX_RELATED_POINTS + 1];
        let mut end = 0;
        for level in decomposition.levels() {
            let start = end;
            for d in points.level(level) {
                values[end] = sign * d.value;
                end += 1;
            }
            values[start..end].sort_unstable_by(f64::total_cmp);
        }
        values[end] = sign * points.beta();
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        values.iter_mut().for_each(|v| *v /= largest);
        let norm = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        values.iter_mut().for_each(|v| *v /= norm);
        values.iter().all(|v| v.is_finite()).then_some(Self { degree, values, count })
    }

    /// Degree of the curve.
    #[must_use]
    pub const fn degree(&self) -> Degree {
        self.degree
    }

    /// The values, highest level first, rising within a level, the constant last; the sum of their squares is 1.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }

    /// The invariant `f(d_i) / f(d_j)`, i and j being positions in [`values`](Self::values). Infinite or NaN where `f(d_j)` is 0.
    ///
    /// # Panics
    /// If a position is beyond the values.
    #[must_use]
    pub fn ratio(&self, i: usize, j: usize) -> f64 {
        self.values()[i] / self.values()[j]
    }

    /// How different two curves are: Euclidean distance of the unit vectors, between 0 (the same curve, moved) and 2.
    /// `None` for curves of different degree, which cannot be compared.
    #[must_use]
    pub fn distance(&self, other: &Self) -> Option<f64> {
        let squares = self.values().iter().zip(other.values()).map(|(a, b)| (a - b) * (a - b));
        (self.degree == other.degree).then(|| squares.sum::<f64>().sqrt())
    }

    /// Distance to other invariants in standard deviations (Mahalanobis 1936): the root of `d' C^-1 d`, d the difference of the unit vectors and C
    /// its covariance, the sum of those of both where both are uncertain ([`CurveUncertainty`](crate::CurveUncertainty)). As
    /// unit vectors do not vary along themselves C is singular; what it leaves out counts nothing. `None` for curves of
    /// different degree, and where C is not of the size of the vectors or not finite.
    #[must_use]
    pub fn mahalanobis(&self, other: &Self, covariance: &DMatrix<f64>) -> Option<f64> {
        let usable = covariance.shape() == (self.count, self.count) && covariance.iter().all(|c| c.is_finite());
        if self.degree != other.degree || !usable {
            return None;
        }
        let difference =
            DVector::from_iterator(self.count, self.values().iter().zip(other.values()).map(|(a, b)| a - b));
        let eigen = covariance.clone().symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let components = eigen.eigenvectors.tr_mul(&difference);
        let terms = components.iter().zip(&eigen.eigenvalues).filter(|(_, c)| **c > SINGULAR * largest);
        Some(terms.map(|(d, c)| d * d / c).sum::<f64>().sqrt())
    }
}
