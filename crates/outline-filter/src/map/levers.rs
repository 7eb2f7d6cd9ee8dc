//! Lever arms: how fast the outline moves along its normals at every cell, by every direction of the pose.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use nalgebra::{Point2, SMatrix, Vector2};

#[cfg(feature = "serde")]
use super::OutlineMap;
use super::{
    NullDirection,
    centring::{Centring, NormalByNeighbours},
    first_cells::OfFirstCells,
};

/// The lever arm of a cell: the normal velocities that a unit of every parameter gives its middle, in centred coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lever {
    pub(super) across: ParameterVector,
    /// With the tangent in place of the normal.
    along: ParameterVector,
    /// Of the direction of the normal, rad squared.
    variance: f64,
    /// Of the outline that the cell stands for, in that of a cell.
    pub(super) length: f64,
}

/// The lever arms of all cells, and the coordinates that they are in.
#[derive(Debug, Clone)]
pub(super) struct Levers {
    pub(super) of_cells: Vec<Lever>,
    pub(super) centring: Centring,
}

/// Sums over cells, each with what it counts for: of the squares of their levers, and of what errors of their normals would make of these.
pub(super) struct SumOfSquares {
    pub(super) levers: SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    pub(super) of_noise: SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
}

impl Levers {
    /// Of cells at these places, with their normals.
    pub(super) fn of(
        model: MotionModel,
        centring: Centring,
        cells: impl Iterator<Item = (Point2<f64>, NormalByNeighbours)>,
        of_first_cells: &[OfFirstCells],
    ) -> Self {
        let lever = |(place, normal): (Point2<f64>, NormalByNeighbours)| {
            let length = centring.relative_length(&normal.direction);
            let (normal, variance) = centring.normal(&normal);
            let p = centring.centred(&place);
            let velocities = |direction| model.normal_velocities(&p, direction);
            let along = Vector2::new(-normal.y, normal.x);
            Lever { across: velocities(&normal), along: velocities(&along), variance, length }
        };
        let mut levers = Self { of_cells: cells.map(lever).collect(), centring };
        of_first_cells.iter().for_each(|of_first| levers.leave_out(model, of_first));
        levers
    }

    /// A direction of the body frame in the coordinates of the levers.
    pub(super) fn stretched(&self, model: MotionModel, in_body: &NullDirection) -> Option<NullDirection> {
        let to_body = self.centring.to_body_from_stretched();
        Some(in_body.moved(model, (&to_body.try_inverse()?, &to_body)))
    }

    /// Leaves out what the first cells do not show.
    pub(super) fn leave_out(&mut self, model: MotionModel, of_first: &OfFirstCells) {
        let Some(null) = self.stretched(model, &of_first.null) else { return };
        for lever in self.of_cells.iter_mut().take(of_first.count) {
            null.project_out(&mut lever.across);
            // What counts for nothing has no noise either.
            null.project_out(&mut lever.along);
        }
    }
}

impl SumOfSquares {
    /// Over levers of k parameters.
    pub(super) fn of<'a>(levers: impl Iterator<Item = (&'a Lever, f64)>, k: usize) -> Self {
        match k {
            3 => Self::sized::<3>(levers),
            4 => Self::sized::<4>(levers),
            6 => Self::sized::<6>(levers),
            _ => Self::sized::<MAX_PARAMETERS>(levers),
        }
    }

    /// Frames of which a part is hidden ask for it in every linearisation.
    fn sized<'a, const K: usize>(levers: impl Iterator<Item = (&'a Lever, f64)>) -> Self {
        let (mut of_levers, mut of_noise) = ([[0.0; K]; K], [[0.0; K]; K]);
        for (lever, times) in levers {
            let of_noise_here = times * lever.variance;
            for i in 0..K {
                let (across, along) = (times * lever.across[i], of_noise_here * lever.along[i]);
                for j in 0..K {
                    of_levers[i][j] += across * lever.across[j];
                    of_noise[i][j] += along * lever.along[j];
                }
            }
        }
        let whole = |sum: [[f64; K]; K]| SMatrix::from_fn(|i, j| if i < K && j < K { sum[i][j] } else { 0.0 });
        Self { levers: whole(of_levers), of_noise: whole(of_noise) }
    }
}

#[cfg(feature = "serde")]
impl OutlineMap {
    /// Works the lever arms out anew, as they were when the null directions were found last.
    pub(super) fn find_levers(&mut self, model: MotionModel) {
        let sigma = self.null_space.sigma;
        let centring = Centring::of(&self.cells, model, sigma, Self::area_covariance(&self.closed_contours()));
        self.levers = Some(self.levers_about(model, centring, sigma));
    }
}
