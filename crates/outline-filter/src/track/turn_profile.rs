//! Whether frames tell a turn that the outline hardly shows as well as its normals promise.
//!
//! A disc with a thin slot along a circle tells its turn by the ends of the slot alone. A pose that misses them looks as good as any other: their few
//! points are taken for outliers, and errors of the normals of all others promise that the turn is known well. The profile of the likelihood does
//! not: poses turned a little either way must be worse.
use freeform_curve_fit::Outline;
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind};
use nalgebra::{Matrix3, SVector};

use super::{Outcome, Track, wrapped};
use crate::{
    belief::StateMatrix,
    map::{CLOCKWISE, TurnEvent},
    measurement::{Frame, NegativeLogLikelihood},
    tuning::{likelihood::ENOUGH_POINTS, turn_profile as tuning},
};

/// Likelihoods over the last frames of the poses as they were told, and of these turned by as much as the frames should tell.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct TurnProfile {
    as_told: NegativeLogLikelihood,
    /// Clockwise and anticlockwise.
    turned: [NegativeLogLikelihood; 2],
    frames: usize,
    promise: Promise,
}

/// Whether a frame promises to tell a turn that can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Promise {
    #[default]
    NotAsked,
    /// What is stated says how little.
    TooLittle,
    Enough,
}

impl TurnProfile {
    /// Adds those of a frame, of its pose and of the turned ones.
    fn add(&mut self, as_told: &NegativeLogLikelihood, turned: [&NegativeLogLikelihood; 2]) {
        self.as_told.add_to_faded(tuning::KEPT, as_told);
        for (sum, of_frame) in self.turned.iter_mut().zip(turned) {
            sum.add_to_faded(tuning::KEPT, of_frame);
        }
        self.frames = (self.frames + 1).min(tuning::MEMORY);
    }

    /// Whether frames that should have told a turn have not.
    fn contradicts(&self) -> bool {
        self.frames >= tuning::MEMORY && self.turned.iter().any(|turned| !turned.is_worse_than(&self.as_told))
    }
}

impl Track {
    /// Compares the pose of an accepted frame with turned ones, where the outline hardly shows its turn; whether the last frames do not tell it as
    /// well as is said. Not where the model may stretch the outline: what turns it then is told with what stretches it.
    pub(crate) fn add_to_turn_profile(&mut self, outline: &Outline, outcome: &Outcome, frame: &mut Frame) -> bool {
        let is_asked = self.map.is_all_but_round() || self.map.turn_hangs_on_few();
        if !is_asked || self.turn_is_unseen() || self.model() > MotionModel::Similarity {
            return false;
        }
        let Some(turn) = self.turn_to_be_told(outcome, outline.point_count()) else {
            self.turn_profile.promise = Promise::TooLittle;
            return false;
        };
        self.turn_profile.promise = Promise::Enough;
        let pose = self.belief.pose;
        let poses = [pose, self.turned(&pose, -turn), self.turned(&pose, turn)];
        let [as_told, clockwise, anticlockwise] = &self.compared(outline, &poses, frame)[..] else { return false };
        self.turn_profile.add(as_told, [clockwise, anticlockwise]);
        self.turn_profile.contradicts()
    }

    /// Whether frames must tell the turn before it is stated.
    pub(crate) fn is_all_but_round(&self) -> bool {
        self.map.is_all_but_round() && !self.turn_is_unseen() && self.model() <= MotionModel::Similarity
    }

    /// Whether the turn of an outline that is all but round is, since a pose, another than expected; rad, anticlockwise where y points up. No turn is
    /// expected where it is to be told from another pose in the same frame.
    pub(crate) fn turn_leaps(&self, before: &Matrix3<f64>, expected: f64) -> bool {
        // By the turn back.
        self.is_all_but_round() && wrapped(self.turn_to(before) + expected).abs() > tuning::LEAP
    }

    /// Forgets what frames have told of the turn.
    pub(crate) fn ask_anew_for_turn(&mut self) {
        self.turn_profile = TurnProfile::default();
    }

    /// Covariance of pose and motion, normalised, of a turn that is promised and that too few frames have told yet: of a radian, and of as much in the
    /// time that the motion is known from. `None` where the turn is shown well, or told by enough frames; from as many frames on also where frames do not
    /// promise to tell it and its deviation is too large to be mistaken for a turn that is known.
    pub(crate) fn covariance_of_untold_turn(&self) -> Option<StateMatrix> {
        let TurnProfile { frames, promise, .. } = self.turn_profile;
        if !self.is_all_but_round() || frames >= tuning::MEMORY {
            return None;
        }
        let (model, span) = (self.belief.model, self.span_of_motion(None));
        let direction = self.turn_about_centroid()?;
        let k = model.parameter_count();
        // In the first frames what is promised rests on normals of a map that follows the errors of these frames.
        if promise == Promise::TooLittle && self.frames >= tuning::MEMORY {
            // What is kept of where the body frame lies may have any turn of it, and is no error of this one.
            let known = self.summary_in_body_frame()?.covariance;
            let is_uncertain = |i: usize| known[(i, i)] > (tuning::LARGEST * direction[i]).powi(2);
            if (0..k - 2).any(|i| direction[i] != 0.0 && is_uncertain(i)) {
                return None;
            }
        }
        let mut covariance = StateMatrix::zeros();
        // Half a circle takes the origin of the body to the other side of its centroid, which no step along the turn does.
        let across = self.map.centroid().coords.norm_squared() * self.belief.scale().powi(2);
        let kinds = model.parameter_kinds().iter().enumerate();
        for (i, _) in kinds.filter(|(_, kind)| **kind == ParameterKind::Velocity) {
            covariance[(i, i)] = across;
        }
        for i in 0..k {
            for j in 0..k {
                let square = direction[i] * direction[j];
                covariance[(i, j)] += square;
                covariance[(k + i, k + j)] = square / (span * span);
            }
        }
        Some(covariance)
    }

