use super::judgement::{Outcome, Quantity};

/// Half of the 95 % interval in standard deviations.
const HALF_INTERVAL: f64 = 1.96;

/// What the runs of a kind, a class or the whole study say. Shares are from 0 to 1, `None` of nothing.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Summary {
    /// Number of runs.
    pub runs: usize,
    /// Share of the runs in which a stated value was more than four standard deviations off, no warning questioned it and no alias named
    /// the truth.
    pub silent_wrong: Option<f64>,
    /// Share of the runs in which a stated value was more than four standard deviations off, told or not.
    pub off: Option<f64>,
    /// Share of the runs in which a number was not stated.
    pub unstated: Option<f64>,
    /// Share of the runs with a warning that questions the values.
    pub warned: Option<f64>,
    /// Share of the runs in which an alias named the true angular velocity.
    pub alias_told: Option<f64>,
    /// Share of the frames that were not used.
    pub frames_rejected: Option<f64>,
    /// Of each quantity that is judged.
    pub quantities: Vec<QuantitySummary>,
    /// Of the poses on the way; `None` where no run has any that are judged.
    pub poses: Option<PoseSummary>,
}

/// What the runs say of the poses in the frames that were used. Shares are from 0 to 1, `None` of nothing.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoseSummary {
    /// Share of the runs in which a number of a pose was more than five standard deviations off, and no warning questioned the values.
    pub silent_wrong: Option<f64>,
    /// Share of the runs in which a number of a pose was more than five standard deviations off, told or not.
    pub off: Option<f64>,
    /// Share of the stated angles whose 95 % interval held the truth.
    pub turn_coverage: Option<f64>,
    /// Share of the stated coordinates whose 95 % interval held the truth.
    pub place_coverage: Option<f64>,
    /// Share of the frames that have no angle, or the first one after a loss, from which others are counted.
    pub turn_unstated: Option<f64>,
}

/// What the runs say of one quantity.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct QuantitySummary {
    /// Which.
    pub quantity: Quantity,
    /// Share of the runs in which a component of it was stated, more than four standard deviations off, without a word.
    pub silent_wrong: Option<f64>,
    /// Share of the runs in which a component of it was not stated.
    pub unstated: Option<f64>,
    /// Share of the stated components whose 95 % interval held the truth.
    pub coverage: Option<f64>,
    /// Median error of the stated components in standard deviations.
    pub median_deviations: Option<f64>,
}

impl Summary {
    /// Of outcomes in any order.
    pub(super) fn of<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Self {
        let outcomes: Vec<&Outcome> = outcomes.collect();
        let share = |is: &dyn Fn(&Outcome) -> bool| share(outcomes.iter().map(|outcome| is(outcome)));
        let [rejected, frames] = outcomes
            .iter()
            .fold([0, 0], |[rejected, frames], outcome| [rejected + outcome.frames_rejected, frames + outcome.frames]);
        let judged = |quantity: &Quantity| outcomes.iter().any(|o| o.numbers.iter().any(|(q, _)| q == quantity));
        Self {
            runs: outcomes.len(),
            silent_wrong: share(&|outcome| outcome.is_off() && outcome.is_silent()),
            off: share(&Outcome::is_off),
            unstated: share(&|outcome| outcome.is_unstated_in(None)),
            warned: share(&|outcome| outcome.warned),
            alias_told: share(&|outcome| outcome.alias_told),
            frames_rejected: (frames > 0).then(|| rejected as f64 / frames as f64),
            quantities: Quantity::ALL
                .into_iter()
                .filter(judged)
                .map(|quantity| QuantitySummary::of(quantity, &outcomes))
                .collect(),
            poses: PoseSummary::of(&outcomes),
        }
    }

    /// Share of the runs with a wrong value in which that was told: of 1 where nothing was wrong, `None`.
    #[must_use]
    pub fn told_of_off(&self) -> Option<f64> {
        let (silent, off) = (self.silent_wrong?, self.off?);
        (off > 0.0).then(|| 1.0 - silent / off)
    }
}

impl PoseSummary {
    fn of(outcomes: &[&Outcome]) -> Option<Self> {
        let judged = || outcomes.iter().filter_map(|outcome| Some((*outcome, outcome.poses.as_ref()?)));
        judged().next()?;
        let holds = |error: &f64| error.abs() <= HALF_INTERVAL;
        let [frames, turns] = judged().fold([0, 0], |[f, t], (_, poses)| [f + poses.frames, t + poses.turns.len()]);
        Some(Self {
            silent_wrong: share(judged().map(|(outcome, poses)| poses.are_off() && outcome.is_silent())),
            off: share(judged().map(|(_, poses)| poses.are_off())),
            turn_coverage: share(judged().flat_map(|(_, poses)| &poses.turns).map(holds)),
            place_coverage: share(judged().flat_map(|(_, poses)| &poses.places).map(holds)),
            turn_unstated: (frames > 0).then(|| 1.0 - turns as f64 / frames as f64),
        })
    }
}

