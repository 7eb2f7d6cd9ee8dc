use freeform_curve_fit::Outline;
use freeform_estimate::PlaneEstimate;
use freeform_riccati::{MotionModel, PinholeCamera};

use super::{
    scenery::Scenery,
    search::{SeenPose, minima},
    solution::{KeptFrame, Solution},
};
use crate::{
    measurement::Frame,
    supervisor::{FilterError, FilterSettings, FilterStep, MotionFilter},
    track::Track,
    tuning::plane as tuning,
};

/// Identifies how a plane with an outline on it moves in space, from its pictures by a perspective camera, one frame after the other.
///
/// A [`MotionFilter`] for projective motion finds the object in every frame and its outline. Beside it the motion of the plane is the least
/// sum of squares over all frames: angular velocity, velocity, normal at the first frame, and the offsets of the outline, all of them
/// constant. Up to two motions are followed, as long as the frames do not decide between the two solutions that are known of plane motion.
#[derive(Debug, Clone)]
pub struct PlaneFilter {
    camera: PinholeCamera,
    follower: MotionFilter,
    /// Time of the first frame, seconds.
    start: f64,
    restarts: usize,
    frames: Vec<KeptFrame>,
    /// Frames that are no longer kept.
    folded: usize,
    pub(super) scenery: Option<Scenery>,
    /// Best first.
    pub(super) solutions: Vec<Solution>,
    buffers: Frame,
}

