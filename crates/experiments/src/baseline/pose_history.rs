use freeform_curve_fit::Outline;
use freeform_estimate::{MotionEstimate, TimeNotIncreasing};
use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Point2, Vector2};

use super::{
    error::BaselineError,
    flow_fit::{PoseObservation, fit_flow},
};

/// The poses found so far, in coordinates in which the first outline is centred and of unit size.
#[derive(Debug, Clone)]
pub(super) struct PoseHistory {
    pub(super) model: MotionModel,
    last_time: f64,
    /// Maps the image to the coordinates of the poses; `None` before the first frame.
    normalisation: Option<Matrix3<f64>>,
    pub(super) observations: Vec<PoseObservation>,
    pub(super) rejected: usize,
}

impl PoseHistory {
    pub(super) fn new(model: MotionModel) -> Self {
        let last_time = f64::NEG_INFINITY;
        Self { model, last_time, normalisation: None, observations: Vec::new(), rejected: 0 }
    }

    /// Checks the time of the next frame.
    pub(super) fn advance(&mut self, time: f64) -> Result<(), BaselineError> {
        TimeNotIncreasing::check(self.last_time, time)?;
        self.last_time = time;
        Ok(())
    }

    /// Forgets everything but the rejected frames; the next outline sets the coordinates.
    pub(super) fn restart(&mut self) {
        self.normalisation = None;
        self.observations.clear();
    }

    /// Sets the coordinates by an outline, unless one has done so.
    pub(super) fn set_coordinates(&mut self, outline: &Outline) {
        self.normalisation.get_or_insert_with(|| {
            let (centre, radius) = (outline.centroid(), outline.rms_radius());
            let scale = radius.recip();
            Matrix3::new(scale, 0.0, -centre.x * scale, 0.0, scale, -centre.y * scale, 0.0, 0.0, 1.0)
        });
    }

    /// The map from the image to the coordinates of the poses.
    pub(super) fn map(&self) -> impl Fn(&Point2<f64>) -> Point2<f64> + Copy + use<> {
        let map = self.normalisation.unwrap_or_else(Matrix3::identity);
        let (scale, shift) = (map[(0, 0)], Vector2::new(map[(0, 2)], map[(1, 2)]));
        move |p| Point2::from(scale * p.coords + shift)
    }

    /// The motion that the poses make.
    pub(super) fn estimate(&self) -> Option<MotionEstimate> {
        fit_flow(self.model, &self.observations, &self.normalisation?)
    }
}
