//! What the map says of the motion.
use freeform_estimate::{MotionEstimate, is_worth};
use freeform_riccati::ParameterKind;
use nalgebra::DMatrix;

use super::{
    arrow_information::{StateMatrix, scaled_inverse},
    outline_map::OutlineMap,
};

/// Steps over which a parameter must be known at least, however fast the motion changes.
const STEPS_KNOWN: f64 = 30.0;

impl OutlineMap {
    /// Variance of the noise times the points that tell no more than one, since their errors are correlated.
    pub(crate) fn effective_variance(&self) -> f64 {
        self.sigma * self.sigma * self.noise_level.correlation()
    }

    /// Covariance of pose and motion in normalised units, of their marginal information or of that with the outline given; `None`
    /// where it cannot be computed.
    pub(crate) fn state_covariance(&self, information: &StateMatrix) -> Option<DMatrix<f64>> {
        let k = self.information.k;
        let inverse = scaled_inverse(information, k)? * self.effective_variance();
        inverse.iter().all(|e| e.is_finite()).then(|| DMatrix::from_fn(2 * k, 2 * k, |i, j| inverse[(i, j)]))
    }

    /// Covariance of the motion parameters in the order of the model, image units; `None` where it cannot be computed, or is beyond any
    /// number.
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let k = self.information.k;
        let to_image = self.to_image();
        let change = self.model.adjoint(&to_image, &to_image.try_inverse()?);
        let state = self.state_covariance(&self.marginal)?;
        let change = DMatrix::from_fn(k, k, |i, j| change[i][j]);
        let covariance = &change * state.view((k, k), (k, k)) * change.transpose();
        // The products round apart where the image origin is far away.
        let symmetric = 0.5 * (&covariance + covariance.transpose());
        symmetric.iter().all(|e| e.is_finite()).then_some(symmetric)
    }

    /// The motion in image units, with standard deviations. A parameter whose standard deviation, over the time that it is
    /// known from, would turn the object by a quarter of a radian or move it by a quarter of its size is marked as
    /// unobservable; so is one that takes part in a motion which the outline does not show, such as the turning of a circle
    /// about its centre.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        let covariance = self.covariance()?;
        let k = self.information.k;
        let to_image = self.to_image();
        let from_image = to_image.try_inverse()?;
        let generator = to_image * self.model.generator(&self.motion[..k]) * from_image;
        let values = self.model.parameters_of(&generator);
        let deviations: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        let mut estimate = MotionEstimate::new(self.model, &values[..k], Some(&deviations));
        let blind = self.blind_parameters();
        let reach = self.radius + self.origin.coords.norm();
        let shortest = self.shortest_span();
        for (j, kind) in self.model.parameter_kinds().iter().enumerate() {
            let (limit, span) = match kind {
                // The velocity at the origin of the image follows from that of the object and all other parameters.
                ParameterKind::Velocity => (reach, shortest),
                ParameterKind::Perspective => (1.0 / reach, self.spans[j]),
                ParameterKind::Rate => (1.0, self.spans[j]),
            };
            let known = self.is_worth(deviations[j], span, limit);
            if !known || blind[j] {
                estimate = estimate.with_unobservable(j);
            }
        }
        Some(estimate)
    }

    /// Seconds of the past that what takes part in all parameters is known from.
    pub(crate) fn shortest_span(&self) -> f64 {
        self.spans[..self.information.k].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether the standard deviation of a rate, over the time that it is known from, makes little of a displacement.
    pub(crate) fn is_worth(&self, deviation: f64, span: f64, displacement: f64) -> bool {
        let floor = self.span.min(STEPS_KNOWN * self.step_seconds);
        is_worth(deviation, span.max(floor), displacement)
    }
}
