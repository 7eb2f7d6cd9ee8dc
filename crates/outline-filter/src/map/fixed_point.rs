//! The point of a body that the motions which its outline does not show leave where it is, as the centre of a disc that spins.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, ProjectiveMotion};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, Vector2};

use super::OutlineMap;
use crate::{
    belief::KnownOffsets,
    tuning::null_space::{MOVES_MIDDLE, TAKES_PART},
};

/// Squared velocity of a point, in the mean of those of the cells, up to which it stays.
const STAYS: f64 = TAKES_PART * TAKES_PART;

type SpanMatrix = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;

impl OutlineMap {
    /// Whether some motion that the outline does not show moves its centroid, against how it moves the outline: a straight bar moves along itself,
    /// a bent one about a centre far away.
    pub(crate) fn hides_motion_of_centroid(&self, model: MotionModel) -> bool {
        let space = &self.null_space;
        self.squared_velocity_at(&space.centroid, model, &space.in_body) > STAYS
    }

    /// Puts the centroid at that of the area or of the cells, or, where some motion that is not shown moves this, at the point nearest to it which
    /// all such motions leave where it is: the centre of a disc of which half is seen, or the vertex of a corner that may grow. Where there
    /// is no such point, or none nearby, it stays. The outline lies at these offsets from its cells.
    pub(crate) fn place_centroid(&mut self, model: MotionModel, offsets: KnownOffsets<'_>) {
        let of_cells = Point2::new(self.null_space.frame.m13, self.null_space.frame.m23);
        // The area of an outline that crosses itself may have its centroid anywhere.
        let is_within = |centroid: &Point2<f64>| (centroid - of_cells).norm() <= self.null_space.frame.m11;
        let centroid = self.area_centroid(offsets).filter(is_within).unwrap_or(of_cells);
        let hidden = &self.null_space.in_body;
        let at = |point: &Point2<f64>| self.squared_velocity_at(point, model, hidden);
        let of_centroid = at(&centroid);
        let fixed = if of_centroid > STAYS && of_centroid <= MOVES_MIDDLE {
            let generators = hidden.iter().map(|direction| model.generator(&direction[..model.parameter_count()]));
            fixed_point(generators, &centroid).filter(|fixed| at(fixed) <= STAYS)
        } else {
            None
        };
        self.null_space.centroid = fixed.unwrap_or(centroid);
    }

    /// The largest squared velocity of a point of the body in motions that span a space, in the mean of those of the cells; infinite where some
    /// motion leaves all cells where they are.
    fn squared_velocity_at(&self, point: &Point2<f64>, model: MotionModel, motions: &[ParameterVector]) -> f64 {
        if motions.is_empty() {
            return 0.0;
        }
        let velocities_at = |point: &Point2<f64>| {
            let mut velocities = SMatrix::<f64, 2, MAX_PARAMETERS>::zeros();
            for (mut column, motion) in velocities.column_iter_mut().zip(motions) {
                let motion = ProjectiveMotion::of_generator(&model.generator(&motion[..model.parameter_count()]));
                column.copy_from(&motion.velocity(point));
            }
            velocities
        };
        let mut of_cells = SpanMatrix::zeros();
        for cell in &self.cells {
            let velocities = velocities_at(&cell.centre);
            of_cells += velocities.transpose() * velocities / self.cells.len() as f64;
        }
        // What is not spanned has no part.
        (motions.len()..MAX_PARAMETERS).for_each(|j| of_cells[(j, j)] = 1.0);
        let Some(cholesky) = of_cells.cholesky() else { return f64::INFINITY };
        let at_point = velocities_at(point);
        let squared: Matrix2<f64> = at_point * cholesky.solve(&at_point.transpose());
        squared.symmetric_eigenvalues().max()
    }
}

/// The point nearest to another where some affine motions are slowest, by least squares. Along axes that they hardly move anything by it is where the
/// other is.
fn fixed_point(generators: impl Iterator<Item = Matrix3<f64>>, near: &Point2<f64>) -> Option<Point2<f64>> {
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for generator in generators {
        let linear = generator.fixed_view::<2, 2>(0, 0);
        let velocity = ProjectiveMotion::of_generator(&generator).velocity(near);
        normal += linear.transpose() * linear;
        right -= linear.transpose() * velocity;
    }
    let axes = normal.symmetric_eigen();
    let largest = axes.eigenvalues.max();
    if largest <= 0.0 {
        return None;
    }
    // Along what all of them move alike the point stays.
    let along = |j: usize| {
        let (value, axis) = (axes.eigenvalues[j], axes.eigenvectors.column(j));
        if value > TAKES_PART * TAKES_PART * largest { axis * (axis.dot(&right) / value) } else { Vector2::zeros() }
    };
    Some(near + along(0) + along(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn generator(a: [f64; 4], b: [f64; 2]) -> Matrix3<f64> {
        MotionModel::Affine.generator(&[a[0], a[1], a[2], a[3], b[0], b[1]])
    }

    #[test]
    fn motions_are_slowest_together_at_the_point_that_all_leave_where_it_is_and_nearest_to_where_it_is_sought() {
        let near = Point2::new(4.0, 1.0);
        let found = |motions: &[Matrix3<f64>]| fixed_point(motions.iter().copied(), &near);
        let about = |a: [f64; 4], p: [f64; 2]| generator(a, [-a[0] * p[0] - a[1] * p[1], -a[2] * p[0] - a[3] * p[1]]);
        let (turn, growth) = ([0.0, 0.5, -0.5, 0.0], [0.3, 0.0, 0.0, 0.3]);
        let is =
            |found: Option<Point2<f64>>, x: f64, y: f64| (found.expect("a point") - Point2::new(x, y)).norm() < 1e-12;
        assert!(is(found(&[about(turn, [2.0, -3.0])]), 2.0, -3.0));
        assert!(is(found(&[about(turn, [2.0, -3.0]), about(growth, [2.0, -3.0])]), 2.0, -3.0));
        // A stretch along x leaves a line as it is; a shift leaves nothing.
        assert!(is(found(&[about([0.2, 0.0, 0.0, 0.0], [7.0, 0.0])]), 7.0, 1.0));
        assert_eq!(found(&[generator([0.0; 4], [1.0, 2.0])]), None);
    }
}
