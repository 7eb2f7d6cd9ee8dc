use freeform_estimate::MotionEstimate;
use freeform_identify::AdaptiveDiagnostics;
use nalgebra::Affine2;

/// What the adaptive law is doing after a frame, for those who study it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveProgress {
    /// Error of the estimator, its energy, and the excitation.
    pub diagnostics: AdaptiveDiagnostics,
    /// The motion as identified so far, in the coordinates of the identifier.
    pub estimate: MotionEstimate,
    /// From the image to the coordinates of the identifier.
    pub identifier_from_image: Affine2<f64>,
}

impl AdaptiveProgress {
    /// The Lyapunov function `sum e' P e + |theta - theta_true|^2` of the structured law, given the true motion in the image, in the
    /// coordinates of the identifier. Of exact lines it never grows; it jumps where the origin of the coordinates is moved.
    ///
    /// For the other laws it is a sum of the same terms, of which that is not claimed. The truth has to be of the same motion model.
    ///
    /// # Panics
    /// If the truth has standard deviations.
    #[must_use]
    pub fn lyapunov_function(&self, truth: &MotionEstimate) -> f64 {
        let truth = truth.in_coordinates(&self.identifier_from_image);
        let errors = self.estimate.values().iter().zip(truth.values()).map(|(found, true_value)| found - true_value);
        self.diagnostics.energy + errors.map(|error| error * error).sum::<f64>()
    }
}
