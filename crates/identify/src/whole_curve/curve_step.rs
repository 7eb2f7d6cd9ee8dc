use std::fmt;

use crate::filter::Phase;

/// What became of one frame in a [`WholeCurveFilter`](crate::WholeCurveFilter).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveStep {
    /// Time of the frame in seconds.
    pub time: f64,
    /// Phase after it.
    pub phase: Phase,
    /// Whether it was used.
    pub accepted: bool,
    /// Mean over the points of the squared value of the polynomial, values beyond 1 counted as 1: how much of the outline lies
    /// off the curve, 0 to 1, where the outer level sets are at -1 and 1.
    pub misfit: f64,
    /// Squared innovation of the pose in units of its predicted covariance: about the number of parameters in the mean, if
    /// the motion has gone on as it was. 0 in frames that were not predicted.
    pub innovation: f64,
    /// Linearisations taken.
    pub iterations: usize,
    /// Why it was not used; `None` where it was.
    pub rejection: Option<CurveRejection>,
}

/// Why a [`WholeCurveFilter`](crate::WholeCurveFilter) has not used a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurveRejection {
    /// More of the outline lies off the curve than usual, wherever it is looked for.
    MisfitTooLarge {
        /// As in [`CurveStep::misfit`].
        misfit: f64,
    },
    /// Misfit or innovation is too large for a frame that goes on as predicted.
    NotAsPredicted {
        /// As in [`CurveStep::misfit`].
        misfit: f64,
        /// As in [`CurveStep::innovation`].
        innovation: f64,
    },
}

impl CurveRejection {
    /// Of a frame that was not accepted.
    pub(crate) fn of(step: &CurveStep) -> Self {
        let CurveStep { misfit, innovation, .. } = *step;
        if innovation > 0.0 { Self::NotAsPredicted { misfit, innovation } } else { Self::MisfitTooLarge { misfit } }
    }
}

impl fmt::Display for CurveRejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MisfitTooLarge { misfit } => write!(f, "does not fit the curve, misfit {misfit:.2}"),
            Self::NotAsPredicted { misfit, innovation } => write!(
                f,
                "does not go on from the frames before it, misfit {misfit:.2}, squared innovation {innovation:.0}"
            ),
        }
    }
}
