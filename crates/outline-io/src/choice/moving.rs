//! What moves in front of a ground that rests. It is looked for where the best way finds what rests, or nothing for sure: the largest thing
//! that stands out of a still picture is seldom the one whose motion is asked for.
use nalgebra::{Point2, Vector2};

use super::evidence::{TracingEvidence, Trial, evidence_of};
use super::sight::Sight;
use super::{AGAINST_NOISE, PictureSample, Tracing, TracingWay};
use crate::affine_moment_invariants::is_within;
use crate::background::Difference;
use crate::channel::Channel;
use crate::identity::{LEFT, Selection};
use crate::picture_outlines::PictureSettings;
use crate::trace_settings::Smoothing;

/// Objects of a picture that are looked at.
const OBJECTS: usize = 12;

/// Largest logarithm of the ratio of areas from one picture to the next, and what the rounding of a small outline adds, over its size.
const GROWTH: f64 = 0.15;
const GROWTH_OF_SMALL: f64 = 2.0;

/// Largest step from one picture to the next, in sizes (roots of areas).
const LARGEST_STEP: f64 = 8.0;

/// How far two steps that follow each other may differ: in sizes, in steps, and in pixels of the trial.
const BEND: [f64; 3] = [0.03, 0.25, 0.3];

/// Steps of so many sizes need no straight way: nothing else is where the thing was.
const OVERLAP: f64 = 0.5;

/// Least way in three pictures: in sizes, and in pixels of the trial.
const LEAST_WAY: [f64; 2] = [0.1, 1.5];

/// Logarithm of the ratio of areas, and distance of the affine moment invariants, that one thing may have at different times.
const ALIKE: f64 = 0.5;

/// Fewest bursts, and least share of all, in which it is seen to move.
const FEWEST_BURSTS: usize = 2;
const LEAST_SHARE: f64 = 0.15;

/// Least likeness of all bursts together, 1 for each where nothing changes.
const LEAST_LIKENESS: f64 = 1.2;

/// Least score. Clutter that looks as if something moved is far below it.
const LEAST_SCORE: f64 = 0.005;

/// A thing moves clearly where it moves by so many of its sizes from picture to picture.
const CLEAR: f64 = 0.75;

/// So likely clutter may look as if it moved.
const BY_CHANCE: f64 = 1e-4;

/// A change is no larger than this share of the picture, and is seen in one of so many pictures.
const LARGEST_CHANGE: f64 = 0.25;
const CHANGES_OFTEN: usize = 4;

/// Three sightings of one thing in pictures that follow each other.
type Chain = [Sight; 3];

/// What is seen to change besides what is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Changes {
    /// Pictures in which something changes elsewhere.
    pub(super) seen: usize,
    /// Pictures looked at.
    pub(super) pictures: usize,
}

impl Changes {
    /// Whether it is seen often enough to be no speck of noise.
    pub(super) fn are_many(self) -> bool {
        self.seen > 2 && CHANGES_OFTEN * self.seen >= self.pictures
    }
}

/// What moves, and what changes at all.
pub(super) struct Motion {
    /// The way that shows best what moves, if something does.
    pub(super) moving: Option<TracingEvidence>,
    /// Changes beside what was found instead.
    pub(super) changes: Option<Changes>,
}

