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
}
