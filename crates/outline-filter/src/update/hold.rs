//! Steps in null directions are not taken: noise asks for any of them, and the path of an object does not tell its turn.
//!
//! A constant generator would tell the turn of a plain circle from its path. Wheels roll and coins slide while they spin, so that would be
//! wrong for most objects: a turn is told by the outline, never by the path alone. Whoever asks for a constant generator has the turn of such an
//! object from its hypothesis of dynamics, which holds nothing then; here it is held all the same.
use std::borrow::Cow;

use freeform_riccati::MotionModel;

use crate::{
    belief::{Belief, StateMatrix},
    map::{NullDirection, OutlineMap},
    tuning::null_space::HOLDING,
};

/// Information by which null directions are held where they are predicted; `None` where there are none.
pub(crate) fn hold(belief: &Belief, map: &OutlineMap, null: &[NullDirection]) -> Option<StateMatrix> {
    // What shear and growth do to a thin outline in one step is seen in the long run.
    if null.is_empty() || (belief.model > MotionModel::Similarity && !map.turn_is_unseen(belief.model)) {
        return None;
    }
    let k = belief.parameter_count();
    let memory = &belief.memory;
    let span = memory.effective[..k].iter().copied().fold(memory.span, f64::min).max(memory.step);
    let mut hold = StateMatrix::zeros();
    for NullDirection { dual, .. } in null {
        for (block, information) in [(0, HOLDING), (k, HOLDING * span * span)] {
            for i in 0..k {
                (0..k).for_each(|j| hold[(block + i, block + j)] += information * dual[i] * dual[j]);
            }
        }
    }
    Some(hold)
}

/// Information with that of a hold, where there is one.
pub(crate) fn with_hold<'a>(information: &'a StateMatrix, hold: Option<&StateMatrix>) -> Cow<'a, StateMatrix> {
    hold.map_or(Cow::Borrowed(information), |hold| Cow::Owned(information + hold))
}
