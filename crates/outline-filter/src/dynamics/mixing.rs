//! Mixing: every hypothesis may have been one of the others a step ago.
use freeform_riccati::MotionModel;
use nalgebra::SMatrix;

use super::{
    accelerations::Accelerations,
    arrival::Arrival,
    course::Rates,
    hypothesis::Hypothesis,
    pooled::{Pooled, changing},
    transitions::{leaving, share_of_changes},
    usual_step::Units,
};
use crate::tuning::dynamics as tuning;

/// Takes every hypothesis to have been one of the others a step ago by chance; the probabilities sum up to one.
///
/// The probability of a change is that the one course is left, times the share of changes that lead to the other. Every mixture has
/// two parts: the hypothesis itself, and all that have changed together. The state of those is that of all that leave their courses, wherever they
/// lead. They are blended, or kept apart as `arrivals` where that is asked for and matters.
pub(super) fn mix<const N: usize>(
    hypotheses: &mut [Hypothesis<N>],
    weights: &mut [f64],
    model: MotionModel,
    units: Units<'_>,
    mut arrivals: Option<&mut Vec<Arrival<N>>>,
) {
    if hypotheses.len() < 2 {
        return;
    }
    let with_all = Pooled::of(hypotheses, weights, model);
    let of_velocity = with_all.of_velocity(hypotheses, weights, model);
    let of_generator = with_all.of_generator(hypotheses, weights, model);
    // Of those whose rates stay and of those whose rates change: all that leave their courses in this step, and the shares of all changes from one.
    let leaving_of = |of: Rates| {
        let sources = changing(hypotheses, weights).filter(|(hypothesis, _)| hypothesis.course.rates() == of);
        units.steps * sources.map(|(_, weight)| weight).sum::<f64>()
    };
    let shares_of =
        |from: Rates| hypotheses.iter().map(|hypothesis| share_of_changes::<N>(from, hypothesis.course)).sum::<f64>();
    let [(steady, from_steady), (varying, from_varying)] =
        [Rates::Stay, Rates::ChangeAtRandom].map(|rates| (leaving_of(rates), shares_of(rates)));
    for (number, (hypothesis, weight)) in hypotheses.iter_mut().zip(weights).enumerate() {
        let of_all = match Accelerations::of(hypothesis.course) {
            Accelerations::OfVelocity => &of_velocity,
            Accelerations::OfGenerator => &of_generator,
            Accelerations::All | Accelerations::None => &with_all,
        };
        // Of what has changed, this hypothesis takes its own part back.
        let course = hypothesis.course;
        let shares = match course.rates() {
            Rates::Stay => from_steady,
            Rates::ChangeAtRandom => from_varying,
        };
        let stays = *weight * (1.0 - units.steps * shares * leaving(course));
        let taken = steady * share_of_changes::<N>(Rates::Stay, course)
            + varying * share_of_changes::<N>(Rates::ChangeAtRandom, course);
        *weight = taken + stays;
        let share = taken / *weight;
        match &mut arrivals {
            Some(arrivals) if widens(hypothesis, of_all, share, units) => {
                arrivals.push(Arrival { number, share, state: of_all.as_state_of(hypothesis, model, units) });
            }
            _ if hypothesis.shared() < hypothesis.size() => {
                let state = of_all.as_state_of(hypothesis, model, units);
                hypothesis.blend((&state.mean, &state.covariance), share);
            }
            _ => {
                // As with that state, which is not made for it: a copy for each of the many.
                hypothesis.blend((&of_all.mean, &of_all.covariance), share);
                of_all.add_unknown_to(hypothesis, model, units, share);
            }
        }
    }
}

