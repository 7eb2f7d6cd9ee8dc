//! What is preferred to what rests, and what is said of what moves besides.
use super::beside::{is_part_of, lies_in_place_of};
use super::evidence::{TracingEvidence, evidence_of};
use super::moving::{Motion, OBJECTS, what_moves};
use super::sight::Sight;
use super::trial::Trial;
use super::warning::TracingWarning;
use super::{FEWEST_FOR_MEDIAN, GOOD, PictureSample, Tracing, TracingChoice};
use crate::identity::identities::Selection;
use crate::picture_file::channel::Channel;
use crate::picture_outlines::PictureSettings;

/// What moves by less than this share of its size in all may rest: its outline may change where something in front of it moves.
const HARDLY_MOVES: f64 = 0.1;

/// What moves by so many of its sizes is nowhere where it was.
const LEAVES: f64 = 1.0;

/// Share of the score of what rests that something else has that is told hardly less well: about as much is left of one seen in two pictures of five.
const HARDLY_LESS: f64 = 0.5;

/// Puts what moves in front of the best way where that shows what rests, or is in doubt. Where the best does neither, but is not seen well or hardly
/// moves, it says what else moves. Where the best shows what rests and another object that moves, all of its objects are to be followed. The first of
/// the candidates, so many, have been looked at closely. `known` is what has been found to move in place of a way.
pub(super) fn preferring_what_moves(
    sample: &PictureSample,
    base: &PictureSettings,
    channel: Channel,
    (candidates, closely): (&mut Vec<TracingEvidence>, usize),
    known: Option<(Tracing, Motion)>,
) -> Option<TracingWarning> {
    let best = candidates.first();
    let rests = best.filter(|best| best.rests).map(|best| best.tracing);
    let is_in_doubt = rests.is_some() || best.is_none_or(|best| best.score < TracingChoice::CONVINCING);
    if !is_in_doubt {
        let best = best?;
        let (is_good, hardly_moves) = (best.score >= GOOD, best.movement < HARDLY_MOVES * size_of(best, sample.size()));
        if is_good && !hardly_moves {
            return moves_by_another_way(sample, base, candidates);
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
        Some((tracing, motion)) if Some(tracing) == rests => Some(motion),
        _ => motion_beside(sample, base, channel, rests.as_ref(), None),
    };
    let is_sure = |way: &TracingEvidence| way.score >= TracingChoice::CONVINCING;
    let (moving, changes) = motion.map_or((None, None), |motion| (motion.moving, motion.changes));
    if moving.is_none()
        && let Some(place) = rests.and_then(|_| leaves_its_place(&candidates[..closely], sample.size()))
    {
        candidates[..=place].rotate_right(1);
        return None;
    }
    if let Some(resting) = candidates.first_mut().filter(|best| best.rests && is_sure(best))
        && !moving.as_ref().is_some_and(is_sure)
        && shows_what_moves(sample, base, &resting.tracing)
    {
        resting.selection = Selection::All;
        return None;
    }
    if let Some(moving) = moving {
        candidates.retain(|candidate| candidate.tracing != moving.tracing);
        candidates.insert(0, moving);
        return None;
    }
    let changes = changes.filter(|changes| changes.are_many())?;
    Some(TracingWarning::MovesBesideRest { seen: changes.seen, pictures: changes.pictures })
}

/// What another way, which is good too, shows to move where the best shows nothing, such as what is darker than the ground beside what is lighter.
/// Light and shadows of a thing lie on it or in it, and are none.
fn moves_by_another_way(
    sample: &PictureSample,
    base: &PictureSettings,
    ways: &[TracingEvidence],
) -> Option<TracingWarning> {
    let (best, others) = ways.split_first()?;
    let mut others = others.iter().filter(|way| way.score >= GOOD && !way.rests).peekable();
    others.peek()?;
    let known = Trial::fine(sample, base, best.tracing.channel).all_sights(&best.tracing, OBJECTS);
    let is_beside = |sight: &Sight| {
        let mut in_picture = known.iter().flatten().filter(|other| other.frame == sight.frame);
        !in_picture.any(|other| is_part_of(sight, other) || is_part_of(other, sight))
    };
    others.find_map(|way| {
        let found = largest_that_moves(&Trial::fine(sample, base, way.tracing.channel), &way.tracing, is_beside)?;
        let is_in_most = 2 * found.found > found.pictures;
        is_in_most.then_some(TracingWarning::MovesBeside { seen: found.found, pictures: found.pictures })
    })
}

/// The largest of some of the objects that a way shows, picture for picture, if it moves beyond doubt.
fn largest_that_moves(trial: &Trial, tracing: &Tracing, is_asked: impl Fn(&Sight) -> bool) -> Option<TracingEvidence> {
    let largest = |sights: Vec<Sight>| sights.into_iter().filter(&is_asked).max_by(|a, b| a.area.total_cmp(&b.area));
    let sights: Vec<Sight> = trial.all_sights(tracing, OBJECTS).into_iter().filter_map(largest).collect();
    evidence_of(trial, *tracing, &sights).filter(|found| !found.rests && found.score >= TracingChoice::CONVINCING)
}

/// Whether a way whose largest object rests shows another one that moves, such as one that turns in its place, of which differences from the median
/// of the pictures show fragments alone. Of masks, which no median is made of, too.
fn shows_what_moves(sample: &PictureSample, base: &PictureSettings, tracing: &Tracing) -> bool {
    let trial = Trial::whole(sample, base, tracing.channel);
    let Some(still) = trial.first_sight(tracing) else { return false };
    largest_that_moves(&trial, tracing, |sight| !lies_in_place_of(sight, &still)).is_some()
}

/// The first way whose object leaves its place, where it is told beyond doubt, and hardly less well than what rests, the best. It has seen it whole,
/// though differences from the median of the pictures have not.
fn leaves_its_place(candidates: &[TracingEvidence], of_pictures: (u32, u32)) -> Option<usize> {
    let least = TracingChoice::CONVINCING.max(HARDLY_LESS * candidates.first()?.score);
    candidates
        .iter()
        .position(|way| !way.rests && way.score >= least && way.movement > LEAVES * size_of(way, of_pictures))
}

/// Side of a square of the area of what a way shows in pictures of so many columns and rows, pixels.
fn size_of(way: &TracingEvidence, (columns, rows): (u32, u32)) -> f64 {
    (way.area_share * f64::from(columns) * f64::from(rows)).sqrt()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::TracingWay;
    use crate::tracing::settings::Smoothing;

    /// What shows a thing of 20 by 20 pixels in pictures of 200 by 100.
    fn way(rests: bool, score: f64, movement: f64) -> TracingEvidence {
        let smoothing = Smoothing::Automatic;
        TracingEvidence {
            tracing: Tracing { way: TracingWay::Lighter, channel: Channel::Luminance, smoothing, level: None },
            pictures: 15,
            found: 15,
            steadiness: 1.0,
            evenness: 1.0,
            contrast: 1.0,
            smoothness: 1.0,
            movement,
            rests,
            clipped: 0.0,
            area_share: 0.02,
            objects: 1,
            second: 0.0,
            selection: Selection::Largest,
            largest_hole: 0.0,
            has_steady_contours: false,
            score,
        }
    }

    #[test]
    fn what_leaves_its_place_is_found_where_it_is_told_hardly_less_well_than_what_rests() {
        let found = |other: TracingEvidence| leaves_its_place(&[way(true, 0.2, 0.5), other], (200, 100));
        assert_eq!(found(way(false, 0.15, 30.0)), Some(1));
        // It is in doubt, hardly moves, or rests as well.
        assert_eq!(found(way(false, 0.11, 30.0)), None);
        assert_eq!(found(way(false, 0.15, 15.0)), None);
        assert_eq!(found(way(true, 0.15, 30.0)), None);
        // What rests is told far better.
        assert_eq!(leaves_its_place(&[way(true, 0.6, 0.5), way(false, 0.15, 30.0)], (200, 100)), None);
    }
}
