use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, ParameterVector};
use nalgebra::{DMatrix, DVector, Matrix3, Point2, Projective2};

use crate::{motion_estimate::MotionEstimate, process_noise::ProcessNoise};

/// Pose and motion of an object at one time, with their joint covariance.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionState {
    pub(crate) model: MotionModel,
    pub(crate) time: f64,
    /// Centre and RMS radius of the first outline, which all below is normalised by.
    pub(crate) origin: Point2<f64>,
    pub(crate) radius: f64,
    pub(crate) pose: Matrix3<f64>,
    pub(crate) motion: ParameterVector,
    /// Of the pose error xi, `g = exp(xi) g_hat`, then the motion; counted from the body frame.
    pub(crate) covariance: DMatrix<f64>,
    /// Of where that lies beside the outline, as a pose error.
    pub(crate) body_frame: DMatrix<f64>,
    /// This covariance if the outline is known exactly.
    pub(crate) within: DMatrix<f64>,
    pub(crate) observable: [bool; MAX_PARAMETERS],
    pub(crate) hidden: [bool; MAX_PARAMETERS],
    pub(crate) centroid: Point2<f64>,
}

/// One parameter of a pose with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseParameter {
    /// Name: see [`MotionState::pose_parameters`].
    pub name: &'static str,
    /// Value; NaN where the outline does not show it, such as the turn of a circle, and where the turn is ambiguous.
    pub value: f64,
    /// Its standard deviation; infinite where there is no value.
    pub standard_deviation: f64,
}

/// The propagation of the errors of pose and motion over a step.
pub(crate) struct Transition {
    pub(crate) flow: Matrix3<f64>,
    /// `F = [[Ad, V], [0, I]]`.
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) inverse: DMatrix<f64>,
    /// Covariance that is added.
    pub(crate) noise: DMatrix<f64>,
}

/// The parts of a [`MotionState`], in coordinates centred on the first outline and divided by its radius.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalisedState {
    /// The motion model, of k parameters.
    pub model: MotionModel,
    /// Time in seconds.
    pub time: f64,
    /// Centre of the first outline, image coordinates.
    pub origin: Point2<f64>,
    /// RMS radius of the first outline, image lengths.
    pub radius: f64,
    /// Map of the plane from the first outline to its present place.
    pub pose: Matrix3<f64>,
    /// Motion parameters, zeros behind the first k.
    pub motion: ParameterVector,
    /// Covariance of the pose error xi, `g = exp(xi) g_hat`, then the motion, counted from the body frame: 2 k by 2 k.
    pub covariance: DMatrix<f64>,
    /// Covariance of where the body frame lies beside the outline as it is known at that time, as a pose error: k by k. Every pose has this error as
    /// well, in common; no motion has it, nor does the velocity of the middle, which is where the outline is.
    pub body_frame: DMatrix<f64>,
    /// This covariance if the outline is known exactly.
    pub covariance_given_outline: DMatrix<f64>,
    /// Which parameters of the motion are observable.
    pub observable: [bool; MAX_PARAMETERS],
    /// Rates that the outline does not show, such as that of the turn of a circle, or that are ambiguous: nor is it known how far the object has
    /// turned.
    /// Of projective motion also the perspective, where it takes part in what the outline does not show. Velocities along axes on which the
    /// outline does not show where the centroid is, as a straight edge does not along itself.
    pub hidden: [bool; MAX_PARAMETERS],
    /// Centroid of the object in the body frame, normalised: what turns without being seen turns about it.
    pub centroid: Point2<f64>,
}

impl From<NormalisedState> for MotionState {
    fn from(state: NormalisedState) -> Self {
        let NormalisedState {
            model,
            time,
            origin,
            radius,
            pose,
            motion,
            covariance,
            body_frame,
            observable,
            hidden,
            centroid,
            covariance_given_outline: within,
        } = state;
        Self { model, time, origin, radius, pose, motion, covariance, body_frame, within, observable, hidden, centroid }
    }
}

impl MotionState {
    /// The motion model.
    #[must_use]
    pub fn model(&self) -> MotionModel {
        self.model
    }

    /// Time in seconds.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The map of the image from the first outline to its present place.
    #[must_use]
    pub fn pose(&self) -> Projective2<f64> {
        let to_image = self.to_image();
        let from_image = to_image.try_inverse().unwrap_or_else(Matrix3::identity);
        Projective2::from_matrix_unchecked(to_image * self.pose * from_image)
    }

