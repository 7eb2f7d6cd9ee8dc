use nalgebra::{Isometry2, Point2};

use super::course::Motion;
use super::recipe::Recipe;

/// Where a body is that moves rigidly in the picture, in the units of its recipe.
#[derive(Debug, Clone, Copy)]
pub(super) struct RigidPoses {
    motion: Motion,
    time_unit: f64,
    length_unit: f64,
    /// How many turns within a full one leave its contour as it is.
    pub(super) folds: usize,
}

impl RigidPoses {
    pub(super) fn new(recipe: &Recipe, motion: Motion) -> Self {
        let Recipe { time_unit, length_unit, body, .. } = *recipe;
        Self { motion, time_unit, length_unit, folds: body.folds() }
    }

    /// The map of the picture from one time to another.
    pub(super) fn moved(&self, from: f64, to: f64) -> Isometry2<f64> {
        let [from, to] = [from, to].map(|time| self.pose(time));
        to * from.inverse()
    }

    /// Where the middle of the body is.
    pub(super) fn middle(&self, time: f64) -> Point2<f64> {
        self.motion.middle(time / self.time_unit) * self.length_unit
    }

    fn pose(&self, time: f64) -> Isometry2<f64> {
        let map = self.motion.trajectory.pose(time / self.time_unit);
        let matrix = map.matrix();
        let offset = self.length_unit * matrix.fixed_view::<2, 1>(0, 2);
        Isometry2::new(offset, matrix[(1, 0)].atan2(matrix[(0, 0)]))
    }
}
