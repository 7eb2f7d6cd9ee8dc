//! The object looked for where nothing says how it has moved, with all poses that explain the frame.
use freeform_curve_fit::Outline;
use freeform_riccati::map_point;
use nalgebra::{Affine2, Matrix3, Rotation2};

use super::{
    acquisition::{Hypothesis, Landmarks, find_pose, motion_between},
    map_update::MapUpdate,
    misfit::Misfit,
    motion_filter::{MotionFilter, Phase, fits},
    outline_map::OutlineMap,
    rivals::Rivals,
};

/// Squared innovation of one frame beyond which the motion has not gone on as it was.
pub(crate) const LARGEST_INNOVATION: f64 = 80.0;
/// Turns from the best that are compared with it, spread by the golden angle, rad.
const OTHER_TURNS: usize = 32;
const GOLDEN_ANGLE: f64 = 2.399_963;
/// Turns nearer than this to the best are no others, rad.
const NEAR: f64 = 0.3;

/// Shares of other turns that a frame must explain worse than the best to show the turn, the latter where no frame has before.
const MOST: f64 = 0.5;
const NEARLY_ALL: f64 = 0.88;

/// Points that turns are compared by.
const ENOUGH_POINTS: usize = 2000;

/// The map in a pose that was tried.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) map: OutlineMap,
    pub(crate) update: MapUpdate,
    /// Turn from the pose before, rad, anticlockwise where y points up.
    pub(crate) turn: f64,
    pub(crate) misfit: Misfit,
}

impl MotionFilter {
    /// Goes on as predicted if that fits, searches for the object otherwise.
    pub(super) fn acquire(&mut self, time: f64, outline: &Outline) -> Option<MapUpdate> {
        let seconds = time - self.map_time;
        let smallest = self.settings.smallest_agreement;
        let fits = fits(self.map.as_ref()?, smallest);
        if self.phase == Phase::Lost {
            let mut going_on = self.map.clone()?;
            going_on.predict(seconds);
            let update = going_on.update(outline, |u| fits(u) && u.innovation <= LARGEST_INNOVATION);
            if update.accepted {
                self.replace(going_on, time, Phase::Tracking);
                return Some(update);
            }
        }
        // The contour of one frame may hide errors that are smooth along it and change from frame to frame: they are only allowed for
        // where nothing fits without.
        let mut candidates = self.candidates(outline, seconds, false);
        if !candidates.iter().any(|candidate| candidate.update.accepted) {
            let relaxed = self.candidates(outline, seconds, true);
            candidates = if relaxed.is_empty() { candidates } else { relaxed };
        }
        let agreement = |c: &Candidate| c.update.agreement;
        let nearest = candidates.iter().max_by(|a, b| agreement(a).total_cmp(&agreement(b)))?.update;
        let lost = self.phase == Phase::Lost;
        candidates.retain(|candidate| candidate.update.accepted);
        let (taken, rivals) = Rivals::among(candidates);
        self.rivals = rivals;
        let update = taken.as_ref().map_or(nearest, |candidate| candidate.update);
        if let Some(taken) = taken {
            // Where a lost object is now says nothing of how it moves now.
            self.replace(taken.map, time, if lost { Phase::Acquiring } else { Phase::Tracking });
            if let Some(map) = self.map.as_mut().filter(|map| !map.turn_is_hidden) {
                map.turn_is_new = false;
            }
        }
        if let Some(map) = self.map.as_mut().filter(|_| update.accepted || lost) {
            map.noise_level.take(update.spread / map.radius);
        }
        Some(update)
    }