/// Whether a hypothesis that has been blended with what has changed to it expects a pose less well than those do that have not: a state that is
/// wide on account of a few explains what neither the few nor the many do.
fn widens<const N: usize>(
    hypothesis: &Hypothesis<N>,
    of_all: &Pooled<N>,
    share: f64,
    Units { pose_variance, usual, steps }: Units<'_>,
) -> bool {
    let (k, seconds) = (N / 3, steps * usual);
    (0..k).any(|j| {
        let expected = |covariance: &SMatrix<f64, N, N>| {
            covariance[(j, j)] + 2.0 * seconds * covariance[(j, k + j)] + seconds * seconds * covariance[(k + j, k + j)]
        };
        let apart = (of_all.mean[j] - hypothesis.mean[j]) + seconds * (of_all.mean[k + j] - hypothesis.mean[k + j]);
        let added = share * (expected(&of_all.covariance) + apart * apart);
        added > tuning::WIDENS * (expected(&hypothesis.covariance) + pose_variance[j])
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;
    use crate::dynamics::{
        Dynamics,
        centred::CentredVector,
        course::{Course, PointOfBody},
    };

    fn units(pose_variance: &CentredVector, steps: f64) -> Units<'_> {
        Units { pose_variance, usual: 0.1, steps }
    }

    /// At rest, whatever its course.
    fn of_course<const N: usize>(course: Course) -> Hypothesis<N> {
        Hypothesis { course, mean: SVector::zeros(), covariance: SMatrix::identity() }
    }

    #[test]
    fn constant_motions_are_left_more_rarely_than_changing_ones() {
        let courses = [
            Course::ConstantGenerator,
            Course::straight(PointOfBody::NearCentroid),
            Course::straight(PointOfBody::Any),
            Course::Shaken { deviations: 4.0 },
            Course::Accelerating { level: 1e-1, rates: true },
            Course::Accelerating { level: 1e3, rates: false },
        ];
        // Of each course in turn, all of the probability: what it has lost after a step, and that all others have it.
        let left = courses.map(|course| {
            let mut hypotheses = courses.map(of_course::<9>);
            let mut weights = courses.map(|other| f64::from(u8::from(other == course)));
            mix(&mut hypotheses, &mut weights, MotionModel::Rigid, units(&CentredVector::repeat(1e-4), 1.0), None);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{weights:?}");
            assert!(weights.iter().all(|weight| *weight > 0.0), "{weights:?}");
            let camera = 3;
            if course != courses[camera] {
                assert!(
                    courses.iter().zip(weights).all(|(other, weight)| *other == course
                        || *other == courses[camera]
                        || weight > 50.0 * weights[camera]),
                    "{weights:?}"
                );
            }
            courses.iter().zip(weights).filter(|(other, _)| **other != course).map(|(_, weight)| weight).sum::<f64>()
        });
        let [generator, velocity, of_any, shaken, middle, high] = left;
        assert!(generator == velocity && velocity == of_any && middle == high, "{left:?}");
        assert!(generator > 0.0 && 50.0 * generator < middle.min(shaken), "{left:?}");
    }

    /// Weights after a step of all hypotheses of a model, of which one has had all of the probability.
    fn after<const N: usize>(model: MotionModel, leaves: Course) -> Vec<(Course, f64)> {
        let courses = Course::all_of(Dynamics::Auto);
        let mut hypotheses: Vec<_> = courses.iter().copied().map(of_course::<N>).collect();
        let mut weights: Vec<_> = courses.iter().map(|course| f64::from(u8::from(*course == leaves))).collect();
        mix(&mut hypotheses, &mut weights, model, units(&CentredVector::repeat(1e-4), 1.0), None);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{model:?}: {weights:?}");
        courses.into_iter().zip(weights).collect()
    }

    #[test]
    fn motions_change_over_a_gap_as_many_times_as_often_as_it_has_steps() {
        let courses = Course::all_of(Dynamics::Auto);
        let left_in = |steps: f64| {
            let mut hypotheses: Vec<_> = courses.iter().copied().map(of_course::<9>).collect();
            let mut weights = vec![0.0; courses.len()];
            let changing = courses.len() - 1;
            weights[changing] = 1.0;
            mix(&mut hypotheses, &mut weights, MotionModel::Rigid, units(&CentredVector::repeat(1e-4), steps), None);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{weights:?}");
            1.0 - weights[changing]
        };
        let of_one = left_in(1.0);
        for steps in [0.2, 17.0, tuning::MOST_STEPS] {
            let left = left_in(steps);
            assert!((left / of_one - steps).abs() < 1e-6 * steps && left < 0.5, "{steps}: {left} {of_one}");
        }
    }

    #[test]
    fn rates_that_change_stay_from_now_on_the_more_rarely_the_more_of_them_there_are() {
        let varying = Course::Accelerating { level: tuning::LEVELS[0], rates: true };
        let camera = Course::Shaken { deviations: tuning::SHAKEN[0] };
        let models = [
            (after::<9>(MotionModel::Rigid, varying), after::<9>(MotionModel::Rigid, camera), 0),
            (after::<12>(MotionModel::Similarity, varying), after::<12>(MotionModel::Similarity, camera), 1),
            (after::<18>(MotionModel::Affine, varying), after::<18>(MotionModel::Affine, camera), 3),
            (after::<24>(MotionModel::Projective, varying), after::<24>(MotionModel::Projective, camera), 5),
        ];
        // Both are left as often.
        for (of_varying, of_camera, further_rates) in models {
            for ((course, from_varying), (_, from_camera)) in of_varying.into_iter().zip(of_camera) {
                if course == varying || course == camera {
                    continue;
                }
                let expected = match course.rates() {
                    Rates::Stay => tuning::RATES_STAY.powi(further_rates),
                    Rates::ChangeAtRandom => 1.0,
                };
                assert!((from_varying / from_camera / expected - 1.0).abs() < 1e-9, "{course:?}: {from_varying}");
            }
        }
    }

    #[test]
    fn what_is_kept_apart_and_blended_at_once_is_what_is_mixed() {
        let (variance, model) = (CentredVector::repeat(1e-4), MotionModel::Rigid);
        let before: Vec<Hypothesis<9>> = Course::all_of(Dynamics::Auto)
            .into_iter()
            .zip(1..)
            .map(|(course, number)| {
                let number = f64::from(number);
                let n = if course.has_more_than_motion() { 9 } else { 6 };
                let mean = SVector::from_fn(|i, _| if i < n { (number + i as f64).sin() } else { 0.0 });
                let variance = 1e-6 * number;
                let covariance = SMatrix::from_fn(|i, j| if i == j && i < n { variance } else { 0.0 });
                Hypothesis { course, mean, covariance }
            })
            .collect();
        let begun: Vec<f64> = before.iter().map(|_| 1.0 / before.len() as f64).collect();
        let (mut mixed, mut weights) = (before.clone(), begun.clone());
        mix(&mut mixed, &mut weights, model, units(&variance, 1.0), None);
        let (mut apart, mut weights_apart, mut arrivals) = (before.clone(), begun, Vec::new());
        mix(&mut apart, &mut weights_apart, model, units(&variance, 1.0), Some(&mut arrivals));
        assert!(arrivals.len() > before.len() / 2, "{}", arrivals.len());
        assert_eq!(weights, weights_apart);
        for Arrival { number, .. } in &arrivals {
            assert_eq!(apart[*number].mean, before[*number].mean);
        }
        arrivals.iter().for_each(|arrival| arrival.blend_into(&mut apart[arrival.number]));
        for (apart, mixed) in apart.iter().zip(&mixed) {
            assert!((apart.mean - mixed.mean).amax() < 1e-12, "{:?}", apart.course);
            // How far off the centroid the point of a constant velocity is follows from the rates, which differ.
            let known = if apart.course.is_constant_velocity() { 6 } else { 9 };
            let off = (apart.covariance - mixed.covariance).view((0, 0), (known, known)).amax();
            assert!(off < 1e-12 * mixed.covariance.amax(), "{:?}: {off}", apart.course);
        }
    }

    #[test]
    fn what_is_mixed_has_the_moments_of_the_mixture_that_it_stands_for() {
        type State = SVector<f64, 9>;
        let of = |level: f64, mean: f64, variance: f64| Hypothesis::<9> {
            course: Course::Accelerating { level, rates: true },
            mean: State::from_fn(|i, _| mean * (1.0 + i as f64)),
            covariance: SMatrix::from_fn(|i, j| if i == j { variance + i as f64 } else { 0.1 * variance }),
        };
        let before = [of(1e-5, 0.3, 1.0), of(1e-2, -0.2, 2.0), of(1e1, 1.0, 0.5)];
        let weights_before = [0.5, 0.3, 0.2];
        let (mut after, mut weights) = (before.clone(), weights_before);
        mix(&mut after, &mut weights, MotionModel::Rigid, units(&CentredVector::repeat(1e-4), 1.0), None);
        let change = tuning::LEAVES_CHANGING;
        for (j, mixed) in after.iter().enumerate() {
            // Equation 68: of hypothesis i comes what has left it for j, and of j itself what has stayed.
            let parts: [f64; 3] =
                std::array::from_fn(|i| weights_before[i] * if i == j { 1.0 - 2.0 * change } else { change });
            let sum: f64 = parts.iter().sum();
            let mean = (0..3).map(|i| parts[i] / sum * before[i].mean).sum::<State>();
            let spread = |i: usize| {
                let apart = before[i].mean - mean;
                parts[i] / sum * (before[i].covariance + apart * apart.transpose())
            };
            assert!((weights[j] - sum).abs() < 1e-12, "{j}");
            assert!((mixed.mean - mean).amax() < 1e-12, "{j}");
            assert!((mixed.covariance - (0..3).map(spread).sum::<SMatrix<f64, 9, 9>>()).amax() < 1e-11, "{j}");
            // Which it would not have without a change.
            assert!((mixed.mean - before[j].mean).amax() > 1e-5, "{j}");
        }
    }
}
