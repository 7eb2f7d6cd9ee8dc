//! Cells for what a frame shows for the first time, with their first measurement.
use std::sync::Arc;

use freeform_curve_fit::Outline;
use nalgebra::Matrix3;

use super::{Track, body_frame::of_pose};
use crate::{
    belief::StateVector,
    map::{CellsInCommon, Contour, Detours, NullDirections, TurnEvent},
    measurement::{Frame, NO_CELL, Pass},
    tuning::update::DEVIATIONS_PER_CELL,
    update::accumulate,
};

/// What an outline has become by cells that were added.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grown {
    /// Number of the first of them.
    first_new: usize,
    /// What the outline did not show before them and shows now, in the image.
    forgotten: NullDirections,
}

impl Track {
    /// A track of the same body frame of what one outline shows, in the pose that this one is in but for its turn, which is unknown as its
    /// motion is. `None` where that outline does not show the turn either.
    pub(crate) fn begun_anew(&self, outline: &Outline, frame: &mut Frame) -> Option<Self> {
        frame.load(outline, self.reference);
        let contours = frame.contours(&self.belief.pose);
        // The contour of one frame hides errors that neighbouring points share, and frames have told of by now.
        let known_noise = self.noise.sigma * frame.deviations.typical();
        let least_noise = self.noise.rounding().of_point().max(known_noise);
        let of = (self.model(), self.reference);
        let mut track = Self::draft(of, self.belief.pose, contours, (least_noise, CellsInCommon::NotNeeded), frame)?;
        track.measure_draft(self.noise.rounding(), frame);
        if track.turn_is_unseen() {
            return None;
        }
        track.noise.adopt_level_of(&self.noise);
        track.record_turn(TurnEvent::Begun { before: self.turn_evidence().times_begun() });
        track.begin_with_any_turn_of(self, outline).then_some(track)
    }

    /// Whether it is known where the outline lies in a frame that has been taken, so that what that shows for the first time has a place on it.
    pub(super) fn knows_place_of_new(&self) -> bool {
        let summaries = self.held_summaries(&self.null_directions());
        let displacement =
            summaries.and_then(|[_, given_outline]| self.farthest_displacement(&of_pose(&given_outline.covariance)));
        displacement.is_some_and(|displacement| DEVIATIONS_PER_CELL * displacement < self.map.spacing())
    }

    /// Adds cells for the parts of contours in the body frame that the map does not have yet, and measures them by the loaded points, which
    /// the contours are of.
    ///
    /// Returns what the outline did not show before and shows now, in the image: all that was known along it is forgotten.
    pub(super) fn grow_along(&mut self, contours: Vec<Contour>, frame: &mut Frame) -> NullDirections {
        let Some(Grown { first_new, forgotten }) = self.add_cells(contours, frame) else {
            return NullDirections::default();
        };
        self.measure_new_cells(frame, first_new);
        forgotten
    }

    /// Adds cells that have not been measured, as [`grow_along`](Self::grow_along) does, if there are any.
    pub(super) fn add_cells(&mut self, contours: Vec<Contour>, frame: &Frame) -> Option<Grown> {
        let model = self.belief.model;
        let null = self.map.null_directions(model, &self.belief.pose);
        let null_in_body = self.map.null_directions(model, &Matrix3::identity());
        let turn_was_unseen = self.turn_is_unseen();
        let before = (!null.is_empty()).then(|| Arc::clone(&self.map));
        // What touches an object in passing would show what its outline does not, such as how a long bar moves along itself.
        let detours = if null.is_empty() { Detours::Added } else { Detours::LeftOut };
        let map = Arc::make_mut(&mut self.map);
        // Of the body frame. New cells come from points of this frame alone, and the others do not.
        let sigma = self.noise.sigma / self.belief.scale();
        let of_frame = sigma * frame.deviations.typical();
        let grown = map.grow(contours, of_frame, &self.belief.offsets, detours).filter(|first_new| {
            map.find_null_directions(model, sigma, self.belief.known_offsets());
            map.are_shown_by_new(model, *first_new, &null_in_body)
        });
        let Some(first_new) = grown else {
            before.into_iter().for_each(|before| self.map = before);
            return None;
        };
        self.frames_before_cells = self.frames;
        let cells = map.cells().len();
        self.belief.information.cells.resize(cells);
        self.belief.offsets.resize(cells, 0.0);
        self.noise.resize(cells);
        self.shape.resize(cells);
        self.early_shape.reserve(cells);
        let mut forgotten = NullDirections::default();
        if !null.is_empty() {
            let shown = map.keep_unshown_by_first(model, first_new, &null_in_body);
            self.body_frame.forget(&shown);
            forgotten = shown.moved(model, &self.belief.pose);
            self.belief.hold_pose(&forgotten);
            // Those that stay are forgotten too: they have another centre, about which something may be known.
            let variance = self.noise.effective_variance();
            self.belief.forget(&null, variance);
            self.belief.forget(&map.null_directions(model, &self.belief.pose), variance);
            let is_shown = turn_was_unseen && !map.turn_is_unseen(model);
            map.record_turn(if is_shown { TurnEvent::ShownByGrowth } else { TurnEvent::NotShownByGrowth });
        }
        Some(Grown { first_new, forgotten })
    }

