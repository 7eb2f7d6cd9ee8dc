use std::{fmt, str::FromStr};

/// What is assumed of how the motion goes on from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Dynamics {
    /// Hypotheses of three kinds, those below (25 in all), weighted by their likelihoods.
    #[default]
    Auto,
    /// The paper's constant generator: the velocity of the object's centroid turns with the object, as on a turntable. The path of the centroid
    /// then tells the turn, also where the outline does not show it (rigid and similarity motion).
    Generator,
    /// Constant rates and a constant velocity of the centroid, as of an object that is thrown or slides.
    Velocity,
    /// Nearly constant accelerations of the rates and of the velocity of the centroid, or a generator that changes nearly steadily, as of an object
    /// that speeds up about a fixed point.
    Accelerating,
}

impl Dynamics {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Generator, Self::Velocity, Self::Accelerating];

    /// Its name: `auto`, `generator`, `velocity`, `accelerating`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Generator => "generator",
            Self::Velocity => "velocity",
            Self::Accelerating => "accelerating",
        }
    }
}

impl fmt::Display for Dynamics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is none of a hypothesis of dynamics.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{name}' is none of auto, generator, velocity, accelerating")]
pub struct UnknownDynamics {
    /// The name.
    pub name: String,
}

impl FromStr for Dynamics {
    type Err = UnknownDynamics;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|d| d.name() == name).ok_or_else(|| UnknownDynamics { name: name.to_owned() })
    }
}

/// Probabilities of the three kinds of hypotheses of dynamics given the frames so far; their sum is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicsWeights {
    /// Of a constant generator, also as a shaking camera sees it: poses have errors of their own then, others in every frame.
    pub generator: f64,
    /// Of constant rates and a constant velocity of a point of the body, the centroid or another.
    pub velocity: f64,
    /// Of nearly constant accelerations.
    pub accelerating: f64,
}

impl DynamicsWeights {
    /// The most probable kind.
    #[must_use]
    pub fn most_probable(&self) -> Dynamics {
        if self.generator >= self.velocity.max(self.accelerating) {
            Dynamics::Generator
        } else if self.velocity >= self.accelerating {
            Dynamics::Velocity
        } else {
            Dynamics::Accelerating
        }
    }
}
