//! Whether the outlines move in ways that the family of motions does not have, and how much of them may be in the estimates.
use std::sync::OnceLock;

use freeform_riccati::MotionModel;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::{
    innovations::InnovationSeries,
    wrong_family::{OF_LENS, WrongFamily, left_out_by, name_of, off_a_lens},
};
use crate::{
    tuning::family as tuning,
    update::{EDGES, LENS, PERSPECTIVE, READ_OUT, UNMODELLED, UnmodelledMatrix, UnmodelledScore, UnmodelledVector},
};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// Tests of what a family of motions leaves out, over frames: generalised likelihood ratios.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FamilyTests {
    /// Of what every frame says, in its deviations.
    series: InnovationSeries<UNMODELLED>,
    /// Over variances of the noise.
    information: UnmodelledMatrix,
    score: UnmodelledVector,
    /// Sum of weights of the points over variances of the noise.
    weight: f64,
    /// Of what one frame says, squared displacements.
    squares: UnmodelledVector,
    /// Deviation of the noise of a point.
    sigma: f64,
    /// Farthest that the object has been from where it was first, its own radius included, normalised.
    reach: f64,
    /// Time from frame to frame.
    step: f64,
    /// What is told, once it has been asked for.
    #[cfg_attr(feature = "serde", serde(skip))]
    told: OnceLock<UnmodelledEstimate>,
}

/// What the outlines do beside their motion, as far as it is told.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnmodelledEstimate {
    /// What is beyond doubt.
    pub(crate) family: Option<WrongFamily>,
    /// Displacement of the outlines that is seen of that, root mean square, normalised.
    pub(crate) displacement: f64,
    /// Second moments of the sizes of the motions that may be there.
    pub(crate) moments: UnmodelledMatrix,
}

/// Some of the motions, estimated together.
struct Fit {
    numbers: Vec<usize>,
    /// Squared distance from none, in deviations.
    squared: f64,
    sizes: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Whether the outline tells all of their combinations. Sizes and covariance know nothing of the others, and say that they are none.
    all_told: bool,
}

impl Fit {
    /// Where a motion is among those that are estimated.
    fn place_of(&self, number: usize) -> Option<usize> {
        self.numbers.iter().position(|n| *n == number)
    }

    /// How far what is found of a lens is from one, by [`off_a_lens`]; `None` where not all of it is told.
    fn off_a_lens(&self) -> Option<f64> {
        let places = OF_LENS.map(|number| self.place_of(number));
        let sizes = SVector::from_fn(|i, _| places[i].map_or(0.0, |at| self.sizes[at]));
        let covariance =
            SMatrix::from_fn(|i, j| places[i].zip(places[j]).map_or(0.0, |(a, b)| self.covariance[(a, b)]));
        let is_told = self.all_told && places.iter().all(Option::is_some);
        is_told.then(|| off_a_lens(&sizes, &covariance)).flatten()
    }
}

impl FamilyTests {
    /// Adds what a frame says of an object whose centroid is at a distance from where it was first, with the time from frame to frame; `sigma` is the
    /// deviation of the noise of a point, and `variance` that which dependence along the contour makes of it.
    pub(crate) fn add(&mut self, frame: &UnmodelledScore, (distance, step): (f64, f64), (sigma, variance): (f64, f64)) {
        self.told.take();
        self.sigma = sigma;
        self.reach = self.reach.max(1.0 + distance);
        self.step = step;
        self.information += frame.information / variance;
        self.score += frame.score / variance;
        self.weight += frame.weight / variance;
        let own = frame.information.diagonal();
        let told = |i: usize| own[i] > 0.0;
        let standardised =
            UnmodelledVector::from_fn(|i, _| if told(i) { frame.score[i] / (own[i] * variance).sqrt() } else { 0.0 });
        let square = |i: usize| if told(i) { frame.score[i].powi(2) / (own[i] * frame.weight) } else { 0.0 };
        self.series.add(&standardised, UNMODELLED);
        self.squares += UnmodelledVector::from_fn(|i, _| square(i));
    }

    /// What is told of them beside a model.
    pub(crate) fn estimate(&self, model: MotionModel) -> &UnmodelledEstimate {
        self.told.get_or_init(|| self.estimated(model))
    }

