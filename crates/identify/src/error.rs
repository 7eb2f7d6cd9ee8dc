use freeform_estimate::TimeNotIncreasing;
use freeform_riccati::MotionModel;
use thiserror::Error;

/// Why an identifier could not be made, or could not take a frame.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum IdentifyError {
    /// The stability matrix has an eigenvalue that does not decay.
    #[error("the stability matrix has an eigenvalue with real part {real_part}, which is not negative")]
    NotStable {
        /// Largest real part of its eigenvalues.
        real_part: f64,
    },
    /// The matrix Q of the Lyapunov equation is not symmetric and positive definite.
    #[error("the matrix Q is not symmetric positive definite (smallest eigenvalue {smallest})")]
    NotPositiveDefinite {
        /// Smallest eigenvalue of its symmetric part; NaN entries give NaN.
        smallest: f64,
    },
    /// The law has no form for the motion model: equation 19 has no terms for projective motion.
    #[error("the printed law has no form for {model} motion")]
    UnsupportedModel {
        /// The model asked for.
        model: MotionModel,
    },
    /// The list of initial values does not fit the motion model.
    #[error("as many initial values as parameters are needed: {needed}, not {found}")]
    WrongInitialValueCount {
        /// Number of parameters.
        needed: usize,
        /// Values given.
        found: usize,
    },
    /// An initial value is NaN or infinite.
    #[error("initial value {index} is not finite")]
    InitialValueNotFinite {
        /// Position in the list, counted from 0.
        index: usize,
    },
    /// The pair asked for is not there.
    #[error("there is no pair {index}, the curve has {count}")]
    NoSuchPair {
        /// Position asked for, counted from 0.
        index: usize,
        /// Pairs of the curve.
        count: usize,
    },
    /// More pairs than a curve can have.
    #[error("{found} line pairs, at most {limit} can be followed")]
    TooManyPairs {
        /// Pairs given.
        found: usize,
        /// Pairs of an octic.
        limit: usize,
    },
    /// A line has a coordinate that is NaN or infinite.
    #[error("the line of pair {pair} is not finite")]
    LineNotFinite {
        /// Which pair, counted from 0.
        pair: usize,
    },
    /// The number of line pairs changed between frames.
    #[error("{found} line pairs, the frames before had {expected}")]
    PairCountChanged {
        /// Pairs of the frames before.
        expected: usize,
        /// Pairs of this frame.
        found: usize,
    },
    /// The law ran away over the time since the frame before: its numbers are not finite.
    #[error("the law diverges over {seconds} s")]
    Diverged {
        /// Time since the frame before.
        seconds: f64,
    },
    /// Times must be finite and increase.
    #[error(transparent)]
    TimeNotIncreasing(#[from] TimeNotIncreasing),
}
