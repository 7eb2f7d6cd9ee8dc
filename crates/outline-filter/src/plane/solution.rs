//! One motion of a plane that explains the frames.
use freeform_curve_fit::Outline;
use freeform_riccati::{MAX_PARAMETERS, PlaneMotion};
use nalgebra::Matrix3;

use super::{
    information::{Information, Step, squares},
    scenery::{Matrix8, Scenery, Vector8},
};
use crate::{belief::Belief, measurement::Frame, tuning::plane as tuning};

/// A frame that is kept, to be measured again where another motion puts it.
#[derive(Debug, Clone)]
pub(super) struct KeptFrame {
    /// Since the first frame.
    pub(super) seconds: f64,
    pub(super) outline: Outline,
    /// Body to image, as it was last found by itself.
    pub(super) pose: Matrix3<f64>,
}

/// A least sum of squares over all frames: motion, offsets of the outline, and the information on both.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub(super) motion: PlaneMotion,
    belief: Belief,
    information: Information,
    /// Information on the motion with the offsets eliminated, in units of the noise.
    pub(super) marginal: Matrix8,
    /// Sum of squares in units of the noise.
    pub(super) squares: f64,
    /// What the parameters have moved by since all frames were last linearised.
    drift: Vector8,
    /// What is known of frames that are no longer kept.
    folded: Option<Folded>,
    pub(super) agreement: Agreement,
}

/// Sums over frames that are no longer kept, and where they were taken.
#[derive(Debug, Clone)]
struct Folded {
    information: Information,
    parameters: Vector8,
    offsets: Vec<f64>,
    squares: f64,
}

/// How far new frames lie from where the motion puts them, in deviations.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Agreement {
    sum: f64,
    frames: f64,
}

impl Agreement {
    fn add(&mut self, square: f64) {
        self.sum += square.min(tuning::LARGEST_INNOVATION);
        self.frames += 1.0;
    }

    /// Mean square of the innovations over what is expected; what chance makes of it taken off, at least 1.
    pub(super) fn excess(&self) -> f64 {
        let degrees = MAX_PARAMETERS as f64 * self.frames;
        if self.frames < tuning::FEWEST_INNOVATIONS {
            return 1.0;
        }
        (self.sum / degrees / (1.0 + tuning::CHANCE * (2.0 / degrees).sqrt())).max(1.0)
    }
}

impl Solution {
    /// One that begins with a motion and an outline.
    pub(super) fn new(motion: PlaneMotion, belief: Belief) -> Self {
        let information = Information::none(belief.offsets.len());
        Self {
            motion,
            belief,
            information,
            marginal: Matrix8::zeros(),
            squares: 0.0,
            drift: Vector8::zeros(),
            folded: None,
            agreement: Agreement::default(),
        }
    }

    /// The outline that is believed.
    pub(super) fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Deviation of a typical place of the outline, normalised.
    pub(super) fn outline_deviation(&self, sigma: f64) -> f64 {
        sigma / self.information.typical_own().sqrt()
    }

    /// Subtracts offsets that a map has been drawn anew with.
    pub(super) fn subtract_redrawn(&mut self, offsets: &[f64]) {
        self.belief.offsets.iter_mut().zip(offsets).for_each(|(own, drawn)| *own -= drawn);
    }

    /// Replaces the outline by another, the frames of which are all still kept.
    pub(super) fn replace_outline(&mut self, belief: Belief) {
        self.belief = belief;
    }

    /// Adds a frame that goes on from the others.
    pub(super) fn add(&mut self, scenery: &Scenery, frame: &mut Frame, seconds: f64) -> Option<()> {
        let sensitivity = scenery.sensitivity(&self.motion, seconds)?;
        scenery.measure(&self.belief, frame, &scenery.pose(&self.motion, seconds));
        self.compare(scenery, frame, &sensitivity);
        self.squares += squares(frame, scenery.sigma());
        self.information.add(&frame.measurements, &sensitivity);
        let step = self.information.solve(&prior(scenery, seconds))?;
        self.squares -= step.fall / scenery.sigma().powi(2);
        self.drift += step.motion;
        self.go(&step, 1.0);
        self.information.settle();
        Some(())
    }

    /// Notes how far the measured frame lies from where the motion puts it.
    fn compare(&mut self, scenery: &Scenery, frame: &Frame, sensitivity: &Matrix8) {
        let (information, right) = self.information.of_pose(&frame.measurements);
        let expected = freeform_estimate::scaled_inverse(&self.marginal)
            .zip(freeform_estimate::scaled_inverse(&information))
            .map(|(motion, pose)| (pose * right, pose + sensitivity * motion * sensitivity.transpose()));
        let square = expected.and_then(|(offset, covariance)| {
            Some(offset.dot(&freeform_estimate::scaled_solution(&covariance, &offset)?))
        });
        if let Some(square) = square.filter(|square| square.is_finite()) {
            self.agreement.add(square / scenery.noise.effective_variance());
        }
    }

    /// Whether the parameters have moved so far that the frames should be linearised anew.
    pub(super) fn is_stale(&self, sigma: f64) -> bool {
        let drift = &self.drift;
        drift.dot(&(self.marginal * drift)) > (tuning::STALE * sigma).powi(2)
    }

