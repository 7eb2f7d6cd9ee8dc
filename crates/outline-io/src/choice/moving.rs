//! What moves in front of a ground that rests. It is looked for where the best way finds what rests, or nothing for sure: the largest thing
//! that stands out of a still picture is seldom the one whose motion is asked for.
use std::collections::BTreeSet;

use super::beside::{Beside, Changes, changes_beside};
use super::chains::{Chain, Likely, chains_of, common_pull, follow_each_other, straight_on};
use super::evidence::{TracingEvidence, evidence_of};
use super::sight::Sight;
use super::trial::Trial;
use super::tuning::chains as tuning;
use super::{AGAINST_NOISE, PictureSample, Tracing, TracingWay};
use crate::ground::background::Difference;
use crate::identity::identities::Selection;
use crate::identity::known_object::LEFT;
use crate::picture_file::channel::Channel;
use crate::picture_outlines::PictureSettings;
use crate::tracing::settings::Smoothing;

/// Objects of a picture that are looked at.
pub(super) const OBJECTS: usize = 12;

/// Logarithm of the ratio of areas, and distance of the affine moment invariants, that one thing may have at different times.
const ALIKE: f64 = 0.5;

/// Fewest bursts, and least share of all, in which it is seen to move.
const FEWEST_BURSTS: usize = 2;
const LEAST_SHARE: f64 = 0.15;

/// Least likeness of all bursts together, 1 for each where nothing changes.
const LEAST_LIKENESS: f64 = 1.2;

/// Least score. Clutter that looks as if something moved is far below it.
const LEAST_SCORE: f64 = 0.005;

/// What moves, and what changes at all.
pub(super) struct Motion {
    /// The way that shows best what moves, if something does.
    pub(super) moving: Option<TracingEvidence>,
    /// Changes beside what was found instead.
    pub(super) changes: Option<Changes>,
    /// Pictures in which something goes on beside what else there is, be it one thing or many.
    pub(super) goes_on: Changes,
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
    let (mut changes, mut best, mut going_on) = (None, None::<Moving>, Vec::new());
    for tracing in ways {
        let pictures = trial.all_sights(&tracing, OBJECTS);
        if tracing.level.is_some() {
            changes = beside.still.as_ref().map(|still| changes_beside(&pictures, still, trial.picture_area()));
        }
        let bursts: Vec<&[Vec<Sight>]> = pictures.windows(3).filter(|burst| follow_each_other(burst)).collect();
        let mut chains: Vec<Vec<Chain>> = bursts.iter().map(|burst| chains_of(burst)).collect();
        for chains in &mut chains {
            chains.retain(|chain| !beside.has(chain));
        }
        // Bursts of pictures that follow each other overlap.
        let frames: BTreeSet<_> = chains.iter().flatten().flatten().map(|sight| sight.frame).collect();
        going_on.push(frames.len());
        let found = moving(&trial, tracing, (bursts, chains), &beside);
        let found = [best, found].into_iter().flatten();
        best = found.min_by(|a, b| a.chance.total_cmp(&b.chance).then(b.found.score.total_cmp(&a.found.score)));
    }
    // What one way alone shows is noise.
    going_on.sort_unstable();
    let seen = going_on.iter().rev().nth(1).or(going_on.first()).copied().unwrap_or(0);
    Motion { moving: best.map(|best| best.found), changes, goes_on: Changes { seen, pictures: trial.count() } }
}

/// What a way shows that moves.
struct Moving {
    found: TracingEvidence,
    /// How likely clutter looks so; nothing where area and shape are steady.
    chance: f64,
}

/// Looks for what moves in what a way shows, by its bursts of pictures and what goes on in them.
fn moving(
    trial: &Trial,
    tracing: Tracing,
    (bursts, chains): (Vec<&[Vec<Sight>]>, Vec<Vec<Chain>>),
    beside: &Beside,
) -> Option<Moving> {
    let fewest = FEWEST_BURSTS.max((LEAST_SHARE * bursts.len() as f64).ceil() as usize);
    let seen = |group: Vec<&Chain>| {
        let mut sights: Vec<Sight> = group.into_iter().flatten().cloned().collect();
        sights.sort_by_key(|sight| sight.frame);
        sights.dedup_by_key(|sight| sight.frame);
        let found = evidence_of(trial, tracing, &sights)?;
        let selection = if found.objects > 1 { Selection::Moving } else { found.selection };
        Some(TracingEvidence { selection, ..found })
    };
    let is_one_thing = |group: &[&Chain]| group.len() >= fewest && leaves(group) && !beside.turns_with(group);
    // Which of them are one thing: the largest number that are like one of them.
    let of_one_thing = |chains: &[Vec<Chain>]| {
        let groups = chains.iter().flatten().map(|chain| like(chain, chains));
        let (group, likeness) = groups.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let found = if is_one_thing(&group) { seen(group)? } else { return None };
        Some((found, likeness))
    };
    if let Some((found, likeness)) = of_one_thing(&chains)
        && likeness >= LEAST_LIKENESS
        && found.score >= LEAST_SCORE
    {
        return Some(Moving { found, chance: 0.0 });
    }
    // Small and fast things change in area and shape. By chance clutter would hardly look as if it went straight on so often, or as if one
    // acceleration bent its way in all bursts, as gravity does that of what is thrown or falls.
    let area = trial.picture_area();
    let by_chance = |likely: Likely| {
        let (found, _) = (likely.chance < tuning::BY_CHANCE).then(|| of_one_thing(&likely.chains))??;
        Some(Moving { found, chance: likely.chance })
    };
    by_chance(straight_on(chains, &bursts, area))
        .or_else(|| by_chance(common_pull(&bursts, area, |chain| !beside.has(chain))?))
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
