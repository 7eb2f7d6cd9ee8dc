use freeform_decompose::{Line, rotation_chart};

/// How much one conjugate pair tells about the motion, against how noisy it is.
///
/// In the rotation chart `w = (l - j) / (l + j)` a rotation turns w about 0, so |w| is an invariant, noise is the same
/// in every orientation, and `l = j (1 + w) / (1 - w)`. The noise is measured by second differences of |w| over time,
/// which a smooth change under affine motion leaves alone.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
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
