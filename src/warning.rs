use std::fmt;

/// What a user should know of an identified motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Warning {
    /// The outlines tell nothing of these parameters.
    NotObservable { parameters: Vec<&'static str> },
    /// Many frames gave nothing.
    FramesRejected { rejected: usize, frames: usize },
    /// The pairs of lines could not be matched for certain in many frames.
    AmbiguousCorrespondence { ambiguous: usize, matched: usize },
    /// The run is shorter than the adaptive law needs, or its parameters still drift.
    MayNotHaveSettled { seconds: f64 },
    /// The outline turned too far from frame to frame.
    LinesNotFollowed { skipped: usize, intervals: usize },
    /// The parameters of an affine motion are biased.
    AffineBias,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotObservable { parameters } => {
                write!(f, "rotation is not observable from these outlines; unknown: {}", parameters.join(", "))
            }
            Self::FramesRejected { rejected, frames } => write!(f, "{rejected} of {frames} frames rejected"),
            Self::AmbiguousCorrespondence { ambiguous, matched } => write!(
                f,
                "lines matched ambiguously in {ambiguous} of {matched} frames: \
                 the turn between frames is large or the outline nearly symmetric"
            ),
            Self::MayNotHaveSettled { seconds } => {
                write!(f, "the adaptive law may not have settled after {seconds:.1} s")
            }
            Self::LinesNotFollowed { skipped, intervals } => write!(
                f,
                "lines not followed over {skipped} of {intervals} intervals between frames: \
                 the outline turns by more than about half a radian"
            ),
            Self::AffineBias => f.write_str(
                "the six parameters are biased, as the fit of an outline does not follow affine motion exactly: \
                 use the motion filter",
            ),
        }
    }
}
