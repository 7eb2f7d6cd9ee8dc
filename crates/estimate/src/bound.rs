use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{DMatrix, DVector, Matrix3, Point2, Vector2};

use crate::information::{InverseInformation, invert_information};

/// Why a [`CramerRaoBound`] cannot be given.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BoundError {
    /// Wrong number of motion parameters.
    #[error("{found} motion parameters where the model has {needed}")]
    ParameterCount {
        /// Parameters given.
        found: usize,
        /// Parameters of the model.
        needed: usize,
    },
    /// A motion parameter is not finite.
    #[error("motion parameter {index} is {value}")]
    ParameterNotFinite {
        /// Its position.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The noise is not positive and finite.
    #[error("noise of {value} where a positive number is needed")]
    Noise {
        /// Standard deviation given.
        value: f64,
    },
    /// A time or weight that is not finite, or one at which the motion overflows.
    #[error("a frame at {time} s with weight {weight} tells nothing")]
    Frame {
        /// Time of the frame in seconds.
        time: f64,
        /// Weight given.
        weight: f64,
    },
    /// Points or motion overflow.
    #[error("the information is not finite")]
    InformationNotFinite,
}

/// A point of the boundary in the image, and the unit normal there (of either sign).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryPoint {
    /// The point, image lengths.
    pub point: Point2<f64>,
    /// Unit normal of the boundary in the image.
    pub normal: Vector2<f64>,
}

/// The Cramer-Rao bound of motion identification from outlines: no unbiased estimator of a constant motion has a smaller
/// covariance, the shape being known and the initial pose not.
///
/// A boundary point seen with isotropic noise sigma informs only along its normal, so the Fisher information is `J = sum g
/// g' / sigma^2` with g the derivative of the normal displacement by the pose at time 0 and the motion parameters. The
/// bound is the block of `J^-1` of the motion. It holds for points drawn independently along the outline; regular
/// spacing can beat it slightly.
///
/// ```
/// use freeform_estimate::{BoundaryPoint, CramerRaoBound};
/// use freeform_riccati::MotionModel;
/// use nalgebra::{Point2, Vector2};
///
/// // How well can 30 frames a second of 300 points with noise 0.005 tell how fast an ellipse turns, after one second?
/// let omega = 0.5;
/// let mut bound = CramerRaoBound::new(MotionModel::Rigid, &[omega, 0.0, 0.0])?;
/// for frame in 0..30 {
///     let time = f64::from(frame) / 30.0;
///     let pose = MotionModel::Rigid.flow(&[omega, 0.0, 0.0], time);
///     let points = (0..300).map(|i| {
///         let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///         let normal = Vector2::new(0.3 * t.cos(), 0.5 * t.sin()).normalize();
///         BoundaryPoint { point: pose * Point2::new(0.5 * t.cos(), 0.3 * t.sin()), normal: pose.matrix().fixed_view::<2, 2>(0, 0) * normal }
///     });
///     bound.add_frame(time, points, 0.005, 1.0)?;
/// }
/// let covariance = bound.covariance()?;
/// let of_omega = covariance.standard_deviations().next().flatten().expect("an ellipse is not round");
/// // The noise over the root of the squared levers of a frame, 6.0, times the squared times from their mean, 2.497.
/// assert!((of_omega - 0.005 / f64::sqrt(6.0 * 2.497)).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CramerRaoBound {
    model: MotionModel,
    parameters: Vec<f64>,
    /// Over the initial pose, then the motion.
    information: DMatrix<f64>,
}

/// Covariance of the motion parameters, and the directions in parameter space that are not observable.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundCovariance {
    /// Smallest covariance of the parameters, in the order of the model, in their units; as if unobservable directions
    /// were known.
    pub covariance: DMatrix<f64>,
    /// Whether each parameter is observable: no direction without information touches it.
    pub observable: Vec<bool>,
    /// Number of directions of pose and motion together that carry information, at most twice the number of parameters.
    pub rank: usize,
}