/// Looks for what moves beside what another way finds, given as `rests` where that rests: then its first sight stands for all, and changes
/// are counted; of one that moves, as `others`, where it is in every picture.
pub(super) fn what_moves(
    sample: &PictureSample,
    base: &PictureSettings,
    channel: Channel,
    rests: Option<&Tracing>,
    others: Option<&Tracing>,
) -> Motion {
    let trial = Trial::whole(sample, base, channel);
    let still = rests.and_then(|tracing| Trial::fine(sample, base, tracing.channel).first_sight(tracing));
    let others = others.map(|tracing| Trial::whole(sample, base, tracing.channel).all_sights(tracing, OBJECTS));
    let beside = Beside { still, others };
    let plain = |smoothing| Tracing { way: TracingWay::Median(Difference::Either), channel, smoothing, level: None };
    let smoothings = match base.trace.smoothing {
        Smoothing::Automatic => vec![Smoothing::Automatic, Smoothing::Gaussian(AGAINST_NOISE)],
        given => vec![given],
    };
    let ways = smoothings.into_iter().flat_map(|smoothing| {
        let otsu = plain(smoothing);
        let level = trial.noise_level(&otsu).map(|level| level * f64::from(sample.factor()));
        [Some(otsu), level.map(|level| Tracing { level: Some(level), ..otsu })].into_iter().flatten()
    });
    let (mut changes, mut best) = (None, None::<Moving>);
    for tracing in ways {
        let pictures = trial.all_sights(&tracing, OBJECTS);
        if tracing.level.is_some() {
            changes = beside.still.as_ref().map(|still| changes_beside(&pictures, still, trial.picture_area()));
        }
        let found = moving(&trial, tracing, &pictures, &beside);
        let found = [best, found].into_iter().flatten();
        best = found.min_by(|a, b| a.chance.total_cmp(&b.chance).then(b.found.score.total_cmp(&a.found.score)));
    }
    Motion { moving: best.map(|best| best.found), changes }
}

/// What else there is.
struct Beside {
    still: Option<Sight>,
    /// Picture for picture.
    others: Option<Vec<Vec<Sight>>>,
}

impl Beside {
    /// Whether a thing is a part of what is known already, or changes with that.
    fn has(&self, chain: &Chain) -> bool {
        let same_picture = |sight: &&Sight| sight.frame == chain[1].frame;
        let in_picture = self.others.iter().flatten().flatten().filter(same_picture);
        self.still.as_ref().is_some_and(|still| lies_on(&chain[1], still))
            || in_picture.into_iter().any(|other| is_part_of(&chain[1], other))
    }
}

/// Whether a thing lies on another or in it.
fn is_part_of(sight: &Sight, other: &Sight) -> bool {
    lies_on(sight, other) || is_within(&sight.centre, &other.points.iter().copied())
}

/// In how many pictures something differs from the ground beside what rests, that is not most of the picture, as light does.
fn changes_beside(pictures: &[Vec<Sight>], still: &Sight, picture_area: f64) -> Changes {
    let is_beside = |sight: &Sight| !is_part_of(sight, still) && sight.area < LARGEST_CHANGE * picture_area;
    let seen = pictures.iter().filter(|sights| sights.iter().any(is_beside)).count();
    Changes { seen, pictures: pictures.len() }
}

/// What a way shows that moves.
struct Moving {
    found: TracingEvidence,
    /// How likely clutter looks so; nothing where area and shape are steady.
    chance: f64,
}

