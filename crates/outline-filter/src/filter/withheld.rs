//! Steps in directions of the pose that an outline does not show are not taken: noise asks for any of them.
//!
//! A constant generator would tell the turn of a plain circle from its path. Wheels roll and coins slide while they spin, so that would be
//! wrong for most objects: a turn is told by the outline, never by the path alone.
use freeform_riccati::MotionModel;

use super::{
    arrow_information::StateMatrix, innovation::PoseInnovation, map_update::Solution, outline_map::OutlineMap,
    unseen_direction::Unseen,
};

/// Information that holds a direction, in units of the noise: it moves by a thousandth of it.
const HOLDING: f64 = 1e6;

impl OutlineMap {
    /// Information by which unseen directions are held where they are predicted; `None` where there are none.
    pub(crate) fn hold(&self, unseen: &[Unseen]) -> Option<StateMatrix> {
        // What shear and growth do to a thin outline in one step is seen in the long run.
        if unseen.is_empty() || (self.model > MotionModel::Similarity && !self.turn_is_unseen()) {
            return None;
        }
        let k = self.information.k;
        let span = self.remembered();
        let mut hold = StateMatrix::zeros();
        for Unseen { dual, .. } in unseen {
            for (block, information) in [(0, HOLDING), (k, HOLDING * span * span)] {
                for i in 0..k {
                    (0..k).for_each(|j| hold[(block + i, block + j)] += information * dual[i] * dual[j]);
                }
            }
        }
        Some(hold)
    }

    /// Innovation of a solution, with what is held.
    pub(crate) fn solution_innovation(
        &self,
        solution: &Solution,
        hold: Option<&StateMatrix>,
        variance: f64,
    ) -> PoseInnovation {
        let [before, after] = [&self.marginal, &solution.marginal].map(|marginal| with_hold(marginal, hold));
        self.pose_innovation([&before, &after], &solution.state, variance)
    }

    /// Seconds of the past that the motion is known from.
    fn remembered(&self) -> f64 {
        let shortest = self.spans[..self.information.k].iter().copied().fold(self.span, f64::min);
        shortest.max(self.step_seconds)
    }

    /// Forgets all that is known of pose and motion in directions that were not seen: another place of the middle of a turn makes something
    /// known of it that is not.
    pub(crate) fn forget(&mut self, unseen: &[Unseen]) {
        let k = self.information.k;
        let units = self.effective_variance();
        for Unseen { direction, .. } in unseen {
            let rate = if self.step_seconds > 0.0 { 1.0 / self.step_seconds } else { 0.0 };
            let unknown = StateMatrix::from_fn(|i, j| {
                let (block, row, column) = (i / k, i % k, j % k);
                if i >= 2 * k || j / k != block {
                    return 0.0;
                }
                let size = if block == 0 { 1.0 } else { rate };
                size * size * direction[row] * direction[column] / units
            });
            self.add_covariance(&unknown);
        }
        self.is_forgotten = true;
    }
}

/// Information with that of a hold, where there is one.
pub(crate) fn with_hold(information: &StateMatrix, hold: Option<&StateMatrix>) -> StateMatrix {
    hold.map_or(*information, |hold| information + hold)
}
