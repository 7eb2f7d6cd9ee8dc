//! Mean and covariance of a hypothesis corrected by what a frame tells of the pose.
//!
//! With the root L of the information of the frame, `W = L L'`, and the covariance P of the predicted pose, the weight of the innovation is
//! `(W^-1 + P)^-1 = (I + W P)^-1 W = T T'`, where `T = L C^-T` and `C C' = I + L' P L`. That is never singular, also where W is, and has the
//! determinant of `I + W P`. The covariance loses `H H'`, where H are its columns of the pose times T: it stays symmetric bit by bit.
use nalgebra::{Const, DimMin, Matrix2};

use super::{
    centred::{CentredDeviations, CentredMatrix, CentredVector, LARGEST},
    hypothesis::{CentredMeasurement, Hypothesis, Innovation},
};
use crate::{
    tuning::dynamics as tuning,
    vectors::{LANES, vectorised},
};

/// Vectors of a column of the largest state.
const MOST_VECTORS: usize = (3 * LARGEST).div_ceil(LANES);

/// Root L of the information W on a pose of k parameters, `W = L L'`, a lower triangle. What W says next to nothing of has none.
pub(super) fn root_of(information: &CentredMatrix, k: usize) -> CentredMatrix {
    let mut root = CentredMatrix::zeros();
    for j in 0..k {
        let own = information[(j, j)];
        let left = own - (0..j).map(|l| root[(j, l)] * root[(j, l)]).sum::<f64>();
        // Not a number is no information either.
        if left.is_nan() || left <= tuning::ROUNDED * own {
            continue;
        }
        let pivot = left.sqrt();
        root[(j, j)] = pivot;
        for i in j + 1..k {
            let left = information[(i, j)] - (0..j).map(|l| root[(i, l)] * root[(j, l)]).sum::<f64>();
            root[(i, j)] = left / pivot;
        }
    }
    root
}

/// Information on a pose that is off, besides, by these deviations: (W^-1 + C)^-1 = (I + W C)^-1 W.
pub(super) fn less_known(information: CentredMatrix, off: &CentredDeviations) -> Option<CentredMatrix> {
    if off.iter().all(|deviation| *deviation == 0.0) {
        return Some(information);
    }
    let covariance = CentredMatrix::from_diagonal(&CentredVector::from_fn(|i, _| off[i] * off[i]));
    let less = (CentredMatrix::identity() + information * covariance).lu().solve(&information)?;
    Some(0.5 * (less + less.transpose()))
}

/// Information on the rates of a pose of k parameters alone, wherever its centroid is.
pub(super) fn of_rates_alone(information: &CentredMatrix, k: usize) -> CentredMatrix {
    let place = information.fixed_view::<2, 2>(k - 2, k - 2).into_owned();
    let across = information.fixed_view::<LARGEST, 2>(0, k - 2).into_owned();
    // Along what the frame says nothing of, it says nothing of the rates beside either.
    let regular = place + Matrix2::from_diagonal_element(tuning::SINGULAR * place.trace());
    let taken = regular.try_inverse().map(|inverse| across * inverse * across.transpose());
    let taken = taken.filter(|taken| taken.iter().all(|entry| entry.is_finite())).unwrap_or_default();
    CentredMatrix::from_fn(|i, j| if i < k - 2 && j < k - 2 { information[(i, j)] - taken[(i, j)] } else { 0.0 })
}

/// Solution of `W x = b` for a matrix that may be singular: none along what it says nothing of.
pub(super) fn solved(information: &CentredMatrix, b: &CentredVector, k: usize) -> Option<CentredVector> {
    match k {
        3 => solved_sized::<3>(information, b),
        4 => solved_sized::<4>(information, b),
        6 => solved_sized::<6>(information, b),
        _ => solved_sized::<LARGEST>(information, b),
    }
}

fn solved_sized<const K: usize>(information: &CentredMatrix, b: &CentredVector) -> Option<CentredVector>
where
    Const<K>: DimMin<Const<K>, Output = Const<K>>,
{
    let mut regular = information.fixed_view::<K, K>(0, 0).into_owned();
    let largest = (0..K).map(|j| regular[(j, j)]).fold(0.0, f64::max);
    for j in 0..K {
        regular[(j, j)] += tuning::SINGULAR * (regular[(j, j)] + tuning::SINGULAR * largest);
    }
    let solution = regular.lu().solve(&b.fixed_rows::<K>(0))?;
    Some(CentredVector::from_fn(|i, _| if i < K { solution[i] } else { 0.0 }))
}

