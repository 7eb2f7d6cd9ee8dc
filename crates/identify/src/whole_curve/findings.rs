//! What the filter has found.
use freeform_curve_fit::{ImplicitPolynomial, MAX_COEFFICIENTS};
use freeform_riccati::Transport;
use nalgebra::{DMatrix, Matrix3, Projective2};

use super::{filter::WholeCurveFilter, settings::CurveFilterSettings};
use crate::{
    estimate::{MAX_PARAMETERS, MotionEstimate},
    filter::Phase,
    motion_algebra::{adjoint, coordinates},
    motion_state::MotionState,
    observability::judged,
};

impl WholeCurveFilter {
    /// Normalised coordinates to image coordinates.
    fn to_image(&self) -> Matrix3<f64> {
        let (r, o) = (self.radius, self.origin);
        Matrix3::new(r, 0.0, o.x, 0.0, r, o.y, 0.0, 0.0, 1.0)
    }

    /// Covariance of the motion parameters in the order of the model, image units; `None` before the second accepted frame.
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        if matches!(self.phase, Phase::Waiting | Phase::Acquiring) {
            return None;
        }
        let k = self.settings.model.parameter_count();
        let to_image = self.to_image();
        let change = adjoint(self.settings.model, &to_image, &to_image.try_inverse()?);
        let change = DMatrix::from_fn(k, k, |i, j| change[i][j]);
        let whole = self.certainty.covariance()?;
        let motion = DMatrix::from_fn(k, k, |i, j| whole[k + i][k + j]);
        Some(&change * motion * change.transpose())
    }

    /// The motion in image units, with standard deviations, as far as it is known; `None` before the second accepted frame. A parameter
    /// whose standard deviation, over the time seen so far, would turn the object by a quarter of a radian or move it by a
    /// quarter of its size and distance from the origin is marked as unobservable.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        let covariance = self.covariance()?;
        let model = self.settings.model;
        let k = model.parameter_count();
        let to_image = self.to_image();
        let generator = to_image * model.generator(&self.motion[..k]) * to_image.try_inverse()?;
        let values = coordinates(model, &generator);
        let deviations: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        let reach = self.radius + self.origin.coords.norm();
        Some(judged(model, &values[..k], &deviations, reach, self.span, &self.settings.process_noise))
    }

    /// The map of the image that has moved the curve of the first frame to where it was in the last frame accepted, or is
    /// predicted after rejected ones; `None` before the first frame.
    #[must_use]
    pub fn pose(&self) -> Option<Projective2<f64>> {
        let to_image = self.to_image();
        let pose = to_image * self.pose * to_image.try_inverse()?;
        (self.phase != Phase::Waiting).then(|| Projective2::from_matrix_unchecked(pose))
    }

    /// Pose and motion with their joint covariance, at the time that they stand at: that of the last frame accepted, or rejected while
    /// tracking. The pose is that of the curve; its error in the first frame goes for all. `None` wherever
    /// [`estimate`](Self::estimate) is.
    #[must_use]
    pub fn state(&self) -> Option<MotionState> {
        let estimate = self.estimate()?;
        let (model, k) = (self.settings.model, self.settings.model.parameter_count());
        let whole = self.certainty.covariance()?;
        // From errors of the pose seen from the body to those seen in the image.
        let to_image = adjoint(model, &self.pose, &self.pose.try_inverse()?);
        let change = DMatrix::from_fn(2 * k, 2 * k, |i, j| match (i < k, j < k) {
            (true, true) => to_image[i][j],
            _ => f64::from(u8::from(i == j)),
        });
        let covariance = DMatrix::from_fn(2 * k, 2 * k, |i, j| whole[i][j]);
        let covariance = &change * covariance * change.transpose();
        let mut observable = [false; MAX_PARAMETERS];
        observable.iter_mut().zip(estimate.parameters()).for_each(|(seen, p)| *seen = p.value.is_some());
        Some(MotionState {
            model,
            time: self.state_time,
            origin: self.origin,
            radius: self.radius,
            pose: self.pose,
            motion: self.motion,
            within: covariance.clone(),
            covariance,
            observable,
        })
    }

    /// The curve where it is now, image coordinates; negative inside, about -1 and 1 at the level-set offset. `None` before the first
    /// frame. Far from the origin its coefficients alone lose digits.
    #[must_use]
    pub fn curve(&self) -> Option<ImplicitPolynomial> {
        let degree = self.settings.degree;
        let n = degree.coefficient_count();
        if self.phase == Phase::Waiting {
            return None;
        }
        let inverse = (self.to_image() * self.pose).try_inverse()?;
        let mut moved = [0.0; MAX_COEFFICIENTS];
        Transport::from_inverse(degree, &inverse).apply(&self.coefficients[..n], &mut moved[..n]);
        ImplicitPolynomial::new(degree, &moved[..n]).ok()
    }

    /// Standard deviation of the noise along the normals, as the first frames show it, image lengths; what the outline bends between
    /// neighbouring points is in it.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.certainty.noise() * self.radius
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &CurveFilterSettings {
        &self.settings
    }

    /// What the filter is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Frames used.
    #[must_use]
    pub fn frames_accepted(&self) -> usize {
        self.accepted
    }

    /// Frames that did not fit, one that a new curve was begun from after others among them.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.rejected
    }

    /// Times the filter has given up an object and begun anew.
    #[must_use]
    pub fn restarts(&self) -> usize {
        self.restarts
    }
}
