//! Directions of the pose that the cells which a map began with do not show, and others do that it has grown by.
//!
//! Errors of the normals make straight cells tell a little of where they lie along themselves. As long as no cell shows a direction it is projected out
//! of all of them. Once new ones show it, nobody knows how far the old ones had gone along it when they were cut; what they tell of that is still the
//! error of their normals, and would hold the object where it was never seen to be.
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::Matrix3;

use super::{NullDirection, NullDirections, OutlineMap};

/// A direction that the first cells, so many, do not show, in the body frame.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct OfFirstCells {
    pub(super) count: usize,
    pub(super) null: NullDirection,
}

impl OutlineMap {
    /// Keeps what the first cells, so many, do not show of some directions in the body frame that are no null directions any more. Returns these.
    pub(crate) fn keep_unshown_by_first(
        &mut self,
        model: MotionModel,
        count: usize,
        directions: &[NullDirection],
    ) -> NullDirections {
        let mut shown = NullDirections::default();
        let Some(to_centred) = self.to_centred(model) else { return shown };
        let hidden = self.hidden_directions(&to_centred);
        let room = MAX_PARAMETERS.saturating_sub(self.null_space.of_first_cells.len());
        for null in
            directions.iter().filter(|null| hidden.beside(&to_centred.centred(&null.direction)).is_some()).take(room)
        {
            let of_first = OfFirstCells { count, null: *null };
            self.null_space.of_first_cells.push(of_first);
            self.levers.iter_mut().for_each(|levers| levers.leave_out(model, &of_first));
            shown.push(*null);
        }
        shown
    }

    /// The directions that the first cells do not show, with how many these are, in the image, for a pose.
    pub(crate) fn unshown_by_first(
        &self,
        model: MotionModel,
        pose: &Matrix3<f64>,
    ) -> impl Iterator<Item = (usize, NullDirection)> {
        let of_first = &self.null_space.of_first_cells;
        let inverse = if of_first.is_empty() { None } else { pose.try_inverse() };
        inverse.into_iter().flat_map(move |inverse| {
            of_first.iter().map(move |OfFirstCells { count, null }| (*count, null.moved(model, (pose, &inverse))))
        })
    }
}
