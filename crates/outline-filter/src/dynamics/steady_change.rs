//! A motion that changes at a steady rate from the beginning: how probable that is, and how far off a constant one is then.
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector};

use super::{
    centred::{CentredDeviations, CentredMatrix, CentredVector, LARGEST},
    correction::{of_rates_alone, root_of},
    course::Course,
    hypothesis::{CentredMeasurement, Hypothesis},
    weighed_changes::{CentroidVelocity, Changes, Weighed, sized},
};
use crate::tuning::steady_change as tuning;

/// Motions that change at a steady rate since hypotheses began: a constant generator, one whose centroid has run straight, and one whose centroid
/// goes any way. Next to nothing is taken to be known of the rates of change beforehand, so that what the frames say of them can be weighed for each
/// size that they may have. They have no part in where the object is expected.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SteadyChange<const N: usize> {
    /// Of a generator, of a straight way and of any.
    hypotheses: Vec<Hypothesis<N>>,
    /// Deviations of a pose over the square of a usual step: the unit of rates of change.
    units: CentredVector,
    /// `ln(L_alpha / L_d)` of (82a) in docs/motion-filter.md: the likelihood of the frames since it began if next to nothing is known of the changes,
    /// over that of a constant velocity of a point near the centroid.
    over_velocity: f64,
    frames: usize,
}

/// The hypotheses by their numbers. The last has the dynamics of the second, and no measurement of the place.
const GENERATOR: usize = 0;
const STRAIGHT: usize = 1;
const ANY_WAY: usize = 2;
const TURNS: [bool; 3] = [true, false, false];

/// What a motion that may change adds to what is known of one whose rates are constant.
#[derive(Debug, Clone, Copy)]
pub(super) struct PossibleChange<const N: usize> {
    /// Probability that the motion changes by as much as frames can tell.
    pub(super) probability: f64,
    /// Second moments of how far off pose and motion are if it does, times the probability: of the mean distances...
    pub(super) apart: SMatrix<f64, N, N>,
    /// ...and beside those.
    pub(super) beside: SMatrix<f64, N, N>,
}

/// The number of the hypothesis of what changes beside such a velocity.
fn number_beside(velocity: CentroidVelocity) -> usize {
    match velocity {
        CentroidVelocity::Turns => GENERATOR,
        CentroidVelocity::Stays => STRAIGHT,
        CentroidVelocity::Changes => ANY_WAY,
    }
}

impl<const N: usize> SteadyChange<N> {
    /// Begins with what is believed of a constant generator after a step of so many seconds.
    pub(super) fn begin(
        model: MotionModel,
        (mean, covariance): (SVector<f64, N>, SMatrix<f64, N, N>),
        (pose_variance, seconds): (&CentredVector, f64),
    ) -> Self {
        let hypotheses = TURNS.into_iter().map(|turns| {
            Hypothesis::begin((Course::SteadyChange { turns }, model), (mean, covariance), (pose_variance, seconds))
        });
        let units = pose_variance.map(f64::sqrt) / (seconds * seconds);
        Self { hypotheses: hypotheses.collect(), units, over_velocity: 0.0, frames: 0 }
    }

    /// Whether it has been followed for long: smaller changes than those that are reckoned with would be seen by then.
    pub(super) fn is_over(&self) -> bool {
        self.frames >= tuning::FRAMES
    }

    /// Its hypotheses as long as they are followed, which are moved on like others.
    pub(super) fn hypotheses(&mut self) -> &mut [Hypothesis<N>] {
        if self.is_over() { &mut [] } else { &mut self.hypotheses }
    }

    /// Takes a frame, of which the information is given too, as long as it is followed; `velocity` is the logarithm of its likelihood where the
    /// velocity of a point near the centroid is constant.
    pub(super) fn update(
        &mut self,
        (measurement, information): (&CentredMeasurement, &CentredMatrix),
        velocity: Option<f64>,
    ) {
        if self.is_over() {
            return;
        }
        let k = Hypothesis::<N>::K;
        let of_rates = CentredMeasurement { root: root_of(&of_rates_alone(information, k), k), ..*measurement };
        let mut gained = 0.0;
        for (number, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            let innovation = hypothesis.update(if number == ANY_WAY { &of_rates } else { measurement });
            if let Some((changes, velocity)) = innovation.zip(velocity).filter(|_| number == STRAIGHT) {
                gained = changes.log_likelihood - velocity;
            }
        }
        self.over_velocity += if gained.is_finite() { gained } else { 0.0 };
        self.frames += 1;
    }

