//! How often a motion leaves one course for another.
use super::course::{Course, Rates};
use crate::tuning::dynamics as tuning;

/// Probability, in a usual step, that a course is left for a certain other one.
pub(super) fn leaving(course: Course) -> f64 {
    match course {
        Course::ConstantVelocity { .. } if course.is_shaken() => tuning::LEAVES_CHANGING,
        Course::ConstantGenerator | Course::ConstantVelocity { .. } | Course::SteadyChange { .. } => {
            tuning::LEAVES_CONSTANT
        }
        Course::Accelerating { .. } | Course::ChangingGenerator { .. } | Course::Shaken { .. } => {
            tuning::LEAVES_CHANGING
        }
    }
}

/// How often a change leads to a course, relative to those that accelerate.
fn arriving(course: Course) -> f64 {
    match course {
        Course::Shaken { .. } => tuning::BEGINS_TO_SHAKE,
        Course::ConstantVelocity { .. } if course.is_shaken() => tuning::BEGINS_TO_SHAKE,
        Course::ConstantGenerator | Course::ConstantVelocity { .. } => tuning::BECOMES_CONSTANT,
        Course::Accelerating { .. } | Course::ChangingGenerator { .. } | Course::SteadyChange { .. } => 1.0,
    }
}

/// How often a change leads to a course, as [`arriving`], by what the rates of the course that is left do, in a model of N / 3 parameters.
pub(super) fn share_of_changes<const N: usize>(from: Rates, to: Course) -> f64 {
    // Two of the parameters are the velocity. The first rate, the turn of rigid motion, is in `arriving`.
    let further_rates = N as i32 / 3 - 3;
    match (from, to.rates()) {
        (Rates::ChangeAtRandom, Rates::Stay) => arriving(to) * tuning::RATES_STAY.powi(further_rates),
        _ => arriving(to),
    }
}
