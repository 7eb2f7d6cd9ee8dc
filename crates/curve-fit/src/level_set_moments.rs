//! The sums that the 3L problem of one outline consists of, in one pass over its points and normals.
use pulp::{Arch, Simd, WithSimd};

use crate::{
    degree::{MAX_COEFFICIENTS, coefficient_count},
    moments::MAX_MOMENTS,
    monomials::monomial_index,
};

/// Sides of the level sets, where f should be -1, 0 and 1.
pub(crate) const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];

/// Powers of `x^2 + y^2` up to the degree of an octic.
const MAX_RADIAL: usize = 9;

const SETS: usize = LEVELS.len();

/// Vectors of points that are accumulated together, so that each sum is loaded and stored once for all of them.
const GROUP: usize = 2;

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
    LevelSetKernel { offset, data, sums: out, .. }: LevelSetKernel<'_>,
) {
    let zero = simd.splat_f64s(0.0);
    let offset = simd.splat_f64s(offset);
    let mut sums =
        Sums::<S, MOMENTS> { gram: [zero; MOMENTS], projection: [zero; MAX_COEFFICIENTS], radial: [zero; MAX_RADIAL] };
    let [xs, ys] = data.points;
    let [nxs, nys] = data.normals;
    let group_len = GROUP * S::F64_LANES;
    let groups = xs.chunks(group_len).zip(ys.chunks(group_len)).zip(nxs.chunks(group_len).zip(nys.chunks(group_len)));
    let mut x_powers = [[[simd.splat_f64s(1.0); SETS]; GROUP]; POWERS];
    for ((xs, ys), (nxs, nys)) in groups {
        let [xs, ys, nxs, nys] = [xs, ys, nxs, nys].map(|chunk| load_group(simd, chunk));
        let mut y = [[zero; SETS]; GROUP];
        for g in 0..GROUP {
            let (dx, dy) = (simd.mul_f64s(offset, nxs[g]), simd.mul_f64s(offset, nys[g]));
            x_powers[1][g] = [simd.sub_f64s(xs[g], dx), xs[g], simd.add_f64s(xs[g], dx)];
            y[g] = [simd.sub_f64s(ys[g], dy), ys[g], simd.add_f64s(ys[g], dy)];
            let squared = simd.mul_add_e_f64s(xs[g], xs[g], simd.mul_f64s(ys[g], ys[g]));
            let mut power = squared;
            for sum in &mut sums.radial[1..=DEGREE] {
                *sum = simd.add_f64s(*sum, power);
                power = simd.mul_f64s(power, squared);
            }
        }
        for i in 2..POWERS {
            x_powers[i] = multiply(simd, &x_powers[i - 1], &x_powers[1]);
        }
        let mut y_power = [[simd.splat_f64s(1.0); SETS]; GROUP];
        // One call per power of y: only with its number of sums known is a row unrolled.
        macro_rules! rows {
            ($($j:literal)*) => { $(
                if $j < POWERS {
                    sums.add_row::<DEGREE, POWERS, $j>(simd, &x_powers, &y_power);
                    y_power = multiply(simd, &y_power, &y);
                }
            )* };
        }
        rows!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
    }
    let reduce = |from: &[S::f64s], to: &mut [f64]| {
        to.iter_mut().zip(from).for_each(|(sum, lanes)| *sum = simd.reduce_sum_f64s(*lanes));
    };
    reduce(&sums.gram, &mut out.gram);
    reduce(&sums.projection[..coefficient_count(DEGREE)], &mut out.projection);
    reduce(&sums.radial[..=DEGREE], &mut out.radial);
}

/// Vectors of one group of points on each of the level sets, from the inner to the outer one.
type Group<S> = [[<S as Simd>::f64s; SETS]; GROUP];

/// The sums, lane by lane.
struct Sums<S: Simd, const MOMENTS: usize> {
    gram: [S::f64s; MOMENTS],
    projection: [S::f64s; MAX_COEFFICIENTS],
    radial: [S::f64s; MAX_RADIAL],
}

impl<S: Simd, const MOMENTS: usize> Sums<S, MOMENTS> {
    /// Adds the monomials with `y^J`.
    #[inline(always)]
    fn add_row<const DEGREE: usize, const POWERS: usize, const J: usize>(
        &mut self,
        simd: S,
        x_powers: &[Group<S>; POWERS],
        y_power: &Group<S>,
    ) {
        for (i, x_power) in x_powers.iter().enumerate().take(POWERS - J) {
            let sum = &mut self.gram[monomial_index(i, J)];
            for g in 0..GROUP {
                for l in 0..SETS {
                    *sum = simd.mul_add_e_f64s(x_power[g][l], y_power[g][l], *sum);
                }
            }
            if i + J <= DEGREE {
                let difference = &mut self.projection[monomial_index(i, J)];
                for g in 0..GROUP {
                    let inner = simd.mul_f64s(x_power[g][0], y_power[g][0]);
                    *difference = simd.mul_add_e_f64s(x_power[g][2], y_power[g][2], *difference);
                    *difference = simd.sub_f64s(*difference, inner);
                }
            }
        }
    }
}

#[inline(always)]
fn multiply<S: Simd>(simd: S, a: &Group<S>, b: &Group<S>) -> Group<S> {
    std::array::from_fn(|g| std::array::from_fn(|l| simd.mul_f64s(a[g][l], b[g][l])))
}

#[inline(always)]
fn load_group<S: Simd>(simd: S, chunk: &[f64]) -> [S::f64s; GROUP] {
    let mut group = [simd.splat_f64s(0.0); GROUP];
    let (full, rest) = S::as_simd_f64s(chunk);
    for (slot, value) in group.iter_mut().zip(full) {
        *slot = *value;
    }
    if !rest.is_empty() {
        group[full.len()] = simd.partial_load_f64s(rest);
    }
    group
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