    fn estimated(&self, model: MotionModel) -> UnmodelledEstimate {
        let mut estimate = UnmodelledEstimate { family: None, displacement: 0.0, moments: UnmodelledMatrix::zeros() };
        if self.series.frames() < tuning::FEWEST_FRAMES || self.weight <= 0.0 {
            return estimate;
        }
        let (groups, of_camera) = left_out_by(model);
        let least = tuning::MATTERS * self.sigma + tuning::OF_NOISE * self.sigma * self.sigma;
        let dependence = self.series.dependence();
        let mut known = self.fit(&[]);
        let mut found = Vec::new();
        loop {
            let mut clearest: Option<(WrongFamily, Fit, f64, f64)> = None;
            for (family, members) in groups.iter().copied() {
                let Some((fit, squared, count)) = self.with(&known, members, &dependence) else { continue };
                let gained = squared - tuning::PER_MOTION * count;
                if clearest.as_ref().is_none_or(|(.., most)| gained > *most) {
                    clearest = Some((family, fit, deviations(squared, count), gained));
                }
            }
            let Some((family, fit, evidence, _)) = clearest.filter(|(_, _, evidence, _)| *evidence > tuning::DOUBTFUL)
            else {
                break;
            };
            let displacement = (fit.squared / self.weight).sqrt();
            let is_found = evidence > tuning::SIGNIFICANT && displacement > least;
            let beside = ((fit.squared - known.squared).max(0.0) / self.weight).sqrt();
            known = fit;
            if !is_found {
                break;
            }
            found.push((family, beside));
            estimate.displacement = displacement;
        }
        let read_out = known.place_of(READ_OUT).map_or(0.0, |at| known.sizes[at].abs());
        let off = known.off_a_lens().map_or(0.0, |squared| deviations(squared, 2.0));
        estimate.family = name_of(&found, read_out / self.step, off);
        for (a, i) in known.numbers.iter().enumerate() {
            for (b, j) in known.numbers.iter().enumerate() {
                estimate.moments[(*i, *j)] = known.sizes[a] * known.sizes[b] + known.covariance[(a, b)];
            }
        }
        for members in of_camera {
            if members.iter().all(|i| !known.numbers.contains(i)) {
                self.add_possible(&mut estimate.moments, &known, (members, model), &dependence);
            }
        }
        if estimate.family.is_none()
            && let Some(displacement) = self.change_of_shape(least, &dependence)
        {
            (estimate.family, estimate.displacement) = (Some(WrongFamily::Shape), displacement);
        }
        estimate
    }

    /// Usual size of a motion that a camera brings in, where it does. The object is within the picture, which is no smaller than where it has been.
    fn usual_size(&self, number: usize, model: MotionModel) -> f64 {
        match number {
            _ if model == MotionModel::Affine && EDGES.contains(&number) => tuning::USUAL_ERROR,
            _ if PERSPECTIVE.contains(&number) => tuning::USUAL_ERROR / self.reach,
            READ_OUT => tuning::USUAL_READ_OUT * self.step / self.reach,
            _ if LENS.contains(&number) => tuning::USUAL_ERROR / self.reach.powi(2),
            _ => tuning::USUAL_ERROR,
        }
    }

    /// Adds what motions may be that are neither found nor ruled out: the frames say how probable they are and how large (R. E. Kass and A. E.
    /// Raftery, Bayes factors, 1995).
    fn add_possible(
        &self,
        moments: &mut UnmodelledMatrix,
        known: &Fit,
        (members, model): (&[usize], MotionModel),
        dependence: &UnmodelledVector,
    ) {
        let usual = self.usual_size(members[0], model);
        let members: Vec<usize> = members.iter().copied().filter(|i| self.information[(*i, *i)] > 0.0).collect();
        let ratio = largest_of(dependence, &members);
        let n = known.numbers.len();
        let numbers: Vec<usize> = known.numbers.iter().chain(&members).copied().collect();
        // In units of what is usual, in which the prior has a variance of 1.
        let scale = usual * usual / ratio;
        let precision = DMatrix::from_fn(numbers.len(), numbers.len(), |a, b| {
            let prior = if a == b && a >= n { 1.0 } else { 0.0 };
            self.information[(numbers[a], numbers[b])] * scale + prior
        });
        let score = DVector::from_fn(numbers.len(), |a, _| self.score[numbers[a]] * usual / ratio);
        let Some(covariance) = precision.cholesky().map(|factor| factor.inverse()) else { return };
        let sizes = &covariance * &score;
        let covariance = covariance.view((n, n), (members.len(), members.len()));
        let for_them = covariance.determinant().ln() + score.dot(&sizes) - known.squared / ratio;
        let probability = 1.0 / (1.0 + tuning::ODDS_AGAINST * (-0.5 * for_them).exp());
        for (a, i) in members.iter().enumerate() {
            for (b, j) in members.iter().enumerate() {
                let moment = covariance[(a, b)] + sizes[n + a] * sizes[n + b];
                moments[(*i, *j)] += probability * usual * usual * moment;
            }
        }
    }

