//! The sums that the 3L problem of one outline consists of, in one pass over its points and normals.
use pulp::{Arch, Simd, WithSimd};

use crate::{
    degree::{MAX_COEFFICIENTS, coefficient_count},
    moment_sums::{BLOCK, MomentSums, Powers},
    moments::MAX_MOMENTS,
    monomials::monomial_index,
    ridge::binomial,
    vectors::load,
};

/// Sides of the level sets, where f should be -1, 0 and 1.
pub(crate) const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];

/// Powers of `x^2 + y^2` up to the degree of an octic.
const MAX_RADIAL: usize = 9;

/// Points and their unit normals, by coordinate; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrientedPoints<'a> {
    pub(crate) points: [&'a [f64]; 2],
    pub(crate) normals: [&'a [f64]; 2],
}

/// What a least-squares fit to the three level sets needs to know of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LevelSetMoments {
    /// `sum x^p y^q` over all three level sets, up to twice the degree, in graded order: the entries of `M'M`.
    pub(crate) gram: [f64; MAX_MOMENTS],
    /// `sum x^i y^j` over the outer level set less that over the inner one, up to the degree: `M'd`.
    pub(crate) projection: [f64; MAX_COEFFICIENTS],
    /// `sum (x^2 + y^2)^d` over the data, for d up to the degree: what a rotation-invariant ridge is made of.
    pub(crate) radial: [f64; MAX_RADIAL],
}

impl LevelSetMoments {
    pub(crate) const ZERO: Self =
        Self { gram: [0.0; MAX_MOMENTS], projection: [0.0; MAX_COEFFICIENTS], radial: [0.0; MAX_RADIAL] };

    /// Overwrites the sums with those for a fit of `degree` to points and their level sets at `offset` along the normals.
    pub(crate) fn set_to(&mut self, degree: usize, offset: f64, data: OrientedPoints<'_>) {
        Arch::new().dispatch(LevelSetKernel { degree, offset, data, sums: self });
        let count = data.points[0].len() as f64;
        // Incomplete vectors are padded with points at the origin without a normal, which count in these sums alone.
        self.gram[0] = LEVELS.len() as f64 * count;
        self.radial[0] = count;
    }
}

struct LevelSetKernel<'a> {
    degree: usize,
    offset: f64,
    data: OrientedPoints<'a>,
    sums: &'a mut LevelSetMoments,
}

impl WithSimd for LevelSetKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // Known sizes let the compiler unroll the loops over the powers and keep the sums close.
        match self.degree {
            2 => accumulate::<S, 2, 5, 15>(simd, self),
            4 => accumulate::<S, 4, 9, 45>(simd, self),
            6 => accumulate::<S, 6, 13, 91>(simd, self),
            _ => accumulate::<S, 8, 17, MAX_MOMENTS>(simd, self),
        }
    }
}

/// POWERS = 2 DEGREE + 1 powers of a coordinate, MOMENTS = (2 DEGREE + 1)(DEGREE + 1) sums.
#[inline(always)]
fn accumulate<S: Simd, const DEGREE: usize, const POWERS: usize, const MOMENTS: usize>(
    simd: S,
    kernel: LevelSetKernel<'_>,
) {
    let LevelSetKernel { offset, data, sums: out, .. } = kernel;
    let zero = simd.splat_f64s(0.0);
    let mut sets = [MomentSums::<S, POWERS, MOMENTS>::new(simd); LEVELS.len()];
    let mut powers = Powers::new(simd);
    let mut block = [[zero; BLOCK]; 4];
    let mut moved = [[zero; BLOCK]; 2];
    let block_len = BLOCK * S::F64_LANES;
    let points = data.points[0].chunks(block_len).zip(data.points[1].chunks(block_len));
    let normals = data.normals[0].chunks(block_len).zip(data.normals[1].chunks(block_len));
    for ((xs, ys), (nxs, nys)) in points.zip(normals) {
        let [x, y, nx, ny] = &mut block;
        let [xs, ys] = [load(simd, xs, x), load(simd, ys, y)];
        let [nxs, nys] = [load(simd, nxs, nx), load(simd, nys, ny)];
        let [moved_xs, moved_ys] = moved.each_mut().map(|axis| &mut axis[..xs.len()]);
        for (level, sums) in LEVELS.into_iter().zip(&mut sets) {
            let distance = simd.splat_f64s(level * offset);
            for (moved, (value, normal)) in moved_xs.iter_mut().zip(xs.iter().zip(nxs)) {
                *moved = simd.mul_add_e_f64s(distance, *normal, *value);
            }
            for (moved, (value, normal)) in moved_ys.iter_mut().zip(ys.iter().zip(nys)) {
                *moved = simd.mul_add_e_f64s(distance, *normal, *value);
            }
            sums.add(simd, &mut powers, moved_xs, moved_ys);
        }
    }
    let [inner, on, outer] = sets.each_ref().map(|sums| &sums.lanes);
    for (k, sum) in out.gram.iter_mut().take(MOMENTS).enumerate() {
        *sum = simd.reduce_sum_f64s(simd.add_f64s(on[k], simd.add_f64s(inner[k], outer[k])));
    }
    for (k, sum) in out.projection.iter_mut().take(coefficient_count(DEGREE)).enumerate() {
        *sum = simd.reduce_sum_f64s(simd.sub_f64s(outer[k], inner[k]));
    }
    for (d, sum) in out.radial.iter_mut().enumerate().take(DEGREE + 1) {
        // (x^2 + y^2)^d by the binomial theorem.
        let terms = (0..=d).map(|k| (binomial(d, k), on[monomial_index(2 * (d - k), 2 * k)]));
        let lanes = terms.fold(simd.splat_f64s(0.0), |sum, (factor, moment)| {
            simd.mul_add_e_f64s(simd.splat_f64s(factor), moment, sum)
        });
        *sum = simd.reduce_sum_f64s(lanes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moments::Moments;

    #[test]
    fn the_vectorised_sums_agree_with_the_reference_moments_of_the_three_level_sets() {
        let offset = 0.15;
        for count in [0_u32, 1, 3, 4, 5, 7, 8, 9, 15, 16, 17, 33, 401] {
            let waves = |a: f64, b: f64| (0..count).map(|i| (a * f64::from(i) + b).sin()).collect::<Vec<f64>>();
            let [x, y] = [waves(1.7, 0.0), waves(0.9, 1.0)];
            let [nx, ny] = [waves(0.3, 0.0), waves(0.3, std::f64::consts::FRAC_PI_2)];
            for degree in [2, 4, 6, 8] {
                let mut sums = LevelSetMoments::ZERO;
                sums.set_to(degree, offset, OrientedPoints { points: [&x, &y], normals: [&nx, &ny] });
                let moved = |values: &[f64], normals: &[f64], level: f64| -> Vec<f64> {
                    values.iter().zip(normals).map(|(v, n)| v + level * offset * n).collect()
                };
                let sets = LEVELS.map(|l| Moments::reference(2 * degree, &moved(&x, &nx, l), &moved(&y, &ny, l)));
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * f64::from(1 + count), "{count}: {a} {b}");
                for k in 0..coefficient_count(2 * degree) {
                    near(sums.gram[k], sets.iter().map(|set| set.as_slice()[k]).sum());
                }
                for k in 0..coefficient_count(degree) {
                    near(sums.projection[k], sets[2].as_slice()[k] - sets[0].as_slice()[k]);
                }
                for d in 0..=degree {
                    let squares = x.iter().zip(&y).map(|(x, y)| x * x + y * y);
                    near(sums.radial[d], squares.map(|square| square.powi(d as i32)).sum());
                }
            }
        }
    }
}
