//! The accelerations that are part of a hypothesis, and those that follow from its motion.
use freeform_riccati::MotionModel;
use nalgebra::SVector;

use super::{
    centred::{centred_generator, parts},
    course::Course,
    hypothesis::Hypothesis,
};

/// The accelerations that a course has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Accelerations {
    None,
    /// Of the velocity of the centroid alone.
    OfVelocity,
    All,
    /// Of all parameters, that of the velocity of the centroid beside what the turn of the object makes of it.
    OfGenerator,
}

impl Accelerations {
    pub(super) fn of(course: Course) -> Self {
        match course {
            Course::ChangingGenerator { .. } | Course::SteadyChange { turns: true } => Self::OfGenerator,
            Course::Accelerating { rates: true, .. } | Course::SteadyChange { turns: false } => Self::All,
            Course::Accelerating { rates: false, .. } => Self::OfVelocity,
            Course::ConstantGenerator | Course::Shaken { .. } | Course::ConstantVelocity { .. } => Self::None,
        }
    }

    /// Whether a course has them all.
    pub(super) fn are_part_of(self, course: Course) -> bool {
        let had = Self::of(course);
        had != Self::None && had == self || self == Self::OfVelocity && had == Self::All
    }

    /// The state of a hypothesis with these accelerations: those that it does not have follow from its motion.
    pub(super) fn mean_of<const N: usize>(self, source: &Hypothesis<N>, model: MotionModel) -> SVector<f64, N> {
        let mut mean = source.mean;
        if self.are_part_of(source.course) {
            return mean;
        }
        let k = N / 3;
        // Along an arc the velocity of the centroid turns all the time.
        let (a, v) = parts(&centred_generator(model, &source.mean.as_slice()[k..2 * k]));
        let mut acceleration = mean.fixed_rows_mut::<2>(3 * k - 2);
        if source.course.is_constant_velocity() {
            acceleration.copy_from(&(a * source.mean.fixed_rows::<2>(3 * k - 2)));
        } else if source.course.turns() {
            acceleration += a * v;
        }
        if self == Self::OfGenerator {
            acceleration -= a * v;
        }
        mean
    }
}
