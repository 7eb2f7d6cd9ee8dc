//! Whether motions that are left out come and go: frames ask for more of them than noise does, though all together may ask for none.
use super::innovations::InnovationSeries;
use crate::{
    tuning::family as tuning,
    update::{UNMODELLED, UnmodelledVector},
};

/// A change of shape, of a displacement, root mean square, normalised, and whether it is beyond doubt.
pub(super) type ChangeOfShape = (f64, bool);

/// What single frames say of each motion by itself.
pub(super) struct ToAndFro<'a> {
    pub(super) series: &'a InnovationSeries<UNMODELLED>,
    /// Sums of squared displacements.
    pub(super) squares: &'a UnmodelledVector,
    /// Frames that tell each of them.
    pub(super) told_by: &'a UnmodelledVector,
}

impl ToAndFro<'_> {
    /// Whether one of them has a larger mean square than noise, or varies slowly, and displaces by more than a least. And whether that is beyond
    /// doubt: its mean square is larger than what frames scatter by as well, or its slow part is larger than its changes from frame to frame make by
    /// chance, in more than one stretch alone of the frames that tell it; and it displaces by more than the rounding of a side.
    pub(super) fn change_of_shape(&self, scatter: f64, (least, of_side): (f64, f64)) -> Option<ChangeOfShape> {
        let n = self.series.frames() as f64;
        let most = (1.0 + tuning::SIGNIFICANT * (2.0 / n).sqrt()).max(tuning::SHAPE_CHANGES);
        let largest = |slow: &UnmodelledVector, scatter: f64, least: f64| {
            let changes = |i: &usize| self.series.mean_square(*i) > most * scatter || slow[*i] > tuning::SIGNIFICANT;
            let sizes = (0..UNMODELLED).filter(changes).map(|i| (self.squares[i] / n).sqrt());
            sizes.max_by(f64::total_cmp).filter(|size| *size > least)
        };
        let by_noise = UnmodelledVector::from_element(1.0);
        let displacement = largest(&self.series.slow_part(&by_noise), 1.0, least)?;
        let fast = self.series.fast_variance().sup(&by_noise);
        let (slow, lasting) = (self.series.slow_part(&fast), self.series.lasting_slow_part(&fast));
        // Where few frames tell it there are no others to show that it has passed.
        let by_most = |i: usize| self.told_by[i] > tuning::MOST_TELL * n;
        let lasting = UnmodelledVector::from_fn(|i, _| if by_most(i) { lasting[i] } else { slow[i] });
        let beyond_doubt = largest(&lasting, scatter, least.max(of_side));
        Some((beyond_doubt.unwrap_or(displacement), beyond_doubt.is_some()))
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::*;

    fn normal(rng: &mut ChaCha8Rng) -> f64 {
        StandardNormal.sample(rng)
    }

    /// What is told of 60 frames, with noise that is so many times what it is taken to be, of which one motion has besides what a function of the
    /// frame says. The displacement is in units of what noise as it is taken to be makes.
    fn told_of(noise: f64, shown: impl Fn(f64) -> f64, of_side: f64) -> Vec<Option<ChangeOfShape>> {
        let told = (0..20).map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let (mut series, mut squares) = (InnovationSeries::default(), UnmodelledVector::zeros());
            for frame in 0..60 {
                let mut asked = UnmodelledVector::from_fn(|_, _| noise * normal(&mut rng));
                asked[2] += shown(f64::from(frame));
                squares += asked.component_mul(&asked);
                series.add(&asked, UNMODELLED);
            }
            let told_by = UnmodelledVector::from_element(60.0);
            let motions = ToAndFro { series: &series, squares: &squares, told_by: &told_by };
            motions.change_of_shape(noise * noise, (0.5, of_side))
        });
        told.collect()
    }

    #[test]
    fn frames_that_scatter_by_more_than_their_noise_show_no_change_of_shape_beyond_doubt() {
        assert!(told_of(1.0, |_| 0.0, 0.0).iter().all(Option::is_none));
        let told = told_of(3.0, |_| 0.0, 0.0);
        assert!(told.iter().all(|told| told.is_some_and(|(_, is_beyond_doubt)| !is_beyond_doubt)), "{told:?}");
    }

    #[test]
    fn a_shape_that_changes_slowly_or_fast_by_more_than_frames_scatter_does_so_beyond_doubt() {
        let slowly = |frame: f64| 6.0 * (0.1 * frame).cos();
        let fast = |frame: f64| 8.0 * (2.0 * frame).cos();
        for told in [told_of(1.0, slowly, 0.0), told_of(2.0, slowly, 0.0), told_of(1.0, fast, 0.0)] {
            assert!(told.iter().all(|told| told.is_some_and(|(_, is_beyond_doubt)| is_beyond_doubt)), "{told:?}");
        }
        // By less than the rounding of a side.
        let told = told_of(1.0, slowly, 6.0);
        assert!(told.iter().all(|told| told.is_some_and(|(_, is_beyond_doubt)| !is_beyond_doubt)), "{told:?}");
    }
}
