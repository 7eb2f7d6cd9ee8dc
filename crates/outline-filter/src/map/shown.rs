//! Whether a pose shows an outline, or is all but singular.
use freeform_riccati::{is_affine, map_point};
use nalgebra::{Matrix2, Matrix3, Point2};

use super::OutlineMap;
use crate::tuning::update::{FARTHEST, FLATTEST, LEAST_DEPTH};

impl OutlineMap {
    /// Whether a pose shows the outline: it is near enough to be told from a point, is seen from its front and nowhere from its edge, and all of it
    /// lies on one side of the line that goes to infinity, none of it close by. No other pose can be worked with: points of the outline lie beyond
    /// any number, and errors of the pose move them by as much.
    ///
    /// Poses begin with the identity and move on continuously; one that is mirrored has been reached by a step over a pose that shows nothing.
    pub(crate) fn is_shown_in(&self, pose: &Matrix3<f64>) -> bool {
        if !pose.iter().all(|entry| entry.is_finite()) {
            return false;
        }
        if is_affine(pose) {
            if pose[(0, 2)].abs().max(pose[(1, 2)].abs()) > FARTHEST {
                return false;
            }
            let linear = pose.fixed_view::<2, 2>(0, 0).into_owned();
            return linear.determinant() > 0.0 && is_regular(&linear);
        }
        let depth = |p: &Point2<f64>| pose[(2, 0)] * p.x + pose[(2, 1)] * p.y + pose[(2, 2)];
        let depths = self.cells.iter().map(|cell| depth(&cell.centre));
        let (least, most) = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), w| (a.min(w), b.max(w)));
        // A matrix and its negative are the same map.
        let is_apart = least > LEAST_DEPTH * most.abs() || -most > LEAST_DEPTH * least.abs();
        // The derivative of the map has the determinant of the matrix over the third power of the depth.
        let is_from_front = pose.determinant() * most > 0.0;
        is_apart && is_from_front && self.cells.iter().all(|cell| is_regular(&scaled_derivative(pose, &cell.centre)))
    }
}

/// Derivative of a map of the plane at a point, times the depth of that.
fn scaled_derivative(map: &Matrix3<f64>, p: &Point2<f64>) -> Matrix2<f64> {
    let image = map_point(map, p);
    Matrix2::from_fn(|row, column| map[(row, column)] - image[row] * map[(2, column)])
}

/// Whether a linear map takes no direction to [`FLATTEST`] of what it takes others to. With the singular values `a <= b` it is `a b >= FLATTEST
/// (a^2 + b^2)`, as good as `a >= FLATTEST b`.
fn is_regular(linear: &Matrix2<f64>) -> bool {
    linear.determinant().abs() > FLATTEST * linear.norm_squared()
}

#[cfg(test)]
mod tests {
    use freeform_riccati::{MAX_PARAMETERS, MotionModel};

    use super::*;
    use crate::{
        drawn_curves::{lobed, outline, polar},
        measurement::Frame,
        track::Track,
    };

    /// A track of an outline between 0.7 and 1.3 from the origin.
    fn track(model: MotionModel) -> Track {
        let shown = outline(200, |t| polar(lobed(t, &[(3.0, [0.2, 0.0]), (2.0, [0.1, 0.0])]), t));
        Track::begin(model, &shown, 0.0, &mut Frame::default()).expect("a track")
    }

    #[test]
    fn an_outline_is_shown_by_poses_in_front_of_the_camera_that_do_not_look_along_the_plane() {
        let track = track(MotionModel::Projective);
        let perspective = |x: f64| Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 1.0);
        let wide = |width: f64| Matrix3::from_diagonal(&nalgebra::Vector3::new(width, 1.0, 1.0));
        let is_shown = |pose: &Matrix3<f64>| track.map().is_shown_in(pose);
        // Cells at x in about -1 to 1.3: the line that goes to infinity is at -1 / x.
        for pose in [Matrix3::identity(), -perspective(0.3), perspective(0.3), perspective(-0.6), wide(1e-3)] {
            assert!(is_shown(&pose), "{pose}");
        }
        for pose in
            [perspective(2.0), perspective(-1e9), wide(1e-7), wide(0.0), wide(f64::NAN), perspective(f64::INFINITY)]
        {
            assert!(!is_shown(&pose), "{pose}");
        }
        let moved = |x: f64| Matrix3::new_translation(&nalgebra::Vector2::new(x, 0.0));
        assert!(is_shown(&moved(-1e8)) && !is_shown(&moved(1e10)) && !is_shown(&moved(-1e119)));
        // Mirrored, and turned about an axis in the plane by more than a right angle.
        let behind = Matrix3::new(-0.9, 0.0, 0.4, 0.0, 1.0, 0.0, -0.4, 0.0, -0.9);
        for pose in [wide(-1.0), wide(-1.0) * perspective(0.3), behind] {
            assert!(!is_shown(&pose), "{pose}");
        }
        // A line that just misses the outline, and one that touches it.
        let farthest = track.map().cells().iter().map(|cell| cell.centre.x).fold(f64::NEG_INFINITY, f64::max);
        assert!(
            is_shown(&perspective(-1.0 / (1.01 * farthest))) && !is_shown(&perspective(-1.0 / (1.00001 * farthest)))
        );
    }

    #[test]
    fn a_track_is_not_moved_on_to_where_its_outline_is_not_shown() {
        for (model, parameter, rate) in [(MotionModel::Projective, 6, 5.0), (MotionModel::Affine, 0, -30.0)] {
            let mut track = track(model);
            let mut motion = [0.0; MAX_PARAMETERS];
            motion[parameter] = rate;
            track.set_motion(motion);
            let marginal = track.belief().marginal;
            assert!(!track.predict(1.0), "{model:?}");
            assert_eq!((track.body_pose(), track.belief().marginal), (&Matrix3::identity(), marginal));
            assert!(track.predict(0.01) && track.is_shown());
        }
    }
}
