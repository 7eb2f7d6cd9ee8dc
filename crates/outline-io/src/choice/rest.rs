//! Whether what a way finds rests.
use super::sight::Sight;
use super::turning::turns;
use crate::edges::median;

/// Pictures so far from each other show whether something moves.
const FAR_APART: u64 = 5;

/// What rests is nowhere so many times farther from where it was first than it may move from picture to picture.
const FAR: f64 = 3.0;

/// A thing looks the same where the logarithm of the ratio of its areas and the distance of its affine moment invariants are less than this. So
/// it must do in this share of the pairs of pictures that are far from each other, or nothing is said.
const SAME_AREA: f64 = 0.05;
const SAME_SHAPE: f64 = 0.1;
const LEAST_SAME: f64 = 0.2;

/// How far a thing has moved from one sight to another: its middle, or its outline about that.
fn moved(a: &Sight, b: &Sight) -> f64 {
    (a.centre - b.centre).norm().max(a.unlike(b))
}

/// Whether what is seen rests: from picture to picture it hardly moves, pictures far from each other show it where it was, and none shows it
/// far from where it was first: what swings slowly comes back too. Or wherever it looks the same it lies in the same place. What turns in its
/// place does not rest, however little that moves its outline.
pub(super) fn rests(sights: &[Sight], factor: f64) -> bool {
    let near = median(sights.windows(2).filter(|w| w[0].frame + 1 == w[1].frame).map(|w| moved(&w[0], &w[1])));
    let Some(near) = near else { return false };
    let again = median(sights.iter().step_by(2).filter_map(|a| {
        let far = sights.iter().filter(|b| a.frame.abs_diff(b.frame) >= FAR_APART);
        far.map(|b| moved(a, b)).min_by(f64::total_cmp)
    }));
    let hardly = (1.0 / factor).max(0.02 * median(sights.iter().map(Sight::size)).unwrap_or(0.0));
    let is_steady = again.is_some_and(|again| near < hardly && again < 1.5 * near + 0.5 / factor);
    is_steady && (movement(sights) < FAR * hardly || is_where_it_was(sights, hardly)) && !turns(sights)
}

/// Whether a thing of which now more is seen and now less, as what is around it belongs to its outline or not, lies in one place wherever it
/// looks the same, in many pictures far from each other.
fn is_where_it_was(sights: &[Sight], hardly: f64) -> bool {
    let pairs = || {
        let others = |k: usize| sights[k + 1..].iter();
        (0..sights.len()).flat_map(move |k| others(k).map(move |b| (&sights[k], b)))
    };
    let far_apart = || pairs().filter(|(a, b)| a.frame.abs_diff(b.frame) >= FAR_APART);
    let looks_same = |(a, b): &(&Sight, &Sight)| {
        let shape = a.invariants.zip(b.invariants).map_or(f64::INFINITY, |(a, b)| a.distance(&b));
        (a.area / b.area).ln().abs() < SAME_AREA && shape < SAME_SHAPE
    };
    let (mut same, mut farthest) = (0_u32, 0.0_f64);
    for (a, b) in far_apart().filter(looks_same) {
        same += 1;
        farthest = farthest.max(moved(a, b));
    }
    f64::from(same) >= LEAST_SAME * far_apart().count() as f64 && same > 0 && farthest < FAR * hardly
}

/// Farthest movement of the middle or of the outline about it, in pixels of the trial.
pub(super) fn movement(sights: &[Sight]) -> f64 {
    let Some(first) = sights.first() else { return 0.0 };
    let step = (sights.len() / 6).max(1);
    sights.iter().skip(1).step_by(step).chain(sights.last()).map(|sight| moved(sight, first)).fold(0.0, f64::max)
}