impl CramerRaoBound {
    /// A bound without any frame yet, at the true motion `parameters` (in the order of the model).
    ///
    /// # Errors
    /// The number of parameters is not that of the model, or one is not finite.
    pub fn new(model: MotionModel, parameters: &[f64]) -> Result<Self, BoundError> {
        let needed = model.parameter_count();
        if parameters.len() != needed {
            return Err(BoundError::ParameterCount { found: parameters.len(), needed });
        }
        if let Some(index) = parameters.iter().position(|value| !value.is_finite()) {
            return Err(BoundError::ParameterNotFinite { index, value: parameters[index] });
        }
        let information = DMatrix::zeros(2 * needed, 2 * needed);
        Ok(Self { model, parameters: parameters.to_vec(), information })
    }

    /// Adds the boundary points seen at a time in seconds, each with noise of standard deviation `noise` in every direction.
    /// Points may be more or fewer than those really taken: `weight` is how many observations each stands for.
    ///
    /// # Errors
    /// Noise that is not positive, a time or weight that is not finite.
    pub fn add_frame(
        &mut self,
        time: f64,
        points: impl IntoIterator<Item = BoundaryPoint>,
        noise: f64,
        weight: f64,
    ) -> Result<(), BoundError> {
        check_frame(time, noise, weight)?;
        let (model, k) = (self.model, self.parameters.len());
        let flow = model.flow(&self.parameters, time).into_inner();
        let inverse = flow.try_inverse().ok_or(BoundError::Frame { time, weight })?;
        let by_pose = model.adjoint(&flow, &inverse);
        let sensitivities: [Matrix3<f64>; MAX_PARAMETERS] = model.flow_sensitivities(&self.parameters, time);
        let by_motion = model.parameter_columns(sensitivities.into_iter());
        let mut g = DVector::zeros(2 * k);
        let scale = weight / (noise * noise);
        for BoundaryPoint { point, normal } in points {
            let velocities = model.normal_velocities(&point, &normal);
            for j in 0..k {
                g[j] = (0..k).map(|i| velocities[i] * by_pose[i][j]).sum();
                g[k + j] = (0..k).map(|i| velocities[i] * by_motion[i][j]).sum();
            }
            self.information.ger(scale, &g, &g, 1.0);
        }
        Ok(())
    }

    /// The Fisher information of the initial pose and the motion, in this order.
    #[must_use]
    pub fn information(&self) -> &DMatrix<f64> {
        &self.information
    }

    /// The bound from the frames so far.
    ///
    /// # Errors
    /// The information is not finite.
    pub fn covariance(&self) -> Result<BoundCovariance, BoundError> {
        BoundCovariance::of_motion(&self.information, self.parameters.len())
    }
}

/// Refuses what a frame cannot have.
pub(crate) fn check_frame(time: f64, noise: f64, weight: f64) -> Result<(), BoundError> {
    if !(noise.is_finite() && noise > 0.0) {
        return Err(BoundError::Noise { value: noise });
    }
    if !(time.is_finite() && weight.is_finite() && weight >= 0.0) {
        return Err(BoundError::Frame { time, weight });
    }
    Ok(())
}

impl BoundCovariance {
    /// That of the motion, from the information of the initial pose, which has so many parameters, and the motion.
    pub(crate) fn of_motion(information: &DMatrix<f64>, pose: usize) -> Result<Self, BoundError> {
        if information.iter().any(|e| !e.is_finite()) {
            return Err(BoundError::InformationNotFinite);
        }
        let InverseInformation { covariance, observable, rank } = invert_information(information);
        let size = information.nrows() - pose;
        let covariance = covariance.view((pose, pose), (size, size)).into_owned();
        Ok(Self { covariance, observable: observable[pose..].to_vec(), rank })
    }

    /// Smallest standard deviation of each parameter, `None` where it is not observable.
    pub fn standard_deviations(&self) -> impl Iterator<Item = Option<f64>> + '_ {
        let diagonal = self.covariance.diagonal();
        self.observable.iter().enumerate().map(move |(i, seen)| seen.then(|| diagonal[i].max(0.0).sqrt()))
    }
}
