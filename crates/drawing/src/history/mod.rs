//! What was found of every object over time.
mod curve_fitter;
mod histories;
mod playback;
mod pose_history;
mod thinned;

pub use curve_fitter::CurveFitter;
pub use histories::OBJECTS_PLAYED;
pub use histories::{Histories, Purpose};
pub(crate) use histories::{History, OBJECTS_WITH_POSES};
pub(crate) use playback::{KnownInFrame, Playback, PlayedFrame};
pub(crate) use pose_history::PoseHistory;