/// Looks for what moves in what a way shows.
fn moving(trial: &Trial, tracing: Tracing, pictures: &[Vec<Sight>], beside: &Beside) -> Option<Moving> {
    let bursts: Vec<&[Vec<Sight>]> = pictures.windows(3).filter(|burst| follow_each_other(burst)).collect();
    let mut chains: Vec<Vec<Chain>> = bursts.iter().map(|burst| chains_of(burst)).collect();
    for chains in &mut chains {
        chains.retain(|chain| !beside.has(chain));
    }
    let fewest = FEWEST_BURSTS.max((LEAST_SHARE * bursts.len() as f64).ceil() as usize);
    let seen = |group: Vec<&Chain>| {
        let mut sights: Vec<Sight> = group.into_iter().flatten().cloned().collect();
        sights.sort_by_key(|sight| sight.frame);
        sights.dedup_by_key(|sight| sight.frame);
        let found = evidence_of(trial, tracing, &sights)?;
        let selection = if found.objects > 1 { Selection::Moving } else { found.selection };
        Some(TracingEvidence { selection, ..found })
    };
    let is_one_thing = |group: &[&Chain]| {
        group.len() >= fewest && leaves(group) && beside.still.as_ref().is_none_or(|still| !turns_with(group, still))
    };
    // Which of them are one thing: the largest number that are like one of them.
    let groups = chains.iter().flatten().map(|chain| like(chain, &chains));
    let (group, likeness) = groups.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let steady = if likeness >= LEAST_LIKENESS && is_one_thing(&group) { seen(group) } else { None };
    if let Some(steady) = steady.filter(|found| found.score >= LEAST_SCORE) {
        return Some(Moving { found: steady, chance: 0.0 });
    }
    // Small and fast things change in area and shape. By chance clutter would hardly look as if it went straight on so often.
    let fast: Vec<(Vec<Chain>, f64)> = chains
        .into_iter()
        .zip(bursts)
        .map(|(mut chains, burst)| {
            chains.retain(is_clear);
            let expected = chains.iter().map(|chain| as_straight(chain, burst, trial.picture_area()));
            // That there is one or more.
            let chance = 1.0 - (-expected.fold(f64::INFINITY, f64::min)).exp();
            (chains, chance)
        })
        .collect();
    let fast_chains: Vec<Vec<Chain>> = fast.iter().map(|(chains, _)| chains.clone()).collect();
    let chance = together(fast.iter().map(|(_, chance)| *chance));
    let groups = fast_chains.iter().flatten().map(|chain| like(chain, &fast_chains));
    let (group, _) = groups.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let found = if chance < BY_CHANCE && is_one_thing(&group) { seen(group)? } else { return None };
    Some(Moving { found, chance })
}

/// Whether a thing is nowhere that it was in the picture before.
fn is_clear(chain: &Chain) -> bool {
    let [a, b, c] = chain;
    let step = (b.centre - a.centre).norm().min((c.centre - b.centre).norm());
    step > CLEAR * b.size()
}

/// How likely chances have at most the product that they have, if all are by chance (R. A. Fisher, *Statistical Methods for Research Workers*).
fn together(chances: impl Iterator<Item = f64>) -> f64 {
    let (mut count, mut logarithm) = (0_u32, 0.0);
    for chance in chances {
        count += 1;
        logarithm -= chance.max(1e-12).ln();
    }
    let (mut term, mut sum) = ((-logarithm).exp(), 0.0);
    for k in 1..=count {
        sum += term;
        term *= logarithm / f64::from(k);
    }
    sum
}

/// How many chains that go as straight on as this one are expected of things that lie anywhere near each other.
fn as_straight(chain: &Chain, burst: &[Vec<Sight>], picture_area: f64) -> f64 {
    let [a, b, c] = chain;
    let bend = (a.centre.coords - 2.0 * b.centre.coords + c.centre.coords).norm() + BEND[2];
    let alike = |of: &[Sight], b: &Sight| of.iter().filter(|a| is_like(a, b)).count();
    let triples: usize = burst[1].iter().map(|b| alike(&burst[0], b) * alike(&burst[2], b)).sum();
    let disc = |radius: f64| std::f64::consts::PI * radius * radius;
    let room = disc(LARGEST_STEP * b.size()).min(picture_area);
    triples as f64 * disc(bend) / room
}

/// Of every burst the chain that is most like a given one, where any is; and how like they are, all together.
fn like<'a>(seed: &Chain, chains: &'a [Vec<Chain>]) -> (Vec<&'a Chain>, f64) {
    let difference = |chain: &Chain| {
        let growth = (chain[1].area / seed[1].area).ln() / ALIKE;
        let shape = chain[1].invariants.zip(seed[1].invariants).map_or(1.0, |(a, b)| a.distance(&b) / ALIKE);
        growth.powi(2) + shape.min(1.0).powi(2)
    };
    let best = chains.iter().filter_map(|chains| {
        let of_burst = chains.iter().map(|chain| (chain, difference(chain)));
        of_burst.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, difference)| *difference < 2.0)
    });
    let group: Vec<(&Chain, f64)> = best.collect();
    let likeness = group.iter().map(|(_, difference)| (-difference).exp()).sum();
    (group.into_iter().map(|(chain, _)| chain).collect(), likeness)
}