    /// Whether all numbers can be worked with.
    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        let is_finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let courses = self.hypotheses.iter().map(|hypothesis| hypothesis.course);
        courses.eq(TURNS.map(|turns| Course::SteadyChange { turns }))
            && self.hypotheses.iter().all(|h| is_finite(h.mean.as_slice()) && is_finite(h.covariance.as_slice()))
            && self.units.iter().all(|unit| unit.is_finite() && *unit > 0.0)
            && self.over_velocity.is_finite()
            && self.frames <= tuning::FRAMES
    }

    /// What it adds to what is known of a motion whose rates are otherwise constant, given what its `velocity` does otherwise. What changes steadily are
    /// the rates alone, the velocity alone or all parameters, by some sizes, weighted by their Bayes factors; where the velocity changes anyway, the
    /// rates alone. Deviations of poses about the centroid are to be multiplied by factors, as what is stated will be, and their variances by that of a
    /// camera that shakes; `place` carries errors of this state to those that are asked for.
    pub(super) fn possible(
        &self,
        velocity: CentroidVelocity,
        (widened_later, shaking): (&CentredDeviations, f64),
        place: &SMatrix<f64, N, N>,
    ) -> Option<PossibleChange<N>> {
        let k = Hypothesis::<N>::K;
        let told = self.told(number_beside(velocity), place)?;
        // Of a body that runs straight the rates alone, whatever way its centroid goes: a point beside that may run straight.
        let of_rates = if velocity == CentroidVelocity::Stays { self.told(ANY_WAY, place)? } else { told };
        let against = match velocity {
            CentroidVelocity::Stays => self.against(&told.changes(|information| information), k)?,
            CentroidVelocity::Turns | CentroidVelocity::Changes => 0.0,
        };
        let widen = |information: CentredMatrix| {
            CentredMatrix::from_fn(|i, j| information[(i, j)] / (widened_later[i] * widened_later[j] * shaking))
        };
        let weighed = told.changes(widen).weighed(k, (velocity, against / shaking), &of_rates.changes(widen))?;
        let Weighed { probability, of_rates: by_rates, others } = weighed;
        // What is stated is widened by the factors later on, and these are sizes as they are.
        let carried = |moments: [CentredMatrix; 2]| {
            let sum = of_rates.carried(&moments[0]) + told.carried(&moments[1]);
            SMatrix::<f64, N, N>::from_fn(|i, j| sum[(i, j)] / (widened_later[i % k] * widened_later[j % k]))
        };
        let (apart, beside) = (carried([by_rates.apart, others.apart]), carried([by_rates.beside, others.beside]));
        Some(PossibleChange { probability, apart, beside })
    }

    /// What a hypothesis of a number tells of its rates of change.
    fn told(&self, number: usize, place: &SMatrix<f64, N, N>) -> Option<Told<N>> {
        let (k, unit) = (Hypothesis::<N>::K, &self.units);
        let Hypothesis { mean, covariance, .. } = &self.hypotheses[number];
        let own = |i: usize, j: usize| f64::from(u8::from(i == j));
        let known = CentredMatrix::from_fn(|i, j| match i < k && j < k {
            true => covariance[(2 * k + i, 2 * k + j)] / (unit[i] * unit[j]) + tuning::SINGULAR * own(i, j),
            false => own(i, j),
        });
        let information = known.cholesky()?.inverse();
        let found = CentredVector::from_fn(|i, _| if i < k { mean[2 * k + i] / unit[i] } else { 0.0 });
        let of_state = SMatrix::<f64, N, LARGEST>::from_fn(|i, j| match i < 2 * k && j < k {
            true => covariance[(i, 2 * k + j)] / unit[j],
            false => 0.0,
        });
        Some(Told { information, found, sensitivity: place * of_state * information })
    }

    /// `ln(L_0 / L_d)` of (82a), at most 0: the likelihood of the frames if the centroid runs straight, over that if a point near it does. The
    /// latter explains what looks like a change of the velocity of the centroid.
    fn against(&self, changes: &Changes, k: usize) -> Option<f64> {
        let any = changes.of_sizes(&sized(&(0..k), tuning::ANY))?;
        Some((self.over_velocity - any.logarithm).min(0.0))
    }
}

/// What a hypothesis says of its rates of change, in their units, and how far they move pose and motion.
#[derive(Debug, Clone, Copy)]
struct Told<const N: usize> {
    information: CentredMatrix,
    found: CentredVector,
    sensitivity: SMatrix<f64, N, LARGEST>,
}

impl<const N: usize> Told<N> {
    fn changes(&self, widen: impl Fn(CentredMatrix) -> CentredMatrix) -> Changes {
        let information = widen(self.information);
        Changes { information, score: information * self.found }
    }

