//! Where an object was over time, kept for figures.
use freeform_motion::estimate::PoseParameter;
use freeform_motion::tracker::{Observation, Poses};

use super::thinned::{Kept, Thinned};

/// Most poses kept of an object: about two for each pixel of a figure.
const MOST_KEPT: usize = 1000;

/// Where an object was over time.
#[derive(Debug, Default)]
pub(crate) struct PoseHistory {
    samples: Thinned<PoseSample>,
    segment: usize,
    poses: Poses,
}

/// Where an object was at one time.
#[derive(Debug)]
pub(crate) struct PoseSample {
    /// In seconds.
    pub(crate) time: f64,
    /// Value and standard deviation of every parameter of the pose, where it is stated; angles are continuous over time.
    pub(crate) parameters: Vec<Option<[f64; 2]>>,
}

impl PoseHistory {
    /// The poses kept, in order.
    pub(crate) fn samples(&self) -> &[Kept<PoseSample>] {
        self.samples.kept()
    }

    /// Adds what a frame says.
    pub(crate) fn take(&mut self, observation: &Observation) {
        // Nobody knows how far the object has turned between segments.
        if observation.segment != self.segment {
            self.segment = observation.segment;
            self.samples.break_off();
        }
        let pose = observation.time.zip(self.poses.take(observation));
        let Some((time, pose)) = pose else { return self.samples.skip() };
        let stated = |PoseParameter { value, standard_deviation, .. }: PoseParameter| {
            value.is_finite().then_some([value, standard_deviation])
        };
        let parameters = pose.into_iter().map(stated).collect();
        self.samples.push(PoseSample { time, parameters });
        if self.samples.kept().len() > MOST_KEPT {
            self.samples.halve();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use freeform_motion::curve_fit::Outline;
    use freeform_motion::outline_io::OutlineFrame;
    use freeform_motion::{Tracker, TrackerSettings};
    use nalgebra::Point2;

    use super::*;

    /// What is stated in the last of some frames of an ellipse that turns, of which the motion is forgotten.
    fn last_pose(width: f64) -> Vec<bool> {
        let frames = (0..12).map(|frame| {
            let time = f64::from(frame) / 10.0;
            let points = (0..120).map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / 120.0).sin_cos();
                nalgebra::Rotation2::new(time) * Point2::new(cos + width * cos * cos, (1.0 - width) * sin)
            });
            let outline = Outline::closed(points.collect()).expect("an outline");
            OutlineFrame { frame: frame as u64, time, object: "a".to_owned(), outline }
        });
        let mut poses = PoseHistory::default();
        let mut tracker = Tracker::new(TrackerSettings::default()).expect("settings");
        tracker.follow(frames, |mut observation| {
            observation.estimate = None;
            poses.take(&observation);
        });
        let last = poses.samples().last().expect("poses");
        last.value.parameters.iter().map(Option::is_some).collect()
    }

    #[test]
    fn a_pose_is_kept_also_where_the_motion_is_not_known_and_an_angle_only_where_the_outline_shows_it() {
        assert_eq!(last_pose(0.3), [true; 3]);
        assert_eq!(last_pose(0.0), [false, true, true], "a circle shows no turn");
    }
}
