//! Remapping: the map cut anew from several frames together, once they are aligned.
use freeform_curve_fit::Outline;
use freeform_riccati::map_point;
use nalgebra::{Matrix3, Point2};

use super::Track;
use crate::{
    belief::EarlierPoses,
    map::{CellPoint, CellsInCommon, Contour, has_common_places},
    measurement::{Frame, NegativeLogLikelihood, Pass},
    tuning::remapping as tuning,
};

/// A frame and the pose, body to image, in which it shows the object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlacedFrame<'a> {
    pub(crate) time: f64,
    pub(crate) outline: &'a Outline,
    pub(crate) pose: Matrix3<f64>,
}

impl Track {
    /// Frames, the last of which this track stands at, in the poses that its motion puts them in.
    pub(crate) fn placed<'a>(
        &self,
        frames: impl DoubleEndedIterator<Item = (f64, &'a Outline)>,
    ) -> Vec<PlacedFrame<'a>> {
        let belief = &self.belief;
        let mut last_time = None;
        let placed = frames.rev().map(|(time, outline)| {
            let seconds = time - *last_time.get_or_insert(time);
            let flow = belief.model.flow(&belief.motion[..belief.parameter_count()], seconds);
            PlacedFrame { time, outline, pose: flow.into_inner() * belief.pose }
        });
        let mut placed: Vec<_> = placed.collect();
        placed.reverse();
        placed
    }

    /// Whether frames are explained better in the poses that they were found in than in those of a constant motion, which have fewer parameters, by
    /// more than chance makes of that: cut along points that were placed by that motion, an outline would be smeared.
    pub(crate) fn explains_better(
        &self,
        as_found: &[PlacedFrame<'_>],
        by_motion: &[PlacedFrame<'_>],
        buffers: &mut Frame,
    ) -> bool {
        // A constant motion has those of two poses.
        let Some(more) = as_found.len().checked_sub(2).filter(|more| *more > 0) else { return false };
        let mut sums = [NegativeLogLikelihood::default(); 2];
        for (found, moved) in as_found.iter().zip(by_motion) {
            let of_frame = self.compared(found.outline, &[found.pose, moved.pose], buffers);
            sums.iter_mut().zip(&of_frame).for_each(|(sum, of_frame)| sum.add(of_frame));
        }
        let parameters = more * self.model().parameter_count();
        sums[1].is_worse_by_fit(tuning::FOUND_ELSEWHERE * parameters as f64, &sums[0])
    }

    /// A track of the same body frame with cells cut from every frame out of `stride`, which are those that this one has taken, and all
    /// then taken one by one; `take` says whether a frame was. `None` where one of them is not, and where the new cells do not show the turn.
    pub(crate) fn remapped(
        &self,
        frames: &[PlacedFrame<'_>],
        stride: usize,
        buffers: &mut Frame,
        take: impl FnMut(&mut Self, &mut Frame, f64, &Outline) -> bool,
    ) -> Option<Self> {
        let (mut track, _) = self.recut(frames, (stride, CellsInCommon::NotNeeded), buffers)?;
        track.begin_as(self, frames.first()?.outline, buffers);
        track.replayed(frames, buffers, take)
    }

    /// A track of the same body frame with cells cut from every frame out of `stride`, which are those that this one has taken; it is to be
    /// [begun](Self::begin_as) with the first of them yet. `None` where the new cells do not show the turn.
    pub(crate) fn recut(
        &self,
        frames: &[PlacedFrame<'_>],
        (stride, in_common): (usize, CellsInCommon),
        buffers: &mut Frame,
    ) -> Option<(Self, CellsInCommon)> {
        let runs = self.points_along(frames, stride, buffers)?;
        self.recut_along(runs, frames.first()?.outline, in_common, buffers)
    }

    /// The points of every frame out of `stride` in their order along the outline, in the body frame, and whether it is closed, of each of its
    /// pieces. `None` where they make no finer map.
    pub(crate) fn points_along(
        &self,
        frames: &[PlacedFrame<'_>],
        stride: usize,
        buffers: &mut Frame,
    ) -> Option<Vec<(Vec<Point2<f64>>, bool)>> {
        // Frames that have turned by what nobody knows would smear what one of them shows of the turn.
        if self.belief.earlier_poses == EarlierPoses::Forgotten || self.turn_is_unseen() {
            return None;
        }
        let points = self.points_in_body(frames, stride, buffers)?;
        if self.map.has_common_points(&points) {
            return None;
        }
        let runs = self.map.along_chains(points, &self.belief.offsets);
        if has_common_places(&runs) {
            return None;
        }
        Some(runs.into_iter().map(|(run, closed)| (run.into_iter().map(|(_, q)| q).collect(), closed)).collect())
    }

    /// As [`recut`](Self::recut), with the points of the frames in their order along the outline; and what cells they have in common.
    pub(crate) fn recut_along(
        &self,
        runs: Vec<(Vec<Point2<f64>>, bool)>,
        first: &Outline,
        mut in_common: CellsInCommon,
        buffers: &mut Frame,
    ) -> Option<(Self, CellsInCommon)> {
        let contours: Vec<_> = runs.into_iter().map(|(run, closed)| Contour::new(run, closed)).collect();
        buffers.load(first, self.reference);
        let least_noise = (tuning::LEAST_NOISE * self.noise.sigma).max(self.noise.rounding().of_point());
        let draft = |contours, in_common| {
            let of = (self.belief.model, self.reference);
            Self::draft(of, self.first_pose.pose, contours, (least_noise, in_common), buffers)
        };
        let to_be_finer = (in_common == CellsInCommon::InEveryFrame).then(|| contours.clone());
        let mut track = draft(contours, in_common)?;
        if let Some(contours) = to_be_finer.filter(|_| track.map.bends_from_cell_to_cell()) {
            in_common = CellsInCommon::InSomeFrames;
            track = draft(contours, in_common)?;
        }
        // Through points that do not lie on one line, as where the frames do not show the same, a contour runs to and fro.
        let is_longer = track.map.length() > tuning::LONGEST * self.map.length();
        if track.turn_is_unseen() || is_longer && self.map.cells().len() >= tuning::CELLS_OF_LENGTH {
            return None;
        }
        Some((track, in_common))
    }

    /// Measures the first of the frames that a track was cut anew from, as what another that has taken them knows of it.
    pub(crate) fn begin_as(&mut self, other: &Self, first: &Outline, buffers: &mut Frame) {
        buffers.load(first, self.reference);
        self.measure_draft(other.noise.rounding(), buffers);
        self.noise.adopt_level_of(&other.noise);
        self.begin_in_pose_of(other);
        self.belief.motion = other.belief.motion;
    }

    /// A track that has been begun in the same frame and in the same pose as another, at that frame, for another motion, which that other track
    /// has: an outline has cells of one length in both, so that frames that are measured on them tell the two apart by what they show. `None`
    /// where the other track was not begun in the same pose.
    pub(crate) fn with_motion_of(&self, other: &Self) -> Option<Self> {
        if other.first_pose != self.first_pose || other.turn_is_unseen() {
            return None;
        }
        let mut track = self.clone();
        track.noise.adopt_level_of(&other.noise);
        track.belief.motion = other.belief.motion;
        Some(track)
    }

    /// A track that stands at the first of some frames, after the others have been taken one by one; `take` says whether a frame was. `None`
    /// where one of them is not.
    pub(crate) fn replayed(
        mut self,
        frames: &[PlacedFrame<'_>],
        buffers: &mut Frame,
        mut take: impl FnMut(&mut Self, &mut Frame, f64, &Outline) -> bool,
    ) -> Option<Self> {
        let (first, others) = frames.split_first()?;
        let mut before = first.time;
        for PlacedFrame { time, outline, .. } in others {
            if !take(&mut self, buffers, time - before, outline) {
                return None;
            }
            before = *time;
        }
        Some(self)
    }

    /// The points of every frame out of `stride` in the body frame, with the cells that they were seen of.
    fn points_in_body(&self, frames: &[PlacedFrame<'_>], stride: usize, buffers: &mut Frame) -> Option<Vec<CellPoint>> {
        let count = frames.iter().step_by(stride).map(|frame| frame.outline.point_count()).sum();
        let mut list = Vec::with_capacity(count);
        for PlacedFrame { outline, pose, .. } in frames.iter().step_by(stride) {
            buffers.load(outline, self.reference);
            let inverse = pose.try_inverse()?;
            buffers.clear_shifts(self.map.cells().len());
            self.view().measure_by_columns(buffers, pose, &[], Pass::First);
            let (cells, Frame { columns, points, places, .. }) = (self.map.cells().len(), &*buffers);
            for ((m, p), place) in columns.points().zip(points).zip(places) {
                let at = map_point(&inverse, p);
                let place = if m.weight > 0.0 { *place } else { at };
                let cell = Some(m.cell).filter(|cell| *cell < cells);
                list.push(CellPoint { cell, place, at });
            }
        }
        Some(list)
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Matrix3, Point2, Vector3};

    use super::*;
    use crate::drawn_curves::{lobed, outline, polar};

    /// An egg with three bulges, its points elsewhere on it from frame to frame.
    fn egg(frame: u32) -> Outline {
        let along = 0.37 * std::f64::consts::TAU / 900.0 * f64::from(frame);
        outline(900, |t| {
            let p = polar(lobed(t + along, &[(3.0, [0.2, 0.0]), (1.0, [0.0, 0.1])]), t + along);
            Point2::new(p.x, 0.8 * p.y)
        })
    }

    #[test]
    fn frames_that_do_not_show_one_line_make_no_map() {
        let outlines: Vec<Outline> = (0..4).map(egg).collect();
        let mut buffers = Frame::default();
        let track = Track::begin(MotionModel::Rigid, &outlines[0], 0.0, &mut buffers).expect("a track");
        // In a row, as where outlines or their poses jitter.
        let mut is_cut = |apart: f64| {
            let placed = |(number, outline)| {
                let shift = apart * f64::from(u32::try_from(number).expect("few"));
                let pose = Matrix3::identity()
                    + Matrix3::from_columns(&[Vector3::zeros(), Vector3::zeros(), Vector3::new(shift, -shift, 0.0)]);
                PlacedFrame { time: number as f64, outline, pose }
            };
            let frames: Vec<PlacedFrame<'_>> = outlines.iter().enumerate().map(placed).collect();
            track.remapped(&frames, 1, &mut buffers, |_, _, _, _| true).is_some()
        };
        assert!(is_cut(0.0));
        assert!(is_cut(0.02));
        assert!(!is_cut(0.07));
    }
}
