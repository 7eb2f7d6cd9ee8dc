use std::fmt;

use freeform_outline_filter::{FilterError, FilterSettings};
use freeform_riccati::{CameraScale, MotionModel, PinholeCamera};

use super::family::MotionFamily;

use crate::{PipelineError, PipelineSettings, Rectification};

/// Settings of a [`Tracker`](super::Tracker): method, motion model, camera scale and plane.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackerSettings {
    /// The method for every object, with its settings.
    pub method: MethodSettings,
    /// Camera scale f/Z0. If it is given, estimates and velocities are those in space: b divided by the scale (equations 23 and 24).
    pub scale: Option<CameraScale>,
    /// The plane that the objects move in, where a camera looks at it from aside. If it is given, outlines are those of a picture, and all
    /// results (motion, pose, velocity, noise, fitted curve) are in the plane.
    pub rectification: Option<Rectification>,
}

/// A method with its settings.
#[derive(Debug, Clone, PartialEq)]
pub enum MethodSettings {
    /// The motion filter.
    Filter(FilterSettings),
    /// The motion filter on a plane in space, seen by a camera.
    Plane(PinholeCamera, FilterSettings),
    /// The paper's adaptive identifier.
    Adaptive(Box<PipelineSettings>),
}

/// A method of identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Outline, pose and motion estimated together, with standard deviations: [`MotionFilter`](freeform_outline_filter::MotionFilter).
    Filter,
    /// The paper's adaptive identifier on the lines of fitted curves: [`Pipeline`](crate::Pipeline).
    Adaptive,
}

/// Why the settings of a [`Tracker`](super::Tracker) are refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackerError {
    /// The motion filter refuses its settings.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// The pipeline refuses its settings.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
}

impl TrackerSettings {
    /// Default settings of a method for a motion model, without a camera scale.
    #[must_use]
    pub fn new(method: Method, motion: MotionModel) -> Self {
        let method = match method {
            Method::Filter => MethodSettings::Filter(FilterSettings { model: motion, ..FilterSettings::default() }),
            Method::Adaptive => MethodSettings::Adaptive(Box::new(PipelineSettings::for_model(motion))),
        };
        Self { method, scale: None, rectification: None }
    }

    /// Default settings of the motion filter for a plane that moves in space before a camera.
    #[must_use]
    pub fn of_plane(camera: PinholeCamera) -> Self {
        let method = MethodSettings::Plane(camera, FilterSettings::default());
        Self { method, scale: None, rectification: None }
    }

    /// The family of motions.
    #[must_use]
    pub fn motion(&self) -> MotionFamily {
        match &self.method {
            MethodSettings::Filter(settings) => settings.model.into(),
            MethodSettings::Plane(..) => MotionFamily::Plane,
            MethodSettings::Adaptive(settings) => settings.identify.model.into(),
        }
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> Method {
        match self.method {
            MethodSettings::Filter(_) | MethodSettings::Plane(..) => Method::Filter,
            MethodSettings::Adaptive(_) => Method::Adaptive,
        }
    }
}

impl Default for TrackerSettings {
    /// Rigid motions by the motion filter, in image lengths.
    fn default() -> Self {
        Self::new(Method::Filter, MotionModel::Rigid)
    }
}

impl Method {
    /// Its name: `filter` or `adaptive`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filter => "filter",
            Self::Adaptive => "adaptive",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