impl QuantitySummary {
    fn of(quantity: Quantity, outcomes: &[&Outcome]) -> Self {
        let judged = || outcomes.iter().filter(|o| o.numbers.iter().any(|(q, _)| *q == quantity));
        let mut deviations: Vec<f64> = judged()
            .flat_map(|outcome| outcome.numbers.iter().filter(|(q, _)| *q == quantity).filter_map(|(_, error)| *error))
            .map(f64::abs)
            .collect();
        deviations.sort_by(f64::total_cmp);
        Self {
            quantity,
            silent_wrong: share(judged().map(|outcome| outcome.is_off_in(Some(quantity)) && outcome.is_silent())),
            unstated: share(judged().map(|outcome| outcome.is_unstated_in(Some(quantity)))),
            coverage: share(deviations.iter().map(|error| *error <= HALF_INTERVAL)),
            median_deviations: median(&deviations),
        }
    }
}

fn share(are: impl Iterator<Item = bool>) -> Option<f64> {
    let (count, hits) = are.fold((0_usize, 0_usize), |(count, hits), is| (count + 1, hits + usize::from(is)));
    (count > 0).then(|| hits as f64 / count as f64)
}

/// Of sorted numbers; of an even count the mean of both in the middle.
fn median(sorted: &[f64]) -> Option<f64> {
    let upper = sorted.get(sorted.len() / 2)?;
    let lower = if sorted.len().is_multiple_of(2) { sorted.get(sorted.len() / 2 - 1)? } else { upper };
    Some(if lower == upper { *upper } else { 0.5 * (lower + upper) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::poses::PoseErrors;

    fn outcome(omega: Option<f64>, warned: bool, alias_told: bool) -> Outcome {
        Outcome {
            numbers: vec![(Quantity::Omega, omega), (Quantity::B, Some(0.5)), (Quantity::B, Some(-3.0))],
            warned,
            alias_told,
            frames: 10,
            frames_rejected: usize::from(warned),
            poses: None,
        }
    }

    #[test]
    fn poses_that_are_off_are_silent_where_nothing_was_said_of_the_values() {
        let poses = PoseErrors { turns: vec![0.5, -6.0], places: vec![1.0, -3.0, 0.0, 0.0], frames: 4 };
        let right = PoseErrors { turns: vec![1.0; 4], places: vec![1.0; 8], frames: 4 };
        let off = |warned: bool| outcome(Some(1.0), warned, false).with_poses(Some(poses.clone()));
        let outcomes = [off(false), off(true), outcome(Some(1.0), false, false).with_poses(Some(right))];
        let summary = Summary::of(outcomes.iter()).poses.expect("poses");
        assert_eq!((summary.silent_wrong, summary.off), (Some(1.0 / 3.0), Some(2.0 / 3.0)));
        assert_eq!((summary.turn_coverage, summary.place_coverage), (Some(6.0 / 8.0), Some(14.0 / 16.0)));
        assert_eq!(summary.turn_unstated, Some(1.0 - 8.0 / 12.0));
        assert_eq!(Summary::of([outcome(Some(1.0), false, false)].iter()).poses, None);
    }

    #[test]
    fn the_figures_are_those_of_their_definitions() {
        let outcomes = [
            outcome(Some(1.0), false, false),
            outcome(Some(-5.0), false, false),
            outcome(Some(9.0), true, false),
            outcome(Some(7.0), false, true),
            outcome(None, false, false),
        ];
        let summary = Summary::of(outcomes.iter());
        assert_eq!((summary.runs, summary.silent_wrong, summary.off), (5, Some(0.2), Some(0.6)));
        assert_eq!((summary.unstated, summary.warned, summary.alias_told), (Some(0.2), Some(0.2), Some(0.2)));
        assert_eq!(summary.frames_rejected, Some(0.02));
        assert!(summary.told_of_off().is_some_and(|share| (share - 2.0 / 3.0).abs() < 1e-12));
        let [omega, b] = &summary.quantities[..] else { panic!("{:?}", summary.quantities) };
        assert_eq!((omega.silent_wrong, omega.unstated), (Some(0.2), Some(0.2)));
        assert_eq!((omega.coverage, omega.median_deviations), (Some(0.25), Some(6.0)));
        assert_eq!((b.silent_wrong, b.coverage, b.median_deviations), (Some(0.0), Some(0.5), Some(1.75)));
    }

    #[test]
    fn of_nothing_there_are_no_shares() {
        let none = Summary::of(std::iter::empty());
        assert_eq!((none.runs, none.silent_wrong, none.frames_rejected), (0, None, None));
        assert!(none.quantities.is_empty() && none.told_of_off().is_none());
        let unstated = [outcome(None, false, false)];
        let omega = &Summary::of(unstated.iter()).quantities[0];
        assert_eq!((omega.coverage, omega.median_deviations, omega.unstated), (None, None, Some(1.0)));
    }

    #[test]
    fn a_median_of_infinities_is_infinite() {
        assert_eq!(median(&[f64::INFINITY, f64::INFINITY]), Some(f64::INFINITY));
        assert_eq!(median(&[1.0, f64::INFINITY]), Some(f64::INFINITY));
    }
}
