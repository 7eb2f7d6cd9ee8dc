//! How far a frame has moved the outline as a whole.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use nalgebra::{Const, DimMin, Point2, SMatrix, SVector, Vector2};

use super::Track;
use crate::{measurement::Frame, tuning::map::UNSEEN_SHIFT, vectors::vectorised};

impl Track {
    /// The motion of the body frame that moves the outline as the frame just taken has moved the offsets of its cells, by least squares; what
    /// is known of a cell is its weight, so that what frames move here and there adds up to what it is all together.
    pub(super) fn common_shift(&self, frame: &Frame) -> SVector<f64, MAX_PARAMETERS> {
        let information = self.belief.information.cells.own().iter().copied();
        self.motion_of_outline(&information.zip(frame.shifts.iter().copied()))
    }

    /// The motion of the body frame that moves the outline as the offsets of its cells have changed, by least squares; of each cell the weight
    /// and the change.
    #[inline(always)]
    pub(super) fn motion_of_outline(
        &self,
        moved: &(impl Iterator<Item = (f64, f64)> + Clone),
    ) -> SVector<f64, MAX_PARAMETERS> {
        match self.belief.model {
            MotionModel::Rigid => {
                self.motion_of_outline_sized::<3>(moved, |p, n| MotionModel::Rigid.normal_velocities(p, n))
            }
            MotionModel::Similarity => {
                self.motion_of_outline_sized::<4>(moved, |p, n| MotionModel::Similarity.normal_velocities(p, n))
            }
            MotionModel::Affine => {
                self.motion_of_outline_sized::<6>(moved, |p, n| MotionModel::Affine.normal_velocities(p, n))
            }
            MotionModel::Projective => {
                self.motion_of_outline_sized::<8>(moved, |p, n| MotionModel::Projective.normal_velocities(p, n))
            }
        }
    }

    #[inline(always)]
    fn motion_of_outline_sized<const K: usize>(
        &self,
        moved: &(impl Iterator<Item = (f64, f64)> + Clone),
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) -> SVector<f64, MAX_PARAMETERS>
    where
        Const<K>: DimMin<Const<K>, Output = Const<K>>,
    {
        let cells = self.map.cells();
        let (squares, right) = vectorised(
            #[inline(always)]
            || {
                let (mut squares, mut right) = ([[0.0; K]; K], [0.0; K]);
                for (cell, (weight, shift)) in cells.iter().zip(moved.clone()) {
                    let h = velocities(&cell.centre, &cell.normal);
                    for i in 0..K {
                        let weighted = weight * h[i];
                        right[i] += weighted * shift;
                        for j in i..K {
                            squares[i][j] += weighted * h[j];
                        }
                    }
                }
                (squares, right)
            },
        );
        let largest = (0..K).map(|i| squares[i][i]).fold(f64::MIN_POSITIVE, f64::max);
        let seen = |i: usize| UNSEEN_SHIFT * largest + squares[i][i];
        let squares = SMatrix::<f64, K, K>::from_fn(|i, j| if i == j { seen(i) } else { squares[i.min(j)][i.max(j)] });
        let mut shift = SVector::<f64, MAX_PARAMETERS>::zeros();
        if let Some(solution) = squares.lu().solve(&SVector::<f64, K>::from(right)) {
            shift.fixed_rows_mut::<K>(0).copy_from(&solution);
        }
        shift
    }
}