impl PlaneFilter {
    /// A filter that waits for its first frame. Of the settings the motion model is not used, and the edge uncertainty does not widen
    /// what is stated.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(camera: PinholeCamera, settings: FilterSettings) -> Result<Self, FilterError> {
        let follower = MotionFilter::new(FilterSettings { model: MotionModel::Projective, ..settings })?;
        Ok(Self {
            camera,
            follower,
            start: 0.0,
            restarts: 0,
            frames: Vec::new(),
            folded: 0,
            scenery: None,
            solutions: Vec::new(),
            buffers: Frame::default(),
        })
    }

    /// Takes the outline seen at a time in seconds.
    ///
    /// # Errors
    /// As [`MotionFilter::step`].
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<FilterStep, FilterError> {
        let step = self.follower.step(time, outline)?;
        if self.follower.restarts() != self.restarts {
            self.restarts = self.follower.restarts();
            self.begin_anew();
        } else if !step.is_accepted() {
            return Ok(step);
        }
        if self.frames.is_empty() && self.folded == 0 {
            self.start = time;
        }
        if let Some(track) = self.follower.track() {
            let seconds = time - self.start;
            self.frames.push(KeptFrame { seconds, outline: outline.clone(), pose: *track.body_pose() });
            self.update();
        }
        Ok(step)
    }

    /// As [`MotionFilter::prepare`], of the filter that follows the object in the picture.
    pub fn prepare(&mut self) -> bool {
        self.follower.prepare()
    }

    fn begin_anew(&mut self) {
        self.frames.clear();
        self.solutions.clear();
        (self.folded, self.scenery) = (0, None);
    }

    /// The filter that follows the object in the picture.
    #[must_use]
    pub fn follower(&self) -> &MotionFilter {
        &self.follower
    }

    /// The camera.
    #[must_use]
    pub fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// Seconds from the first frame to the last one taken.
    pub(super) fn span(&self) -> f64 {
        self.frames.last().map_or(0.0, |frame| frame.seconds)
    }

    /// Frames that the motion rests on.
    pub(super) fn frame_count(&self) -> usize {
        self.folded + self.frames.len()
    }

    /// Takes the last frame into every solution, and looks for others when it is time.
    fn update(&mut self) {
        let Some(track) = self.follower.track() else { return };
        let track = track.clone();
        let is_new = self.update_scenery(&track);
        let is_occasion = self.folded == 0 && tuning::OCCASIONS.contains(&self.frames.len());
        if is_occasion && !self.is_decided() {
            self.search();
            return;
        }
        let Some(scenery) = &self.scenery else { return };
        let (frames, buffers) = (&self.frames, &mut self.buffers);
        let Some(last) = frames.last() else { return };
        for solution in &mut self.solutions {
            if !is_new {
                buffers.load(&last.outline, scenery.reference);
                if solution.add(scenery, buffers, last.seconds).is_some() && !solution.is_stale(scenery.sigma()) {
                    continue;
                }
            }
            solution.relinearise(scenery, frames, buffers);
        }
        self.sort();
        if is_occasion {
            self.redraw();
        }
        self.fold();
    }

    /// Whether one motion is left and all of it is known, so that there is nothing to look for.
    fn is_decided(&self) -> bool {
        let [only] = &self.solutions[..] else { return false };
        self.frames.len() >= tuning::FEWEST_TO_DECIDE
            && self.estimate_of(only).is_some_and(|estimate| estimate.known().iter().all(|known| *known))
    }

    /// Updates outline and noise by those of the follower. Whether the outline is another than before.
    fn update_scenery(&mut self, track: &Track) -> bool {
        let is_same = self.scenery.as_ref().is_some_and(|scenery| scenery.is_of(track));
        if is_same {
            if let Some(scenery) = &mut self.scenery {
                scenery.noise = track.noise().clone();
            }
            return false;
        }
        if self.folded > 0 {
            // What is no longer kept was measured against the outline as it was.
            return false;
        }
        self.scenery = Scenery::of(track, &self.camera);
        let Some(scenery) = &mut self.scenery else { return false };
        let belief = Scenery::belief_of(track);
        // The error of this pose is that of the whole outline, which its offsets take up.
        if let Some(first) = self.frames.first() {
            self.buffers.load(&first.outline, scenery.reference);
            if let Some((pose, _)) = scenery.find_pose(&belief, &mut self.buffers, &scenery.first_pose.clone()) {
                scenery.first_pose = pose;
            }
        }
        self.solutions.iter_mut().for_each(|solution| solution.replace_outline(belief.clone()));
        true
    }

    /// Looks for all motions that explain the frames.
    fn search(&mut self) {
        let Some((scenery, track)) = self.scenery.as_ref().zip(self.follower.track()) else { return };
        let belief = match self.solutions.first() {
            Some(best) => best.belief().clone(),
            None => Scenery::belief_of(track),
        };
        let stride = self.frames.len().div_ceil(tuning::MOST_POSES);
        let mut poses = Vec::new();
        let last = self.frames.len() - 1;
        for (index, frame) in self.frames.iter_mut().enumerate() {
            if index % stride != 0 && index != last {
                continue;
            }
            self.buffers.load(&frame.outline, scenery.reference);
            let Some((pose, information)) = scenery.find_pose(&belief, &mut self.buffers, &frame.pose) else {
                continue;
            };
            frame.pose = pose;
            poses.push(SeenPose { seconds: frame.seconds, pose, information: information * stride as f64 });
        }
        let known: Vec<_> = self.solutions.iter().map(|solution| solution.motion).collect();
        let mut found = minima(scenery, &poses, &known);
        let least = found.first().map_or(0.0, |best| best.squares);
        found.retain(|other| other.squares < least + tuning::FAR_FROM_BEST);
        found.truncate(tuning::MOST_SOLUTIONS);
        let agreement = self.solutions.first().map(|solution| solution.agreement).unwrap_or_default();
        self.solutions.clear();
        for minimum in found {
            let mut solution = Solution::new(minimum.motion, belief.clone());
            solution.agreement = agreement;
            if solution.relinearise(scenery, &self.frames, &mut self.buffers) {
                self.solutions.push(solution);
            }
        }
        self.sort();
        self.redraw();
    }

    /// Draws the outline anew where the best solution has found it.
    fn redraw(&mut self) {
        if self.frames.len() < tuning::FEWEST_TO_REDRAW {
            return;
        }
        let Some((scenery, best)) = self.scenery.as_mut().zip(self.solutions.first()) else { return };
        let offsets = best.belief().offsets.clone();
        scenery.redraw(&offsets, best.outline_deviation(scenery.sigma()));
        for solution in &mut self.solutions {
            solution.subtract_redrawn(&offsets);
            solution.relinearise(scenery, &self.frames, &mut self.buffers);
        }
        self.sort();
    }

    /// Best first; without those that no camera can see, those that the frames have ruled out, and one that has come to where another is.
    fn sort(&mut self) {
        let (scenery, span) = (self.scenery.as_ref(), self.span());
        let is_seen = |solution: &Solution| scenery.is_none_or(|scenery| scenery.shows(&solution.motion, span));
        self.solutions.retain(|solution| solution.squares.is_finite() && is_seen(solution));
        self.solutions.sort_by(|a, b| a.squares.total_cmp(&b.squares));
        let least = self.solutions.first().map_or(0.0, |best| best.squares);
        self.solutions.retain(|other| other.squares <= least + tuning::RULED_OUT);
        let Some(scenery) = &self.scenery else { return };
        let sigma = scenery.sigma();
        let mut kept: Vec<Solution> = Vec::new();
        for solution in self.solutions.drain(..) {
            if !kept.iter().any(|other| other.is_near(&solution, sigma)) {
                kept.push(solution);
            }
        }
        kept.truncate(2);
        self.solutions = kept;
    }

    /// Keeps of the oldest frames no more than what they say where the solutions are now, once there are many.
    fn fold(&mut self) {
        if self.frames.len() < tuning::MOST_KEPT {
            return;
        }
        let Some(scenery) = &self.scenery else { return };
        let oldest = self.frames.len() / 2;
        for solution in &mut self.solutions {
            solution.relinearise(scenery, &self.frames, &mut self.buffers);
            solution.fold(scenery, &self.frames[..oldest], &mut self.buffers);
        }
        self.frames.drain(..oldest);
        self.folded += oldest;
    }

    /// The motion, if it is known at all, with standard deviations.
    #[must_use]
    pub fn estimate(&self) -> Option<PlaneEstimate> {
        self.estimate_of(self.solutions.first()?)
    }
}