/// What a correction is made of.
struct Weight<const K: usize, const N: usize> {
    /// T, by columns.
    root: [[f64; K]; K],
    /// H, by columns.
    gain: [[f64; N]; K],
    /// Of `I + W P`.
    determinant: f64,
}

impl<const K: usize, const N: usize> Weight<K, N> {
    /// By the root of the information and the covariance of a hypothesis, both by columns.
    ///
    /// `T C' = L` and `H C' = P L` are solved column by column. The entries of C come with them: to the left of its diagonal it is `L' H`, H in the
    /// rows of the pose.
    #[inline(always)]
    fn of(root: &[[f64; K]; K], covariance: &[[f64; N]; N]) -> Self {
        let (mut roots, mut gain, mut determinant) = (*root, [[0.0; N]; K], 1.0);
        for m in 0..K {
            // None above the diagonal.
            let own = root[m];
            let (mut of_root, mut of_gain) = (own, [0.0; N]);
            for l in m..K {
                for i in 0..N {
                    of_gain[i] += covariance[l][i] * own[l];
                }
            }
            for j in 0..m {
                let before = gain[j];
                let mut factor = 0.0;
                for l in 0..K {
                    factor += own[l] * before[l];
                }
                for i in 0..N {
                    of_gain[i] -= factor * before[i];
                }
                for i in 0..K {
                    of_root[i] -= factor * roots[j][i];
                }
            }
            let mut squared = 1.0;
            for l in 0..K {
                squared += own[l] * of_gain[l];
            }
            determinant *= squared;
            let inverse = 1.0 / squared.sqrt();
            for i in 0..K {
                roots[m][i] = of_root[i] * inverse;
            }
            for i in 0..N {
                gain[m][i] = of_gain[i] * inverse;
            }
        }
        Self { root: roots, gain, determinant }
    }
}

impl<const N: usize> Hypothesis<N> {
    /// As [`update`](Self::update), for K parameters.
    pub(super) fn update_sized<const K: usize>(&mut self, measurement: &CentredMeasurement) -> Option<Innovation> {
        let shaking = self.course.shaking();
        let noise_inflation = if self.course.changes_at_random() { measurement.noise_inflation } else { 1.0 };
        let scale = 1.0 / (shaking * noise_inflation).sqrt();
        let root: [[f64; K]; K] = std::array::from_fn(|j| std::array::from_fn(|i| measurement.root[(i, j)] * scale));
        let off: [f64; K] = std::array::from_fn(|i| measurement.deviation[i] - self.mean[i]);
        let (covariance, mean) = (&mut self.covariance.data.0, &mut self.mean.data.0[0]);
        let (root, determinant, pulled, squared) = vectorised(
            #[inline(always)]
            || {
                let weight = Weight::<K, N>::of(&root, covariance);
                let along: [f64; K] = std::array::from_fn(|l| (0..K).map(|i| weight.root[l][i] * off[i]).sum());
                let squared: f64 = along.iter().map(|along| along * along).sum();
                if weight.determinant > 0.0 && squared.is_finite() {
                    correct(&weight.gain, &along, (mean, covariance));
                }
                let mut pulled = [0.0; K];
                for (column, along) in weight.root.iter().zip(&along) {
                    for (pulled, entry) in pulled.iter_mut().zip(column) {
                        *pulled += entry * along;
                    }
                }
                (weight.root, weight.determinant, pulled, squared)
            },
        );
        if !(determinant > 0.0 && squared.is_finite()) {
            return None;
        }
        // The score, S^-1 off with S the covariance of the innovation, has the covariance S^-1: also where S is not finite.
        let mut standardised = CentredVector::zeros();
        for j in 0..K {
            let own: f64 = root.iter().map(|column| column[j] * column[j]).sum();
            standardised[j] = if own > 0.0 { pulled[j] / own.sqrt() } else { 0.0 };
        }
        // The density of the innovation, without the factor that all hypotheses share.
        let of_shaking = if shaking > 1.0 { K as f64 * shaking.ln() } else { 0.0 };
        // Directions that the frame says nothing of do not count.
        let of_inflation = if noise_inflation > 1.0 { measurement.rank() as f64 * noise_inflation.ln() } else { 0.0 };
        let log_likelihood = -0.5 * (determinant.ln() + of_shaking + of_inflation + squared);
        Some(Innovation { log_likelihood, standardised })
    }
}

