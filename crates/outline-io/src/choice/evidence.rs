//! What speaks for a way of tracing, and the score made of it.
use super::rest::{movement, rests};
use super::sight::{Inner, Sight};
use super::trial::Trial;
use super::tuning::score as tuning;
use super::{LINE, Tracing};
use crate::edges::median;
use crate::identity::identities::Selection;

/// What speaks for a way of tracing, and against it. Shares are from 0 to 1, 1 the best.
#[derive(Debug, Clone, PartialEq)]
pub struct TracingEvidence {
    /// The way.
    pub tracing: Tracing,
    /// Pictures looked at.
    pub pictures: usize,
    /// Pictures in which something was found.
    pub found: usize,
    /// How alike area and shape of what was found are over the sequence.
    pub steadiness: f64,
    /// How alike they are from one picture to the next.
    pub evenness: f64,
    /// How clear the contrast is along the edge.
    pub contrast: f64,
    /// How smooth the path is.
    pub smoothness: f64,
    /// Farthest movement seen, of the middle or of the outline, in pixels.
    pub movement: f64,
    /// Whether it rests: it moves no more from one picture to another far from it than its outline scatters.
    pub rests: bool,
    /// Share of the pictures in which the edge of the picture clips it.
    pub clipped: f64,
    /// Median share of the picture that it has.
    pub area_share: f64,
    /// Objects of at least half its area, in the median picture.
    pub objects: usize,
    /// Area of the largest other object over its own, in the median picture; 0 where there is none.
    pub second: f64,
    /// Which objects are worth to be followed: all where several are of its size, or where it rests and another one moves; those that move where it
    /// was chosen as it moves.
    pub selection: Selection,
    /// Share of its area that the largest of its holes and marks has.
    pub largest_hole: f64,
    /// Whether holes or marks within it, each of less than half of its area, are the same all the time.
    pub has_steady_contours: bool,
    /// All of it together, 0 to 1.
    pub score: f64,
}

impl TracingEvidence {
    /// Ways with their places in a list, the highest score first. [`TracingChoice::candidates`](super::TracingChoice) has the one that is taken in
    /// front of them, whatever its score.
    #[must_use]
    pub fn by_score(ways: &[Self]) -> Vec<(usize, &Self)> {
        let mut ranked: Vec<_> = ways.iter().enumerate().collect();
        ranked.sort_by(|(_, a), (_, b)| b.score.total_cmp(&a.score));
        ranked
    }
}

/// Tries a way; `None` where it finds nothing.
pub(super) fn judged(trial: &Trial, tracing: Tracing) -> Option<TracingEvidence> {
    evidence_of(trial, tracing, &trial.sights(&tracing))
}

/// What speaks for a way by what it finds; `None` where that is nothing.
pub(super) fn evidence_of(trial: &Trial, tracing: Tracing, sights: &[Sight]) -> Option<TracingEvidence> {
    let factor = trial.factor();
    let (found, pictures) = (sights.len(), trial.count());
    let picture_area = trial.picture_area();
    let of = |value: &dyn Fn(&Sight) -> f64| median(sights.iter().map(value));
    let area = of(&|sight| sight.area)?;
    let contrast = of(&|sight| sight.contrast)?;
    let objects = of(&|sight| sight.objects[0] as f64)? as usize;
    let all_objects = of(&|sight| sight.objects[1] as f64)?;
    let second = of(&|sight| sight.second)?;
    let clipped = sights.iter().filter(|sight| sight.is_clipped).count() as f64 / found as f64;

    let whole: Vec<&Sight> = sights.iter().filter(|sight| !sight.is_clipped).collect();
    let steadiness = steadiness(&whole);
    let pairs: Vec<(&Sight, &Sight)> =
        sights.windows(2).filter(|w| w[0].frame + 1 == w[1].frame).map(|w| (&w[0], &w[1])).collect();
    let evenness = if pairs.is_empty() && pictures < 2 { 1.0 } else { evenness(&pairs, factor) };
    let smoothness = if pictures < 3 { 1.0 } else { smoothness(sights) };
    let movement = factor * movement(sights);
    let area_share = area / picture_area;

    let moves = if pictures < 3 || movement > tuning::MOVES { 1.0 } else { tuning::AT_REST };
    let is_ground = if area_share > tuning::MOST_OF_PICTURE { tuning::GROUND } else { 1.0 };
    // Many small things do no harm where one is much larger than all.
    let too_many = (all_objects - tuning::FEW_OBJECTS).max(0.0) / tuning::FEW_OBJECTS;
    let many = (1.0 + too_many).powf(-(second / tuning::SECOND_COUNTS).min(1.0));
    let size = area * factor * factor / (area * factor * factor + tuning::SMALL);
    let share = (found as f64 / pictures as f64).powf(tuning::POWER_OF_SHARE);
    let score = share
        * steadiness
        * evenness
        * contrast
        * smoothness
        * moves
        * is_ground
        * many
        * size
        * (1.0 - tuning::LOST_BY_CLIPPING * clipped * clipped);
    Some(TracingEvidence {
        tracing,
        pictures,
        found,
        steadiness,
        evenness,
        contrast,
        smoothness,
        movement,
        rests: rests(sights, factor),
        clipped,
        area_share,
        objects,
        second,
        selection: if objects > 1 { Selection::All } else { Selection::Largest },
        largest_hole: of(&|sight| sight.inner.largest)?,
        has_steady_contours: has_steady_contours(&whole),
        score,
    })
}