    /// Takes the loaded points on cells from `first_new` on, which have just been added, as their first measurement.
    pub(super) fn measure_new_cells(&mut self, frame: &mut Frame, first_new: usize) {
        Arc::make_mut(&mut self.map).prepare_association();
        let null = self.map.null_directions(self.belief.model, &self.belief.pose);
        frame.clear_shifts(self.map.cells().len());
        self.view().measure(frame, &self.belief.pose, &null, Pass::First);
        frame.measurements.retain(|m| m.cell != NO_CELL && m.cell >= first_new);
        let mut work = self.belief.information.clone();
        accumulate(frame, &mut work, &StateVector::zeros());
        for (number, right) in frame.right.iter().enumerate().skip(first_new) {
            let own = work.cells.own()[number];
            if own > 0.0 {
                self.belief.offsets[number] += right / own;
            }
        }
        self.belief.information = work;
        self.belief.marginal = self.belief.information.marginal();
        self.sensitivity.begin_cells(&self.belief, &self.map);
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::{OpenArc, OpenOutline};
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;

    use super::*;
    use crate::{
        dense_filter::{AGREES, DenseFilter},
        drawn_curves::{all_around, lobed, outline, polar},
        measurement::Measurement,
        tuning::map::MOST_TIMES_SEEN,
    };

    /// Three quarters of an outline that shows every model of motion, and all of it, in the same body frame.
    fn part_and_whole() -> [Outline; 2] {
        // The last lobes keep residuals from being zero.
        let lobes = [(3.0, [0.24, 0.0]), (2.0, [0.0, 0.16]), (5.0, [0.1, 0.0]), (31.0, [0.0, 0.004])];
        let all = all_around(320, |t| polar(0.5 * lobed(t, &lobes), t));
        let arc = OpenArc::new(all[..240].to_vec()).expect("an arc");
        let part = Outline::Open(OpenOutline::new(vec![arc]).expect("an outline"));
        [part, Outline::closed(all).expect("an outline")]
    }

    #[test]
    fn new_cells_are_begun_as_the_dense_filter_begins_them_with_pose_and_motion_held() {
        let [part, whole] = part_and_whole();
        for model in MotionModel::ALL {
            let mut frame = Frame::default();
            let mut track = Track::begin(model, &part, 0.0, &mut frame).expect("a track");
            // Well known, so that the reference loses no digits.
            let k = track.belief.parameter_count();
            (0..k).for_each(|i| track.belief.information.dense[k + i][k + i] = 100.0);
            // Ends that no point lies on have no information; the reference would divide by it.
            track.belief.information.cells.own_mut().iter_mut().for_each(|own| *own = own.max(1.0));
            track.belief.marginal = track.belief.information.marginal();
            let mut dense = DenseFilter::of(&track.belief.information);
            // Otherwise something would be forgotten.
            assert!(track.map.null_directions(model, &track.belief.pose).is_empty(), "{model:?}");
            let first_new = track.map.cells().len();
            frame.load(&whole, track.reference);
            track.grow_along(frame.contours(&track.belief.pose), &mut frame);
            let count = track.map.cells().len();
            assert!(count > first_new + 10, "{model:?}: {first_new} and {count} cells");
            let unseen = Measurement { cell: 0, residual: 0.0, by_offset: 1.0, jacobian: [0.0; 8], weight: 1.0 };
            for cell in first_new..count {
                let mut of_cell = frame.measurements.iter().filter(|m| m.cell == cell && m.weight > 0.0);
                let first = of_cell.next();
                dense.begin_cell(first.unwrap_or(&unseen));
                of_cell.for_each(|m| dense.measure(m));
                if first.is_none() {
                    track.belief.information.cells.own_mut()[cell] = 1.0;
                }
            }
            let difference = dense.difference(&track.belief.information, |_, _| true);
            assert!(difference < AGREES, "{model:?}: {difference}");
            let difference = dense.difference_of_marginal(&track.belief.marginal);
            assert!(difference < AGREES, "{model:?}: marginal {difference}");
            // What is left out is next to nothing.
            let step = |i: usize| dense.mean[i].abs() / (dense.covariance[(i, i)].sqrt() * track.noise.sigma);
            assert!((0..2 * k).map(step).all(|step| step < 1e-3), "{model:?}");
            let expected = dense.offsets_where_state_is_zero(first_new);
            let size = expected.iter().fold(0.0, |size, offset| f64::max(size, offset.abs()));
            for (found, expected) in track.belief.offsets[first_new..].iter().zip(expected) {
                assert!((found - expected).abs() < AGREES * size, "{model:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_map_that_wrong_poses_add_to_for_ever_stops_growing() {
        let egg =
            |shift: f64| outline(300, |t| Point2::new(shift + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin()));
        let mut frame = Frame::default();
        let mut track = Track::begin(MotionModel::Rigid, &egg(0.0), 0.0, &mut frame).expect("a track");
        let count = |track: &Track| track.map.cells().len();
        let first = count(&track);
        let mut counts = Vec::new();
        for shift in 1..30 {
            frame.load(&egg(3.0 * f64::from(shift)), track.reference);
            let contours = frame.contours(&track.belief.pose);
            track.grow_along(contours, &mut frame);
            counts.push(count(&track));
        }
        assert!(counts[0] > first && counts[28] <= (MOST_TIMES_SEEN + 1) * first + 10, "{first}: {counts:?}");
        assert_eq!(counts[27], counts[28]);
    }
}