    /// Whether the shape changes to and fro, and by what displacement: all motions that are left out together are more than none, or one of them has a
    /// larger mean square than noise, or varies slowly.
    fn change_of_shape(&self, least: f64, dependence: &UnmodelledVector) -> Option<f64> {
        let n = self.series.frames() as f64;
        let all: Vec<usize> = (0..UNMODELLED).collect();
        if let Some((fit, squared, count)) = self.with(&self.fit(&[]), &all, dependence) {
            let displacement = (fit.squared / self.weight).sqrt();
            if deviations(squared, count) > tuning::SIGNIFICANT && displacement > least {
                return Some(displacement);
            }
        }
        let most = (1.0 + tuning::SIGNIFICANT * (2.0 / n).sqrt()).max(tuning::SHAPE_CHANGES);
        let slow = self.series.slow_part();
        let changes = (0..UNMODELLED).filter(|i| self.series.mean_square(*i) > most || slow[*i] > tuning::SIGNIFICANT);
        changes.map(|i| (self.squares[i] / n).sqrt()).max_by(f64::total_cmp).filter(|size| *size > least)
    }

    /// The motions known with others, what these add to the squared distance from none, dependence from frame to frame allowed for, and how many.
    fn with(&self, known: &Fit, others: &[usize], dependence: &UnmodelledVector) -> Option<(Fit, f64, f64)> {
        let new: Vec<usize> = others.iter().copied().filter(|i| !known.numbers.contains(i)).collect();
        let numbers: Vec<usize> = known.numbers.iter().copied().chain(new.iter().copied()).collect();
        let dependence = largest_of(dependence, &new);
        let mut fit = self.fit(&numbers);
        fit.covariance *= dependence;
        let count = fit.numbers.len().saturating_sub(known.numbers.len());
        let squared = (fit.squared - known.squared).max(0.0) / dependence;
        (count > 0).then_some((fit, squared, count as f64))
    }

    /// Some of the motions estimated together; combinations that the outline hardly tells apart are left out.
    fn fit(&self, numbers: &[usize]) -> Fit {
        let own = |i: usize| self.information[(i, i)];
        let numbers: Vec<usize> = numbers.iter().copied().filter(|i| own(*i) > 0.0).collect();
        let count = numbers.len();
        let roots = DVector::from_fn(count, |a, _| own(numbers[a]).sqrt());
        let scaled =
            DMatrix::from_fn(count, count, |a, b| self.information[(numbers[a], numbers[b])] / (roots[a] * roots[b]));
        let score = DVector::from_fn(count, |a, _| self.score[numbers[a]] / roots[a]);
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
        Fit { numbers, squared, sizes: sizes.component_div(&roots), covariance: unscaled, all_told }
    }
}

/// Largest dependence of some of the motions, at least 1.
fn largest_of(dependence: &UnmodelledVector, numbers: &[usize]) -> f64 {
    numbers.iter().map(|i| dependence[*i]).fold(1.0, f64::max)
}

/// Deviations of a normal distribution that are as improbable as so large a chi-square of so many degrees of freedom (E. B. Wilson and M. M.
/// Hilferty, The distribution of chi-square, 1931).
fn deviations(squared: f64, count: f64) -> f64 {
    let share = 2.0 / (9.0 * count);
    ((squared / count).cbrt() - 1.0 + share) / share.sqrt()
}

