//! Angles that go on beyond half a turn.
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use freeform_estimate::{MotionState, PoseParameter};
use freeform_outline_filter::Ambiguity;

/// In shortest steps so far, up to which a step leaves no whole turns open: the object turns by less than half a circle from frame to frame. It is
/// half way to a missing frame, which makes two. `UNSEEN_STEPS` of the motion filter is 1.75 since it has another base, the step before, and another
/// consequence: the object may be lost, so that steps of 2 and 3 in turn (24 pictures a second shown at 60) must be below it. Here such a step is
/// only counted, and widens no deviation unless the angular velocity leaves turns open.
const LONGEST_STEP: f64 = 1.5;
/// Turns beyond what was expected of which one the other way round is not [`Ambiguity::SURELY_SMALLER`] times as large, rad: nobody knows which of
/// them it was.
const EITHER_WAY: f64 = TAU / (1.0 + Ambiguity::SURELY_SMALLER);

/// Phase unwrapping: the angle of the poses of an object, continuous over time. Of the whole turns that it may have made since the pose before, those
/// are counted that its angular velocity has made, the mean of those known last before and first afterwards; the fewest where none is known.
///
/// Where an object was not seen for long, and its angular velocity is not known well enough, was not known before, is not known yet, or was another one
/// before than it is afterwards, whole turns may have been missed. So they may where it was seen to have turned by more than a third of a circle beyond what was
/// expected, and might have turned the other way round. The standard deviation of all angles from then on has what that may be.
///
/// Predicted poses are in line with those before them, and nothing goes on from them.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContinuousAngle {
    last: Option<LastPose>,
    /// Time of the last pose that was left out since then, s.
    left_out: Option<f64>,
    /// The shortest step between poses, s.
    step: Option<f64>,
    /// The last angular velocity that was known.
    omega: Option<Omega>,
    /// Time for which poses were missing, s, after which none has been known yet.
    open: f64,
    /// Of whole turns that may have been missed, rad.
    deviation: f64,
}

/// Where a pose is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseSource {
    /// A frame that was used.
    Frame,
    /// The frames before one that was not used.
    Prediction,
}

impl PoseSource {
    /// Of the pose after a frame, by whether that was used.
    pub(super) fn of(is_accepted: bool) -> Self {
        if is_accepted { Self::Frame } else { Self::Prediction }
    }
}

/// Of the last frame that was used.
#[derive(Debug, Clone, Copy)]
struct LastPose {
    /// In seconds.
    time: f64,
    angle: f64,
}

/// An angular velocity and its standard deviation, rad/s.
#[derive(Debug, Clone, Copy)]
struct Omega {
    value: f64,
    deviation: f64,
}

impl Omega {
    fn of(state: &MotionState) -> Option<Self> {
        let motion = state.motion();
        let omega = motion.parameters().find(|parameter| parameter.name == "omega")?;
        Some(Self { value: omega.value?, deviation: omega.standard_deviation? })
    }

    /// How far an object may have turned in so many seconds beside the mean of this one and another that it had before, rad.
    fn spread(self, before: Self, seconds: f64) -> f64 {
        (0.5 * (self.value - before.value)).hypot(self.deviation.max(before.deviation)) * seconds
    }
}

