//! The lines of a frame, matched to those of the frames before.
use freeform_decompose::{Correspondence, CorrespondenceError, Criterion, Decomposition, Line, MAX_PAIRS};

/// A match by continuity is ambiguous where the second best pairing is less than twice as far away (costs are squares).
const AMBIGUOUS_COST_RATIO: f64 = 4.0;

/// The lines of a frame and in which order its pairs continue those of the first frame.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MatchedFrame {
    pub(crate) decomposition: Decomposition,
    pub(crate) order: [usize; MAX_PAIRS],
}

/// How frames were matched so far.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Matches {
    pub(crate) all: usize,
    pub(crate) ambiguous: usize,
}

impl MatchedFrame {
    /// Finds which pair of a frame continues which of the last one, if there is one, in coordinates in which the first outline has this
    /// RMS radius.
    pub(crate) fn after(
        last: Option<&Self>,
        decomposition: Decomposition,
        radius: f64,
    ) -> Result<(Self, Option<Correspondence>), CorrespondenceError> {
        let mut order = [0, 1, 2, 3];
        let Some(last) = last else { return Ok((Self { decomposition, order }, None)) };
        let correspondence = Correspondence::between(&last.decomposition, &decomposition, radius)?;
        for (slot, &before) in order.iter_mut().zip(&last.order).take(correspondence.permutation().len()) {
            *slot = correspondence.permutation()[before];
        }
        Ok((Self { decomposition, order }, Some(correspondence)))
    }

    /// One line of each conjugate pair, in the order of the first frame, and how many there are.
    pub(crate) fn lines(&self) -> ([Line; MAX_PAIRS], usize) {
        let pairs = self.decomposition.conjugate_pairs(self.decomposition.degree().value());
        let mut found = [self.decomposition.level(self.decomposition.degree().value())[0]; MAX_PAIRS];
        let mut count = 0;
        for (slot, line) in found.iter_mut().zip(pairs) {
            *slot = *line;
            count += 1;
        }
        let mut ordered = found;
        ordered.iter_mut().zip(&self.order).take(count).for_each(|(slot, &pair)| *slot = found[pair]);
        (ordered, count)
    }
}

impl Matches {
    pub(crate) fn take(&mut self, correspondence: Option<&Correspondence>) {
        let Some(matching) = correspondence else { return };
        self.all += 1;
        // The order of the values settles the rest, whatever the turn.
        self.ambiguous += usize::from(
            matching.decided_by() == Criterion::Continuity
                && matching.runner_up_cost() < AMBIGUOUS_COST_RATIO * matching.continuity_cost(),
        );
    }
}
