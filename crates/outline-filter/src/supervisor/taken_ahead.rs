//! Frames kept that a track and its rivals take on cells cut anew, taken between two frames.
use super::{
    gates::Turns,
    initialisation::frames_at_once,
    motion_filter::{MotionFilter, Phase},
    window::Remapped,
};

/// A hypothesis of the turn: that of the present track, or a rival's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hypothesis {
    Present,
    Rival { turn: f64 },
}

/// What becomes of a hypothesis with one more of the frames kept.
#[derive(Debug, Clone)]
struct Taken {
    of: Hypothesis,
    /// Frames that it had taken before.
    after: usize,
    turns: Turns,
    /// None where it does not take the frame.
    remapped: Option<Remapped>,
}

/// What becomes of hypotheses with frames kept that they have not taken yet.
#[derive(Debug, Clone, Default)]
pub(super) struct TakenAhead(Vec<Taken>);

impl TakenAhead {
    fn position(&self, of: Hypothesis, after: usize, turns: Turns) -> Option<usize> {
        self.0.iter().position(|taken| taken.of == of && taken.after == after && taken.turns == turns)
    }

    fn get(&self, of: Hypothesis, after: usize, turns: Turns) -> Option<&Option<Remapped>> {
        Some(&self.0[self.position(of, after, turns)?].remapped)
    }

    /// What becomes of a hypothesis with one more frame, as has been found, or else as `next` finds. In line, as tracks are large to be handed on.
    #[inline(always)]
    pub(super) fn take_or(
        &mut self,
        of: Hypothesis,
        turns: Turns,
        remapped: Remapped,
        next: impl FnOnce(Remapped) -> Option<Remapped>,
    ) -> Option<Remapped> {
        match self.position(of, remapped.frames_taken(), turns) {
            Some(at) => self.0.swap_remove(at).remapped,
            None => next(remapped),
        }
    }
}

impl MotionFilter {
    /// The hypothesis that will be the next to take one of the frames kept, after so many, that it has not taken ahead, as far as can be told before
    /// the frame that all take first.
    pub(super) fn next_to_take(&self) -> Option<(Hypothesis, usize)> {
        let measured = self.window.measured_for(self.turn_hypotheses.present_turn())?;
        if self.phase != Phase::Tracking {
            return None;
        }
        let (turns, ahead) = (self.turns_of_kept(), self.window.taken_ahead());
        let followed: Vec<f64> = self.turn_hypotheses.followed().map(|(turn, _)| turn).collect();
        let mut present = measured.present.frames_taken();
        let of_rival = |(turn, rival): &(f64, Option<Remapped>)| Some((*turn, rival.as_ref()?.frames_taken()));
        let mut rivals: Vec<_> = measured.rivals.iter().filter_map(of_rival).collect();
        rivals.retain(|(turn, _)| followed.contains(turn));
        // One more will be begun before, from where it is then.
        let begun = followed.iter().find(|turn| measured.rivals.iter().all(|(of, _)| of != *turn));
        rivals.extend(begun.map(|turn| (*turn, 1)));
        for _ in 0..frames_at_once(1 + followed.len()) {
            let behind =
                (0..rivals.len()).min_by_key(|rival| rivals[*rival].1).filter(|rival| rivals[*rival].1 < present);
            let (of, after) = match behind {
                Some(rival) => (Hypothesis::Rival { turn: rivals[rival].0 }, rivals[rival].1),
                None if present < self.window.len() => (Hypothesis::Present, present),
                None => return None,
            };
            let is_begun = behind.is_some_and(|rival| Some(&rivals[rival].0) == begun);
            match (ahead.get(of, after, turns), behind) {
                (Some(None), None) => return None,
                (Some(None), Some(rival)) => {
                    rivals.remove(rival);
                }
                (None, _) if !is_begun => return Some((of, after)),
                (_, Some(rival)) => rivals[rival].1 += 1,
                (_, None) => present += 1,
            }
        }
        None
    }

    /// Takes one of the frames kept ahead, if a hypothesis will.
    pub(super) fn take_ahead(&mut self) {
        let Some((of, after)) = self.next_to_take() else { return };
        let Some(measured) = self.window.measured_for(self.turn_hypotheses.present_turn()) else { return };
        let turns = self.turns_of_kept();
        let nominal = match of {
            Hypothesis::Present => Some(&measured.present),
            Hypothesis::Rival { turn } => {
                measured.rivals.iter().find(|(of, _)| *of == turn).and_then(|(_, rival)| rival.as_ref())
            }
        };
        let from = match nominal.filter(|nominal| nominal.frames_taken() == after) {
            Some(nominal) => Some(nominal),
            None => self.window.taken_ahead().get(of, after - 1, turns).and_then(Option::as_ref),
        };
        let Some(from) = from.cloned() else { return };
        let remapped = self.take_kept(from, 1);
        self.window.taken_ahead_mut().0.push(Taken { of, after, turns, remapped });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{drawn_curves::turning, supervisor::settings::FilterSettings};

    #[test]
    fn what_is_taken_ahead_is_what_the_next_frame_takes() {
        // Two turns that look alike, and four.
        for lobes in [2.0, 4.0] {
            let lobed = |t: f64| 1.0 + 0.2 * (lobes * t).cos();
            let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
            let mut all_ahead = 0;
            for frame in 0..18 {
                while filter.prepare() {}
                let ahead: Vec<_> = filter.window.taken_ahead().0.iter().map(|taken| (taken.of, taken.after)).collect();
                all_ahead += ahead.len();
                filter.step(f64::from(frame) / 30.0, &turning(frame, 400, lobed)).expect("increasing times");
                assert!(filter.window.taken_ahead().0.is_empty());
                let Some(measured) = filter.window.measured_for(filter.turn_hypotheses.present_turn()) else {
                    // All have taken all frames.
                    continue;
                };
                let has_taken = |(of, after): &(Hypothesis, usize)| {
                    let remapped = match of {
                        Hypothesis::Present => Some(&measured.present),
                        Hypothesis::Rival { turn } => {
                            measured.rivals.iter().find(|(of, _)| of == turn).and_then(|(_, rival)| rival.as_ref())
                        }
                    };
                    remapped.is_none_or(|remapped| remapped.frames_taken() > *after)
                };
                assert!(ahead.iter().all(has_taken), "{lobes} lobes, frame {frame}: {ahead:?}");
            }
            assert!(all_ahead > 3, "{lobes} lobes: {all_ahead}");
        }
    }
}
