//! Some of the motions that a family leaves out, estimated together, and how far frames scatter about what they agree on.
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::wrong_family::{OF_LENS, off_a_lens};
use crate::{
    tuning::family as tuning,
    update::{UNMODELLED, UnmodelledMatrix, UnmodelledScore, UnmodelledVector},
};

/// Some of the motions, estimated together.
pub(super) struct Fit {
    pub(super) numbers: Vec<usize>,
    /// Squared distance from none, in deviations.
    pub(super) squared: f64,
    pub(super) sizes: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// Whether the outline tells all of their combinations. Sizes and covariance know nothing of the others, and say that they are none.
    all_told: bool,
}

impl Fit {
    /// By information and score; combinations that the outline hardly tells apart are left out.
    pub(super) fn of((information, score): (&UnmodelledMatrix, &UnmodelledVector), numbers: &[usize]) -> Self {
        let own = |i: usize| information[(i, i)];
        let numbers: Vec<usize> = numbers.iter().copied().filter(|i| own(*i) > 0.0).collect();
        let count = numbers.len();
        let roots = DVector::from_fn(count, |a, _| own(numbers[a]).sqrt());
        let scaled =
            DMatrix::from_fn(count, count, |a, b| information[(numbers[a], numbers[b])] / (roots[a] * roots[b]));
        let score = DVector::from_fn(count, |a, _| score[numbers[a]] / roots[a]);
        let (mut covariance, mut all_told) = (DMatrix::zeros(count, count), true);
        if count > 0 {
            let eigen = scaled.symmetric_eigen();
            for (value, v) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
                if *value > tuning::TOLD_APART {
                    covariance += v * v.transpose() / *value;
                } else {
                    all_told = false;
                }
            }
        }
        let sizes = &covariance * &score;
        let squared = score.dot(&sizes);
        let unscaled = DMatrix::from_fn(count, count, |a, b| covariance[(a, b)] / (roots[a] * roots[b]));
        Self { numbers, squared, sizes: sizes.component_div(&roots), covariance: unscaled, all_told }
    }

    /// Where a motion is among those that are estimated.
    pub(super) fn place_of(&self, number: usize) -> Option<usize> {
        self.numbers.iter().position(|n| *n == number)
    }

    /// Information and score of some motions beside these, which are eliminated: estimated along. `None` where numbers do not allow it.
    pub(super) fn beside(
        &self,
        (information, score): (&UnmodelledMatrix, &UnmodelledVector),
        members: &[usize],
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let of = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |a, b| information[(rows[a], columns[b])])
        };
        let of_score = |rows: &[usize]| DVector::from_fn(rows.len(), |a, _| score[rows[a]]);
        let (own, across) = (of(members, members), of(&self.numbers, members));
        if self.numbers.is_empty() {
            return Some((own, of_score(members)));
        }
        let explained = of(&self.numbers, &self.numbers).cholesky()?.solve(&across);
        let score = of_score(members) - explained.transpose() * of_score(&self.numbers);
        Some((own - across.transpose() * explained, score))
    }

    /// How far what is found of a lens is from one, by [`off_a_lens`]; `None` where not all of it is told.
    pub(super) fn off_a_lens(&self) -> Option<f64> {
        let places = OF_LENS.map(|number| self.place_of(number));
        let sizes = SVector::from_fn(|i, _| places[i].map_or(0.0, |at| self.sizes[at]));
        let covariance =
            SMatrix::from_fn(|i, j| places[i].zip(places[j]).map_or(0.0, |(a, b)| self.covariance[(a, b)]));
        let is_told = self.all_told && places.iter().all(Option::is_some);
        is_told.then(|| off_a_lens(&sizes, &covariance)).flatten()
    }
}

/// A fit of some motions more.
pub(super) struct Addition {
    pub(super) fit: Fit,
    /// What they add to the squared distance from none, dependence from frame to frame allowed for.
    pub(super) squared: f64,
    /// How many they are.
    pub(super) count: f64,
    /// What dependence has been allowed for, at least 1.
    pub(super) dependence: f64,
}

impl Addition {
    /// How much clearer they are than chance explains so many motions.
    pub(super) fn gained(&self) -> f64 {
        self.squared - tuning::PER_MOTION * self.count
    }

    /// How far they are from none, in deviations.
    pub(super) fn evidence(&self) -> f64 {
        deviations(self.squared, self.count)
    }

    /// The same by what frames scatter, where that is more than their noise and its dependence.
    pub(super) fn evidence_beside(&self, scatter: f64) -> f64 {
        deviations(self.squared * self.dependence / self.dependence.max(scatter), self.count)
    }
}

/// How far frames scatter about what they agree on. By the noise of the points alone the mean square is 1. Where a pose is not what it is taken to
/// be, a map was learnt in such poses, or all points of a side are rounded together, it is more, and what frames agree on is known less well.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct FrameScatter {
    /// Sum of the squared distances of what single frames ask for from none, in deviations.
    squared: f64,
    /// Numbers that they are told by.
    count: f64,
}

