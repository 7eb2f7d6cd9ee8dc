use freeform_decompose::{Line, rotation_chart};

/// A pair contains information on rotation if |w| exceeds its noise by this factor, per pair of the curve.
///
/// The leading form of a circle has an m-fold root l = j, m pairs. Noise splits it: `w^m` is Gaussian about 0, so |w|^m
/// follows Rayleigh's law, whose mean is 1.9 times its standard deviation, and |w| has a ratio of 3.6, 5.2 and 6.7
/// for m = 2, 3 and 4: about 1.7 m. Measured over 60 frames of circles, noise 0.001 to 0.02: at most 2.3 m.
const NOISE_FACTOR: f64 = 3.0;
/// With n second differences the noise may be underrated by a factor of about this over n.
const FEW_FRAMES: f64 = 20.0;

/// Information of one conjugate pair on the motion, relative to its noise.
///
/// In the rotation chart `w = (l - j) / (l + j)` a rotation turns w about 0, so |w| is an invariant, noise is the same
/// in every orientation, and `l = j (1 + w) / (1 - w)`. The noise is measured by second differences of |w| over time,
/// which a smooth change under affine motion leaves alone.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PairQuality {
    recent: [f64; 2],
    frames: usize,
    sum: f64,
    squared_differences: f64,
}

impl PairQuality {
    pub(crate) fn take(&mut self, line: &Line) {
        let magnitude = rotation_chart(line.l).norm();
        if self.frames >= 2 {
            self.squared_differences += (magnitude - 2.0 * self.recent[1] + self.recent[0]).powi(2);
        }
        self.recent = [self.recent[1], magnitude];
        self.frames += 1;
        self.sum += magnitude;
    }

    /// Whether it can be what so many frames left behind.
    #[cfg(feature = "serde")]
    pub(crate) fn is_of(&self, frames: usize) -> bool {
        let numbers = [self.recent[0], self.recent[1], self.sum, self.squared_differences];
        // A line of slope -j has an infinite w.
        self.frames == frames && !numbers.iter().any(|number| *number < 0.0)
    }

    /// Mean of |w|.
    pub(crate) fn magnitude(&self) -> f64 {
        self.sum / self.frames.max(1) as f64
    }

    /// Standard deviation of the noise on w.
    fn noise(&self) -> f64 {
        // A second difference of independent values has six times their variance.
        let count = self.frames.saturating_sub(2).max(1) as f64;
        (self.squared_differences / (6.0 * count)).sqrt()
    }

    /// Whether |w| is more than noise about 0, on a curve with so many pairs. Taken for granted before three frames.
    pub(crate) fn tells_of_rotation(&self, pairs: usize) -> bool {
        let differences = self.frames.saturating_sub(2) as f64;
        let needed = NOISE_FACTOR * pairs as f64 * (1.0 + FEW_FRAMES / differences);
        self.frames < 3 || (self.magnitude() > 0.0 && self.magnitude() >= needed * self.noise())
    }

    /// Expected relative error of the angular velocity by the gradient law: the noise on l times the gain `4 w / (1 -
    /// w)^2` of the regressor, over the gain squared, each averaged over all orientations. `sum C(k+n, n)^2 r^k` gives the
    /// averages of `|1 - w|^-4` (n = 1) and `|1 - w|^-8` (n = 3), with `r = |w|^2`. Infinite before three frames.
    pub(crate) fn relative_error(&self) -> f64 {
        let w = self.magnitude();
        let r = (w * w).min(0.999_999);
        let signal = (1.0 + r) / (1.0 - r).powi(3);
        let noise = (1.0 + 9.0 * r + 9.0 * r * r + r * r * r) / (1.0 - r).powi(7);
        if self.frames < 3 || w == 0.0 { f64::INFINITY } else { self.noise() * noise.sqrt() / (w * signal) }
    }
}

#[cfg(test)]
mod tests {
    use freeform_decompose::from_rotation_chart;
    use nalgebra::Complex;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_distr::StandardNormal;

    use super::*;

    /// The quality of a pair whose w^2 is `centre` turning at a constant rate, with unit Gaussian noise times `noise`, as
    /// noise splits a double root.
    fn quality_of_double_root(seed: u64, centre: f64, noise: f64, frames: usize) -> PairQuality {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut quality = PairQuality::default();
        for frame in 0..frames {
            let mut normal = || rng.sample::<f64, _>(StandardNormal);
            let square = Complex::from_polar(centre, 0.2 * frame as f64) + Complex::new(normal(), normal()) * noise;
            let l = from_rotation_chart(square.sqrt());
            quality.take(&Line { l, k: Complex::ZERO });
        }
        quality
    }

    #[test]
    fn a_double_root_split_by_noise_alone_tells_nothing_of_rotation_and_one_that_is_split_does() {
        for seed in 0..200 {
            for frames in [20, 100, 1000] {
                assert!(!quality_of_double_root(seed, 0.0, 1e-3, frames).tells_of_rotation(2), "{seed} {frames}");
                assert!(quality_of_double_root(seed, 0.02, 1e-3, frames).tells_of_rotation(2), "{seed} {frames}");
            }
        }
    }
}
