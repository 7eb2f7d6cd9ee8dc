//! Whether a frame may be found to show the object.
use freeform_riccati::MotionModel;

use crate::{track::Track, tuning::registration as tuning};

/// Whether a frame may be found to show the object, as far as a search with few points says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outlook {
    Open,
    /// Even in the pose that explains it best it scatters by far more than is tolerated.
    Hopeless,
    /// As that, of the poses that were found from a part of the turns.
    HopelessSoFar,
}

impl Outlook {
    /// Of a frame with so many points, from the deviation of few of them, normalised, in the pose that explains it best.
    pub(super) fn of(track: &Track, points: usize, spread: f64) -> Self {
        let is_far_off = spread > tuning::HOPELESS * track.most_noise_tolerated();
        if is_far_off && Self::can_be_told(track, points) { Self::Hopeless } else { Self::Open }
    }

    /// Whether few points can tell that there is nothing to be found: of rigid motion alone, since others change the outline, of frames of enough
    /// points, and of outlines without ends, beyond which points may lie. Of points that state deviations it is not said
    /// either: [`Track::most_noise_tolerated`] is infinite then.
    pub(super) fn can_be_told(track: &Track, points: usize) -> bool {
        points >= tuning::ENOUGH_POINTS && track.model() == MotionModel::Rigid && !track.map().has_ends()
    }
}
