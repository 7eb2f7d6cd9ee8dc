//! What goes on from picture to picture, in three pictures that follow each other.
use nalgebra::Vector2;

use super::sight::Sight;
use super::tuning::chains as tuning;

/// Three sightings of one thing in pictures that follow each other.
pub(super) type Chain = [Sight; 3];

/// Whether a thing is nowhere that it was in the picture before.
fn is_clear([a, b, c]: [&Sight; 3]) -> bool {
    let step = (b.centre - a.centre).norm().min((c.centre - b.centre).norm());
    step > tuning::CLEAR * b.size()
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

/// How many triples of like things there are in a burst, whatever way they go.
fn triples(burst: &[Vec<Sight>]) -> usize {
    let alike = |of: &[Sight], b: &Sight| of.iter().filter(|a| is_like(a, b)).count();
    burst[1].iter().map(|b| alike(&burst[0], b) * alike(&burst[2], b)).sum()
}

/// How many of so many triples are expected to be bent as little as by `bend`, of things that lie anywhere near each other.
fn as_straight(triples: usize, bend: f64, size: f64, picture_area: f64) -> f64 {
    let disc = |radius: f64| std::f64::consts::PI * radius * radius;
    let room = disc(tuning::LARGEST_STEP * size).min(picture_area);
    triples as f64 * disc(bend + tuning::BEND[2]) / room
}

/// That there is one or more where so many are expected.
fn one_or_more(expected: f64) -> f64 {
    1.0 - (-expected).exp()
}

/// By how much the second step of a chain differs from its first.
fn bend([a, b, c]: [&Sight; 3]) -> Vector2<f64> {
    a.centre.coords - 2.0 * b.centre.coords + c.centre.coords
}

/// Chains of every burst, and how likely things that lie anywhere look so.
pub(super) struct Likely {
    pub(super) chains: Vec<Vec<Chain>>,
    pub(super) chance: f64,
}

/// The chains of things that are nowhere that they were in the picture before.
pub(super) fn straight_on(mut chains: Vec<Vec<Chain>>, bursts: &[&[Vec<Sight>]], picture_area: f64) -> Likely {
    let chance = together(chains.iter_mut().zip(bursts).map(|(chains, burst)| {
        chains.retain(|chain| is_clear(chain.each_ref()));
        let triples = triples(burst);
        let expected = chains
            .iter()
            .map(|chain| as_straight(triples, bend(chain.each_ref()).norm(), chain[1].size(), picture_area));
        one_or_more(expected.fold(f64::INFINITY, f64::min))
    }));
    Likely { chains, chance }
}

/// The chains that one acceleration bends most alike in all bursts. Each chain is tried: its own burst says nothing for it then, and the chance is
/// that of the best of so many.
pub(super) fn common_pull(
    bursts: &[&[Vec<Sight>]],
    picture_area: f64,
    is_wanted: impl Fn(&Chain) -> bool,
) -> Option<Likely> {
    let bent: Vec<Vec<Chain>> = bursts.iter().map(|burst| bent_chains(burst, &is_wanted)).collect();
    let triples: Vec<usize> = bursts.iter().map(|burst| triples(burst)).collect();
    let off = |chain: &Chain, pull: &Vector2<f64>| (bend(chain.each_ref()) - pull).norm();
    let chance_of = |pull: &Vector2<f64>, own: usize| {
        let others = bent.iter().zip(&triples).enumerate().filter(|(k, _)| *k != own);
        together(others.map(|(_, (chains, triples))| {
            let expected =
                chains.iter().map(|chain| as_straight(*triples, off(chain, pull), chain[1].size(), picture_area));
            one_or_more(expected.fold(f64::INFINITY, f64::min))
        }))
    };
    let tried =
        bent.iter().enumerate().flat_map(|(own, chains)| chains.iter().map(move |chain| (own, bend(chain.each_ref()))));
    let count = tried.clone().count();
    let (pull, chance) = tried.map(|(own, pull)| (pull, chance_of(&pull, own))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let along = |chains: &Vec<Chain>| -> Vec<Chain> {
        let is_along = |chain: &&Chain| {
            off(chain, &pull) < tuning::BEND[0] * chain[1].size() + tuning::BEND[2] + tuning::PULL_VARIES * pull.norm()
        };
        chains.iter().filter(is_along).cloned().collect()
    };
    Some(Likely { chains: bent.iter().map(along).collect(), chance: count as f64 * chance })
}

/// What is like each other in three pictures, nowhere that it was in the picture before, and goes on, bent however within limits.
fn bent_chains(burst: &[Vec<Sight>], is_wanted: impl Fn(&Chain) -> bool) -> Vec<Chain> {
    let [first, second, third] = burst else { return Vec::new() };
    let goes_on =
        |chain: &[&Sight; 3]| is_clear(*chain) && bend(*chain).norm() < tuning::LARGEST_PULL * chain[1].size();
    let all = second.iter().flat_map(|b| candidates(first, b, third)).filter(goes_on);
    all.map(|chain| chain.map(Sight::clone)).filter(is_wanted).collect()
}

/// All that may be one thing in three pictures, of which it is seen in the second.
fn candidates<'a>(first: &'a [Sight], b: &'a Sight, third: &'a [Sight]) -> impl Iterator<Item = [&'a Sight; 3]> {
    let alike = |of: &'a [Sight]| -> Vec<&'a Sight> { of.iter().filter(|a| is_like(a, b)).collect() };
    let (before, after) = (alike(first), alike(third));
    before.into_iter().flat_map(move |a| after.clone().into_iter().map(move |c| [a, b, c]))
}

pub(super) fn follow_each_other(burst: &[Vec<Sight>]) -> bool {
    let frames: Vec<u64> = burst.iter().filter_map(|sights| Some(sights.first()?.frame)).collect();
    frames.len() == 3 && frames[0] + 1 == frames[1] && frames[1] + 1 == frames[2]
}

/// What goes straight on within three pictures.
pub(super) fn chains_of(burst: &[Vec<Sight>]) -> Vec<Chain> {
    let [first, second, third] = burst else { return Vec::new() };
    let goes_on = |[a, b, c]: &[&Sight; 3]| {
        let (one, two) = (b.centre - a.centre, c.centre - b.centre);
        let step = one.norm().max(two.norm());
        let bend = tuning::BEND[0] * b.size() + tuning::BEND[1] * step + tuning::BEND[2];
        let overlaps = step < tuning::OVERLAP * b.size();
        (overlaps || (two - one).norm() < bend)
            && (one + two).norm() > tuning::LEAST_WAY[0] * b.size() + tuning::LEAST_WAY[1]
    };
    let chain = |b: &Sight| -> Option<Chain> {
        let straight = candidates(first, b, third).filter(goes_on);
        Some(straight.min_by(|x, y| way(*x).total_cmp(&way(*y)))?.map(Sight::clone))
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
        && (a.area / b.area).ln().abs() < tuning::GROWTH + tuning::GROWTH_OF_SMALL / size
        && (a.centre - b.centre).norm() < tuning::LARGEST_STEP * size
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::choice::sight::Inner;

    /// What is seen of something small.
    fn speck(frame: u64, [x, y]: [f64; 2]) -> Sight {
        let (centre, area, contrast, objects) = (Point2::new(x, y), 100.0, 1.0, [1, 1]);
        let (invariants, is_clipped, points, inner, second) = (None, false, vec![], Inner::default(), 0.0);
        Sight { frame, centre, area, invariants, is_clipped, points, contrast, objects, inner, second }
    }

    /// Six bursts of pictures with a few specks at random places, and something that was thrown.
    fn thrown(seed: u64, is_thrown: bool) -> Vec<Vec<Sight>> {
        let mut state = seed;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let frames = (0..6_u64).flat_map(|burst| (0..3).map(move |k| 20 * burst + k));
        let seen = |frame: u64| {
            let time = (frame % 20) as f64;
            let start = [60.0 + 30.0 * random(), 60.0 + 40.0 * random()];
            let mut sights: Vec<Sight> = (0..3).map(|_| speck(frame, [300.0 * random(), 220.0 * random()])).collect();
            let (burst, rises) = ((frame / 20) as f64, 14.0 - 9.0 * (frame / 20 % 3) as f64);
            let place = [40.0 + 25.0 * burst + 12.0 * time, 120.0 + rises * time + 5.0 * time * time];
            sights.extend(is_thrown.then(|| speck(frame, [place[0] + 0.01 * start[0], place[1] + 0.01 * start[1]])));
            sights
        };
        frames.map(seen).collect()
    }

    #[test]
    fn what_is_thrown_is_told_by_its_acceleration_and_specks_at_random_places_are_not() {
        let pulled = |pictures: &[Vec<Sight>]| {
            let bursts: Vec<&[Vec<Sight>]> = pictures.chunks(3).collect();
            common_pull(&bursts, 76_800.0, |_| true)
        };
        for seed in 0..20 {
            let with = pulled(&thrown(seed, true)).expect("chains");
            assert!(with.chance < tuning::BY_CHANCE, "{seed}: {}", with.chance);
            let of_thrown = |chain: &Chain| (bend(chain.each_ref()) - Vector2::new(0.0, 10.0)).norm() < 2.0;
            assert!(with.chains.iter().all(|chains| chains.iter().any(of_thrown)), "{seed}");
            let without = pulled(&thrown(seed, false)).map_or(1.0, |likely| likely.chance);
            assert!(without > tuning::BY_CHANCE, "{seed}: {without}");
        }
    }

    #[test]
    fn chances_together_are_likely_where_they_are_by_chance_and_not_where_all_are_small() {
        assert!((together([0.3].into_iter()) - 0.3).abs() < 1e-12);
        // 1/2 - 1/2 ln 1/2 and the like: the area below a hyperbola in the unit square.
        assert!((together([0.5, 1.0].into_iter()) - 0.5 * (1.0 + 2_f64.ln())).abs() < 1e-12);
        assert!(together((1..=22).map(|k| f64::from(k) / 23.0)) > 0.3);
        assert!(together([0.01; 6].into_iter()) < 1e-6);
    }
}
