use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use nalgebra::{DMatrix, Matrix3};

use super::{Arrowhead, StateMatrix, scaled_inverse};

/// Pose, motion and offsets of one object with the information on them, in normalised coordinates: centred on the first outline and
/// divided by its RMS radius. Cheap to clone beside the map, which it does not hold.
///
/// The error of the pose is on the left: with the generator X of the error xi, the true pose is `expm(X)` after the one held.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Belief {
    pub(crate) model: MotionModel,
    /// Body to image.
    pub(crate) pose: Matrix3<f64>,
    pub(crate) motion: ParameterVector,
    /// Signed distance of the outline from the centre of each cell along its normal.
    pub(crate) offsets: Vec<f64>,
    /// In units of the noise.
    pub(crate) information: Arrowhead,
    /// Of pose and motion with the offsets eliminated.
    pub(crate) marginal: StateMatrix,
    pub(crate) memory: Memory,
    pub(crate) earlier_poses: EarlierPoses,
}

/// How long ago what is known of the motion goes back to.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Memory {
    /// Seconds of the last prediction.
    pub(crate) step: f64,
    /// Seconds predicted over since the motion was last unknown.
    pub(crate) span: f64,
    /// Of the span, seconds up to the last frame that was taken.
    pub(crate) told: f64,
    /// Of the span, seconds up to the first of them that has told something of the motion.
    pub(crate) first: f64,
    /// Effective memory: seconds of the past that each parameter is known from, the span, or, where the motion changes, what of it is
    /// not forgotten.
    pub(crate) effective: ParameterVector,
}

/// Whether the poses of earlier frames are known beside the present one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum EarlierPoses {
    Known,
    /// They are off by what nobody knows: something of them was forgotten as the map grew.
    Forgotten,
}

impl Belief {
    /// Nothing known, in the body frame.
    pub(crate) fn new(model: MotionModel) -> Self {
        let information = Arrowhead::new(model.parameter_count());
        Self {
            model,
            pose: Matrix3::identity(),
            motion: [0.0; MAX_PARAMETERS],
            offsets: Vec::new(),
            marginal: information.marginal(),
            information,
            memory: Memory::default(),
            earlier_poses: EarlierPoses::Known,
        }
    }

    /// Number of parameters k.
    pub(crate) fn parameter_count(&self) -> usize {
        self.information.k
    }

    /// Scale of lengths from the body frame to the image.
    pub(crate) fn scale(&self) -> f64 {
        self.pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt()
    }

    /// Covariance of pose and motion from an information matrix in units of `variance`; `None` where it cannot be computed.
    pub(crate) fn covariance_of(&self, information: &StateMatrix, variance: f64) -> Option<DMatrix<f64>> {
        let k = self.information.k;
        let inverse = scaled_inverse(information, k)? * variance;
        inverse.iter().all(|e| e.is_finite()).then(|| DMatrix::from_fn(2 * k, 2 * k, |i, j| inverse[(i, j)]))
    }
}

impl Memory {
    /// Moves on by `seconds`.
    pub(crate) fn advance(&mut self, seconds: f64) {
        self.span += seconds;
        self.effective.iter_mut().for_each(|span| *span += seconds);
        self.step = seconds;
    }

    /// Records that a frame has been taken.
    pub(crate) fn take_frame(&mut self) {
        if self.told <= 0.0 {
            self.first = self.span;
        }
        self.told = self.span;
    }

    /// Whether no more than one step has been measured.
    pub(crate) fn is_of_one_step(&self) -> bool {
        self.told <= self.first
    }

    /// Steps predicted over, as long as the one measured, since the middle of that one, of which it says the mean motion.
    pub(crate) fn steps_since_middle(&self) -> f64 {
        if self.told > 0.0 { self.span / self.told - 0.5 } else { 0.5 }
    }

    /// Effective memory of what takes part in all of k parameters.
    pub(crate) fn shortest(&self, k: usize) -> f64 {
        self.effective[..k].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        (self.span, self.told, self.first) = (0.0, 0.0, 0.0);
        self.effective = [0.0; MAX_PARAMETERS];
    }
}

#[cfg(feature = "serde")]
impl Belief {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_valid(&self, cells: usize) -> bool {
        let Arrowhead { k, dense, cells: information } = &self.information;
        let Memory { step, span, told, first, effective } = self.memory;
        let numbers = self.pose.iter().chain(&self.motion).chain(&self.offsets).chain(dense.iter().flatten());
        let numbers = numbers.chain(&self.marginal).chain([&step, &span, &told, &first]);
        *k == self.model.parameter_count()
            && self.offsets.len() == cells
            && information.is_valid(cells, 2 * k)
            && numbers.into_iter().all(|number| number.is_finite())
            && !effective.iter().any(|seconds| seconds.is_nan())
            && self.pose.try_inverse().is_some()
    }
}
