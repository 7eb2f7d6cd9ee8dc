//! How much of what a frame tells of its pose comes from points that agree with the outline.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Matrix3, SVector};

use super::gate::Agreeing;
use crate::{
    measurement::{Frame, View},
    prediction::PoseMatrix,
    tuning::update::UNTOLD_DIRECTION,
};

impl View<'_> {
    /// Of all directions that the pose may err in, the one that points which agree with the outline say least of: how much that is of what a frame
    /// with as many points is to say, in [0, 1]. Most of the points of a bar say nothing of where it lies along itself: where those of its ends
    /// disagree, or are taken for points of its sides, nearly all agree, and the share is next to nothing. What a frame with gaps does not show is
    /// not asked of it, and directions that the outline does not show are left out. `limit` is what agrees in the frame.
    pub(crate) fn weakest_agreement(&self, frame: &mut Frame, limit: &Agreeing) -> f64 {
        let Frame { columns, weighted, deviations, pieces, .. } = frame;
        let (cells, model) = (self.map.cells(), self.belief.model);
        // Of each cell, what its points count for, and those of them that agree.
        let of_cells = weighted;
        of_cells.clear();
        of_cells.resize(cells.len(), (0.0, 0.0));
        for (i, m) in columns.points().enumerate() {
            let Some((all, agreeing)) = of_cells.get_mut(m.cell) else { continue };
            let ratio = deviations.ratios().map_or(1.0, |ratios| ratios[i]);
            let share = (ratio * ratio).recip();
            *all += share;
            *agreeing += if m.residual.abs() < limit.of(ratio) { share } else { 0.0 };
        }
        // What frames have told of the cells says how many points each has; where a whole contour has none of them, they lie elsewhere.
        let is_whole = pieces.iter().all(|piece| piece.closed);
        let own = self.belief.information.cells.own();
        let points: f64 = of_cells.iter().map(|(all, _)| all).sum();
        let all_own: f64 = own.iter().sum();
        let usual = if is_whole && all_own > 0.0 { points / all_own } else { 0.0 };
        // Rigid and similar poses leave the shares as they are, and others change them little: those of the body frame need no image.
        let null = self.map.null_directions(model, &Matrix3::identity());
        let (mut of_all, mut of_agreeing) = (PoseMatrix::zeros(), PoseMatrix::zeros());
        for ((cell, own), (all, agreeing)) in cells.iter().zip(own).zip(of_cells.iter()) {
            let expected = all.max(usual * own);
            if expected <= 0.0 {
                continue;
            }
            let mut along = model.normal_velocities(&cell.centre, &cell.normal);
            null.iter().for_each(|direction| direction.project_out(&mut along));
            let along = SVector::from(along);
            of_all.ger(expected, &along, &along, 1.0);
            of_agreeing.ger(*agreeing, &along, &along, 1.0);
        }
        smallest_share(of_agreeing, of_all, model.parameter_count())
    }
}

/// The smallest of `x' A x / x' B x` over the directions x of k parameters, of A that is nowhere more than B.
fn smallest_share(mut a: PoseMatrix, mut b: PoseMatrix, k: usize) -> f64 {
    for i in 0..MAX_PARAMETERS {
        // What nothing tells is not told by what disagrees either.
        let untold = if i < k { UNTOLD_DIRECTION * b[(i, i)] } else { 0.0 };
        let untold = if untold > 0.0 { untold } else { 1.0 };
        (a[(i, i)], b[(i, i)]) = (a[(i, i)] + untold, b[(i, i)] + untold);
    }
    let Some(root) = b.cholesky() else { return 1.0 };
    let lower = root.l();
    let Some(half) = lower.solve_lower_triangular(&a) else { return 1.0 };
    let Some(shares) = lower.solve_lower_triangular(&half.transpose()) else { return 1.0 };
    (0.5 * (shares + shares.transpose())).symmetric_eigenvalues().min().clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;

    use crate::{
        measurement::{Frame, Pass, spread},
        track::Track,
    };

    /// A bar of 6 by 1/2 that has been moved along itself.
    fn bar(along: f64) -> Outline {
        let side = |i: u32| f64::from(i) / 20.0;
        let points = (0..120)
            .map(|i| (side(i), 0.0))
            .chain((0..10).map(|i| (6.0, side(i))))
            .chain((0..120).map(|i| (6.0 - side(i), 0.5)))
            .chain((0..10).map(|i| (0.0, 0.5 - side(i))));
        Outline::closed(points.map(|(x, y)| Point2::new(x + along, y)).collect()).expect("an outline")
    }

    fn weakest(along: f64) -> f64 {
        let mut frame = Frame::default();
        let mut track = Track::begin(MotionModel::Rigid, &bar(0.0), 0.0, &mut frame).expect("a track");
        track.set_noise(0.002);
        frame.load(&bar(along), track.reference());
        let pose = *track.body_pose();
        track.view().measure_by_columns(&mut frame, &pose, &[], Pass::First);
        let spread = spread(&mut frame, track.sigma());
        let limit = track.view().agreeing(&frame, spread);
        track.view().weakest_agreement(&mut frame, &limit)
    }

    #[test]
    fn where_a_bar_lies_along_itself_its_ends_alone_tell() {
        assert!(weakest(0.0) > 0.9, "{}", weakest(0.0));
        for along in [-0.4, -0.2, 0.2, 0.4] {
            assert!(weakest(along) < 0.3, "{along}: {}", weakest(along));
        }
    }
}