impl ContinuousAngle {
    /// Makes the angle of the next pose go on from those before it. It is given as that of a state, between -pi and pi rad, and its standard
    /// deviation gets what whole turns may have been missed. Where there is none, or it is not known, nothing changes.
    pub fn go_on(&mut self, state: &MotionState, source: PoseSource, pose: &mut [PoseParameter]) {
        let angle = pose.iter_mut().find(|parameter| parameter.name == "angle");
        let Some(PoseParameter { value, standard_deviation, .. }) = angle.filter(|angle| angle.value.is_finite())
        else {
            return;
        };
        let (time, omega) = (state.time(), Omega::of(state));
        let mut next = *self;
        let expected = next.expect(time, omega);
        *value += TAU * ((expected - *value) / TAU).round();
        let mut deviation = next.deviation.hypot(next.missed(omega));
        if self.last.is_some() && source == PoseSource::Frame && (*value - expected).abs() > EITHER_WAY {
            // As often one as the other, a whole turn apart. In the next frame it may be off in the same direction: deviations add up.
            (next.deviation, deviation) = (next.deviation + PI, deviation + PI);
        }
        *standard_deviation = standard_deviation.hypot(deviation);
        if source == PoseSource::Prediction {
            // How often poses come is told by those that are predicted as well.
            self.step = next.step;
            return;
        }
        if omega.is_some() {
            (next.deviation, next.open, next.omega) = (deviation, 0.0, omega);
        }
        (next.last, next.left_out) = (Some(LastPose { time, angle: *value }), None);
        *self = next;
    }

    /// Leaves out a pose at a time in seconds whose turn is one of several: until one is told, nobody knows how the object turns, and its angular
    /// velocity says afterwards what it has made of the time.
    pub fn leave_out(&mut self, time: f64) {
        if let Some(before) = self.left_out.or(self.last.map(|last| last.time)) {
            self.shortest_step(time - before);
        }
        // The angle is 0 in the first frame, a step before the first pose.
        self.last.get_or_insert(LastPose { time, angle: 0.0 });
        self.left_out = Some(time);
    }

    /// The shortest step between poses, after one of so many seconds.
    fn shortest_step(&mut self, seconds: f64) -> f64 {
        *self.step.insert(self.step.map_or(seconds, |step| step.min(seconds)))
    }

    /// The angle that is expected at a time, none before the first, by the angular velocities before and then; counts the time that poses were
    /// missing.
    fn expect(&mut self, time: f64, omega: Option<Omega>) -> f64 {
        let Some(last) = self.last else { return 0.0 };
        let seconds = time - last.time;
        if seconds > LONGEST_STEP * self.shortest_step(seconds) || self.left_out.is_some() {
            self.open += seconds;
        }
        let known = [self.omega, omega].into_iter().flatten();
        let (sum, count) = known.fold((0.0, 0.0), |(sum, count), omega| (sum + omega.value, count + 1.0));
        last.angle + sum / f64::max(count, 1.0) * seconds
    }

