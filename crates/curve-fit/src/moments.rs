use pulp::{Arch, Simd, WithSimd};

use crate::{
    degree::coefficient_count,
    moment_sums::{BLOCK, MomentSums, Powers},
    monomials::monomial_index,
    vectors::load,
};

/// Highest total degree of a moment that any fit needs: twice the degree of an octic.
const MAX_TOTAL_DEGREE: usize = 16;
pub(crate) const MAX_MOMENTS: usize = coefficient_count(MAX_TOTAL_DEGREE);

/// The moments `sum x^p y^q`, `p + q <= D`, of a set of points: everything that a least-squares fit of a polynomial of
/// degree `D / 2` needs to know of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    total_degree: usize,
    sums: [f64; MAX_MOMENTS],
}

impl Moments {
    /// Moments up to `total_degree` (at most 16) of the points `(xs[i], ys[i])`. Work: one multiply-add per point and
    /// moment, with the widest vector instructions that the machine has.
    ///
    /// # Panics
    /// If the slices differ in length or `total_degree` exceeds 16.
    #[must_use]
    pub fn of(total_degree: usize, xs: &[f64], ys: &[f64]) -> Self {
        assert!(total_degree <= MAX_TOTAL_DEGREE, "moments beyond degree {MAX_TOTAL_DEGREE}");
        assert_eq!(xs.len(), ys.len(), "as many x as y");
        let mut sums = [0.0; MAX_MOMENTS];
        Arch::new().dispatch(MomentKernel { total_degree, xs, ys, sums: &mut sums });
        // An incomplete vector is padded with points at the origin, which count in this sum alone.
        sums[0] = xs.len() as f64;
        Self { total_degree, sums }
    }

    /// Moments by the plain definition, slower than [`of`](Self::of). A test compares the two.
    ///
    /// # Panics
    /// If `total_degree` exceeds 16.
    #[must_use]
    pub fn reference(total_degree: usize, xs: &[f64], ys: &[f64]) -> Self {
        let mut sums = [0.0; MAX_MOMENTS];
        let mut monomials = [0.0; MAX_MOMENTS];
        for (&x, &y) in xs.iter().zip(ys) {
            crate::monomials::evaluate_monomials(total_degree, x, y, &mut monomials);
            sums.iter_mut().zip(&monomials).for_each(|(sum, m)| *sum += m);
        }
        Self { total_degree, sums }
    }

    /// Highest `p + q`.
    #[must_use]
    pub fn total_degree(&self) -> usize {
        self.total_degree
    }

    /// `sum x^p y^q`.
    ///
    /// # Panics
    /// If `p + q` exceeds the total degree.
    #[must_use]
    pub fn get(&self, p: usize, q: usize) -> f64 {
        assert!(p + q <= self.total_degree, "moment ({p}, {q}) beyond degree {}", self.total_degree);
        self.sums[monomial_index(p, q)]
    }

    /// All moments in graded order.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.sums[..coefficient_count(self.total_degree)]
    }
}

struct MomentKernel<'a> {
    total_degree: usize,
    xs: &'a [f64],
    ys: &'a [f64],
    sums: &'a mut [f64; MAX_MOMENTS],
}

impl WithSimd for MomentKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // Known sizes let the compiler unroll the loops over the powers and keep the sums close.
        match self.total_degree {
            4 => accumulate::<S, 5, 15>(simd, self.xs, self.ys, self.sums),
            8 => accumulate::<S, 9, 45>(simd, self.xs, self.ys, self.sums),
            12 => accumulate::<S, 13, 91>(simd, self.xs, self.ys, self.sums),
            _ => accumulate::<S, { MAX_TOTAL_DEGREE + 1 }, MAX_MOMENTS>(simd, self.xs, self.ys, self.sums),
        }
    }
}

/// POWERS = D + 1 powers of a coordinate, MOMENTS = (D + 1)(D + 2) / 2 sums.
#[inline(always)]
fn accumulate<S: Simd, const POWERS: usize, const MOMENTS: usize>(
    simd: S,
    xs: &[f64],
    ys: &[f64],
    sums: &mut [f64; MAX_MOMENTS],
) {
    let mut accumulated = MomentSums::<S, POWERS, MOMENTS>::new(simd);
    let mut powers = Powers::new(simd);
    let [mut x, mut y] = [[simd.splat_f64s(0.0); BLOCK]; 2];
    let block_len = BLOCK * S::F64_LANES;
    for (xs, ys) in xs.chunks(block_len).zip(ys.chunks(block_len)) {
        accumulated.add(simd, &mut powers, load(simd, xs, &mut x), load(simd, ys, &mut y));
    }
    for (sum, lanes) in sums.iter_mut().zip(accumulated.lanes) {
        *sum = simd.reduce_sum_f64s(lanes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vectorised_sums_agree_with_the_reference_for_any_number_of_points() {
        for count in [0, 1, 2, 3, 7, 8, 15, 16, 17, 31, 33, 100, 401] {
            let xs: Vec<f64> = (0..count).map(|i| (1.7 * f64::from(i)).sin() * 1.4).collect();
            let ys: Vec<f64> = (0..count).map(|i| (0.9 * f64::from(i)).cos() * 1.2).collect();
            for degree in [4, 8, 12, 16] {
                let fast = Moments::of(degree, &xs, &ys);
                let reference = Moments::reference(degree, &xs, &ys);
                for (a, b) in fast.as_slice().iter().zip(reference.as_slice()) {
                    assert!((a - b).abs() <= 1e-11 * (1.0 + f64::from(count) * 300.0), "{count} {degree}: {a} {b}");
                }
            }
        }
    }
}