impl FrameScatter {
    /// Adds what a frame asks for, in units of a variance of the noise.
    pub(super) fn add(&mut self, frame: &UnmodelledScore, variance: f64) {
        let own = frame.information.diagonal();
        let roots = own.map(|own| if own > 0.0 { own.sqrt() } else { 1.0 });
        // Combinations that the frame hardly tells count for little.
        let scaled = UnmodelledMatrix::from_fn(|a, b| {
            let correlation = frame.information[(a, b)] / (roots[a] * roots[b]);
            let alone = if own[a] > 0.0 { tuning::HARDLY_TOLD } else { 1.0 };
            if a == b { correlation + alone } else { correlation }
        });
        let Some(inverse) = scaled.cholesky().map(|factor| factor.inverse()) else { return };
        let score = frame.score.component_div(&roots);
        self.squared += score.dot(&(inverse * score)) / variance;
        // The expectation of that by noise: the trace of the correlations times that inverse.
        let told = (0..UNMODELLED).filter(|a| own[*a] > 0.0);
        self.count += told.map(|a| 1.0 - tuning::HARDLY_TOLD * inverse[(a, a)]).sum::<f64>();
    }

    /// Mean square, in deviations, at least 1, about what frames agree on: sizes of so many motions, so far from none.
    pub(super) fn about(&self, common: &Fit) -> f64 {
        let left = (self.squared - common.squared).max(0.0);
        let count = (self.count - common.numbers.len() as f64).max(0.0);
        ((left + tuning::PRIOR_SCATTER) / (count + tuning::PRIOR_SCATTER)).max(1.0)
    }

    #[cfg(feature = "serde")]
    pub(super) fn numbers(&self) -> [&f64; 2] {
        [&self.squared, &self.count]
    }
}

/// Deviations of a normal distribution that are as improbable as so large a chi-square of so many degrees of freedom (E. B. Wilson and M. M.
/// Hilferty, The distribution of chi-square, 1931).
pub(super) fn deviations(squared: f64, count: f64) -> f64 {
    let share = 2.0 / (9.0 * count);
    ((squared / count).cbrt() - 1.0 + share) / share.sqrt()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    #[test]
    fn deviations_are_those_of_the_tails_of_chi_square() {
        // Quantiles of chi-square beyond which lies what lies beyond three deviations of a normal distribution on one side, 0.00135.
        for (squared, count) in [(10.27, 1.0), (13.22, 2.0), (19.82, 5.0), (26.97, 9.0)] {
            assert!((deviations(squared, count) - 3.0).abs() < 0.06, "{count}: {}", deviations(squared, count));
        }
    }

    #[test]
    fn frames_scatter_about_what_they_agree_on_by_their_noise_over_what_it_is_taken_to_be() {
        for (noise, is_known) in [(1.0, true), (3.0, true), (3.0, false)] {
            let mut rng = ChaCha8Rng::seed_from_u64(11);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let (mut scatter, mut information, mut score) =
                (FrameScatter::default(), UnmodelledMatrix::zeros(), UnmodelledVector::zeros());
            let sizes = UnmodelledVector::from_fn(|i, _| 0.1 * i as f64);
            for _ in 0..200 {
                let mut factor = UnmodelledMatrix::from_fn(|_, _| normal());
                if !is_known {
                    // Frames that tell nothing of some of them.
                    factor.rows_mut(5, 4).fill(0.0);
                }
                let own = factor * factor.transpose();
                let asked = own * sizes + factor * UnmodelledVector::from_fn(|_, _| noise * normal());
                scatter.add(&UnmodelledScore { information: own, score: asked, weight: 1.0 }, 1.0);
                information += own;
                score += asked;
            }
            let common = Fit::of((&information, &score), &(0..UNMODELLED).collect::<Vec<_>>());
            let found = scatter.about(&common) / (noise * noise);
            assert!((0.85..1.1).contains(&found), "{noise} {is_known}: {found}");
        }
    }

    #[test]
    fn nothing_is_said_of_a_lens_of_which_outlines_do_not_tell_all() {
        // A lens of strength 0.02 with its middle at (0.5, -0.3), of which a stretch and the derivative by x may be taken for each other.
        let mut sizes = UnmodelledVector::zeros();
        for (number, size) in OF_LENS.into_iter().zip([0.0032, -0.006, 0.02, -0.01, 0.006]) {
            sizes[number] = size;
        }
        let [all, some] = [0.0, 1.0].map(|alike| {
            let mut information = UnmodelledMatrix::identity() * 1e6;
            information[(OF_LENS[0], OF_LENS[3])] = alike * 1e6;
            information[(OF_LENS[3], OF_LENS[0])] = alike * 1e6;
            Fit::of((&information, &(information * sizes)), &OF_LENS).off_a_lens()
        });
        assert!(all.is_some_and(|off| off < 1e-6) && some.is_none(), "{all:?} {some:?}");
    }

    #[test]
    fn what_is_left_beside_motions_that_are_known_is_what_estimating_all_together_says() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let factor = UnmodelledMatrix::from_fn(|_, _| normal());
        let information = factor * factor.transpose() + UnmodelledMatrix::identity();
        let score = UnmodelledVector::from_fn(|_, _| normal());
        let of = |numbers: &[usize]| Fit::of((&information, &score), numbers);
        for known in [vec![], vec![2, 5, 7]] {
            let members = [0, 9];
            let (left, right) = of(&known).beside((&information, &score), &members).expect("numbers");
            let covariance = left.try_inverse().expect("regular");
            let all = of(&[known.as_slice(), &members].concat());
            let from = known.len();
            assert!((&covariance - all.covariance.view((from, from), (2, 2))).amax() < 1e-12);
            assert!((covariance * right - all.sizes.rows(from, 2)).amax() < 1e-12);
        }
    }
}
