//! How far a frame has moved the outline as a whole.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use nalgebra::{Const, DimMin, Point2, SMatrix, SVector, Vector2};

use super::Track;
use crate::{belief::sum_of_outer_products, measurement::Frame, tuning::map::UNSEEN_SHIFT, vectors::vectorised};

impl Track {
    /// The motion of the body frame that moves the outline as the frame just taken has moved the offsets of its cells, by least squares; what
    /// is known of a cell is its weight, so that what frames move here and there adds up to what it is all together.
    pub(super) fn common_shift(&self, frame: &Frame) -> SVector<f64, MAX_PARAMETERS> {
        let (information, shifts) = (self.belief.information.cells.own(), frame.shifts.as_slice());
        self.motion_of_outline(
            #[inline(always)]
            |number| (information[number], shifts[number]),
        )
    }

    /// The motion of the body frame that moves the outline as the offsets of its cells have changed, by least squares; of each cell, by its
    /// number, the weight and the change.
    #[inline(always)]
    pub(super) fn motion_of_outline(&self, moved: impl Fn(usize) -> (f64, f64)) -> SVector<f64, MAX_PARAMETERS> {
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
        moved: impl Fn(usize) -> (f64, f64),
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) -> SVector<f64, MAX_PARAMETERS>
    where
        Const<K>: DimMin<Const<K>, Output = Const<K>>,
    {
        let sums = match K {
            3 => self.sums_of_cells::<K, 4>(moved, velocities),
            4 | 6 => self.sums_of_cells::<K, 8>(moved, velocities),
            _ => self.sums_of_cells::<K, 12>(moved, velocities),
        };
        let largest = (0..K).map(|i| sums.squares[i][i]).fold(f64::MIN_POSITIVE, f64::max);
        let seen = |i: usize| UNSEEN_SHIFT * largest + sums.squares[i][i];
        let squares = SMatrix::<f64, K, K>::from_fn(|i, j| if i == j { seen(i) } else { sums.squares[i][j] });
        let mut shift = SVector::<f64, MAX_PARAMETERS>::zeros();
        if let Some(solution) = squares.lu().solve(&SVector::<f64, K>::from(sums.right)) {
            shift.fixed_rows_mut::<K>(0).copy_from(&solution);
        }
        shift
    }

    /// P is room for all velocities of a cell with its change, in whole vectors.
    #[inline(always)]
    fn sums_of_cells<const K: usize, const P: usize>(
        &self,
        moved: impl Fn(usize) -> (f64, f64),
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) -> Sums<K> {
        let cells = self.map.cells();
        let sums = vectorised(
            #[inline(always)]
            || {
                sum_of_outer_products::<_, P>(
                    cells.len(),
                    #[inline(always)]
                    |number| {
                        let (cell, (weight, change)) = (&cells[number], moved(number));
                        let along = velocities(&cell.centre, &cell.normal);
                        let mut row = [0.0; P];
                        row[..K].copy_from_slice(&along[..K]);
                        row[K] = change;
                        (row, weight)
                    },
                )
            },
        );
        Sums {
            squares: std::array::from_fn(|i| std::array::from_fn(|j| sums[i][j])),
            right: std::array::from_fn(|i| sums[i][K]),
        }
    }
}

/// Sums over cells, by their weights, of the products of their normal velocities with each other and with what they have moved by.
struct Sums<const K: usize> {
    squares: [[f64; K]; K],
    right: [f64; K],
}
