//! Null directions of an outline in one pose, in a place of their own size: they are asked for in every frame, which takes no memory from the heap.
use std::{array, iter::Take, ops::Deref};

use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use nalgebra::{Matrix3, SMatrix, SVector};

/// A null direction in the image: Jacobians of measurements lose `(h . direction) dual`.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NullDirection {
    pub(crate) direction: ParameterVector,
    pub(crate) dual: ParameterVector,
}

impl NullDirection {
    /// Projects the direction out of the Jacobian of a measurement.
    pub(crate) fn project_out(&self, jacobian: &mut ParameterVector) {
        let along: f64 = jacobian.iter().zip(&self.direction).map(|(a, b)| a * b).sum();
        jacobian.iter_mut().zip(&self.dual).for_each(|(r, d)| *r -= along * d);
    }

    /// The covariance of a motion along the direction, by as much as that is long.
    pub(crate) fn square(&self) -> SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS> {
        let direction = SVector::from(self.direction);
        direction * direction.transpose()
    }

    /// The direction in other coordinates, which a map takes those that it is in to.
    pub(crate) fn moved(&self, model: MotionModel, (map, inverse): (&Matrix3<f64>, &Matrix3<f64>)) -> Self {
        let (forth, back, k) = (model.adjoint(map, inverse), model.adjoint(inverse, map), model.parameter_count());
        let mut moved = Self::default();
        for i in 0..k {
            moved.direction[i] = (0..k).map(|j| forth[i][j] * self.direction[j]).sum();
            moved.dual[i] = (0..k).map(|j| self.dual[j] * back[j][i]).sum();
        }
        moved
    }

    /// Subtracts the part of a motion that is in this direction.
    fn subtract_from(&self, motion: &mut ParameterVector) {
        let part: f64 = motion.iter().zip(&self.dual).map(|(a, b)| a * b).sum();
        motion.iter_mut().zip(&self.direction).for_each(|(m, d)| *m -= part * d);
    }
}

/// The null directions of an outline in a pose: no more than a pose has parameters. Read as a slice.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NullDirections {
    entries: [NullDirection; MAX_PARAMETERS],
    count: usize,
}

impl NullDirections {
    /// Those of the body frame in the image, for a pose; none for one that has no inverse.
    pub(crate) fn moved(&self, model: MotionModel, pose: &Matrix3<f64>) -> Self {
        let mut moved = Self::default();
        if let Some(inverse) = pose.try_inverse() {
            self.iter().for_each(|direction| moved.push(direction.moved(model, (pose, &inverse))));
        }
        moved
    }

    /// Subtracts the part of a motion that is in these directions.
    pub(crate) fn subtract_from(&self, motion: &mut ParameterVector) {
        self.iter().for_each(|direction| direction.subtract_from(motion));
    }

    /// Adds a direction. Of independent directions there are no more than there is room for: another is not taken.
    pub(super) fn push(&mut self, direction: NullDirection) {
        if let Some(entry) = self.entries.get_mut(self.count) {
            *entry = direction;
            self.count += 1;
        }
    }
}

impl Deref for NullDirections {
    type Target = [NullDirection];

    fn deref(&self) -> &[NullDirection] {
        &self.entries[..self.count]
    }
}

impl IntoIterator for NullDirections {
    type Item = NullDirection;
    type IntoIter = Take<array::IntoIter<NullDirection, MAX_PARAMETERS>>;

    fn into_iter(self) -> Self::IntoIter {
        self.entries.into_iter().take(self.count)
    }
}