    /// All poses found, measured. A turn of which the frame shows next to nothing is taken to be unseen.
    fn candidates(&mut self, outline: &Outline, seconds: f64, relaxed: bool) -> Vec<Candidate> {
        if let Some(map) = &mut self.map {
            map.show_turn();
        }
        let candidates = self.measured(outline, seconds, relaxed);
        let fitting = candidates.iter().filter(|c| c.update.accepted);
        let Some(best) = fitting.min_by(|a, b| a.misfit.squares.total_cmp(&b.misfit.squares)) else {
            return candidates;
        };
        let pose = best.map.pose;
        let Some(map) = self.map.as_mut().filter(|map| !map.turn_is_unseen()) else { return candidates };
        if map.shows_turn(outline, &pose) {
            return candidates;
        }
        map.hide_turn();
        self.measured(outline, seconds, relaxed)
    }

    fn measured(&mut self, outline: &Outline, seconds: f64, relaxed: bool) -> Vec<Candidate> {
        let Some(map) = self.map.as_mut() else { return Vec::new() };
        let landmarks = self.landmarks.and_then(|landmarks| {
            let pose: Affine2<f64> = nalgebra::try_convert(map.pose())?;
            Some([landmarks.moved(&pose), Landmarks::of(outline)?])
        });
        let hypotheses = find_pose(map, outline, landmarks);
        let tried = hypotheses.iter().filter_map(|hypothesis| self.try_pose(hypothesis, outline, seconds, relaxed));
        let mut candidates: Vec<Candidate> = tried.collect();
        let poses: Vec<_> = candidates.iter().map(|candidate| candidate.map.pose).collect();
        let misfits = self.map.as_mut().map_or_else(Vec::new, |map| map.compared(outline, &poses));
        candidates.iter_mut().zip(misfits).for_each(|(candidate, misfit)| candidate.misfit = misfit);
        candidates
    }

    fn try_pose(&self, hypothesis: &Hypothesis, outline: &Outline, seconds: f64, relaxed: bool) -> Option<Candidate> {
        let mut map = self.map.clone()?;
        map.noise_level.relaxed = relaxed;
        if self.phase == Phase::Lost {
            map.relocate(hypothesis.pose);
        } else {
            let change = hypothesis.pose * map.pose.try_inverse()?;
            map.motion = motion_between(self.settings.model, &change, seconds)?;
            map.predict(seconds);
        }
        let fits = fits(&map, self.settings.smallest_agreement);
        let update = map.update(outline, fits);
        map.noise_level.relaxed = false;
        Some(Candidate { map, update, turn: hypothesis.turn, misfit: Misfit::default() })
    }
}

impl OutlineMap {
    /// Misfit of an outline in several poses.
    fn compared(&mut self, outline: &Outline, poses: &[Matrix3<f64>]) -> Vec<Misfit> {
        self.load(outline);
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.thin_out(ENOUGH_POINTS);
        let misfits = self.misfits_in(&mut scratch, poses);
        self.scratch = scratch;
        misfits
    }

    /// Whether the outline in a pose explains a frame significantly better than in most of the poses turned from it.
    fn shows_turn(&mut self, outline: &Outline, pose: &Matrix3<f64>) -> bool {
        let centre = map_point(pose, &self.middle());
        let turned = (1..=OTHER_TURNS).map(|i| Rotation2::new(GOLDEN_ANGLE * i as f64));
        let turned = turned.filter(|rotation| rotation.angle().abs() >= NEAR).map(|rotation| {
            let shift = centre - rotation * centre;
            let mut turned = rotation.to_homogeneous();
            (turned[(0, 2)], turned[(1, 2)]) = (shift.x, shift.y);
            turned * pose
        });
        let poses: Vec<_> = std::iter::once(*pose).chain(turned).collect();
        let misfits = self.compared(outline, &poses);
        let worse = misfits[1..].iter().filter(|other| other.is_worse_than(&misfits[0])).count();
        // What has been seen of a turn for the first time may be a single mark, which the next frame may hide: it then lies anywhere in
        // what that frame does not show.
        let share = if self.turn_is_new { NEARLY_ALL } else { MOST };
        worse as f64 > share * (misfits.len() - 1) as f64 && (!self.turn_is_new || self.begun_anew(outline).is_some())
    }
}
