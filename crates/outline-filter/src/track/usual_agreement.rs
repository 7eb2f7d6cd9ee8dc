//! Whether more points of a frame disagree with the outline than usual, or fewer than usual agree of those that tell some direction of the pose.
//!
//! Where a body shows its turn, or its place along itself, by a small part of its outline only, such as the notch of a disc or the ends of a bar,
//! a prediction that misses this part makes outliers of its points. All others agree, and the pose goes on as predicted, for ever. A share of points
//! that disagree which is larger than usual says so.
use super::{Doubt, Rise, Track};
use crate::{measurement::Frame, tuning::usual_agreement as tuning, update::Gate};

/// How far the points of most of the frames agree.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct UsualAgreement {
    /// Share of the points that disagree.
    disagreeing: f64,
    /// The [weakest agreement](crate::measurement::View::weakest_agreement).
    weakest: f64,
    /// Share of the points that disagree in the last frame, but for those in doubt for a share that has risen at once.
    last_disagreeing: f64,
    /// Mean share of the points that disagree together with both of their neighbours, over the last frames.
    in_runs: f64,
    frames: usize,
}

impl Default for UsualAgreement {
    fn default() -> Self {
        Self { disagreeing: 0.0, weakest: 1.0, last_disagreeing: 0.0, in_runs: 0.0, frames: 0 }
    }
}

impl UsualAgreement {
    /// Updates the usual share by a frame of so many points with a share that disagrees; whether that is significantly more than usual, and how the
    /// share has come to be so.
    fn update(&mut self, disagreeing: f64, points: usize, shown: TurnShown) -> Option<Rise> {
        let is_known = self.frames >= tuning::FEWEST_FRAMES;
        let usual = self.disagreeing;
        let points = points.max(1) as f64;
        self.frames += 1;
        self.disagreeing += gain(disagreeing < usual).max(1.0 / self.frames as f64) * (disagreeing - usual);
        // Few marks are soon missed, in the very first frames as well.
        let significant = match shown {
            TurnShown::ByMany => tuning::SIGNIFICANT,
            TurnShown::ByFew => tuning::SIGNIFICANT_OF_FEW,
        };
        let is_more = |than: f64| {
            let deviation = (than.max(1.0 / points) * (1.0 - than) / points).sqrt();
            disagreeing > than + significant * deviation
        };
        let rise = if self.frames < tuning::FRAMES_OF_RISE || is_more(self.last_disagreeing) {
            Rise::AtOnce
        } else {
            Rise::BitByBit
        };
        let is_in_doubt = (is_known || shown == TurnShown::ByFew) && is_more(usual);
        if !is_in_doubt || rise == Rise::BitByBit {
            self.last_disagreeing = disagreeing;
        }
        is_in_doubt.then_some(rise)
    }

    /// Updates the mean share of points that disagree in runs by that of the frame that was taken last.
    fn update_runs(&mut self, in_runs: f64) {
        self.in_runs += (1.0 / self.frames.max(1) as f64).max(tuning::GAIN_OF_PART) * (in_runs - self.in_runs);
    }

    /// Updates the usual weakest agreement by that of a frame; whether it is far less than usual.
    fn update_weakest(&mut self, weakest: f64) -> bool {
        let usual = self.weakest;
        self.weakest += gain(weakest > usual) * (weakest - usual);
        weakest < tuning::WEAKEST * usual
    }
}

/// Share by which a frame corrects what is usual, where its points agree better than that or worse.
fn gain(is_better: bool) -> f64 {
    if is_better { tuning::TOWARDS_BETTER } else { tuning::TOWARDS_WORSE }
}

/// How much of an outline shows its turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TurnShown {
    ByMany,
    /// A pose that misses these few passes for one that shows it.
    ByFew,
}

impl Track {
    /// Takes how far the points of an accepted frame agree: their share, and the weakest agreement if it was asked for. Why the object may lie
    /// elsewhere, if it may.
    pub(super) fn doubt_of_agreement(&mut self, agreement: f64, weakest: Option<f64>, points: usize) -> Option<Doubt> {
        let shown = if self.map.is_all_but_round() { TurnShown::ByFew } else { TurnShown::ByMany };
        let rise = self.usual.update(disagreeing(agreement), points, shown);
        if let Some(weakest) = weakest.filter(|weakest| self.usual.update_weakest(*weakest)) {
            return Some(Doubt::Direction { weakest, rise });
        }
        rise.map(|rise| Doubt::Points { rise })
    }