#[cfg(feature = "serde")]
impl FamilyTests {
    /// Whether more can be taken, and all numbers can be worked with.
    pub(crate) fn is_valid(&self) -> bool {
        let numbers = [&self.weight, &self.sigma, &self.reach, &self.step];
        let vectors = self.information.iter().chain(&self.score).chain(&self.squares).chain(numbers);
        self.series.is_valid()
            && vectors.into_iter().all(|number| number.abs() < StateFormat::LARGEST_NUMBER)
            && self.sigma >= 0.0
            && self.reach >= 0.0
            && self.step >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;
    use crate::dynamics::wrong_family::GROUPS;

    const SIGMA: f64 = 0.01;
    const RIGID: MotionModel = MotionModel::Rigid;

    /// Tests after so many frames that show motions of these sizes, noise included.
    fn after(frames: usize, sizes: &UnmodelledVector, seed: u64) -> FamilyTests {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut tests = FamilyTests::default();
        for _ in 0..frames {
            let factor = UnmodelledMatrix::from_fn(|_, _| normal());
            let information = factor * factor.transpose();
            let noise = factor * UnmodelledVector::from_fn(|_, _| SIGMA * normal());
            let score = UnmodelledScore { information, score: information * sizes + noise, weight: 50.0 };
            tests.add(&score, (0.0, 1.0), (SIGMA, SIGMA * SIGMA));
        }
        tests
    }

    #[test]
    fn noise_alone_is_no_wrong_family() {
        let found = (0..200)
            .filter(|seed| after(40, &UnmodelledVector::zeros(), *seed).estimate(RIGID).family.is_some())
            .count();
        assert_eq!(found, 0);
    }

    #[test]
    fn each_motion_that_is_left_out_is_told_by_its_name_and_size() {
        for (family, members) in GROUPS {
            // Of a lens, whose middle is where the object is first, the part that is its own.
            let member = if family == WrongFamily::Lens { LENS[0] } else { members[members.len() - 1] };
            let mut sizes = UnmodelledVector::zeros();
            sizes[member] = 0.02;
            let tests = after(40, &sizes, 7);
            let UnmodelledEstimate { family: found, displacement, moments } = tests.estimate(RIGID);
            assert_eq!(*found, Some(family));
            let size = moments[(member, member)].sqrt();
            assert!((size / 0.02 - 1.0).abs() < 0.1, "{family:?}: {size}");
            // A square of 0.02 times an information of about 9 over a weight of 50.
            assert!((0.006..0.012).contains(displacement), "{family:?}: {displacement}");
        }
    }

    #[test]
    fn what_may_be_there_is_reckoned_with_before_it_is_beyond_doubt() {
        let mut sizes = UnmodelledVector::zeros();
        // Information of about 9 in each of 40 frames: 3.5 deviations.
        sizes[0] = 3.5 * SIGMA / 360.0_f64.sqrt();
        let doubts = (0..40).map(|seed| after(40, &sizes, seed)).filter(|tests| {
            let estimate = tests.estimate(RIGID);
            estimate.family.is_none() && estimate.moments[(0, 0)] > 0.0
        });
        assert!(doubts.count() > 20);
    }

    #[test]
    fn faults_that_cameras_have_now_and_then_are_reckoned_with_until_frames_rule_them_out() {
        let second_moment = |frames: usize, noise: f64| {
            let mut tests = FamilyTests::default();
            for seed in 0..frames as u64 {
                let frame = after(1, &UnmodelledVector::zeros(), seed);
                // What frames say of noise alone, by how much of it there is.
                let score = UnmodelledScore {
                    information: frame.information * SIGMA * SIGMA,
                    score: frame.score * SIGMA * noise,
                    weight: 50.0,
                };
                tests.add(&score, (1.0, 0.1), (noise, noise * noise));
            }
            tests.estimate(RIGID).moments[(6, 6)]
        };
        // At a reach of two radii a lens has a quarter of the usual error, one time in ten.
        let beforehand = 0.1 * (tuning::USUAL_ERROR / 4.0).powi(2);
        let unknown = second_moment(10, 10.0);
        assert!((0.9..1.1).contains(&(unknown / beforehand)), "{unknown} {beforehand}");
        let [many, few] = [1000, 10].map(|frames| second_moment(frames, 1e-3));
        assert!(few < 0.5 * beforehand && many < 0.1 * few, "{many} {few} {beforehand}");
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
            let tests = FamilyTests { information, score: information * sizes, ..FamilyTests::default() };
            tests.fit(&OF_LENS).off_a_lens()
        });
        assert!(all.is_some_and(|off| off < 1e-6) && some.is_none(), "{all:?} {some:?}");
    }

    #[test]
    fn deviations_are_those_of_the_tails_of_chi_square() {
        // Quantiles of chi-square beyond which lies what lies beyond three deviations of a normal distribution on one side, 0.00135.
        for (squared, count) in [(10.27, 1.0), (13.22, 2.0), (19.82, 5.0), (26.97, 9.0)] {
            assert!((deviations(squared, count) - 3.0).abs() < 0.06, "{count}: {}", deviations(squared, count));
        }
    }
}
