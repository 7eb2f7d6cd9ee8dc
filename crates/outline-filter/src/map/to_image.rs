//! Directions of the pose taken from the body frame to the image.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterMatrix, ParameterVector};
use nalgebra::{Matrix3, SMatrix};

use super::NullDirection;

/// Takes directions of the body frame to the image, and duals there from centred coordinates, of a model with k parameters.
pub(super) struct ToImage {
    k: usize,
    adjoint: ParameterMatrix,
    of_inverse: ParameterMatrix,
    of_centring: ParameterMatrix,
}

impl ToImage {
    /// For a pose, and centred coordinates that `frame` takes to the body frame; `None` where one of them has no inverse.
    pub(super) fn of(model: MotionModel, pose: &Matrix3<f64>, frame: &Matrix3<f64>) -> Option<Self> {
        let (inverse, from_body) = (pose.try_inverse()?, frame.try_inverse()?);
        Some(Self {
            k: model.parameter_count(),
            adjoint: model.adjoint(pose, &inverse),
            of_inverse: model.adjoint(&inverse, pose),
            of_centring: model.adjoint(&from_body, frame),
        })
    }

    /// A direction of the body frame in centred coordinates.
    pub(super) fn centred(&self, in_body: &ParameterVector) -> ParameterVector {
        let mut centred = [0.0; MAX_PARAMETERS];
        for (entry, row) in centred.iter_mut().zip(&self.of_centring).take(self.k) {
            *entry = (0..self.k).map(|j| row[j] * in_body[j]).sum();
        }
        centred
    }

    /// The covariance of an error of the pose in the body frame, in centred coordinates.
    pub(super) fn centred_covariance(
        &self,
        in_body: &SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    ) -> SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS> {
        let change = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| self.of_centring[i][j]);
        change * in_body * change.transpose()
    }

    /// A direction of the body frame in the image, with the dual that has these entries in centred coordinates.
    pub(super) fn direction(&self, in_body: &ParameterVector, dual_of_centred: &ParameterVector) -> NullDirection {
        let (k, mut null) = (self.k, NullDirection::default());
        let mut dual_in_body = [0.0; MAX_PARAMETERS];
        for i in 0..k {
            null.direction[i] = (0..k).map(|j| self.adjoint[i][j] * in_body[j]).sum();
        }
        for (j, entry) in dual_in_body.iter_mut().enumerate().take(k) {
            *entry = (0..k).map(|i| dual_of_centred[i] * self.of_centring[i][j]).sum();
        }
        for j in 0..k {
            null.dual[j] = (0..k).map(|i| dual_in_body[i] * self.of_inverse[i][j]).sum();
        }
        null
    }
}