    /// Linearises all frames anew until the solution settles. False where there is none, or one that a camera cannot see.
    pub(super) fn relinearise(&mut self, scenery: &Scenery, frames: &[KeptFrame], buffers: &mut Frame) -> bool {
        self.try_relinearise(scenery, frames, buffers).is_some()
    }

    fn try_relinearise(&mut self, scenery: &Scenery, frames: &[KeptFrame], buffers: &mut Frame) -> Option<()> {
        let sigma = scenery.sigma();
        let span = frames.last()?.seconds;
        // The place before the last step, the step, its share, and the squares there.
        let mut last: Option<(PlaneMotion, Vec<f64>, Step, f64, f64)> = None;
        for _ in 0..tuning::MOST_STEPS {
            let sums = self.linearise(scenery, frames, buffers);
            let is_worse = |before: f64, now: f64| now.is_nan() || now > before + tuning::WORSE;
            if let Some((motion, offsets, step, share, before)) = &mut last
                && sums.as_ref().is_none_or(|(_, now)| is_worse(*before, *now))
            {
                *share *= tuning::LESS_SHARE;
                (self.motion, self.belief.offsets) = (*motion, offsets.clone());
                let (step, share) = (step.clone(), *share);
                if share < tuning::LEAST_SHARE {
                    break;
                }
                self.go(&step, share);
                continue;
            }
            let (information, squares) = sums?;
            let step = information.solve(&prior(scenery, span))?;
            let size = step.motion.dot(&(step.marginal * step.motion)).max(0.0).sqrt() / sigma;
            last = Some((self.motion, self.belief.offsets.clone(), step.clone(), 1.0, squares));
            self.information = information;
            self.go(&step, 1.0);
            self.squares = squares - step.fall / (sigma * sigma);
            if size < tuning::SETTLED {
                break;
            }
        }
        self.information.settle();
        self.drift = Vector8::zeros();
        if !frames.iter().all(|frame| scenery.shows(&self.motion, frame.seconds)) {
            // It explains nothing: it is no least sum of squares of what a camera may see.
            self.squares = f64::INFINITY;
            return None;
        }
        Some(())
    }

    /// Sums over all frames where motion and offsets are now, and their squares.
    fn linearise(&self, scenery: &Scenery, frames: &[KeptFrame], buffers: &mut Frame) -> Option<(Information, f64)> {
        let mut information = Information::none(self.belief.offsets.len());
        let mut sum = 0.0;
        if let Some(folded) = &self.folded {
            let motion = Vector8::from(self.motion.parameters()) - folded.parameters;
            let offsets: Vec<f64> =
                self.belief.offsets.iter().zip(&folded.offsets).map(|(now, then)| now - then).collect();
            information.add_about(&folded.information, &motion, &offsets);
            sum += folded.squares - folded.information.fall_to(&motion, &offsets) / scenery.sigma().powi(2);
        }
        for KeptFrame { seconds, outline, .. } in frames {
            let sensitivity = scenery.sensitivity(&self.motion, *seconds)?;
            buffers.load(outline, scenery.reference);
            scenery.measure(&self.belief, buffers, &scenery.pose(&self.motion, *seconds));
            information.add(&buffers.measurements, &sensitivity);
            sum += squares(buffers, scenery.sigma());
        }
        Some((information, sum))
    }

    /// Keeps of some frames no more than their sums.
    pub(super) fn fold(&mut self, scenery: &Scenery, frames: &[KeptFrame], buffers: &mut Frame) {
        let Some((information, squares)) = self.linearise(scenery, frames, buffers) else { return };
        let (parameters, offsets) = (Vector8::from(self.motion.parameters()), self.belief.offsets.clone());
        self.folded = Some(Folded { information, parameters, offsets, squares });
    }

    /// Whether another has come to the same place.
    pub(super) fn is_near(&self, other: &Self, sigma: f64) -> bool {
        let apart = Vector8::from(other.motion.parameters()) - Vector8::from(self.motion.parameters());
        let distance = apart.dot(&(self.marginal * apart)).max(apart.dot(&(other.marginal * apart)));
        distance < (tuning::SAME * sigma).powi(2)
    }

    fn go(&mut self, step: &Step, share: f64) {
        let parameters = Vector8::from(self.motion.parameters()) + share * step.motion;
        self.motion = PlaneMotion::of_parameters(parameters.into());
        self.belief.offsets.iter_mut().zip(&step.offsets).for_each(|(offset, by)| *offset += share * by);
        self.marginal = step.marginal;
    }

    /// Covariance of the parameters, in the unit of the noise.
    pub(super) fn covariance(&self, scenery: &Scenery, span: f64) -> Option<Matrix8> {
        let information = self.marginal + Matrix8::from_diagonal(&prior(scenery, span));
        let covariance = freeform_estimate::scaled_inverse(&information)? * scenery.noise.effective_variance();
        covariance.iter().all(|entry| entry.is_finite()).then_some(covariance)
    }
}

/// Information in units of the noise that bounds what no frame tells of: whole turns, velocities of many distances, planes seen edge on.
pub(super) fn prior(scenery: &Scenery, span: f64) -> Vector8 {
    let (rate, normal) = (tuning::LARGEST_MOTION / span.max(f64::MIN_POSITIVE), tuning::LARGEST_NORMAL);
    let deviations = Vector8::from([rate, rate, rate, rate, rate, rate, normal, normal]);
    deviations.map(|deviation| (scenery.sigma() / deviation).powi(2))
}
