//! What the part of an outline in view does not tell of its pose.
use nalgebra::Matrix3;

use super::{Frame, Jacobians, View};
use crate::map::NullDirection;

impl View<'_> {
    /// Projects out of the Jacobians of a frame that has been measured what errors of the normals alone tell: directions that the [first
    /// cells](crate::map::OutlineMap::unshown_by_first) do not show, and, where some of the outline may be hidden, those that the [part in
    /// view](crate::map::OutlineMap::untold_directions) does not.
    pub(crate) fn leave_out_untold(&self, frame: &mut Frame, pose: &Matrix3<f64>, null: &[NullDirection]) {
        for (count, direction) in self.map.unshown_by_first(self.belief.model, pose) {
            self.make_jacobians_of_points(frame, null);
            let of_first = frame.measurements.iter_mut().filter(|m| m.cell < count);
            of_first.for_each(|m| direction.project_out(&mut m.jacobian));
        }
        // A closed contour shows all of it.
        if frame.pieces.iter().all(|piece| piece.closed) {
            return;
        }
        let cells = self.map.cells().len();
        let Frame { columns, values, .. } = &mut *frame;
        values.clear();
        values.resize(cells, 0.0);
        for point in columns.points().filter(|point| point.cell < cells) {
            values[point.cell] += point.weight;
        }
        for direction in self.map.untold_directions(self.belief.model, pose, values) {
            self.make_jacobians_of_points(frame, null);
            frame.measurements.iter_mut().for_each(|m| direction.project_out(&mut m.jacobian));
        }
    }

    fn make_jacobians_of_points(&self, frame: &mut Frame, null: &[NullDirection]) {
        if frame.columns.jacobians == Jacobians::OfCells {
            self.write_measurements(frame, null);
        }
    }
}
