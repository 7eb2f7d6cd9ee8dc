//! What a hypothesis says that the motion does between frames.
use super::{centred::CentredVector, setting::Dynamics};
use crate::tuning::{dynamics as tuning, steady_change};

/// A point of the body whose velocity stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum PointOfBody {
    /// The centroid, but for what noise and hidden parts make of it.
    NearCentroid,
    /// Any, such as an axle.
    Any,
}

impl PointOfBody {
    /// How far it may be from the centroid, in RMS radii, as a deviation.
    pub(super) fn off_centroid(self) -> f64 {
        match self {
            Self::NearCentroid => tuning::OFF_CENTROID,
            Self::Any => tuning::ANY_POINT,
        }
    }
}

/// What the rates of a motion do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rates {
    Stay,
    ChangeAtRandom,
}

/// What the motion does between frames: the mode of a hypothesis of the interacting multiple model.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Course {
    /// The velocity of the centroid turns with the object.
    ConstantGenerator,
    /// As that, seen by a camera that shakes: poses have errors of their own, in every frame others.
    Shaken {
        /// In standard deviations of a pose as the points of a frame tell it.
        deviations: f64,
    },
    /// The velocity of a point of the object stays. In place of accelerations its state has the part of the velocity of the centroid that turns with
    /// the object.
    ConstantVelocity {
        of: PointOfBody,
        /// As those of [`Shaken`](Self::Shaken); none where the camera stands still.
        deviations: f64,
    },
    /// The accelerations change at random.
    Accelerating {
        /// Level of their density, in variances of a pose per fifth power of a usual step.
        level: f64,
        /// Whether the rates do as well, or the velocity of the centroid alone, as of an object that spins while it falls.
        rates: bool,
    },
    /// The generator changes at rates that change at random, which its state has in place of accelerations: the velocity of the centroid turns with
    /// the object, as of one that speeds up about a fixed point.
    ChangingGenerator {
        /// As that of accelerations.
        level: f64,
    },
    /// The motion changes at a steady rate, which its state has in place of accelerations.
    SteadyChange {
        /// Whether the velocity of the centroid turns with the object, but for that.
        turns: bool,
    },
}

impl Course {
    /// The velocity of a point stays, seen by a camera that stands still.
    pub(super) const fn straight(of: PointOfBody) -> Self {
        Self::ConstantVelocity { of, deviations: 0.0 }
    }

    /// What the hypotheses of a setting say that the motion does.
    pub(super) fn all_of(setting: Dynamics) -> Vec<Self> {
        let all = tuning::LEVELS.map(|level| Self::Accelerating { level, rates: true });
        let of_velocity = tuning::LEVELS_OF_VELOCITY.map(|level| Self::Accelerating { level, rates: false });
        let of_generator = tuning::LEVELS_OF_GENERATOR.map(|level| Self::ChangingGenerator { level });
        let accelerating = all.into_iter().chain(of_velocity).chain(of_generator);
        match setting {
            Dynamics::Auto => {
                let shaken = tuning::SHAKEN.map(|deviations| Self::Shaken { deviations });
                let of_velocity = [PointOfBody::NearCentroid, PointOfBody::Any].map(Self::straight);
                let constant = std::iter::once(Self::ConstantGenerator).chain(of_velocity);
                let straight_and_shaken =
                    Self::ConstantVelocity { of: PointOfBody::Any, deviations: tuning::SHAKEN_STRAIGHT };
                constant.chain(shaken).chain([straight_and_shaken]).chain(accelerating).collect()
            }
            Dynamics::Generator => vec![Self::ConstantGenerator],
            Dynamics::Velocity => vec![Self::straight(PointOfBody::NearCentroid)],
            Dynamics::Accelerating => accelerating.collect(),
        }
    }

    /// Variances of accelerations of which nothing is known yet: such that they move the object by some deviations of a pose over the steps
    /// that the level remembers. Larger ones are those of higher levels.
    pub(super) fn acceleration_prior(self, pose_variance: &CentredVector, k: usize, seconds: f64) -> CentredVector {
        let (first, span, size) = match self {
            Self::Accelerating { .. } | Self::ChangingGenerator { .. } => {
                (self.first_changing(k), seconds * self.memory(), tuning::FIRST_ACCELERATION)
            }
            Self::SteadyChange { .. } => (0, seconds, steady_change::ANY),
            Self::ConstantGenerator | Self::Shaken { .. } | Self::ConstantVelocity { .. } => {
                return CentredVector::zeros();
            }
        };
        let unit = (size / (span * span)).powi(2);
        CentredVector::from_fn(|j, _| if (first..k).contains(&j) { pose_variance[j] * unit } else { 0.0 })
    }