    /// Second moments of the rates of change as those of pose and motion.
    fn carried(&self, moments: &CentredMatrix) -> SMatrix<f64, N, N> {
        self.sensitivity * moments * self.sensitivity.transpose()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Matrix3, Point2, Vector2};

    use super::*;
    use crate::dynamics::{CentredPose, step::Step, usual_step::Units};

    /// Columns of the propagation of errors over a step, by finite differences and as the covariance is carried.
    #[test]
    fn errors_of_a_steady_change_are_carried_as_the_motion_is() {
        let pose = CentredPose { pose: Matrix3::identity(), centroid: Point2::origin() };
        let variance = CentredVector::repeat(1.0);
        let dt = 0.005;
        let step =
            Step::new((MotionModel::Rigid, dt), [&pose, &pose], Units::of_usual_step(&variance, dt)).expect("poses");
        let mean = SVector::<f64, 9>::from([0.0, 0.0, 0.0, 1.5, 0.6, -0.2, -0.8, 0.3, 0.9]);
        for turns in [true, false] {
            let moved = |mean: SVector<f64, 9>, covariance: SMatrix<f64, 9, 9>| {
                let mut hypothesis = Hypothesis::<9> { course: Course::SteadyChange { turns }, mean, covariance };
                assert!(hypothesis.predict(&step));
                hypothesis
            };
            for j in 3..9 {
                let unit = SVector::<f64, 9>::from_fn(|i, _| f64::from(u8::from(i == j)));
                let (ahead, behind) =
                    (moved(mean + 1e-5 * unit, SMatrix::zeros()), moved(mean - 1e-5 * unit, SMatrix::zeros()));
                let difference = (ahead.mean - behind.mean) / 2e-5;
                let carried = moved(mean, unit * unit.transpose()).covariance;
                let column = carried.column(j) / carried[(j, j)].sqrt();
                // Of motions to the second order of a step, of their changes to the third.
                let tolerance = if j < 6 { dt * dt } else { 10.0 * dt * dt * dt };
                assert!((difference - column).amax() < tolerance, "{turns} {j}: {difference} {column}");
            }
        }
    }

    #[test]
    fn a_motion_that_changes_steadily_is_moved_on_as_by_an_integrator() {
        let (steps, seconds) = (200, 1.0);
        let (omega, change) = (1.5, -0.8);
        let (velocity, push) = (Vector2::new(0.6, -0.2), Vector2::new(0.3, 0.9));
        let pose = CentredPose { pose: Matrix3::identity(), centroid: Point2::origin() };
        let variance = CentredVector::repeat(1.0);
        for turns in [true, false] {
            let begun = [0.0, 0.0, 0.0, omega, velocity.x, velocity.y, change, push.x, push.y];
            let mut hypothesis = Hypothesis::<9> {
                course: Course::SteadyChange { turns },
                mean: begun.into(),
                covariance: SMatrix::identity(),
            };
            let dt = seconds / f64::from(steps);
            let step = Step::new((MotionModel::Rigid, dt), [&pose, &pose], Units::of_usual_step(&variance, dt))
                .expect("poses");
            (0..steps).for_each(|_| assert!(hypothesis.predict(&step)));
            // The clockwise turn of section 1: a rotation by the angle that has been turned by since.
            let angle = |t: f64| omega * t + 0.5 * change * t * t;
            let turn = |by: f64| Matrix2::new(by.cos(), by.sin(), -by.sin(), by.cos());
            let at = |t: f64, from: f64| if turns { turn(angle(t) - angle(from)) } else { Matrix2::identity() };
            let pieces = 2000;
            let width = seconds / f64::from(pieces);
            let times = || (0..pieces).map(|i| (f64::from(i) + 0.5) * width);
            let velocity_at = |t: f64| {
                let pushed = times().filter(|s| *s < t).map(|s| at(t, s) * push * width);
                at(t, 0.0) * velocity + pushed.fold(Vector2::zeros(), |sum, v| sum + v)
            };
            let later = velocity_at(seconds);
            let expected_turn = angle(seconds);
            assert!((hypothesis.mean[0] - expected_turn).abs() < 1e-12, "{turns}: {}", hypothesis.mean);
            assert!((hypothesis.mean.fixed_rows::<2>(4) - later).norm() < 2e-3, "{turns}: {} {later}", hypothesis.mean);
            let way = (0..100).map(|i| velocity_at((f64::from(i) + 0.5) / 100.0) / 100.0);
            let way = way.fold(Vector2::zeros(), |sum, v| sum + v);
            assert!((hypothesis.mean.fixed_rows::<2>(1) - way).norm() < 2e-3, "{turns}: {} {way}", hypothesis.mean);
        }
    }
}
