use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_riccati::{MotionModel, ParameterVector};
use nalgebra::DMatrix;

use crate::{
    measurement::Frame,
    supervisor::{FilterError, FilterSettings, MotionFilter, Phase},
    track::{Comparison, Track},
    tuning::{batch as tuning, remapping::PLENTY},
    update::Gate,
};

/// Why a recording gives no motion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// A frame that cannot be used at all.
    #[error("frame {index} cannot be used: {error}")]
    Frame {
        /// Its position, counted from 0.
        index: usize,
        /// What is wrong with it.
        error: FilterError,
    },
    /// The motion filter, which gives the initial motion, found the object in fewer than two frames.
    #[error("the object was found in fewer than two of {frames} frames")]
    NoStart {
        /// Frames given.
        frames: usize,
    },
}

/// The constant motion that fits all frames of a recording best.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchEstimate {
    /// The motion in image units, with standard deviations.
    pub motion: MotionEstimate,
    /// Covariance of its parameters, in their order.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of the noise on the points, image lengths.
    pub noise: f64,
    /// Frames used: those that the filter for the initial motion did not reject.
    pub frames_used: usize,
    /// Number of pieces of the outline, each with its own offset.
    pub outline_pieces: usize,
    /// How often the outline was rebuilt from all frames. It is 0 if that is not possible: the turn is not observable, all frames have the
    /// same sampling, or the object was lost and found again. The motion is then that of the filter.
    pub rounds: usize,
    /// Whether the last round changed the estimate, the mean of the motions of the rounds, by little compared with the standard deviations.
    pub converged: bool,
}

/// Estimates a constant motion from all frames together.
///
/// The motion filter gives the initial motion and rejects frames that show something else. In each round the outline is then rebuilt from
/// frames over the whole recording, aligned by the motion, and all frames are measured against it. Rounds are repeated until the mean of
/// their motions settles. Points are associated with pieces of an outline built from all frames, and every frame is linearised at the joint
/// motion. The work of a round is linear in the number of points. Use this estimator as the reference for recorded data, and
/// [`MotionFilter`] for frames from a camera.
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_outline_filter::estimate_batch;
/// use freeform_riccati::MotionModel;
/// use nalgebra::{Isometry2, Point2, Vector2};
///
/// let egg = |i: i32| {
///     let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///     Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
/// };
/// let mut frames = Vec::new();
/// for frame in 0..10 {
///     let time = f64::from(frame) / 30.0;
///     let pose = Isometry2::new(Vector2::new(0.2 * time, 0.0), 0.5 * time);
///     frames.push((time, Outline::closed((0..300).map(|i| pose * egg(i)).collect())?));
/// }
/// let found = estimate_batch(MotionModel::Rigid, &frames)?;
/// assert!((found.motion.values()[0] + 0.5).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Times that do not increase, a first outline of fewer than 8 points, an object that is found in fewer than two frames.
pub fn estimate_batch(model: MotionModel, frames: &[(f64, Outline)]) -> Result<BatchEstimate, BatchError> {
    let no_start = BatchError::NoStart { frames: frames.len() };
    let settings = FilterSettings { model, ..FilterSettings::default() };
    let Start { estimate: start, track, used } = Start::of(settings, frames)?;
    let Rounds { mut best, mean, count, has_converged } =
        Rounds::of(track, &used, settings.smallest_agreement).ok_or(no_start)?;
    // Where points fall on the pieces differs from cut to cut, and so does the motion, by a part of its deviation.
    best.set_motion(mean);
    let covariance = best.covariance().ok_or(no_start)?;
    let motion = best.estimate().ok_or(no_start)?;
    // What the filter has not seen is not there to be seen.
    let unseen = start.parameters().enumerate().filter(|(_, p)| p.value.is_none()).map(|(j, _)| j);
    Ok(BatchEstimate {
        motion: unseen.fold(motion, MotionEstimate::with_unobservable),
        covariance,
        noise: best.sigma() * best.reference().radius,
        frames_used: used.len(),
        outline_pieces: best.cell_count(),
        rounds: count,
        converged: has_converged,
    })
}

/// What the motion filter makes of a recording.
struct Start<'a> {
    estimate: MotionEstimate,
    /// After the last frame that was used.
    track: Track,
    used: Vec<(f64, &'a Outline)>,
}

impl<'a> Start<'a> {
    fn of(settings: FilterSettings, frames: &'a [(f64, Outline)]) -> Result<Self, BatchError> {
        let no_start = BatchError::NoStart { frames: frames.len() };
        let mut filter = MotionFilter::new(settings).map_err(|error| BatchError::Frame { index: 0, error })?;
        let mut used = Vec::new();
        let (mut last_used, mut restarts) = (None, 0);
        for (index, (time, outline)) in frames.iter().enumerate() {
            let step = filter.step(*time, outline).map_err(|error| BatchError::Frame { index, error })?;
            let is_begun_anew = filter.restarts() > restarts;
            restarts = filter.restarts();
            if step.is_accepted() || is_begun_anew {
                // It has not gone on from the frames before.
                if step.phase == Phase::Acquiring {
                    used.clear();
                }
                used.push((*time, outline));
                last_used = filter.track().cloned();
            }
        }
        let estimate = filter.estimate().filter(|_| used.len() > 1).ok_or(no_start)?;
        // Frames rejected in the end have moved the filter's own map on.
        let track = last_used.ok_or(no_start)?;
        Ok(Self { estimate, track, used })
    }
}

/// The outline rebuilt round by round.
struct Rounds {
    /// Of the last round.
    best: Track,
    /// Of the motions of all rounds.
    mean: ParameterVector,
    count: usize,
    has_converged: bool,
}

impl Rounds {
    /// `None` where the numbers do not allow it.
    fn of(track: Track, used: &[(f64, &Outline)], smallest_agreement: f64) -> Option<Self> {
        let points: usize = used.iter().map(|(_, outline)| outline.point_count()).sum();
        let stride = points.div_ceil(PLENTY).max(1);
        let gate = Gate { smallest_agreement, largest_innovation: None, largest_noise: None };
        let measure = |track: &mut Track, buffers: &mut Frame, seconds: f64, outline: &Outline| {
            if !track.predict(seconds) {
                return false;
            }
            buffers.load(outline, track.reference());
            track.update(buffers, &gate, Comparison::NotAsked).is_accepted()
        };
        let unit = track.reference().time_unit;
        let mut buffers = Frame::default();
        // Nothing to cut from where the filter has begun with another frame.
        let may_be_cut = track.is_begun_with(used[0].1);
        let mut rounds = Self { mean: track.belief().motion, best: track, count: 0, has_converged: false };
        while may_be_cut && rounds.count < tuning::MOST_ROUNDS && !rounds.has_converged {
            let placed = rounds.best.placed(used.iter().map(|(time, outline)| (time / unit, *outline)));
            let Some(new) = rounds.best.remapped(&placed, stride, &mut buffers, measure) else { break };
            rounds.add(new)?;
        }
        Some(rounds)
    }

    fn add(&mut self, new: Track) -> Option<()> {
        self.best = new;
        self.count += 1;
        let before = self.mean;
        for (mean, new) in self.mean.iter_mut().zip(&self.best.belief().motion) {
            *mean += (new - *mean) / self.count as f64;
        }
        let moved = self.best.in_deviations(&before, &self.mean)?;
        self.has_converged = self.count > 1 && moved < tuning::SETTLED;
        Some(())
    }
}
