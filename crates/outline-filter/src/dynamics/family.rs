//! Whether the outlines move in ways that the family of motions does not have, and how much of them may be in the estimates.
use std::sync::OnceLock;

use freeform_riccati::MotionModel;

use super::{
    family_fit::{Addition, Fit, FrameScatter, deviations},
    innovations::InnovationSeries,
    possible_faults::moments_of_fault,
    to_and_fro::{ChangeOfShape, ToAndFro},
    unmodelled_estimate::UnmodelledEstimate,
    wrong_family::{Found, WrongFamily, left_out_by, name_of},
};
use crate::{
    tuning::family as tuning,
    update::{EDGES, LENS, PERSPECTIVE, READ_OUT, UNMODELLED, UnmodelledMatrix, UnmodelledScore, UnmodelledVector},
};
#[cfg(feature = "serde")]
use freeform_estimate::StateFormat;

/// Numbers of all motions.
const ALL: [usize; UNMODELLED] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10];

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
    scatter: FrameScatter,
    /// Frames that tell each of them.
    told_by: UnmodelledVector,
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
        self.scatter.add(frame, variance);
        let told = |i: usize| own[i] > 0.0;
        self.told_by += UnmodelledVector::from_fn(|i, _| f64::from(u8::from(told(i))));
        let standardised =
            UnmodelledVector::from_fn(|i, _| if told(i) { frame.score[i] / (own[i] * variance).sqrt() } else { 0.0 });
        let square = |i: usize| if told(i) { frame.score[i].powi(2) / (own[i] * frame.weight) } else { 0.0 };
        self.series.add(&standardised, UNMODELLED);
        self.squares += UnmodelledVector::from_fn(|i, _| square(i));
    }

    /// What is told of them beside a model, of points whose rounding moves sides by a deviation, normalised.
    pub(crate) fn estimate(&self, model: MotionModel, of_side: f64) -> &UnmodelledEstimate {
        self.told.get_or_init(|| self.estimated(model, of_side))
    }

    fn estimated(&self, model: MotionModel, of_side: f64) -> UnmodelledEstimate {
        let mut estimate = UnmodelledEstimate::default();
        if self.weight <= 0.0 {
            return estimate;
        }
        let (groups, of_pictures) = left_out_by(model);
        let dependence = self.series.dependence();
        if self.series.frames() < tuning::FEWEST_FRAMES {
            // Too few to find anything; what cameras have now and then is reckoned with as far as they do not rule it out.
            let none = self.fit(&[]);
            for members in of_pictures {
                self.add_possible(&mut estimate.moments, &none, members, &dependence);
            }
            return estimate;
        }
        let least = tuning::MATTERS * self.sigma + tuning::OF_NOISE * self.sigma * self.sigma;
        let scatter = self.scatter.about(&self.fit(&ALL));
        let mut known = self.fit(&[]);
        let (mut found, mut beyond_doubt): (Vec<Found>, Vec<Found>) = Default::default();
        loop {
            let mut clearest: Option<(WrongFamily, Addition)> = None;
            for (family, members) in groups.iter().copied() {
                let Some(addition) = self.with(&known, members, &dependence) else { continue };
                if clearest.as_ref().is_none_or(|(_, most)| addition.gained() > most.gained()) {
                    clearest = Some((family, addition));
                }
            }
            let Some((family, addition)) = clearest.filter(|(_, addition)| addition.evidence() > tuning::DOUBTFUL)
            else {
                break;
            };
            let displacement = (addition.fit.squared / self.weight).sqrt();
            let is_found = addition.evidence() > tuning::SIGNIFICANT && displacement > least;
            let is_beyond_doubt = addition.evidence_beside(scatter) > tuning::SIGNIFICANT;
            let beside = ((addition.fit.squared - known.squared).max(0.0) / self.weight).sqrt();
            known = addition.fit;
            if !is_found {
                break;
            }
            found.push((family, beside));
            if is_beyond_doubt {
                beyond_doubt.push((family, beside));
            }
            estimate.displacement = displacement;
        }
        let read_out = known.place_of(READ_OUT).map_or(0.0, |at| known.sizes[at].abs());
        let off = known.off_a_lens().map_or(0.0, |squared| deviations(squared, 2.0));
        let named = if beyond_doubt.is_empty() { &found } else { &beyond_doubt };
        estimate.family = name_of(named, read_out / self.step, off);
        // Points that are rounded together change the shape.
        let may_be_rounding = estimate.family == Some(WrongFamily::Shape) && estimate.displacement <= of_side;
        estimate.is_beyond_doubt = !beyond_doubt.is_empty() && !may_be_rounding;
        for (a, i) in known.numbers.iter().enumerate() {
            for (b, j) in known.numbers.iter().enumerate() {
                estimate.moments[(*i, *j)] = known.sizes[a] * known.sizes[b] + known.covariance[(a, b)];
            }
        }
        for members in of_pictures {
            if members.iter().all(|i| !known.numbers.contains(i)) {
                self.add_possible(&mut estimate.moments, &known, members, &dependence);
            }
        }
        if !estimate.is_beyond_doubt
            && let Some(change) = self.change_of_shape(scatter, (least, of_side), &dependence)
        {
            estimate.add_change_of_shape(change);
        }
        estimate
    }

    /// Usual size of a motion that pictures have now and then. The object is within the picture, which is no smaller than where it has been.
    fn usual_size(&self, number: usize) -> f64 {
        match number {
            _ if PERSPECTIVE.contains(&number) => tuning::USUAL_ERROR / self.reach,
            READ_OUT => tuning::USUAL_READ_OUT * self.step / self.reach,
            _ if LENS.contains(&number) => tuning::USUAL_ERROR / self.reach.powi(2),
            _ => tuning::USUAL_ERROR,
        }
    }

    /// Adds what motions may be that are neither found nor ruled out.
    fn add_possible(
        &self,
        moments: &mut UnmodelledMatrix,
        known: &Fit,
        members: &[usize],
        dependence: &UnmodelledVector,
    ) {
        let is_told = |i: &usize| self.information[(*i, *i)] > 0.0 || EDGES.contains(i);
        let told: Vec<usize> = members.iter().copied().filter(is_told).collect();
        let ratio = largest_of(dependence, &told);
        let Some((information, score)) = known.beside((&self.information, &self.score), &told) else { return };
        // Rows are read before the next frame.
        let most = if members == [READ_OUT] { 1.0 / tuning::USUAL_READ_OUT } else { f64::INFINITY };
        let sizes = (self.usual_size(members[0]), most);
        let Some(possible) = moments_of_fault(&(information / ratio), &(score / ratio), sizes) else { return };
        for (a, i) in told.iter().enumerate() {
            for (b, j) in told.iter().enumerate() {
                moments[(*i, *j)] += possible[(a, b)];
            }
        }
    }

    /// Whether the shape changes: all motions that are left out together are more than none, or one of them comes and goes. And whether that is
    /// beyond doubt: by what frames scatter, and by more than the rounding of a side.
    fn change_of_shape(
        &self,
        scatter: f64,
        (least, of_side): (f64, f64),
        dependence: &UnmodelledVector,
    ) -> Option<ChangeOfShape> {
        let together = self.with(&self.fit(&[]), &ALL, dependence).and_then(|all| {
            let displacement = (all.fit.squared / self.weight).sqrt();
            let is_there = all.evidence() > tuning::SIGNIFICANT && displacement > least;
            let is_beyond_doubt = all.evidence_beside(scatter) > tuning::SIGNIFICANT && displacement > of_side;
            is_there.then_some((displacement, is_beyond_doubt))
        });
        if together.is_some_and(|(_, is_beyond_doubt)| is_beyond_doubt) {
            return together;
        }
        let one = ToAndFro { series: &self.series, squares: &self.squares, told_by: &self.told_by };
        let one = one.change_of_shape(scatter, (least, of_side));
        [together, one].into_iter().flatten().reduce(|a, b| (a.0.max(b.0), a.1 || b.1))
    }

    /// The motions known with others; `None` where these are none.
    fn with(&self, known: &Fit, others: &[usize], dependence: &UnmodelledVector) -> Option<Addition> {
        let new: Vec<usize> = others.iter().copied().filter(|i| !known.numbers.contains(i)).collect();
        let numbers: Vec<usize> = known.numbers.iter().copied().chain(new.iter().copied()).collect();
        let dependence = largest_of(dependence, &new);
        let mut fit = self.fit(&numbers);
        fit.covariance *= dependence;
        let count = fit.numbers.len().saturating_sub(known.numbers.len());
        let squared = (fit.squared - known.squared).max(0.0) / dependence;
        (count > 0).then_some(Addition { fit, squared, count: count as f64, dependence })
    }

    fn fit(&self, numbers: &[usize]) -> Fit {
        Fit::of((&self.information, &self.score), numbers)
    }
}

