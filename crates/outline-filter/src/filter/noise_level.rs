//! How much noise the frames of a sequence show, good ones and bad ones.

/// Frames that are looked back on.
const FRAMES: usize = 9;
/// A frame with so many times the noise of most does not show the known outline, however well the map is bent to it.
const LARGEST_RATIO: f64 = 1.8;
/// Nor does one with more than this, in RMS radii of the object: outlines of different objects differ by more.
const LARGEST: f64 = 0.05;
/// The same while no frame has been compared with another.
const LARGEST_AT_FIRST: f64 = 0.03;
/// Stretches that the contour is cut into to see whether its errors are correlated.
pub(crate) const STRETCHES: usize = 24;

/// Noise of the last frames, and its correlation along the contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoiseLevel {
    frames: [f64; FRAMES],
    count: usize,
    /// Whether frames may show more noise than the contour of the first, none having been compared yet.
    pub(crate) relaxed: bool,
    correlation: f64,
    correlated_frames: f64,
}

impl NoiseLevel {
    pub(crate) const NEW: Self =
        Self { frames: [0.0; FRAMES], count: 0, relaxed: false, correlation: 1.0, correlated_frames: 0.0 };

    /// Takes the noise of a frame in normalised units, used or not.
    pub(crate) fn take(&mut self, noise: f64) {
        self.frames[self.count % FRAMES] = noise.min(2.0 * LARGEST);
        self.count += 1;
    }

    /// Most noise that a frame may have: by comparison with what most frames have shown, once there are any.
    pub(crate) fn tolerated(&self, known: f64) -> f64 {
        let mut frames = self.frames;
        let seen = &mut frames[..self.count.min(FRAMES)];
        let typical = super::contour::median(seen);
        let at_first = if self.relaxed { LARGEST_AT_FIRST } else { 0.0 };
        let most = typical.map_or(at_first, |typical| (LARGEST_RATIO * typical.max(known)).min(LARGEST));
        most.max(LARGEST_RATIO * known)
    }

    /// Takes how many times the variance of the mean over a stretch was what independent errors give.
    pub(crate) fn take_correlation(&mut self, ratio: f64) {
        self.correlated_frames = (self.correlated_frames + 1.0).min(50.0);
        self.correlation += (ratio - self.correlation) / self.correlated_frames;
    }

    /// Points that tell as much as one with independent errors would, at least 1.
    pub(crate) fn correlation(&self) -> f64 {
        let uncertainty = (2.0 / (STRETCHES as f64 * self.correlated_frames.max(1.0))).sqrt();
        (self.correlation / (1.0 + 2.0 * uncertainty)).max(1.0)
    }
}
