use freeform_estimate::TimeNotIncreasing;
use freeform_riccati::MotionModel;

/// Why a baseline could not be made or could not take a frame. Frames that merely do not fit are no errors.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BaselineError {
    /// Area moments up to the third order do not fix a pose of this model.
    #[error("area moments have no pose of {model} motion")]
    UnsupportedModel {
        /// The model asked for.
        model: MotionModel,
    },
    /// Times must be finite and increase.
    #[error(transparent)]
    TimeNotIncreasing(#[from] TimeNotIncreasing),
}