/// Largest dependence of some of the motions, at least 1.
fn largest_of(dependence: &UnmodelledVector, numbers: &[usize]) -> f64 {
    numbers.iter().map(|i| dependence[*i]).fold(1.0, f64::max)
}

#[cfg(feature = "serde")]
impl FamilyTests {
    /// Whether more can be taken, and all numbers can be worked with.
    pub(crate) fn is_valid(&self) -> bool {
        let numbers = [&self.weight, &self.sigma, &self.reach, &self.step];
        let vectors = self.information.iter().chain(&self.score).chain(&self.squares).chain(&self.told_by);
        let numbers = vectors.chain(self.scatter.numbers()).chain(numbers);
        self.series.is_valid()
            && numbers.into_iter().all(|number| number.abs() < StateFormat::LARGEST_NUMBER)
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
    use crate::{dynamics::wrong_family::GROUPS, update::GROWTH};

    const SIGMA: f64 = 0.01;
    const RIGID: MotionModel = MotionModel::Rigid;

    /// Tests after so many frames that show motions of these sizes, noise included.
    fn after(frames: usize, sizes: &UnmodelledVector, seed: u64) -> FamilyTests {
        after_frames_with(1.0, frames, sizes, seed)
    }

    /// The same, with so many times the noise that it is taken to be.
    fn after_frames_with(noise: f64, frames: usize, sizes: &UnmodelledVector, seed: u64) -> FamilyTests {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut tests = FamilyTests::default();
        for _ in 0..frames {
            let factor = UnmodelledMatrix::from_fn(|_, _| normal());
            let information = factor * factor.transpose();
            let errors = factor * UnmodelledVector::from_fn(|_, _| noise * SIGMA * normal());
            let score = UnmodelledScore { information, score: information * sizes + errors, weight: 50.0 };
            tests.add(&score, (0.0, 1.0), (SIGMA, SIGMA * SIGMA));
        }
        tests
    }

    #[test]
    fn noise_alone_is_no_wrong_family() {
        let found = (0..200)
            .filter(|seed| after(40, &UnmodelledVector::zeros(), *seed).estimate(RIGID, 0.0).family.is_some())
            .count();
        assert_eq!(found, 0);
    }

    #[test]
    fn what_frames_scatter_as_much_as_they_show_is_not_beyond_doubt() {
        let mut sizes = UnmodelledVector::zeros();
        sizes[PERSPECTIVE[0]] = 0.004;
        // Seven deviations by the noise; two by what frames scatter. Whether sides are rounded by more than that displaces or not at all.
        for of_side in [0.0, SIGMA] {
            let told = [1.0, 3.0].map(|noise| {
                let tests = after_frames_with(noise, 40, &sizes, 7);
                let estimate = tests.estimate(RIGID, of_side);
                (estimate.family.is_some(), estimate.is_beyond_doubt)
            });
            assert_eq!(told, [(true, true), (true, false)], "{of_side}");
        }
    }

    #[test]
    fn noise_that_is_more_than_it_is_taken_to_be_is_a_change_of_shape_beyond_doubt_once_in_some_hundred_recordings() {
        let told = (0..4000).filter(|seed| {
            let tests = after_frames_with(3.0, 40, &UnmodelledVector::zeros(), *seed);
            tests.estimate(RIGID, 0.0).is_beyond_doubt
        });
        // Six: what frames scatter is told by forty of them, and by eight more that scatter by the noise alone.
        assert!(told.count() <= 10);
    }

    #[test]
    fn what_is_beyond_doubt_has_its_name_whatever_else_may_be_there() {
        let mut sizes = UnmodelledVector::zeros();
        (sizes[READ_OUT], sizes[GROWTH]) = (0.02, 0.0055);
        let names = [1.0, 3.0].map(|noise| {
            let tests = after_frames_with(noise, 40, &sizes, 7);
            let estimate = tests.estimate(RIGID, 0.0);
            (estimate.family, estimate.is_beyond_doubt)
        });
        // Growth by ten deviations of the noise, and by four of what frames scatter.
        assert_eq!(names, [(Some(WrongFamily::Shape), true), (Some(WrongFamily::RollingShutter), true)]);
    }

    #[test]
    fn each_motion_that_is_left_out_is_told_by_its_name_and_size() {
        for (family, members) in GROUPS {
            // Of a lens, whose middle is where the object is first, the part that is its own.
            let member = if family == WrongFamily::Lens { LENS[0] } else { members[members.len() - 1] };
            let mut sizes = UnmodelledVector::zeros();
            sizes[member] = 0.02;
            let tests = after(40, &sizes, 7);
            let UnmodelledEstimate { family: found, is_beyond_doubt, displacement, moments, .. } =
                tests.estimate(RIGID, 0.0);
            assert_eq!((*found, *is_beyond_doubt), (Some(family), true));
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
            let estimate = tests.estimate(RIGID, 0.0);
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
            tests.estimate(RIGID, 0.0).moments[(6, 6)]
        };
        // At a reach of two radii a lens has a quarter of the usual error, one time in ten, and larger ones more rarely.
        let larger = tuning::SIZES.iter().map(|(times, share)| share * times * times).sum::<f64>();
        let beforehand = 0.1 * larger * (tuning::USUAL_ERROR / 4.0).powi(2);
        let unknown = second_moment(10, 10.0);
        assert!((0.9..1.1).contains(&(unknown / beforehand)), "{unknown} {beforehand}");
        let [many, few] = [1000, 10].map(|frames| second_moment(frames, 1e-3));
        assert!(few < 0.5 * beforehand && many < 0.1 * few, "{many} {few} {beforehand}");
    }
}