    /// Probability before the third frame, among those that say where the object is expected.
    pub(super) fn prior(self) -> f64 {
        match self {
            Self::ConstantGenerator => tuning::PRIOR_OF_GENERATOR,
            Self::Shaken { .. } => tuning::PRIOR_OF_SHAKEN,
            Self::ConstantVelocity { .. } if self.is_shaken() => tuning::PRIOR_OF_SHAKEN,
            Self::ConstantVelocity { of: PointOfBody::NearCentroid, .. } => tuning::PRIOR_OF_VELOCITY,
            Self::ConstantVelocity { of: PointOfBody::Any, .. } => tuning::PRIOR_OF_VELOCITY_OF_ANY,
            Self::Accelerating { .. } | Self::ChangingGenerator { .. } => tuning::PRIOR_OF_EACH_LEVEL,
            Self::SteadyChange { .. } => 0.0,
        }
    }

    /// Factor of the variance of a pose as the points of a frame tell it.
    pub(super) fn shaking(self) -> f64 {
        match self {
            Self::Shaken { deviations } | Self::ConstantVelocity { deviations, .. } => 1.0 + deviations * deviations,
            _ => 1.0,
        }
    }

    /// Whether accelerations, the generator or the camera change at random.
    pub(super) fn changes_at_random(self) -> bool {
        self.is_shaken() || matches!(self, Self::Accelerating { .. } | Self::ChangingGenerator { .. })
    }

    /// Whether the camera shakes.
    pub(super) fn is_shaken(self) -> bool {
        self.shaking() > 1.0
    }

    /// Whether no part of the velocity of the centroid turns with the object, and the motion changes.
    pub(super) fn accelerates(self) -> bool {
        matches!(self, Self::Accelerating { .. } | Self::SteadyChange { turns: false })
    }

    /// Whether the state has entries behind the motion.
    pub(super) fn has_more_than_motion(self) -> bool {
        self.has_accelerations() || self.is_constant_velocity()
    }

    /// Whether the velocity of a point stays.
    pub(super) fn is_constant_velocity(self) -> bool {
        matches!(self, Self::ConstantVelocity { .. })
    }

    /// Whether these are accelerations, or rates of change in place of them.
    pub(super) fn has_accelerations(self) -> bool {
        matches!(self, Self::Accelerating { .. } | Self::ChangingGenerator { .. } | Self::SteadyChange { .. })
    }

    /// Whether the velocity of the centroid turns with the object, but for what changes it.
    pub(super) fn turns(self) -> bool {
        match self {
            Self::ConstantGenerator | Self::Shaken { .. } | Self::ChangingGenerator { .. } => true,
            Self::ConstantVelocity { .. } | Self::Accelerating { .. } => false,
            Self::SteadyChange { turns } => turns,
        }
    }

    /// Whether it takes the step that has led to its beginning to have been straight. Those that accelerate begin with the arc: begun with the chord
    /// they explain the first frames of a straight flight as well as a constant velocity does, whose errors were a tenth larger then.
    pub(super) fn has_run_straight(self) -> bool {
        matches!(self, Self::ConstantVelocity { .. } | Self::SteadyChange { turns: false })
    }

    /// Level at which its accelerations change at random, if they do.
    pub(super) fn level(self) -> Option<f64> {
        match self {
            Self::Accelerating { level, .. } | Self::ChangingGenerator { level } => Some(level),
            Self::ConstantGenerator
            | Self::Shaken { .. }
            | Self::ConstantVelocity { .. }
            | Self::SteadyChange { .. } => None,
        }
    }

    /// Steps that it remembers: those over which what changes at random moves the object by as much as a pose is off.
    pub(super) fn memory(self) -> f64 {
        self.level().map_or(f64::INFINITY, |level| (tuning::MEMORY * level.powf(-1.0 / 6.0)).max(1.0))
    }

    /// Whether its [memory](Self::memory) is of less than a few steps; asked of all in every frame, and so without a root.
    pub(super) fn is_forgetful(self) -> bool {
        self.level().is_some_and(|level| level > (tuning::MEMORY / tuning::REMEMBERED).powi(6))
    }

    /// What its rates do. Those of a steady change have no random part.
    pub(super) fn rates(self) -> Rates {
        match self {
            Self::Accelerating { rates: true, .. } | Self::ChangingGenerator { .. } => Rates::ChangeAtRandom,
            Self::Accelerating { rates: false, .. }
            | Self::ConstantGenerator
            | Self::Shaken { .. }
            | Self::ConstantVelocity { .. }
            | Self::SteadyChange { .. } => Rates::Stay,
        }
    }

    /// The first of k parameters that changes at random, where accelerations do: the velocity of the centroid, and the rates before it if they
    /// change.
    pub(super) fn first_changing(self, k: usize) -> usize {
        match self.rates() {
            Rates::ChangeAtRandom => 0,
            Rates::Stay => k - 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_are_forgetful_whose_memory_is_of_less_than_a_few_steps() {
        for course in Course::all_of(Dynamics::Auto) {
            assert_eq!(course.is_forgetful(), course.memory() < tuning::REMEMBERED, "{course:?}");
        }
    }
}