    /// Takes what frames have told another track of the same poses.
    pub(crate) fn go_on_with_turn_profile_of(&mut self, other: &Self) {
        self.turn_profile = other.turn_profile;
    }

    /// The clockwise turn by 1 rad about the centroid, as parameters of the image.
    fn turn_about_centroid(&self) -> Option<SVector<f64, MAX_PARAMETERS>> {
        let model = self.belief.model;
        Some(self.centred_pose().about_origin(model)? * SVector::from(model.parameters_of(&CLOCKWISE)))
    }

    /// The turn that frames like this one should tell from none beyond doubt, by the information that this one promises, rad; `None` where they
    /// promise too little.
    fn turn_to_be_told(&self, outcome: &Outcome, points: usize) -> Option<f64> {
        let direction = self.turn_about_centroid()?;
        let pose = outcome.pose?;
        // Over the variance that poses are compared by.
        let of_turn = direction.dot(&(pose.information * direction)) / pose.noise_inflation;
        // Of more points only so many are compared.
        let kept = points as f64 / points.div_ceil(ENOUGH_POINTS).max(1) as f64;
        let of_turn = of_turn * kept / points.max(1) as f64;
        // Of squares, as they are compared.
        let needed = NegativeLogLikelihood::significant(kept * self.noise.correlation() / tuning::MEMORY as f64);
        let turn = (tuning::PROMISED * needed / (of_turn * self.noise.stated_correlation())).sqrt();
        (turn <= tuning::LARGEST).then_some(turn)
    }

    /// Holds the turn as unseen from now on, after frames that have not told it: nothing is known of it any more.
    pub(crate) fn refute_turn(&mut self) {
        self.turn_profile = TurnProfile::default();
        self.record_turn(TurnEvent::Refuted);
        self.hide_turn();
        let null = self.null_directions();
        let variance = self.noise.effective_variance();
        self.belief.forget(&null, variance);
        null.subtract_from(&mut self.belief.motion);
    }
}

#[cfg(feature = "serde")]
impl TurnProfile {
    /// Whether it is one of so many frames.
    pub(super) fn is_valid(&self) -> bool {
        self.frames <= tuning::MEMORY
            && self.as_told.is_valid()
            && self.turned.iter().all(NegativeLogLikelihood::is_valid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn_curves::{lobed, outline, polar};

    /// Whether so many frames of 400 points in which both turns are worse by such differences of squares contradict the turn.
    fn contradicted(frames: usize, clockwise: f64, anticlockwise: f64) -> bool {
        let of_frame = |difference: f64| NegativeLogLikelihood::of_squares(400.0 + difference, 400.0);
        let mut profile = TurnProfile::default();
        for _ in 0..frames {
            profile.add(&of_frame(0.0), [of_frame(clockwise), of_frame(anticlockwise)].each_ref());
        }
        profile.contradicts()
    }

    #[test]
    fn a_turn_is_contradicted_where_one_way_is_not_worse_by_half_of_what_was_promised_once_there_are_enough_frames() {
        let promised = tuning::PROMISED * NegativeLogLikelihood::significant(400.0 / tuning::MEMORY as f64);
        let enough = 4 * tuning::MEMORY;
        assert!(!contradicted(enough, promised, promised));
        assert!(!contradicted(enough, 0.6 * promised, 0.6 * promised));
        assert!(contradicted(enough, promised, 0.4 * promised) && contradicted(enough, 0.4 * promised, promised));
        assert!(contradicted(enough, promised, -promised));
        assert!(contradicted(tuning::MEMORY, 0.0, 0.0) && !contradicted(tuning::MEMORY - 1, 0.0, 0.0));
    }

    #[test]
    fn a_turn_that_frames_promise_too_little_to_tell_is_taken_as_stated_after_the_first_ones_if_little_is_stated() {
        let body = outline(400, |t| polar(lobed(t, &[(3.0, [0.058, 0.0])]), t));
        let begun = Track::begin(MotionModel::Rigid, &body, 0.0, &mut Frame::default()).expect("a track");
        // After a frame that shows no turn its body frame may be turned by any.
        let circle = outline(400, |t| polar(1.0, t));
        let before = Track::begin(MotionModel::Rigid, &circle, 0.0, &mut Frame::default()).expect("a track");
        let with_any_turn = before.begun_anew(&body, &mut Frame::default()).expect("a turn that is shown");
        for mut track in [begun, with_any_turn] {
            assert!(track.is_all_but_round());
            track.turn_profile.promise = Promise::TooLittle;
            for (noise, is_known_well) in [(1e-3, true), (1e3, false)] {
                track.noise.sigma = noise;
                for frames in 1..2 * tuning::MEMORY {
                    track.frames = frames;
                    let is_untold = frames < tuning::MEMORY || is_known_well;
                    assert_eq!(track.covariance_of_untold_turn().is_some(), is_untold, "{frames} frames, {noise}");
                }
            }
        }
    }
}