    /// Takes how many of the points of an accepted frame, which have been measured, disagree in runs: a part of an object that moves by itself does,
    /// and something in front of it. Outliers here and there do not.
    pub(super) fn record_runs(&mut self, frame: &Frame) {
        let (cells, weights) = (self.map.cells().len(), &frame.columns.weights);
        let disagrees = |i: usize| weights[i] <= 0.0 && (frame.columns.numbers[i] as usize) < cells;
        let within = 1..weights.len().saturating_sub(1);
        let count = within.filter(|i| (i - 1..=i + 1).all(disagrees)).count();
        self.usual.update_runs(count as f64 / weights.len().max(1) as f64);
    }

    /// Mean share of the points of a frame that disagree in runs, if that is no small part of the outline and several frames have shown it.
    pub(crate) fn disagreeing_part(&self) -> Option<f64> {
        let UsualAgreement { in_runs, frames, .. } = self.usual;
        (frames >= tuning::FRAMES_OF_PART && in_runs >= tuning::SMALLEST_PART).then_some(in_runs)
    }

    /// Whether hardly any point usually disagrees with the outline.
    pub(crate) fn usually_agrees(&self) -> bool {
        self.usual.disagreeing <= 1.0 - tuning::ALL_AGREE
    }

    /// A gate for frames that show all of the outline, but for the share of the points that usually disagrees, once that is known.
    pub(crate) fn gate_of_all(&self, gate: Gate) -> Gate {
        let is_known = self.usual.frames >= tuning::FEWEST_FRAMES;
        let of_all = tuning::ALL_OF_IT * if is_known { 1.0 - self.usual.disagreeing } else { 1.0 };
        Gate { smallest_agreement: gate.smallest_agreement.max(of_all), ..gate }
    }

    /// Records how far the points agree of a frame in doubt as nearer to what is usual: nothing else explains them better.
    pub(crate) fn record_as_usual(&mut self, agreement: f64, doubt: Doubt) {
        match doubt {
            Doubt::Points { .. } => {
                let more = disagreeing(agreement) - self.usual.disagreeing;
                self.usual.disagreeing += tuning::UNEXPLAINED * more.max(0.0);
                self.usual.last_disagreeing = disagreeing(agreement);
            }
            Doubt::Direction { weakest, .. } => {
                self.usual.weakest += tuning::UNEXPLAINED * (weakest - self.usual.weakest).min(0.0);
                self.usual.last_disagreeing = disagreeing(agreement);
            }
            Doubt::AfterRejected | Doubt::Turn => {}
        }
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
        [self.disagreeing, self.weakest, self.last_disagreeing, self.in_runs]
            .iter()
            .all(|share| (0.0..=1.0).contains(share))
            && self.frames < freeform_estimate::StateFormat::MOST_COUNTED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_marks_that_tell_the_turn_are_missed_from_the_first_frame_on() {
        let first = |share: f64, shown: TurnShown| UsualAgreement::default().update(share, 300, shown);
        assert!(first(0.05, TurnShown::ByFew).is_some() && first(0.05, TurnShown::ByMany).is_none());
        assert_eq!(first(0.005, TurnShown::ByFew), None);
    }

    #[test]
    fn a_direction_that_few_points_tell_is_in_doubt_where_these_disagree_and_not_where_they_always_do() {
        let mut usual = UsualAgreement::default();
        let noticed = |usual: &mut UsualAgreement, weakest: f64, frames: i32| {
            (0..frames).filter(|_| usual.update_weakest(weakest)).count()
        };
        assert_eq!(noticed(&mut usual, 0.8, 50), 0);
        assert_eq!(noticed(&mut usual, 0.2, 5), 5);
        assert!(noticed(&mut usual, 0.2, 200) < 100);
        assert_eq!(noticed(&mut usual, 0.2, 50), 0);
    }

    #[test]
    fn points_that_come_off_the_outline_bit_by_bit_are_told_from_as_many_at_once() {
        let mut usual = UsualAgreement::default();
        let share = |frame: i32| 0.01 + 0.005 * f64::from((frame - 10).clamp(0, 30));
        let mut raised = (0..60).filter_map(|frame| usual.update(share(frame), 400, TurnShown::ByMany)).peekable();
        assert!(raised.peek().is_some() && raised.all(|rise| rise == Rise::BitByBit));
        assert_eq!(usual.update(share(60) + 0.16, 400, TurnShown::ByMany), Some(Rise::AtOnce));
    }

    #[test]
    fn a_part_of_the_outline_that_is_missed_is_noticed_in_every_frame_and_usual_outliers_are_not() {
        let mut usual = UsualAgreement::default();
        let noticed = |usual: &mut UsualAgreement, share: f64, frames: i32| {
            (0..frames)
                .filter_map(|i| usual.update(share + if i % 2 == 0 { 0.01 } else { -0.01 }, 400, TurnShown::ByMany))
                .count()
        };
        assert_eq!(noticed(&mut usual, 0.05, 100), 0);
        assert_eq!(noticed(&mut usual, 0.15, 10), 10);
    }
}
