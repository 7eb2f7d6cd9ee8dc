//! Where every object was in every frame.
use freeform_motion::estimate::{MotionState, ProcessNoise, SmootherError, smooth};

use crate::tracking::Observation;

/// One object in one frame.
#[derive(Debug)]
pub(crate) struct TrajectoryRow {
    pub(crate) object: String,
    pub(crate) frame: u64,
    /// In seconds; `None` where the outline could not be read.
    pub(crate) time: Option<f64>,
    pub(crate) accepted: bool,
    /// What was known then, at a time up to that of the frame.
    state: Option<MotionState>,
}

impl TrajectoryRow {
    /// Pose and motion at the time of the frame.
    pub(crate) fn state(&self) -> Option<MotionState> {
        let (state, time) = (self.state.as_ref()?, self.time?);
        // Not since it was lost: where it is then is a guess.
        (state.time() == time).then(|| state.clone())
    }
}

/// The rows of all objects, as they came.
#[derive(Debug, Default)]
pub(crate) struct Trajectory {
    pub(crate) rows: Vec<TrajectoryRow>,
}

impl Trajectory {
    /// Adds what a frame of an object gave.
    pub(crate) fn take(&mut self, observation: &Observation) {
        self.rows.push(TrajectoryRow {
            object: observation.object.clone(),
            frame: observation.frame,
            time: observation.time,
            accepted: observation.is_accepted(),
            state: observation.state.clone(),
        });
    }

    /// Lets later frames take part, within each run of frames through which an object was followed. The frame that such a run
    /// began with, when the motion was not known yet, gets its pose from the ones after it.
    pub(crate) fn smooth(&mut self, noise: &ProcessNoise) -> Result<(), SmootherError> {
        let mut names: Vec<String> = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.object) {
                names.push(row.object.clone());
            }
        }
        for name in names {
            let mut rows: Vec<&mut TrajectoryRow> = self.rows.iter_mut().filter(|row| row.object == name).collect();
            let followed: Vec<bool> = rows.iter().map(|row| row.state.is_some()).collect();
            let mut start = 0;
            for run in followed.chunk_by(|a, b| a == b) {
                if run[0] {
                    let (before, from) = rows.split_at_mut(start);
                    smooth_run(&mut from[..run.len()], before.last_mut().map(|row| &mut **row), noise)?;
                }
                start += run.len();
            }
        }
        Ok(())
    }
}

fn smooth_run(
    rows: &mut [&mut TrajectoryRow],
    before: Option<&mut TrajectoryRow>,
    noise: &ProcessNoise,
) -> Result<(), SmootherError> {
    let filtered: Vec<MotionState> = rows.iter().filter_map(|row| row.state()).collect();
    let smoothed = smooth(&filtered, noise)?;
    if let (Some(before), Some(first)) = (before.filter(|row| row.accepted), smoothed.first()) {
        before.state = before.time.map(|time| first.predicted(time, noise));
    }
    let known = rows.iter_mut().filter(|row| row.state().is_some());
    known.zip(smoothed).for_each(|(row, state)| row.state = Some(state));
    Ok(())
}
