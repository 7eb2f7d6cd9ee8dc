//! The frames that a map was begun from, and the map cut anew from them.
use freeform_curve_fit::Outline;
use nalgebra::{Affine2, Matrix3};

use super::{
    acquisition::Landmarks,
    map_recut::{PLENTY, PlacedFrame},
    motion_change::MotionChange,
    motion_filter::{Known, MotionFilter, Phase, advance},
    outline_map::OutlineMap,
    rivals::Rivals,
};

/// Frames after which the map is cut anew.
const OCCASIONS: [usize; 3] = [4, 16, 64];
/// With so many points of one frame for each cell there is nothing to be gained.
const PLENTY_PER_CELL: f64 = 3.5;
/// Times that a map is cut from the same frames at most.
const MOST_CUTS: usize = 4;

/// The frames that a map was begun from, kept until it has been cut from enough of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct FirstFrames {
    frames: Vec<(f64, Outline)>,
    /// What the map found of them.
    poses: Vec<Matrix3<f64>>,
    points: usize,
    over: bool,
}

impl FirstFrames {
    /// Begins with the first frame of a map.
    pub(crate) fn begin(time: f64, outline: &Outline, map: &OutlineMap) -> Self {
        let mut frames = Self {
            frames: vec![(time, outline.clone())],
            poses: vec![map.pose],
            points: outline.point_count(),
            over: false,
        };
        frames.end_unless_few(map.cells.len());
        frames
    }

    /// Forgets what is kept.
    pub(crate) fn end(&mut self) {
        *self = Self { over: true, ..Self::default() };
    }

    /// Begins anew with a frame, unless a map has been cut already, which knows more of the outline than frames yet to come.
    pub(crate) fn begin_anew(&mut self, time: f64, outline: &Outline, map: &OutlineMap) {
        if self.frames.len() < OCCASIONS[0] && !self.over {
            *self = Self::begin(time, outline, map);
        } else {
            self.end();
        }
    }

    /// Keeps a frame that follows the others, in the pose of the map; whether the map is to be cut from them now.
    pub(crate) fn take(&mut self, time: f64, outline: &Outline, map: &OutlineMap) -> bool {
        if self.over {
            return false;
        }
        self.frames.push((time, outline.clone()));
        self.poses.push(map.pose);
        self.points += outline.point_count();
        OCCASIONS.contains(&self.frames.len())
    }

    /// Whether there are frames to cut a map from.
    pub(crate) fn are_several(&self) -> bool {
        self.frames.len() > 1
    }

    /// Forgets what is kept unless more frames would make a map of so many cells better.
    pub(crate) fn end_unless_few(&mut self, cells: usize) {
        let count = self.frames.len().max(1);
        let next = OCCASIONS.into_iter().find(|occasion| *occasion > count);
        let each = self.points / count;
        let would_be_plenty = count > 1 && next.is_none_or(|next| next * each > PLENTY);
        let one_is_plenty = each as f64 > PLENTY_PER_CELL * cells as f64;
        if would_be_plenty || one_is_plenty {
            self.end();
        }
    }

    /// Takes the poses that a map cut anew has found.
    pub(crate) fn take_poses(&mut self, poses: Vec<Matrix3<f64>>) {
        self.poses = poses;
    }

    /// In the poses that they were found in.
    pub(crate) fn as_found(&self) -> Vec<PlacedFrame<'_>> {
        let placed = self.frames.iter().zip(&self.poses);
        placed.map(|((time, outline), pose)| PlacedFrame { time: *time, outline, pose: *pose }).collect()
    }

    /// In the poses that the motion of a map puts them in: where they were if it has never changed.
    pub(crate) fn by_motion(&self, map: &OutlineMap) -> Vec<PlacedFrame<'_>> {
        map.placed(self.frames.iter().map(|(time, outline)| (*time, outline)))
    }
}

/// A map cut anew, how the motion changes in the frames that it was cut from, and their poses.
struct Recut {
    map: OutlineMap,
    change: MotionChange,
    poses: Vec<Matrix3<f64>>,
}

impl MotionFilter {
    /// Keeps one of the first frames, and cuts the map anew once there are enough of them, or where the motion seems to change, which
    /// may be what coarse cells make of it.
    pub(super) fn keep(&mut self, time: f64, outline: &Outline, changes: bool) {
        let Some(map) = &mut self.map else { return };
        if self.phase != Phase::Tracking {
            // Found again somewhere: what was seen before has come there by what nobody knows.
            self.first_frames.begin_anew(time, outline, map);
            map.begin_here();
            return;
        }
        let is_due = self.first_frames.take(time, outline, map);
        if !is_due && !changes || !self.first_frames.are_several() {
            return;
        }
        if map.turn_is_unseen() {
            self.begin_with_turn(outline);
        } else {
            self.recut();
        }
        self.first_frames.end_unless_few(self.map.as_ref().map_or(0, OutlineMap::cell_count));
    }