    /// The motion at that time, image units, with standard deviations.
    #[must_use]
    pub fn motion(&self) -> MotionEstimate {
        let k = self.model.parameter_count();
        let to_image = self.to_image();
        let from_image = to_image.try_inverse().unwrap_or_else(Matrix3::identity);
        let generator = to_image * self.model.generator(&self.motion[..k]) * from_image;
        let values = self.model.parameters_of(&generator);
        let covariance = self.covariance();
        let deviations: Vec<f64> = (k..2 * k).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
        let estimate = MotionEstimate::new(self.model, &values[..k], Some(&deviations));
        (0..k).filter(|j| !self.observable[*j]).fold(estimate, MotionEstimate::with_unobservable)
    }

    /// Covariance of the pose error xi and the motion, each in the order of the parameters, image units. The error of the pose is on
    /// the left: with the generator X of the parameters xi, the true pose is `expm(X)` after the estimated one.
    #[must_use]
    pub fn covariance(&self) -> DMatrix<f64> {
        let k = self.model.parameter_count();
        let to_image = self.to_image();
        let from_image = to_image.try_inverse().unwrap_or_else(Matrix3::identity);
        let change = self.model.adjoint(&to_image, &from_image);
        let change = DMatrix::from_fn(2 * k, 2 * k, |i, j| if (i < k) == (j < k) { change[i % k][j % k] } else { 0.0 });
        &change * self.with_body_frame() * change.transpose()
    }

    /// The pose as numbers. First its linear part, rigid: `angle`; similarity: `scale`, `angle`; affine and projective: `m11`, `m12`,
    /// `m21`, `m22`; then `x` and `y`, where the centre of the first outline (the mean of its points) is now, image lengths;
    /// projective also `m31`, `m32` per length, at m33 = 1 and with that centre for origin. The angle is the turn since the first frame in rad
    /// between -pi and pi, positive where omega is. What the outline does not show is NaN: also `x` or `y`, where a straight edge may have gone along
    /// itself. Where a turn is not shown, that centre, if it is not the centroid of the object, is less certain.
    #[must_use]
    pub fn pose_parameters(&self) -> Vec<PoseParameter> {
        let k = self.model.parameter_count();
        let g = self.pose / self.pose[(2, 2)];
        // Derivatives of the entries by the pose error.
        let basis = self.model.basis();
        let rates: Vec<Matrix3<f64>> = basis
            .iter()
            .map(|e| {
                let d = e * g;
                d - g * d[(2, 2)]
            })
            .collect();
        let covariance = self.covariance.view((0, 0), (k, k)) + &self.body_frame;
        let parameter = |name, value: f64, by_entry: &dyn Fn(&Matrix3<f64>) -> f64| {
            let slope = DVector::from_iterator(k, rates.iter().map(by_entry));
            let variance = (slope.transpose() * &covariance * &slope)[(0, 0)];
            PoseParameter { name, value, standard_deviation: variance.max(0.0).sqrt() }
        };
        let entry = |name, i, j, unit: f64| parameter(name, g[(i, j)] * unit, &|d| d[(i, j)] * unit);
        let (c, s) = (0.5 * (g[(0, 0)] + g[(1, 1)]), 0.5 * (g[(0, 1)] - g[(1, 0)]));
        let turned = |d: &Matrix3<f64>| (0.5 * (d[(0, 0)] + d[(1, 1)]), 0.5 * (d[(0, 1)] - d[(1, 0)]));
        let scale = c.hypot(s);
        let angle = || {
            parameter("angle", s.atan2(c), &|d| {
                let (dc, ds) = turned(d);
                (c * ds - s * dc) / (scale * scale)
            })
        };
        let mut list = match self.model {
            MotionModel::Rigid => vec![angle()],
            MotionModel::Similarity => {
                let growth = |d: &Matrix3<f64>| {
                    let (dc, ds) = turned(d);
                    (c * dc + s * ds) / scale
                };
                vec![parameter("scale", scale, &growth), angle()]
            }
            _ => [("m11", 0, 0), ("m12", 0, 1), ("m21", 1, 0), ("m22", 1, 1)]
                .map(|(name, i, j)| entry(name, i, j, 1.0))
                .to_vec(),
        };
        // Of a rigid motion or a similarity every number has a rate of its own.
        let is_one_by_one = self.model <= MotionModel::Similarity;
        let is_hidden = |of: ParameterKind| {
            let kinds = self.model.parameter_kinds().iter();
            kinds.zip(self.hidden).any(|(kind, hidden)| *kind == of && hidden)
        };
        let is_perspective_hidden = is_hidden(ParameterKind::Perspective);
        let is_any_hidden = is_hidden(ParameterKind::Rate) || is_perspective_hidden;
        for (parameter, rate_is_hidden) in list.iter_mut().zip(self.hidden) {
            if rate_is_hidden || is_any_hidden && !is_one_by_one {
                (parameter.value, parameter.standard_deviation) = (f64::NAN, f64::INFINITY);
            }
        }
        // Turned about the centroid by any angle a point moves by sqrt(2) times its distance, root mean square over both coordinates.
        let lever = self.radius * (g.fixed_view::<2, 2>(0, 0) * self.centroid.coords).norm();
        let by_unseen_turn = if is_any_hidden { lever } else { 0.0 };
        // A perspective that is not seen, such as that of an ellipse, puts another point of the body there.
        let size = self.radius * g.fixed_view::<2, 2>(0, 0).norm();
        let by_unseen_perspective = if is_perspective_hidden { size } else { 0.0 };
        let velocity = self.model.parameter_kinds().iter().position(|kind| *kind == ParameterKind::Velocity);
        for (name, row, start) in [("x", 0, self.origin.x), ("y", 1, self.origin.y)] {
            let mut at = entry(name, row, 2, self.radius);
            at.value += start;
            at.standard_deviation = at.standard_deviation.hypot(by_unseen_turn).hypot(by_unseen_perspective);
            if velocity.is_some_and(|first| self.hidden[first + row]) {
                (at.value, at.standard_deviation) = (f64::NAN, f64::INFINITY);
            }
            list.push(at);
        }
        if self.model == MotionModel::Projective {
            list.extend([("m31", 0), ("m32", 1)].map(|(name, j)| {
                let shown = entry(name, 2, j, 1.0 / self.radius);
                let unseen = PoseParameter { name, value: f64::NAN, standard_deviation: f64::INFINITY };
                // Another turn gives the body another perspective, too.
                if is_any_hidden { unseen } else { shown }
            }));
        }
        list
    }

