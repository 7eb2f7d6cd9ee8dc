use std::fmt;

use freeform_riccati::{MotionModel, ParameterKind, PlaneMotion};

use super::{settings::Method, trajectory::Trajectory};

/// Family of motions that is identified: of the picture, or of a plane in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionFamily {
    /// Motions of the picture with a constant generator.
    Picture(MotionModel),
    /// A plane that moves in space with constant angular velocity and velocity, before a perspective camera.
    Plane,
}

impl MotionFamily {
    /// The motion model of the picture; `None` for a plane in space, whose generator changes.
    #[must_use]
    pub const fn model(self) -> Option<MotionModel> {
        match self {
            Self::Picture(model) => Some(model),
            Self::Plane => None,
        }
    }

    /// Whether a method gives a velocity of the middle, where it is known: the motion filter does, but not of a plane in space.
    #[must_use]
    pub fn has_velocity(self, method: Method) -> bool {
        method == Method::Filter && self != Self::Plane
    }

    /// Names of the numbers of a pose that a method gives, where they are known, in order, as of a [`Trajectory`](super::Trajectory): none of a plane in
    /// space, and none with the adaptive method.
    #[must_use]
    pub fn pose_names(self, method: Method) -> &'static [&'static str] {
        let model = self.model().filter(|_| method == Method::Filter);
        model.map_or(&[], Trajectory::pose_names)
    }

    /// Names of the parameters in order.
    #[must_use]
    pub const fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Self::Picture(model) => model.parameter_names(),
            Self::Plane => &PlaneMotion::NAMES,
        }
    }

    /// Their units, the length unit left out.
    #[must_use]
    pub const fn units(self) -> &'static [&'static str] {
        match self {
            Self::Picture(model) => model.units(),
            Self::Plane => &PlaneMotion::UNITS,
        }
    }

    /// What each parameter is with respect to lengths of the picture, on which those of a plane do not depend.
    #[must_use]
    pub const fn parameter_kinds(self) -> &'static [ParameterKind] {
        match self {
            Self::Picture(model) => model.parameter_kinds(),
            Self::Plane => &[ParameterKind::Rate; PlaneMotion::NAMES.len()],
        }
    }
}

impl From<MotionModel> for MotionFamily {
    fn from(model: MotionModel) -> Self {
        Self::Picture(model)
    }
}

impl fmt::Display for MotionFamily {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Picture(model) => model.fmt(f),
            Self::Plane => f.write_str("plane"),
        }
    }
}
