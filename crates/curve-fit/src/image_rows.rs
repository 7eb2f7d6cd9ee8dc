//! Values of a polynomial at many points of a row of the image at once.
use nalgebra::Matrix2;
use pulp::Arch;

use crate::{
    degree::{Degree, MAX_COEFFICIENTS, coefficient_count},
    normalisation::Normalisation,
    polynomial::ImplicitPolynomial,
};

/// Points that are evaluated side by side: two vector registers of doubles.
const LANES: usize = 8;

type Lanes = [f64; LANES];

/// A polynomial of working coordinates, to be evaluated along rows of the image.
pub(crate) struct ImageRows<'a> {
    polynomial: &'a ImplicitPolynomial,
    normalisation: &'a Normalisation,
    unstretch: Matrix2<f64>,
}

impl<'a> ImageRows<'a> {
    pub(crate) fn of(polynomial: &'a ImplicitPolynomial, normalisation: &'a Normalisation) -> Self {
        Self { polynomial, normalisation, unstretch: normalisation.unstretch() }
    }

    /// The values at these x and one y, as [`ImplicitPolynomial::evaluate`] gives them: the operations on each point and their order
    /// are the same, so that no bit differs.
    pub(crate) fn evaluate(&self, xs: &[f64], y: f64, values: &mut [f64]) {
        let arch = Arch::new();
        match self.polynomial.degree() {
            Degree::Conic => arch.dispatch(|| self.evaluate_of_degree::<2>(xs, y, values)),
            Degree::Quartic => arch.dispatch(|| self.evaluate_of_degree::<4>(xs, y, values)),
            Degree::Sextic => arch.dispatch(|| self.evaluate_of_degree::<6>(xs, y, values)),
            Degree::Octic => arch.dispatch(|| self.evaluate_of_degree::<8>(xs, y, values)),
        }
    }

    #[inline(always)]
    fn evaluate_of_degree<const N: usize>(&self, xs: &[f64], y: f64, values: &mut [f64]) {
        let Normalisation { centre, radius, .. } = self.normalisation;
        let u = &self.unstretch;
        let from_centre = (y - centre.y) / radius;
        let mut monomials = [[1.0; LANES]; MAX_COEFFICIENTS];
        for (xs, values) in xs.chunks(LANES).zip(values.chunks_mut(LANES)) {
            let mut across: Lanes = [0.0; LANES];
            across.iter_mut().zip(xs).for_each(|(to, x)| *to = (x - centre.x) / radius);
            let x: Lanes = across.map(|across| u.m11 * across + u.m12 * from_centre);
            let y: Lanes = across.map(|across| u.m21 * across + u.m22 * from_centre);
            let found = self.sums::<N>(&x, &y, &mut monomials);
            values.iter_mut().zip(found).for_each(|(value, found)| *value = found);
        }
    }

    /// The values at points in working coordinates. The first of the monomials is 1.
    #[inline(always)]
    fn sums<const N: usize>(&self, x: &Lanes, y: &Lanes, monomials: &mut [Lanes; MAX_COEFFICIENTS]) -> Lanes {
        for d in 1..=N {
            let (start, previous) = (d * (d + 1) / 2, d * (d - 1) / 2);
            for j in 0..d {
                monomials[start + j] = product(x, &monomials[previous + j]);
            }
            monomials[start + d] = product(y, &monomials[previous + d - 1]);
        }
        // What a sum of nothing is.
        let mut sums = [-0.0; LANES];
        for (a, monomial) in self.polynomial.coefficients().iter().zip(&monomials[..coefficient_count(N)]) {
            sums.iter_mut().zip(monomial).for_each(|(sum, m)| *sum += a * m);
        }
        sums
    }
}

#[inline(always)]
fn product(a: &Lanes, b: &Lanes) -> Lanes {
    std::array::from_fn(|lane| a[lane] * b[lane])
}

#[cfg(test)]
mod tests {
    use nalgebra::{Affine2, Matrix3, Point2};
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_row_has_the_values_of_its_points_to_the_last_bit(
            degree in 0..4_usize,
            coefficients in prop::collection::vec(-1e3..1e3_f64, MAX_COEFFICIENTS),
            (turn, size, centre) in (0.1..6.0_f64, 1e-3..1e3_f64, (-1e6..1e6_f64, -10.0..10.0_f64)),
            is_stretched: bool,
            count in 0..40_usize,
        ) {
            let degree = Degree::ALL[degree];
            let polynomial = ImplicitPolynomial::new(degree, &coefficients[..degree.coefficient_count()])
                .expect("finite coefficients");
            let (sine, cosine) = turn.sin_cos();
            let map = Matrix3::new(2.0 * cosine, -sine, centre.0, 2.0 * sine, cosine, centre.1, 0.0, 0.0, 1.0 / size) * size;
            let normalisation = if is_stretched {
                Normalisation::affine(&Affine2::from_matrix_unchecked(map)).expect("a regular map")
            } else {
                Normalisation::similarity(Point2::new(centre.0, centre.1), size)
            };
            let xs: Vec<f64> = (0..count).map(|k| centre.0 + size * (k as f64 / 7.0 - 3.0)).collect();
            for y in [centre.1, centre.1 + 0.3 * size, centre.1 - 1.7 * size] {
                let mut found = vec![f64::NAN; count];
                ImageRows::of(&polynomial, &normalisation).evaluate(&xs, y, &mut found);
                let at = |x: &f64| polynomial.evaluate(&normalisation.to_working(&Point2::new(*x, y))).to_bits();
                let expected: Vec<u64> = xs.iter().map(at).collect();
                prop_assert_eq!(found.into_iter().map(f64::to_bits).collect::<Vec<_>>(), expected);
            }
        }
    }
}
