//! What a track says of the motion.
use freeform_estimate::{MotionEstimate, MotionState, NormalisedState, PointVelocity, is_worth};
use freeform_riccati::{MAX_PARAMETERS, ParameterKind, ParameterVector};
use nalgebra::DMatrix;

use super::Track;
use crate::tuning::{null_space::TAKES_PART, supervisor::STEPS_KNOWN};

impl Track {
    /// Covariance of the motion parameters in the order of the model, image units; `None` where it cannot be computed, or is beyond any
    /// number.
    pub(crate) fn covariance(&self) -> Option<DMatrix<f64>> {
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let to_image = self.reference.to_image();
        let change = model.adjoint(&to_image, &to_image.try_inverse()?);
        let state = self.belief.covariance_of(&self.belief.marginal, self.noise.effective_variance())?;
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
    pub(crate) fn estimate(&self) -> Option<MotionEstimate> {
        let covariance = self.covariance()?;
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let to_image = self.reference.to_image();
        let from_image = to_image.try_inverse()?;
        let generator = to_image * model.generator(&self.belief.motion[..k]) * from_image;
        let values = model.parameters_of(&generator);
        let deviations: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        let mut estimate = MotionEstimate::new(model, &values[..k], Some(&deviations));
        let blind = self.blind_parameters();
        let reach = self.reference.radius + self.reference.origin.coords.norm();
        let memory = &self.belief.memory;
        let shortest = memory.shortest(k);
        for (j, kind) in model.parameter_kinds().iter().enumerate() {
            let (limit, span) = match kind {
                // The velocity at the origin of the image follows from that of the object and all other parameters.
                ParameterKind::Velocity => (reach, shortest),
                ParameterKind::Perspective => (1.0 / reach, memory.effective[j]),
                ParameterKind::Rate => (1.0, memory.effective[j]),
            };
            if !self.is_worth(deviations[j], span, limit) || blind[j] {
                estimate = estimate.with_unobservable(j);
            }
        }
        Some(estimate)
    }

    /// Pose and motion with their joint covariance at a time in seconds, with the parameters marked that `observable` says nothing is known of.
    pub(crate) fn state(&self, time: f64, observable: [bool; MAX_PARAMETERS]) -> Option<MotionState> {
        let (belief, variance) = (&self.belief, self.noise.effective_variance());
        let state = NormalisedState {
            model: belief.model,
            time,
            origin: self.reference.origin,
            radius: self.reference.radius,
            pose: belief.pose,
            motion: belief.motion,
            covariance: belief.covariance_of(&belief.marginal, variance)?,
            covariance_given_outline: belief.covariance_of(&belief.information.with_outline_given(), variance)?,
            observable,
        };
        Some(state.into())
    }

    /// Velocity of the object's middle in a state of this track; `None` where it is not worth stating.
    pub(crate) fn velocity_of_middle(&self, state: &MotionState) -> Option<PointVelocity> {
        let velocity = state.velocity_of(&(self.reference.origin + self.reference.radius * self.map.middle().coords));
        let span = self.belief.memory.shortest(self.belief.parameter_count());
        let worth = |deviation: &f64| self.is_worth(*deviation, span, self.reference.radius);
        velocity.standard_deviations().iter().all(worth).then_some(velocity)
    }

    /// The largest difference of a parameter of two motions, in standard deviations; normalised.
    pub(crate) fn in_deviations(&self, a: &ParameterVector, b: &ParameterVector) -> Option<f64> {
        let k = self.belief.parameter_count();
        let covariance = self.belief.covariance_of(&self.belief.marginal, self.noise.effective_variance())?;
        let differences = (0..k).map(|j| (a[j] - b[j]).abs() / covariance[(k + j, k + j)].sqrt());
        Some(differences.fold(0.0, f64::max))
    }

    /// Whether the standard deviation of a rate, over the time that it is known from, makes little of a displacement.
    fn is_worth(&self, deviation: f64, span: f64, displacement: f64) -> bool {
        let memory = &self.belief.memory;
        is_worth(deviation, span.max(memory.span.min(STEPS_KNOWN * memory.step)), displacement)
    }

    /// Parameters, in image units, that take part in a motion which the outline does not show. The velocity at the origin of the image is
    /// one of them wherever the middle of a turn that is not seen is not there.
    fn blind_parameters(&self) -> [bool; MAX_PARAMETERS] {
        let mut blind = [false; MAX_PARAMETERS];
        let (model, radius) = (self.belief.model, self.reference.radius);
        let to_image = self.reference.to_image();
        let Some(inverse) = to_image.try_inverse() else { return blind };
        for null in self.map.null_directions(model, &self.belief.pose) {
            let generator = to_image * model.generator(&null.direction[..model.parameter_count()]) * inverse;
            let direction = model.parameters_of(&generator);
            // In units of the object, so that lengths and angles compare.
            let sizes = direction.iter().zip(model.parameter_kinds()).map(|(entry, kind)| match kind {
                ParameterKind::Rate => entry.abs(),
                ParameterKind::Velocity => entry.abs() / radius,
                ParameterKind::Perspective => entry.abs() * radius,
            });
            let sizes: Vec<f64> = sizes.collect();
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            for (blind, size) in blind.iter_mut().zip(sizes) {
                *blind |= size > TAKES_PART * largest;
            }
        }
        blind
    }
}