    /// Standard deviation of the whole turns that may have been missed where poses were missing, by the angular velocity afterwards.
    fn missed(&self, omega: Option<Omega>) -> f64 {
        let spread = match (self.omega, omega) {
            _ if self.open == 0.0 => 0.0,
            (Some(before), Some(now)) => now.spread(before, self.open),
            // It may have stopped, or be twice as fast, or have been so before it was known.
            (Some(only), None) | (None, Some(only)) => only.value.hypot(only.deviation) * self.open,
            (None, None) => TAU,
        };
        // Two deviations of it reach half a turn, from where on another whole turn is nearer.
        if spread > FRAC_PI_2 { spread } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use freeform_estimate::NormalisedState;
    use freeform_riccati::{MAX_PARAMETERS, MotionModel};
    use nalgebra::{DMatrix, Matrix3, Point2};

    use super::*;

    /// One of which the angular velocity is not known where it is no number.
    fn state(time: f64, omega: f64, deviation: f64) -> MotionState {
        let mut motion = [0.0; MAX_PARAMETERS];
        motion[0] = if omega.is_finite() { omega } else { 0.0 };
        let covariance = DMatrix::identity(6, 6) * (deviation * deviation);
        NormalisedState {
            model: MotionModel::Rigid,
            time,
            origin: Point2::origin(),
            radius: 1.0,
            pose: Matrix3::identity(),
            motion,
            covariance: covariance.clone(),
            body_frame: DMatrix::zeros(3, 3),
            covariance_given_outline: covariance,
            observable: [omega.is_finite(); MAX_PARAMETERS],
            hidden: [false; MAX_PARAMETERS],
            centroid: Point2::origin(),
        }
        .into()
    }

    /// An angle with the deviation that comes to its own, after those before it.
    fn next(angles: &mut ContinuousAngle, state: &MotionState, angle: f64) -> (f64, f64) {
        let mut pose = [PoseParameter { name: "angle", value: angle, standard_deviation: 0.0 }];
        angles.go_on(state, PoseSource::Frame, &mut pose);
        (pose[0].value, pose[0].standard_deviation)
    }

    /// The last of some angles, of times, angular velocities and their deviation, which are taken between -pi and pi.
    fn last(poses: &[(f64, f64, f64)], deviation: f64) -> (f64, f64) {
        let mut angles = ContinuousAngle::default();
        let mut last = (0.0, 0.0);
        for (time, angle, omega) in poses {
            last = next(&mut angles, &state(*time, *omega, deviation), angle - TAU * (angle / TAU).round());
        }
        last
    }

    #[test]
    fn whole_turns_that_were_made_while_nothing_was_seen_are_those_of_the_motion() {
        for omega in [-9.0, -1.5, 0.3, 4.0] {
            let seen = [0.0, 0.1, 0.2, 2.7, 2.8].map(|time| (time, omega * time, omega));
            let (angle, deviation) = last(&seen, 0.01);
            assert!((angle - 2.8 * omega).abs() < 1e-9 && deviation == 0.0, "{omega}: {angle} {deviation}");
        }
    }

    #[test]
    fn where_whole_turns_may_have_been_missed_all_angles_from_then_on_say_so() {
        let before = [(-0.2, -0.8, 4.0), (-0.1, -0.4, 4.0), (0.0, 0.0, 4.0)];
        let after = |poses: &[(f64, f64, f64)], deviation: f64| last(&[&before, poses].concat(), deviation);
        // It was faster before by 3 rad/s, for two seconds: what it has made of them nobody knows.
        let (angle, deviation) = after(&[(2.0, 5.0, 1.0), (2.1, 5.1, 1.0)], 0.01);
        assert!((angle - 5.1).abs() < 1e-9 && (deviation - 3.0).abs() < 0.01, "{angle} {deviation}");
        let (_, unknown) = after(&[(3.0, 12.0, 4.0)], 1.0);
        assert!((unknown - 3.0).abs() < 1e-9, "{unknown}");
        // Not known yet: it may have stopped. Once it is known, that tells.
        let not_yet = [(0.5, 2.0, f64::NAN), (0.6, 2.4, f64::NAN)];
        assert!((after(&not_yet, 0.01).1 - 2.0).abs() < 0.01);
        assert_eq!(after(&[&not_yet[..], &[(0.7, 2.8, 4.0)]].concat(), 0.01).1, 0.0);
        let (_, other) = after(&[&not_yet[..], &[(0.7, 2.2, -9.0), (0.8, 1.3, -9.0)]].concat(), 0.01);
        assert!((other - 3.25).abs() < 0.01, "{other}");
    }

    #[test]
    fn angles_begin_near_none_and_those_that_are_not_known_are_passed_over() {
        assert_eq!(last(&[(0.0, PI - 0.1, 0.0)], 0.01).0, PI - 0.1);
        let mut angles = ContinuousAngle::default();
        let first = next(&mut angles, &state(0.0, 40.0, 0.1), 3.0);
        assert!(next(&mut angles, &state(0.01, 40.0, 0.1), f64::NAN).0.is_nan());
        let later = next(&mut angles, &state(0.02, 40.0, 0.1), 3.8 - TAU);
        assert!(first == (3.0, 0.0) && (later.0 - 3.8).abs() < 1e-9, "{first:?} {later:?}");
    }

    #[test]
    fn turns_made_while_several_were_possible_are_those_of_the_motion_told_afterwards_and_may_be_others() {
        let mut angles = ContinuousAngle::default();
        for frame in 1..17 {
            angles.leave_out(0.002 * f64::from(frame));
        }
        let turned = 287.0 * 0.034;
        let (angle, deviation) = next(&mut angles, &state(0.034, 287.0, 0.5), turned - TAU * (turned / TAU).round());
        assert!((angle - turned).abs() < 1e-9 && deviation > PI, "{angle} {deviation}");
        // Slow ones leave no whole turns open.
        let mut angles = ContinuousAngle::default();
        (1..5).for_each(|frame| angles.leave_out(0.03 * f64::from(frame)));
        let (angle, deviation) = next(&mut angles, &state(0.15, 5.0, 0.01), 0.75);
        assert!((angle - 0.75).abs() < 1e-9 && deviation == 0.0, "{angle} {deviation}");
        // Where the turn was known before, it tells as well.
        let mut angles = ContinuousAngle::default();
        let known = |frame: u32| f64::from(frame) * 0.1;
        next(&mut angles, &state(0.0, 5.0, 0.01), 0.0);
        (1..30).for_each(|frame| angles.leave_out(known(frame)));
        let (angle, deviation) = next(&mut angles, &state(3.0, 5.0, 0.01), 15.0 - 2.0 * TAU);
        assert!((angle - 15.0).abs() < 1e-9 && deviation == 0.0, "{angle} {deviation}");
    }

    #[test]
    fn an_angle_that_is_predicted_wrong_is_not_gone_on_from() {
        let mut angles = ContinuousAngle::default();
        assert_eq!(next(&mut angles, &state(0.0, 0.1, 0.01), 0.5).0, 0.5);
        // Taken aside at once, which is predicted to go on: three rad in a step.
        for (time, angle) in [(0.1, 3.0), (0.2, -3.0), (0.3, -0.6)] {
            let mut pose = [PoseParameter { name: "angle", value: angle, standard_deviation: 0.0 }];
            angles.go_on(&state(time, f64::NAN, 0.0), PoseSource::Prediction, &mut pose);
        }
        let (angle, deviation) = next(&mut angles, &state(0.4, f64::NAN, 0.0), 0.6);
        assert!((angle - 0.6).abs() < 1e-9 && deviation < 0.1, "{angle} {deviation}");
    }

    #[test]
    fn whole_turns_may_be_missed_while_poses_are_predicted_from_the_first_one_on() {
        let mut angles = ContinuousAngle::default();
        next(&mut angles, &state(0.0, 5.0, 0.1), 0.5);
        for frame in 1..10 {
            let mut pose = [PoseParameter { name: "angle", value: 0.5, standard_deviation: 0.0 }];
            angles.go_on(&state(0.1 * f64::from(frame), 5.0, 0.1), PoseSource::Prediction, &mut pose);
        }
        let (_, deviation) = next(&mut angles, &state(1.0, 5.0, 3.0), 0.6);
        assert!(deviation > 2.0, "{deviation}");
    }

    #[test]
    fn where_an_object_may_have_turned_the_other_way_round_the_angle_says_so_from_then_on() {
        let turned = |step: f64| {
            let mut angles = ContinuousAngle::default();
            let poses = (0..5).map(|i| (0.1 * f64::from(i), step * f64::from(i)));
            poses.fold((0.0, 0.0), |_, (time, angle)| {
                // A first angular velocity is known, and none of those after it.
                let omega = if time == 0.0 { 0.0 } else { f64::NAN };
                next(&mut angles, &state(time, omega, 0.01), angle - TAU * (angle / TAU).round())
            })
        };
        let (_, deviation) = turned(2.0);
        assert_eq!(deviation, 0.0);
        // Four turns of nearly half a circle, each of them perhaps one the other way round.
        let (angle, deviation) = turned(3.1);
        assert!((angle - 12.4).abs() < 1e-9 && deviation >= 4.0 * PI, "{angle} {deviation}");
    }
}