/// Whether a thing is seen in different places.
fn leaves(group: &[&Chain]) -> bool {
    let first = &group[0][0];
    group.iter().any(|chain| (chain[2].centre - first.centre).norm() > LEFT * first.size())
}

/// Whether it goes around the middle of another, within its outline: then it is a part of that.
fn turns_with(group: &[&Chain], still: &Sight) -> bool {
    let radius = |chain: &Chain| (chain[1].centre - still.centre).norm();
    let first = radius(group[0]);
    let is_part = |chain: &&Chain| {
        is_within(&chain[1].centre, &still.points.iter().copied())
            && (radius(chain) - first).abs() < 0.5 * chain[1].size()
    };
    group.iter().all(is_part)
}

fn follow_each_other(burst: &[Vec<Sight>]) -> bool {
    let frames: Vec<u64> = burst.iter().filter_map(|sights| Some(sights.first()?.frame)).collect();
    frames.len() == 3 && frames[0] + 1 == frames[1] && frames[1] + 1 == frames[2]
}

/// What goes straight on within three pictures.
fn chains_of(burst: &[Vec<Sight>]) -> Vec<Chain> {
    let [first, second, third] = burst else { return Vec::new() };
    let goes_on = |a: &Sight, b: &Sight, c: &Sight| {
        let (one, two) = (b.centre - a.centre, c.centre - b.centre);
        let step = one.norm().max(two.norm());
        let bend = BEND[0] * b.size() + BEND[1] * step + BEND[2];
        let overlaps = step < OVERLAP * b.size();
        (overlaps || (two - one).norm() < bend) && (one + two).norm() > LEAST_WAY[0] * b.size() + LEAST_WAY[1]
    };
    let chain = |b: &Sight| -> Option<Chain> {
        let candidates = |of: &'_ [Sight]| -> Vec<Sight> { of.iter().filter(|a| is_like(a, b)).cloned().collect() };
        let (before, after) = (candidates(first), candidates(third));
        let pairs = before.iter().flat_map(|a| after.iter().map(move |c| (a, c)));
        let straight = pairs.filter(|(a, c)| goes_on(a, b, c));
        let (a, c) = straight.min_by(|x, y| way([x.0, b, x.1]).total_cmp(&way([y.0, b, y.1])))?;
        Some([a.clone(), b.clone(), c.clone()])
    };
    second.iter().filter_map(chain).collect()
}

/// Length of the way.
fn way([a, b, c]: [&Sight; 3]) -> f64 {
    (b.centre - a.centre).norm() + (c.centre - b.centre).norm()
}

/// Whether both may be one thing in pictures that follow each other.
fn is_like(a: &Sight, b: &Sight) -> bool {
    let size = a.size().min(b.size());
    !a.is_clipped
        && !b.is_clipped
        && (a.area / b.area).ln().abs() < GROWTH + GROWTH_OF_SMALL / size
        && (a.centre - b.centre).norm() < LARGEST_STEP * size
}

/// Whether a thing lies on the outline of another: what turns with it changes the picture there.
fn lies_on(sight: &Sight, still: &Sight) -> bool {
    let to = |point: &Point2<f64>| -> Vector2<f64> { point - sight.centre };
    still.points.iter().any(|point| to(point).norm() < sight.size())
}

#[cfg(test)]
mod tests {
    use super::together;

    #[test]
    fn chances_together_are_likely_where_they_are_by_chance_and_not_where_all_are_small() {
        assert!((together([0.3].into_iter()) - 0.3).abs() < 1e-12);
        // 1/2 - 1/2 ln 1/2 and the like: the area below a hyperbola in the unit square.
        assert!((together([0.5, 1.0].into_iter()) - 0.5 * (1.0 + 2_f64.ln())).abs() < 1e-12);
        assert!(together((1..=22).map(|k| f64::from(k) / 23.0)) > 0.3);
        assert!(together([0.01; 6].into_iter()) < 1e-6);
    }
}
