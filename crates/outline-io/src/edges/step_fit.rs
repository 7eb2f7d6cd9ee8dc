//! One Gauss-Newton step of the fit of a blurred step to a profile; [`fitting`](super::fitting) iterates it.

/// Distance of the samples of a profile, in pixels.
pub(super) const SPACING: f64 = 0.5;

/// Samples of a profile that are worked out side by side: some registers full.
pub(super) const SIDE_BY_SIDE: usize = 4;

/// Farthest from the middle that one fit puts a step, in pixels: what is farther off is not seen well.
const FARTHEST_AT_ONCE: f64 = 2.0;

/// A least-squares fit of a step of known width to a profile about it. The even part of the profile tells the place, the odd part the
/// height: on a window that is symmetric about the edge the two do not disturb each other, nor does an even slope the place.
#[derive(Debug, Clone)]
pub(super) struct StepFit {
    width: f64,
    offsets: Offsets,
    /// Of every sample.
    weights: Vec<Weights>,
    /// The step of height 1 about its middle.
    shape: Vec<f64>,
    /// Height times place that a change of light shows as, which is steady on one side and the opposite of it on the other.
    place_of_bend: f64,
}

/// Weights of a sample in sums over a profile: in that which gives the height, in that which gives height times place, in that which gives how much
/// steeper the light rises on the far side than on the near one, half of it, and in that of all.
type Weights = [f64; 4];

/// Where the samples of a profile are, in pixels from its middle.
#[derive(Debug, Clone)]
pub(super) struct Offsets {
    /// In their order; the last of them fill it with what is at the far end.
    side_by_side: Vec<[f64; SIDE_BY_SIDE]>,
    count: usize,
}

impl Offsets {
    /// Of so many samples to either side and that of the middle.
    pub(super) fn within(reach: usize) -> Self {
        let count = 2 * reach + 1;
        let offset = |k: usize| SPACING * (k.min(2 * reach) as f64 - reach as f64);
        let four = |block: usize| std::array::from_fn(|k| offset(SIDE_BY_SIDE * block + k));
        Self { side_by_side: (0..count.div_ceil(SIDE_BY_SIDE)).map(four).collect(), count }
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = f64> {
        self.side_by_side.iter().flatten().copied().take(self.count)
    }

    pub(super) fn side_by_side(&self) -> &[[f64; SIDE_BY_SIDE]] {
        &self.side_by_side
    }

    /// The first and the last.
    pub(super) fn ends(&self) -> [f64; 2] {
        let far = 0.5 * SPACING * (self.count - 1) as f64;
        [-far, far]
    }
}

/// What a profile shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// From the middle of the profile, in pixels, to first order.
    pub(super) place: f64,
    /// Grey values that the profile rises by.
    pub(super) height: f64,
    /// Mean of the grey values.
    middle: f64,
    /// How much farther along the edge is seen to lie as the light changes on one side of it more than on the other.
    pub(super) one_sided: f64,
}

impl StepFit {
    /// For steps of this width, from samples as far as `reach` from the middle, in pixels.
    pub(super) fn new(width: f64, reach: f64) -> Self {
        let offsets = Offsets::within(((reach / SPACING).round() as usize).max(3));
        let (shape, slope): (Vec<f64>, Vec<f64>) =
            offsets.iter().map(|s| (normal_cdf(s / width) - 0.5, normal_pdf(s / width) / width)).unzip();
        let bend: Vec<f64> = offsets.iter().map(f64::abs).collect();
        let about_mean = |values: &[f64]| -> Vec<f64> {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.iter().map(|value| value - mean).collect()
        };
        // A step moved by e is the step less e times its slope.
        let (slope, bend) = (about_mean(&slope), about_mean(&bend));
        let (of_step, of_place) = (weights(&shape), weights(&slope));
        let place_of_bend = dot(&of_place, &bend);
        let of_bend = weights(&bend.iter().zip(&slope).map(|(b, s)| b - place_of_bend * s).collect::<Vec<f64>>());
        let together = of_step.into_iter().zip(of_place).zip(of_bend);
        let weights = together.map(|((step, place), bend)| [step, place, bend, 1.0]).collect();
        Self { width, offsets, weights, shape, place_of_bend }
    }

    /// Width of the steps, in pixels.
    pub(super) fn width(&self) -> f64 {
        self.width
    }

    /// Places of the samples, in pixels from the middle.
    pub(super) fn offsets(&self) -> &Offsets {
        &self.offsets
    }

    /// Standard deviation of a height, for samples with this residual.
    pub(super) fn deviation_of_height(&self, residual: f64) -> f64 {
        // Samples of neighbouring places share pixels: half of them are independent.
        residual * (2.0 * self.weights.iter().map(|[step, ..]| step * step).sum::<f64>()).sqrt()
    }