    /// Cuts the map anew from the first frames, until it settles, and looks for changes of the motion once more: what was taken for one may
    /// have been what coarse cells left.
    fn recut(&mut self) {
        let Some(cut) = self.map.as_ref().and_then(|map| self.settled(map, self.may_change(&self.change))) else {
            return;
        };
        let mut rivals = std::mem::take(&mut self.rivals);
        rivals.recut(|map| self.settled(map, false).map(|cut| cut.map));
        self.rivals = rivals;
        self.map = Some(cut.map);
        self.motion_changed = cut.change.is_seen();
        // What the first few frames seem to say of it counts for nothing.
        self.change = if cut.change.is_seen() { cut.change } else { MotionChange::default() };
        self.first_frames.take_poses(cut.poses);
    }

    /// A map cut anew from the first frames until its pose settles; `changes` tells whether its motion has been another in them.
    fn settled(&self, map: &OutlineMap, changes: bool) -> Option<Recut> {
        let frames = if changes { self.first_frames.as_found() } else { self.first_frames.by_motion(map) };
        let mut cut = self.cut(map, &frames)?;
        let mut before = map.pose;
        // Better aligned frames make a better map, which aligns them better.
        for _ in 1..MOST_CUTS {
            if (cut.map.pose - before).norm() < cut.map.sigma {
                break;
            }
            before = cut.map.pose;
            let mut frames = self.first_frames.by_motion(&cut.map);
            if self.may_change(&cut.change) {
                frames.iter_mut().zip(&cut.poses).for_each(|(frame, pose)| frame.pose = *pose);
            }
            cut = self.cut(&cut.map, &frames)?;
        }
        Some(cut)
    }

    /// Whether the motion changes, as is seen or as the settings say.
    fn may_change(&self, change: &MotionChange) -> bool {
        change.is_seen() || !self.settings.process_noise.is_none()
    }

    fn cut(&self, map: &OutlineMap, frames: &[PlacedFrame<'_>]) -> Option<Recut> {
        let mut change = MotionChange::default();
        let mut poses = vec![map.first_pose.pose];
        let map = map.recut(frames, 1, |map, seconds, outline| {
            let update = advance(&self.settings, map, &mut change, (seconds, outline), Known::ShowsObject);
            poses.push(map.pose);
            update
        })?;
        Some(Recut { map, change, poses })
    }

    /// Begins anew, in the same body frame, with a frame that shows the turn at last: the earlier ones have turned by what nobody
    /// knows.
    pub(super) fn begin_with_turn(&mut self, outline: &Outline) {
        let Some(map) = &mut self.map else { return };
        let Some(new) = map.begun_anew(outline) else {
            map.hide_turn();
            map.turn_is_new = true;
            return;
        };
        let to_body: Option<Affine2<f64>> = nalgebra::try_convert(new.pose().inverse());
        self.landmarks = to_body.and_then(|to_body| Some(Landmarks::of(outline)?.moved(&to_body)));
        self.first_frames = FirstFrames::begin(self.last_time, outline, &new);
        self.rivals = Rivals::default();
        (self.change, self.motion_changed) = (MotionChange::default(), false);
        (self.taken_by_map, self.refused_by_map) = (1, 0);
        self.replace(new, self.map_time, Phase::Acquiring);
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;

    use super::*;
    use crate::FilterSettings;

    #[test]
    fn frames_are_not_kept_for_ever_where_the_turn_stays_unknown() {
        let circle = |i: i32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 100.0;
            Point2::new(angle.cos(), angle.sin())
        };
        let outline = Outline::closed((0..100).map(circle).collect()).expect("an outline");
        let mut filter =
            MotionFilter::new(FilterSettings { model: MotionModel::Rigid, ..Default::default() }).expect("settings");
        for frame in 0..100 {
            filter.step(f64::from(frame) / 30.0, &outline).expect("increasing times");
            assert!(filter.first_frames.frames.len() <= OCCASIONS[2], "frame {frame}");
        }
        assert!(filter.map.as_ref().is_some_and(OutlineMap::turn_is_unseen));
    }
}