    /// The state predicted for another time, in seconds, with process noise on the motion in between.
    #[must_use]
    pub fn predicted(&self, time: f64, noise: &ProcessNoise) -> Self {
        let Transition { flow, matrix, noise, .. } = self.transition(time - self.time, noise);
        let later = |p: &DMatrix<f64>| &matrix * p * matrix.transpose() + &noise;
        let (covariance, within) = (later(&self.covariance), later(&self.within));
        let k = self.model.parameter_count();
        let moved = matrix.view((0, 0), (k, k));
        let body_frame = moved * &self.body_frame * moved.transpose();
        Self { time, pose: flow * self.pose, covariance, body_frame, within, ..self.clone() }
    }

    /// The covariance of pose and motion with that of the body frame.
    pub(crate) fn with_body_frame(&self) -> DMatrix<f64> {
        let mut covariance = self.covariance.clone();
        let k = self.model.parameter_count();
        let mut of_pose = covariance.view_mut((0, 0), (k, k));
        of_pose += &self.body_frame;
        covariance
    }

    pub(crate) fn transition(&self, seconds: f64, noise: &ProcessNoise) -> Transition {
        let (model, k) = (self.model, self.model.parameter_count());
        let theta = &self.motion[..k];
        let flow = model.flow(theta, seconds).into_inner();
        let back = model.flow(theta, -seconds).into_inner();
        let by_motion = model.parameter_columns(model.flow_sensitivities(theta, seconds).into_iter());
        let (ad, ad_back) = (model.adjoint(&flow, &back), model.adjoint(&back, &flow));
        let mut matrix = DMatrix::identity(2 * k, 2 * k);
        let mut inverse = DMatrix::identity(2 * k, 2 * k);
        for i in 0..k {
            for j in 0..k {
                matrix[(i, j)] = ad[i][j];
                matrix[(i, k + j)] = by_motion[i][j];
                inverse[(i, j)] = ad_back[i][j];
                inverse[(i, k + j)] = -(0..k).map(|m| ad_back[i][m] * by_motion[m][j]).sum::<f64>();
            }
        }
        let mut added = DMatrix::zeros(2 * k, 2 * k);
        for (j, variance) in noise.variances(model, self.radius).into_iter().enumerate().take(k) {
            added[(k + j, k + j)] = variance * seconds.abs();
        }
        Transition { flow, matrix, inverse, noise: added }
    }

    fn to_image(&self) -> Matrix3<f64> {
        let (r, o) = (self.radius, self.origin);
        Matrix3::new(r, 0.0, o.x, 0.0, r, o.y, 0.0, 0.0, 1.0)
    }
}