/// Corrects mean and covariance, given by its columns: by H, the `gain`, times `along`, T' times the innovation, and by H H'.
#[inline(always)]
fn correct<const K: usize, const N: usize>(
    gain: &[[f64; N]; K],
    along: &[f64; K],
    (mean, covariance): (&mut [f64; N], &mut [[f64; N]; N]),
) {
    let mut moved = *mean;
    for l in 0..K {
        for i in 0..N {
            moved[i] += gain[l][i] * along[l];
        }
    }
    *mean = moved;
    // The columns of what a hypothesis has no entries for are none, and stay so. Only the entries up to the diagonal
    // are worked out, in whole vectors; those below it are taken from them.
    let mut gain_vectors = [[[0.0; LANES]; K]; MOST_VECTORS];
    for l in 0..K {
        let vectors = gain[l].as_chunks::<LANES>().0;
        for c in 0..N / LANES {
            gain_vectors[c][l] = vectors[c];
        }
    }
    for j in 0..N {
        let mut factors = [0.0; K];
        for l in 0..K {
            factors[l] = gain[l][j];
        }
        let vectors = covariance[j].as_chunks_mut::<LANES>().0;
        for c in 0..(j / LANES + 1).min(N / LANES) {
            let mut left = vectors[c];
            for l in 0..K {
                for lane in 0..LANES {
                    left[lane] -= gain_vectors[c][l][lane] * factors[l];
                }
            }
            vectors[c] = left;
        }
        for i in N - N % LANES..=j {
            for l in 0..K {
                covariance[j][i] -= gain[l][i] * factors[l];
            }
        }
    }
    // What is rounded in one half only would grow from frame to frame.
    for j in 1..N {
        let (before, from) = covariance.split_at_mut(j);
        for (column, entry) in before.iter_mut().zip(from[0]) {
            column[j] = entry;
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::course::Course;

    #[test]
    fn the_rates_alone_are_known_as_by_the_inverse_of_what_is_known_of_the_whole_pose() {
        let k = 3;
        let mut information = CentredMatrix::zeros();
        information
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&nalgebra::Matrix3::new(5.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 4.0));
        let whole = information.fixed_view::<3, 3>(0, 0).into_owned().try_inverse().expect("regular");
        let alone = of_rates_alone(&information, k);
        assert!((alone[(0, 0)] * whole[(0, 0)] - 1.0).abs() < 1e-8, "{alone}");
        assert_eq!(alone.sum(), alone[(0, 0)]);
        // Of a strip that shows its turn and the place across alone, and of what shows no place.
        (1..3).for_each(|i| (information[(i, 2)], information[(2, i)]) = (0.0, 0.0));
        (information[(0, 2)], information[(2, 0)]) = (0.0, 0.0);
        assert!((of_rates_alone(&information, k)[(0, 0)] - (5.0 - 1.0 / 3.0)).abs() < 1e-8);
        let turn = CentredMatrix::from_fn(|i, j| if i + j == 0 { 5.0 } else { 0.0 });
        assert_eq!(of_rates_alone(&turn, k), turn);
    }

    /// Largest difference from the plain way, in units of what is there: `(I + W P)^-1 W` by elimination, for information of a rank on a pose of K
    /// parameters.
    fn difference<const K: usize, const N: usize>(numbers: &[f64], rank: usize, course: Course) -> f64 {
        let number = |i: usize| (7.0 * numbers[i % numbers.len()] + i as f64).sin();
        let factor = SMatrix::<f64, K, K>::from_fn(|i, j| if j < rank { 3.0 * number(i + K * j) } else { 0.0 });
        let information = factor * factor.transpose();
        let whole = CentredMatrix::from_fn(|i, j| if i < K && j < K { information[(i, j)] } else { 0.0 });
        let spread = SMatrix::<f64, N, N>::from_fn(|i, j| number(100 + i + N * j));
        let (mean, covariance) = (SVector::<f64, N>::from_fn(|i, _| number(1000 + i)), spread * spread.transpose());
        let deviation = CentredVector::from_fn(|i, _| number(2000 + i));
        let mut corrected = Hypothesis::<N> { course, mean, covariance };
        let measurement = CentredMeasurement { root: root_of(&whole, K), deviation, noise_inflation: 1.0 };
        let found = corrected.update_sized::<K>(&measurement).expect("a correction");

        let information = information / course.shaking();
        let predicted = covariance.fixed_view::<K, K>(0, 0).into_owned();
        let off = deviation.fixed_rows::<K>(0) - mean.fixed_rows::<K>(0);
        let both = SMatrix::<f64, K, K>::identity() + information * predicted;
        let inverse = nalgebra::DMatrix::from_fn(K, K, |i, j| both[(i, j)]).try_inverse().expect("not singular");
        let weight = SMatrix::<f64, K, K>::from_fn(|i, j| inverse[(i, j)]) * information;
        let columns = covariance.fixed_view::<N, K>(0, 0).into_owned();
        let expected_mean = mean + columns * weight * off;
        let expected = covariance - columns * weight * columns.transpose();
        let determinant = nalgebra::DMatrix::from_fn(K, K, |i, j| both[(i, j)]).determinant();
        let squared = (off.transpose() * weight * off).x;
        let log_likelihood = -0.5 * (determinant.ln() + K as f64 * course.shaking().ln() + squared);
        let pulled = weight * off;
        let standardised = (0..K).map(|j| {
            let expected = if rank > 0 { pulled[j] / weight[(j, j)].sqrt() } else { 0.0 };
            (found.standardised[j] - expected).abs()
        });
        assert_eq!(corrected.covariance, corrected.covariance.transpose());
        let of_covariance = (corrected.covariance - expected).amax() / covariance.amax();
        let of_mean = (corrected.mean - expected_mean).amax() / (mean.amax() + covariance.amax().sqrt());
        let of_likelihood = (found.log_likelihood - log_likelihood).abs() / (1.0 + log_likelihood.abs());
        standardised.fold(of_covariance.max(of_mean).max(of_likelihood), f64::max)
    }

    #[test]
    fn an_error_besides_takes_information_away_also_where_there_is_none() {
        let mut information = CentredMatrix::zeros();
        (information[(0, 0)], information[(1, 1)], information[(0, 1)], information[(1, 0)]) = (4.0, 9.0, 1.0, 1.0);
        assert_eq!(less_known(information, &CentredDeviations::zeros()), Some(information));
        let less = less_known(information, &CentredDeviations::from_element(0.5)).expect("a solution");
        let known = |m: &CentredMatrix| m.fixed_view::<2, 2>(0, 0).try_inverse().expect("two parameters are known");
        let added = known(&less) - known(&information);
        assert!((added - nalgebra::Matrix2::identity() * 0.25).amax() < 1e-12, "{added}");
        assert_eq!(less.view((2, 2), (LARGEST - 2, LARGEST - 2)).amax(), 0.0);
    }

    #[test]
    fn what_a_frame_tells_of_the_pose_counts_for_less_where_the_motion_changes_at_random() {
        const INFLATION: f64 = 4.0;
        let (prior, deviation) = (9.0, CentredVector::from_fn(|i, _| if i == 0 { 2.0 } else { 0.0 }));
        // Nothing is told of the third number.
        let information = CentredMatrix::from_fn(|i, j| if i == j && i < 2 { 1.0 } else { 0.0 });
        let measurement = CentredMeasurement { root: root_of(&information, 3), deviation, noise_inflation: INFLATION };
        let changing = Course::Accelerating { level: 1.0, rates: true };
        for (course, noise) in [(changing, INFLATION), (Course::ConstantGenerator, 1.0)] {
            let covariance = SMatrix::<f64, 9, 9>::identity() * prior;
            let mut hypothesis = Hypothesis::<9> { course, mean: SVector::zeros(), covariance };
            let found = hypothesis.update_sized::<3>(&measurement).expect("a correction");
            let left = noise * prior / (noise + prior);
            assert!((hypothesis.covariance[(0, 0)] - left).abs() < 1e-12, "{course:?}");
            assert_eq!(hypothesis.covariance[(2, 2)], prior);
            // The density of both innovations, but for what all hypotheses share.
            let density = -(noise + prior).ln() - 0.5 * deviation[0] * deviation[0] / (noise + prior);
            assert!((found.log_likelihood - density).abs() < 1e-12, "{course:?}: {}", found.log_likelihood);
        }
    }

    proptest! {
        #[test]
        fn hypotheses_are_corrected_by_roots_as_by_elimination_also_where_the_information_is_singular(
            numbers in prop::collection::vec(-1.0_f64..1.0, 40), rank in 0_usize..=6, shaken in any::<bool>(),
        ) {
            let course = if shaken { Course::Shaken { deviations: 3.0 } } else { Course::Accelerating { level: 0.1, rates: true } };
            let rigid = difference::<3, 9>(&numbers, rank.min(3), course);
            let affine = difference::<6, 18>(&numbers, rank, course);
            prop_assert!(rigid.max(affine) < 1e-7, "{rank}: {rigid} {affine}");
        }
    }
}