/// Whether nearly all show the same number of holes and marks, of the same area together.
fn has_steady_contours(whole: &[&Sight]) -> bool {
    let of = |value: fn(&Inner) -> f64| median(whole.iter().map(|sight| value(&sight.inner)));
    let (Some(count), Some(area), Some(largest)) =
        (of(|inner| inner.count as f64), of(|inner| inner.share), of(|inner| inner.largest))
    else {
        return false;
    };
    let is_same = |sight: &&&Sight| {
        sight.inner.count as f64 == count && (sight.inner.share / area).ln().abs() < tuning::SAME_HOLES
    };
    whole.len() > 2
        && count > 0.0
        && largest < LINE
        && whole.iter().filter(is_same).count() as f64 >= tuning::NEARLY_ALL * whole.len() as f64
}

/// How many of the sights are like the one that most are like.
fn steadiness(whole: &[&Sight]) -> f64 {
    if whole.is_empty() {
        return tuning::NOT_TOLD;
    }
    let alike = |a: &Sight, b: &Sight| {
        let growth = (a.area / b.area).ln() / tuning::GROWTH;
        let shape = a.invariants.zip(b.invariants).map_or(1.0, |(a, b)| a.distance(&b) / tuning::SHAPE);
        (-0.5 * (growth * growth + shape * shape)).exp()
    };
    let mean = |a: &&Sight| whole.iter().map(|b| alike(a, b)).sum::<f64>() / whole.len() as f64;
    whole.iter().map(mean).fold(0.0, f64::max)
}

/// How little area and shape change from one picture to the next.
fn evenness(pairs: &[(&Sight, &Sight)], factor: f64) -> f64 {
    let whole = || pairs.iter().filter(|(a, b)| !a.is_clipped && !b.is_clipped);
    let [of_all, of_rounding] = tuning::GROWTH_OF_STEP;
    let expected = |area: f64| of_all + of_rounding * factor.min(2.0) / area.max(1.0).sqrt();
    let growth = median(whole().map(|(a, b)| (a.area / b.area).ln().abs() / expected(a.area)));
    let shape = median(whole().filter_map(|(a, b)| Some(a.invariants?.distance(&b.invariants?))));
    match (growth, shape) {
        (Some(growth), Some(shape)) => {
            1.0 / (1.0 + (growth / tuning::MUCH_GROWTH).powi(2)) / (1.0 + (shape / tuning::SHAPE_OF_STEP).powi(2))
        }
        _ if pairs.is_empty() => tuning::NOT_TOLD,
        _ => tuning::HALF_TOLD,
    }
}

/// How little the path bends within three pictures, in sizes of the object, and in steps where those are longer.
fn smoothness(sights: &[Sight]) -> f64 {
    let bends = sights.windows(3).filter(|w| w[0].frame + 2 == w[2].frame && w.iter().all(|sight| !sight.is_clipped));
    let bend = median(bends.map(|w| {
        let step = (w[1].centre - w[0].centre).norm();
        (w[0].centre.coords - 2.0 * w[1].centre.coords + w[2].centre.coords).norm() / (w[1].size() + 2.0 * step)
    }));
    bend.map_or(tuning::HALF_TOLD, |bend| 1.0 / (1.0 + (bend / tuning::BEND).powi(2)))
}
