//! Shape process noise: outlines that change slowly, as those of segmented pictures do, seen by innovations of the offsets that repeat.
use crate::{
    belief::{Arrowhead, Belief, OffsetInformation},
    tuning::shape_noise as tuning,
    vectors::vectorised,
};

/// How fast the offsets change, from the correlation of their innovations in successive frames (R. Mehra, 1970); none until the
/// evidence is significant.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ShapeNoise {
    /// Variance added to every offset per frame, in units of the noise.
    variance: f64,
    repeated: f64,
    uncertainty: f64,
    /// Innovation of the offset of each cell in the last frame, in units of the noise; 0 where it was not seen.
    last: Vec<f64>,
}

impl ShapeNoise {
    /// Whether the outline has been seen to change.
    pub(crate) fn is_seen(&self) -> bool {
        self.variance > 0.0
    }

    /// Makes room for so many cells.
    pub(crate) fn resize(&mut self, cells: usize) {
        self.last.resize(cells, 0.0);
    }

    /// Updates the variance by the sums of products of successive innovations and of their squares, over so many cells.
    fn update(&mut self, products: f64, squares: f64, cells: f64) {
        if self.variance > 0.0 {
            self.variance = (self.variance + tuning::GAIN * products / cells).max(0.0);
            return;
        }
        let kept = 1.0 - 1.0 / tuning::MEMORY;
        self.repeated = kept * self.repeated + products;
        self.uncertainty = kept * self.uncertainty + squares;
        if self.repeated > tuning::SIGNIFICANT * self.uncertainty.sqrt() {
            self.variance = tuning::GAIN * products.max(0.0) / cells;
            (self.repeated, self.uncertainty) = (0.0, 0.0);
        }
    }

    /// Compares the innovations of the offsets with those of the frame before. `before` is the information that the cells had, now
    /// held by the belief with the frame added; `shifts` are the corrections made. `sigma` is the deviation of the noise; where points do not count
    /// alike but by deviations of their own, what less than one good point tells of a cell is taken in its own deviations. `innovations` is room for
    /// a number for each cell.
    pub(crate) fn compare_innovations(
        &mut self,
        belief: &Belief,
        shifts: &[f64],
        before: &OffsetInformation,
        (sigma, counts_alike): (f64, bool),
        innovations: &mut Vec<f64>,
    ) {
        let scale = belief.scale() / sigma;
        innovations.resize(shifts.len(), 0.0);
        let innovations = innovations.as_mut_slice();
        vectorised(
            #[inline(always)]
            || {
                let known = before.own().iter().zip(belief.information.cells.own());
                for (innovation, ((before, after), shift)) in innovations.iter_mut().zip(known.zip(shifts)) {
                    let gain = 1.0 - before / after;
                    // Also false where a cell has no information yet.
                    let is_told = (gain > tuning::SMALLEST_GAIN) & (*before > 0.0);
                    let size = scale * shift / gain;
                    let share = if counts_alike { 1.0 } else { (after - before).clamp(0.0, 1.0).sqrt() };
                    let size = if is_told { share * size } else { 0.0 };
                    let size = if size < -tuning::CLIPPED { -tuning::CLIPPED } else { size };
                    *innovation = if size > tuning::CLIPPED { tuning::CLIPPED } else { size };
                }
            },
        );
        let (mut products, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (last, innovation) in self.last.iter_mut().zip(innovations.iter()) {
            // None where either was not seen.
            let product = innovation * *last;
            products += product;
            squares += product * product;
            count += if product != 0.0 { 1.0 } else { 0.0 };
            *last = *innovation;
        }
        if count > 0.0 {
            self.update(products, squares, count);
        }
    }

    /// Lets the outline have changed since the last frame: the offsets lose information, pose and motion do not.
    pub(crate) fn forget_shape(&self, belief: &mut Belief) {
        if self.variance <= 0.0 {
            return;
        }
        match belief.parameter_count() {
            3 => self.forget_sized::<6>(&mut belief.information),
            4 => self.forget_sized::<8>(&mut belief.information),
            6 => self.forget_sized::<12>(&mut belief.information),
            _ => self.forget_sized::<16>(&mut belief.information),
        }
    }

    /// Of pose and motion of S entries.
    fn forget_sized<const S: usize>(&self, Arrowhead { dense, cells, .. }: &mut Arrowhead) {
        let mut block: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| dense[i][j]));
        let (own, couplings) = cells.all_mut::<S>();
        vectorised(
            #[inline(always)]
            || {
                for (known, coupling) in own.iter_mut().zip(couplings.iter_mut()) {
                    if *known <= 0.0 {
                        continue;
                    }
                    let own = 1.0 / (1.0 / *known + self.variance);
                    let kept = own / *known;
                    // The marginal information `dense - c c' / own` stays as it is.
                    let lost = (1.0 - kept) / *known;
                    for (row, c) in block.iter_mut().zip(&*coupling) {
                        let factor = lost * c;
                        for j in 0..S {
                            row[j] -= factor * coupling[j];
                        }
                    }
                    for entry in coupling.iter_mut() {
                        *entry *= kept;
                    }
                    *known = own;
                }
            },
        );
        for (row, of_block) in dense.iter_mut().zip(block) {
            row[..S].copy_from_slice(&of_block);
        }
    }
}

#[cfg(feature = "serde")]
impl ShapeNoise {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_valid(&self, cells: usize) -> bool {
        let numbers = [self.variance, self.repeated, self.uncertainty];
        let is_finite = numbers.iter().chain(&self.last).all(|number| number.is_finite());
        is_finite && self.variance >= 0.0 && self.last.len() == cells
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dense_filter::{AGREES, DenseFilter, Problem};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn shape_noise_adds_a_variance_to_every_offset_and_leaves_pose_and_motion_alone(mut problem in Problem::any()) {
            let noise = ShapeNoise { variance: problem.rng.random_range(0.01..2.0), ..ShapeNoise::default() };
            let belief = &mut problem.belief;
            let mut dense = DenseFilter::of(&belief.information);
            dense.add_shape_noise(noise.variance);
            noise.forget_shape(belief);
            let difference = dense.difference(&belief.information, |_, _| true);
            prop_assert!(difference < AGREES, "{difference}");
            let difference = dense.difference_of_marginal(&belief.marginal);
            prop_assert!(difference < AGREES, "marginal {difference}");
        }
    }

    #[test]
    fn innovations_that_repeat_are_taken_for_a_changing_shape_and_independent_ones_are_not() {
        let variance_after = |products: f64| {
            let mut noise = ShapeNoise::default();
            (0..60).for_each(|_| noise.update(products, 100.0, 100.0));
            noise.variance
        };
        assert!(variance_after(50.0) > 0.0);
        assert_eq!(variance_after(5.0), 0.0);
        assert_eq!(variance_after(-50.0), 0.0);
    }
}
