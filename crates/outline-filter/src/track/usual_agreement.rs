//! Whether more points of a frame disagree with the outline than usual.
//!
//! Where a body shows its turn, or its place along itself, by a small part of its outline only, such as the notch of a disc, a prediction
//! that misses this part makes outliers of its points. All others agree, and the pose goes on as predicted, for ever. A share of points
//! that disagree which is larger than usual says so.
use super::Track;
use crate::tuning::usual_agreement as tuning;

/// Share of the points that disagree in most of the frames.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct UsualAgreement {
    disagreeing: f64,
    frames: usize,
}

impl UsualAgreement {
    /// Updates the usual share by a frame of so many points with a share that disagrees; whether that is significantly more than usual.
    fn update(&mut self, disagreeing: f64, points: usize, shown: TurnShown) -> bool {
        let is_known = self.frames >= tuning::FEWEST_FRAMES;
        let usual = self.disagreeing;
        let points = points.max(1) as f64;
        let deviation = (usual.max(1.0 / points) * (1.0 - usual) / points).sqrt();
        self.frames += 1;
        // Frames in which a part has been missed must not become the usual ones.
        let gain = if disagreeing < usual { tuning::FALLS } else { tuning::RISES };
        self.disagreeing += gain.max(1.0 / self.frames as f64) * (disagreeing - usual);
        // Few marks are soon missed, in the very first frames as well.
        let significant = match shown {
            TurnShown::ByMany => tuning::SIGNIFICANT,
            TurnShown::ByFew => tuning::SIGNIFICANT_OF_FEW,
        };
        (is_known || shown == TurnShown::ByFew) && disagreeing > usual + significant * deviation
    }
}

/// How much of an outline shows its turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TurnShown {
    ByMany,
    /// A pose that misses these few passes for one that shows it.
    ByFew,
}

impl Track {
    /// Takes the share of the points of an accepted frame that agree; whether more than usual do not.
    pub(super) fn disagrees_more_than_usual(&mut self, agreement: f64, points: usize) -> bool {
        let shown = if self.map.is_all_but_round() { TurnShown::ByFew } else { TurnShown::ByMany };
        self.usual.update(disagreeing(agreement), points, shown)
    }

    /// Records a share of points that agree as nearer to the usual one: nothing else explains them better.
    pub(crate) fn record_as_usual(&mut self, agreement: f64) {
        let more = disagreeing(agreement) - self.usual.disagreeing;
        self.usual.disagreeing += tuning::UNEXPLAINED * more.max(0.0);
    }
}

/// Share of the points that disagree, of that which agree.
fn disagreeing(agreement: f64) -> f64 {
    (1.0 - agreement).clamp(0.0, 1.0)
}

#[cfg(feature = "serde")]
impl UsualAgreement {
    /// Whether it is a share of so many frames.
    pub(super) fn is_valid(&self) -> bool {
        (0.0..=1.0).contains(&self.disagreeing) && self.frames < freeform_estimate::StateFormat::MOST_COUNTED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_marks_that_tell_the_turn_are_missed_from_the_first_frame_on() {
        let first = |share: f64, shown: TurnShown| UsualAgreement::default().update(share, 300, shown);
        assert!(first(0.05, TurnShown::ByFew) && !first(0.05, TurnShown::ByMany));
        assert!(!first(0.005, TurnShown::ByFew));
    }

    #[test]
    fn a_part_of_the_outline_that_is_missed_is_noticed_in_every_frame_and_usual_outliers_are_not() {
        let mut usual = UsualAgreement::default();
        let noticed = |usual: &mut UsualAgreement, share: f64, frames: i32| {
            (0..frames)
                .filter(|i| usual.update(share + if i % 2 == 0 { 0.01 } else { -0.01 }, 400, TurnShown::ByMany))
                .count()
        };
        assert_eq!(noticed(&mut usual, 0.05, 100), 0);
        assert_eq!(noticed(&mut usual, 0.15, 10), 10);
    }
}
