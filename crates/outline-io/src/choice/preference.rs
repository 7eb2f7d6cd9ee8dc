//! What is preferred to what rests, and what is said of what moves besides.
use super::evidence::TracingEvidence;
use super::moving::{Motion, what_moves};
use super::warning::TracingWarning;
use super::{FEWEST_FOR_MEDIAN, GOOD, PictureSample, Tracing, TracingChoice};
use crate::channel::Channel;
use crate::picture_outlines::PictureSettings;

/// What moves by less than this share of its size in all may rest: its outline may change where something in front of it moves.
const HARDLY_MOVES: f64 = 0.1;

/// Puts what moves in front of the best way where that shows what rests, or is in doubt. Where the best does neither, but is not seen well or hardly
/// moves, it says what else moves. `known` is what has been found to move in place of a way.
pub(super) fn preferring_what_moves(
    sample: &PictureSample,
    base: &PictureSettings,
    channel: Channel,
    candidates: &mut Vec<TracingEvidence>,
    known: Option<(Tracing, Motion)>,
) -> Option<TracingWarning> {
    let best = candidates.first();
    let rests = best.filter(|best| best.rests).map(|best| best.tracing);
    let is_in_doubt = rests.is_some() || best.is_none_or(|best| best.score < TracingChoice::CONVINCING);
    if !is_in_doubt {
        let best = best?;
        let (columns, rows) = sample.size();
        let size = (best.area_share * f64::from(columns) * f64::from(rows)).sqrt();
        let (is_good, hardly_moves) = (best.score >= GOOD, best.movement < HARDLY_MOVES * size);
        if is_good && !hardly_moves {
            return None;
        }
        let motion = motion_beside(sample, base, channel, None, Some(&best.tracing))?;
        let (seen, pictures) = match motion.moving {
            Some(moving) => (moving.found, moving.pictures),
            // Many things that go on may be the teeth or marks of what is seen well.
            None if !is_good && motion.goes_on.are_most() => (motion.goes_on.seen, motion.goes_on.pictures),
            None => return None,
        };
        return Some(TracingWarning::MovesBeside { seen, pictures });
    }
    let motion = match known {
        Some((tracing, motion)) if Some(tracing) == rests => motion,
        _ => motion_beside(sample, base, channel, rests.as_ref(), None)?,
    };
    if let Some(moving) = motion.moving {
        candidates.retain(|candidate| candidate.tracing != moving.tracing);
        candidates.insert(0, moving);
        return None;
    }
    let changes = motion.changes.filter(|changes| changes.are_many())?;
    Some(TracingWarning::MovesBesideRest { seen: changes.seen, pictures: changes.pictures })
}

/// What moves beside what `rests`, or beside `others`, where the pictures can show it.
pub(super) fn motion_beside(
    sample: &PictureSample,
    base: &PictureSettings,
    channel: Channel,
    rests: Option<&Tracing>,
    others: Option<&Tracing>,
) -> Option<Motion> {
    let may_show = !sample.is_two_valued() && sample.len() >= FEWEST_FOR_MEDIAN;
    may_show.then(|| what_moves(sample, base, channel, rests, others))
}