    /// Standard deviation of a place that a profile one pixel wide tells, in pixels, where noise is as large as the step: from the information
    /// of the step, less what goes into the grey values of the two sides.
    pub(super) fn deviation_of_place(&self) -> f64 {
        let information = 1.0 / (2.0 * std::f64::consts::PI.sqrt() * self.width) - 0.5 / self.offsets.ends()[1];
        information.max(1e-3).powf(-0.5)
    }

    /// The step that a profile shows, its place to first order: one off the middle is found by taking the profile about that place and fitting again.
    pub(super) fn of(&self, values: &[f64]) -> Step {
        let place_of = |height: f64, shift: f64| match height {
            0.0 => 0.0,
            _ => (-shift / height).clamp(-FARTHEST_AT_ONCE, FARTHEST_AT_ONCE),
        };
        // All sums side by side: one alone waits for its own last addition.
        let mut sums = [0.0; 4];
        for (of, value) in self.weights.iter().zip(values) {
            sums.iter_mut().zip(of).for_each(|(sum, of)| *sum += of * value);
        }
        let [height, shift, bend, sum] = sums;
        let place = place_of(height, shift);
        let one_sided = place_of(height, bend * self.place_of_bend);
        Step { place, height, middle: sum / values.len().max(1) as f64, one_sided }
    }

    /// Root mean square of what a step leaves of the profile that shows it.
    pub(super) fn residual(&self, values: &[f64], Step { height, middle, .. }: &Step) -> f64 {
        let squares = values.iter().zip(&self.shape).map(|(value, shape)| (value - middle - height * shape).powi(2));
        (squares.sum::<f64>() / (values.len().max(4) - 3) as f64).sqrt()
    }
}

/// Weights that give how much of a shape there is.
fn weights(shape: &[f64]) -> Vec<f64> {
    let square = dot(shape, shape);
    shape.iter().map(|value| value / square).collect()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

fn normal_pdf(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

/// The normal distribution function, to 2e-7 (M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 7.1.26).
pub(super) fn normal_cdf(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let tail = series.iter().rev().fold(0.0, |sum, c| (sum + c) * t) * (-x * x).exp();
    if z < 0.0 { 0.5 * tail } else { 1.0 - 0.5 * tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_found_with_its_height_wherever_it_lies() {
        for (width, place, height, ground) in
            [(0.8, 0.3, -120.0, 200.0), (2.0, -0.7, 40.0, 10.0), (3.0, 1.0, 77.0, 0.0)]
        {
            let fit = StepFit::new(width, 2.2 * width + 1.2);
            let mut found = 0.0;
            for _ in 0..5 {
                let value = |s: f64| ground + height * normal_cdf((s + found - place) / width);
                let values: Vec<f64> = fit.offsets().iter().map(value).collect();
                found += fit.of(&values).place;
            }
            let values: Vec<f64> =
                fit.offsets().iter().map(|s| ground + height * normal_cdf((s + found - place) / width)).collect();
            let found_again = fit.of(&values);
            let (step, residual) = (found_again.height, fit.residual(&values, &found_again));
            assert!((found - place).abs() < 1e-4, "{found} {place}");
            assert!((step / height - 1.0).abs() < 1e-3 && residual < 1e-2 * height.abs(), "{step} {residual}");
        }
    }

    #[test]
    fn a_slope_of_the_ground_does_not_move_the_step() {
        let fit = StepFit::new(1.5, 4.5);
        let values: Vec<f64> = fit.offsets().iter().map(|s| 100.0 * normal_cdf(s / 1.5) + 2.0 * s).collect();
        assert!(fit.of(&values).place.abs() < 1e-6);
    }

    #[test]
    fn a_slope_of_the_light_on_one_side_alone_tells_how_far_it_moves_the_step() {
        let fit = StepFit::new(1.5, 7.5);
        for slope in [-0.7, 0.3] {
            let light = |s: f64| slope * s.max(0.0) + 100.0 * normal_cdf(s / 1.5);
            let Step { place, one_sided, .. } = fit.of(&fit.offsets().iter().map(light).collect::<Vec<f64>>());
            assert!(place.abs() > 0.01 && (one_sided / place - 1.0).abs() < 0.02, "{one_sided} {place}");
        }
        let even: Vec<f64> = fit.offsets().iter().map(|s| 100.0 * normal_cdf((s - 0.01) / 1.5) + 0.5 * s).collect();
        assert!(fit.of(&even).one_sided.abs() < 1e-4);
    }
}
