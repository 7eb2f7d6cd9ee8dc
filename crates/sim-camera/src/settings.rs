use crate::{
    corruption::Occlusion,
    error::SimulationError::{self, NoFrame, OutOfRange, TooFewPoints, TooManyFrames},
    sampling::Sampling,
};

/// Most points of an outline: as many as are read from one.
const MOST_POINTS: usize = 1 << 22;

/// Fewest points that a closed outline has.
const FEWEST_POINTS: usize = 3;

/// Most frames of one sequence: nine hours at 30 frames/s.
const MOST_FRAMES: usize = 1_000_000;

/// How long a sequence is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SequenceLength {
    /// So many frames, at least 1.
    Frames(usize),
    /// All frames at times below so many seconds: `seconds fps` of them, rounded up.
    Seconds(f64),
}

/// How the outlines are taken and corrupted. Lengths are image lengths.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Settings {
    /// Frames per second; frame k is taken at k / fps.
    pub fps: f64,
    /// Length of the sequence.
    pub length: SequenceLength,
    /// Points on the whole contour, at least 3. A frame with a hidden arc has its share of them.
    pub points: usize,
    /// How the points are spread along the contour.
    pub sampling: Sampling,
    /// Standard deviation of the Gaussian noise on each coordinate, from 0 to 1e50.
    pub noise: f64,
    /// The missing arc, at a random place in every frame.
    pub occlusion: Occlusion,
    /// Share of the points, in [0, 1), that are moved somewhere else; rounded to whole points.
    pub outliers: f64,
    /// Radius of the disc about a point that its outlier is drawn from, from 0 to 1e50.
    pub outlier_radius: f64,
    /// Probability, in [0, 1), that a frame shows another object of the paper's figure 1 in the same place, turned at
    /// random.
    pub wrong_frames: f64,
    /// Probability, in [0, 1), that a frame is missing.
    pub dropped_frames: f64,
    /// Everything random follows from it.
    pub seed: u64,
}

impl Default for Settings {
    /// 30 frames/s for 4 s, 400 points, noise 0.005 as in the paper, stratified sampling, nothing missing or wrong
    /// (outliers, once asked for, within 0.3), seed 0.
    fn default() -> Self {
        Self {
            fps: 30.0,
            length: SequenceLength::Seconds(4.0),
            points: 400,
            sampling: Sampling::default(),
            noise: 0.005,
            occlusion: Occlusion::default(),
            outliers: 0.0,
            outlier_radius: 0.3,
            wrong_frames: 0.0,
            dropped_frames: 0.0,
            seed: 0,
        }
    }
}

impl Settings {
    /// Checks every setting and returns the number of frames.
    ///
    /// # Errors
    /// A number that is not finite or out of its range, fewer than 3 points in view or more than 4194304, no frame or more than a million.
    pub fn frame_count(&self) -> Result<usize, SimulationError> {
        positive("fps", self.fps)?;
        length_or_none("noise", self.noise)?;
        length_or_none("outlier radius", self.outlier_radius)?;
        fraction("occlusion", self.occlusion.fraction)?;
        fraction("outliers", self.outliers)?;
        fraction("wrong frames", self.wrong_frames)?;
        fraction("dropped frames", self.dropped_frames)?;
        share("occlusion probability", self.occlusion.probability)?;
        if let Sampling::Regular { jitter } = self.sampling {
            share("sampling jitter", jitter)?;
        }
        check(self.points <= MOST_POINTS, "points", self.points as f64, "3 to 4194304")?;
        let visible = self.visible_points();
        if visible < FEWEST_POINTS {
            return Err(TooFewPoints { points: self.points, visible, needed: FEWEST_POINTS });
        }
        let frames = match self.length {
            SequenceLength::Frames(frames) => frames as f64,
            SequenceLength::Seconds(seconds) => {
                positive("seconds", seconds)?;
                let exact = seconds * self.fps;
                // A product such as 0.3 * 30 that is a hair above a whole number means the whole number.
                (exact * (1.0 - 1e-12)).ceil().max(1.0)
            }
        };
        if frames < 1.0 {
            return Err(NoFrame);
        }
        if frames > MOST_FRAMES as f64 {
            return Err(TooManyFrames { frames, limit: MOST_FRAMES });
        }
        Ok(frames as usize)
    }

    /// Points in a frame with a hidden arc.
    pub(crate) fn visible_points(&self) -> usize {
        (self.points as f64 * (1.0 - self.occlusion.fraction)).round() as usize
    }
}

fn check(ok: bool, setting: &'static str, value: f64, range: &'static str) -> Result<(), SimulationError> {
    if ok { Ok(()) } else { Err(OutOfRange { setting, value, range }) }
}

fn positive(setting: &'static str, value: f64) -> Result<(), SimulationError> {
    check(value.is_finite() && value > 0.0, setting, value, "finite and above 0")
}

/// Poses have the same limit: fourth powers of longer lengths, which moments are made of, are soon no numbers.
fn length_or_none(setting: &'static str, value: f64) -> Result<(), SimulationError> {
    check((0.0..=1e50).contains(&value), setting, value, "from 0 to 1e50")
}

fn fraction(setting: &'static str, value: f64) -> Result<(), SimulationError> {
    check((0.0..1.0).contains(&value), setting, value, "from 0 up to but not including 1")
}

fn share(setting: &'static str, value: f64) -> Result<(), SimulationError> {
    check((0.0..=1.0).contains(&value), setting, value, "from 0 to 1")
}
