//! What the frames of a plane are measured against, whatever its motion.
use std::sync::Arc;

use freeform_riccati::{MotionModel, PinholeCamera, PlaneMotion, map_point, pull_back};
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

use crate::{
    belief::Belief,
    map::{Cell, OutlineMap},
    measurement::{Frame, Measurement, NO_CELL, NoiseModel, Pass, Reference, View},
    track::Track,
    tuning::plane as tuning,
};

/// Over the parameters of a plane in motion, or over the eight of a pose of the picture.
pub(super) type Vector8 = SVector<f64, 8>;
pub(super) type Matrix8 = SMatrix<f64, 8, 8>;

/// The picture moves by projective maps.
const MODEL: MotionModel = MotionModel::Projective;

/// Outline, noise and camera, in the normalised coordinates of the motion filter.
#[derive(Debug, Clone)]
pub(super) struct Scenery {
    map: Arc<OutlineMap>,
    /// The map that this one was drawn from.
    source: Arc<OutlineMap>,
    /// Of its cells, once it has been drawn anew; none before.
    curvatures: Vec<f64>,
    pub(super) noise: NoiseModel,
    pub(super) reference: Reference,
    /// Pose, body to image, of the first frame.
    pub(super) first_pose: Matrix3<f64>,
    /// Normalised image points of the camera to normalised coordinates, and back.
    from_camera: Matrix3<f64>,
    to_camera: Matrix3<f64>,
}

/// What the points of one frame tell of its pose, the outline being given.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseInformation {
    /// In units of the noise.
    pub(super) information: Matrix8,
    pub(super) right: Vector8,
}

impl Scenery {
    /// That which a motion filter has found.
    pub(super) fn of(track: &Track, camera: &PinholeCamera) -> Option<Self> {
        let reference = track.reference();
        let to_picture = reference.to_image();
        let (from_camera, to_camera) =
            (to_picture.try_inverse()? * camera.to_picture(), camera.from_picture() * to_picture);
        let (map, noise) = (Arc::clone(track.map()), track.noise().clone());
        let source = Arc::clone(&map);
        Some(Self {
            map,
            source,
            curvatures: Vec::new(),
            noise,
            reference,
            first_pose: *track.first_body_pose(),
            from_camera,
            to_camera,
        })
    }

    /// Whether its outline comes from that of a track.
    pub(super) fn is_of(&self, track: &Track) -> bool {
        Arc::ptr_eq(&self.source, track.map())
    }

    /// Draws the outline anew where the offsets put it, which are known to such a deviation.
    pub(super) fn redraw(&mut self, offsets: &[f64], deviation: f64) {
        self.map = self.map.redrawn(offsets, deviation);
        self.curvatures = self.map.curvatures();
    }

    /// Nothing believed but the offsets of a track.
    pub(super) fn belief_of(track: &Track) -> Belief {
        let mut belief = Belief::new(MODEL);
        belief.offsets.clone_from(&track.belief().offsets);
        belief
    }

    /// Deviation of the noise, normalised.
    pub(super) fn sigma(&self) -> f64 {
        self.noise.sigma
    }

    /// The map that has moved the picture since the first frame, normalised coordinates.
    pub(super) fn flow(&self, motion: &PlaneMotion, seconds: f64) -> Matrix3<f64> {
        self.from_camera * motion.flow(seconds).matrix() * self.to_camera
    }

    /// A map of the picture, in normalised coordinates, as one of normalised image points.
    pub(super) fn in_camera(&self, flow: &Matrix3<f64>) -> Option<Matrix3<f64>> {
        let map = self.to_camera * flow * self.from_camera;
        map.iter().all(|entry| entry.is_finite()).then_some(map)
    }

    /// The pose, body to image, so many seconds after the first frame.
    pub(super) fn pose(&self, motion: &PlaneMotion, seconds: f64) -> Matrix3<f64> {
        self.flow(motion, seconds) * self.first_pose
    }

    /// Whether a motion leaves all of the outline before the camera, and seen from its front, so many seconds after the first frame: the horizon of
    /// the plane lies beside it. Residuals of other motions are of points beyond any number. A plane that has hardly moved shows no horizon.
    pub(super) fn shows(&self, motion: &PlaneMotion, seconds: f64) -> bool {
        let hardly_moves = motion.velocity.norm() * seconds < tuning::HARDLY_MOVED;
        (hardly_moves || self.is_beside_horizon(motion)) && self.map.is_shown_in(&self.pose(motion, seconds))
    }

    /// Whether the horizon of the plane lies beside the outline in the first frame.
    fn is_beside_horizon(&self, motion: &PlaneMotion) -> bool {
        let to_camera = self.to_camera * self.first_pose;
        // Of a point at (x, y) of the picture, over that of the plane on the optical axis.
        let inverse_depth = |cell: &Cell| {
            let p = map_point(&to_camera, &cell.centre);
            motion.normal.dot(&Vector3::new(p.x, p.y, 1.0))
        };
        let inverse_depths = self.map.cells().iter().map(inverse_depth);
        let (least, most) = inverse_depths.fold((f64::INFINITY, 0.0_f64), |(a, b), d| (a.min(d), b.max(d)));
        least > tuning::LEAST_DEPTH * most
    }

    /// Derivative of the error of the pose, on its left, by the parameters of the motion (equation 7 of docs/plane-in-space.md).
    pub(super) fn sensitivity(&self, motion: &PlaneMotion, seconds: f64) -> Option<Matrix8> {
        let back = motion.flow(seconds).matrix().try_inverse()?;
        let columns = motion.flow_sensitivities(seconds).map(|derivative| {
            Vector8::from(MODEL.parameters_of(&(self.from_camera * derivative * back * self.to_camera)))
        });
        let sensitivity = Matrix8::from_columns(&columns);
        sensitivity.iter().all(|entry| entry.is_finite()).then_some(sensitivity)
    }

    /// Measures the loaded frame in a pose against the outline that is believed.
    pub(super) fn measure(&self, belief: &Belief, frame: &mut Frame, pose: &Matrix3<f64>) {
        frame.clear_shifts(self.map.cells().len());
        let null = self.map.null_directions(MODEL, pose);
        View { map: &self.map, belief, noise: &self.noise }.measure(frame, pose, &null, Pass::First);
        if !self.curvatures.is_empty() {
            self.bend(frame, pose);
        }
    }

    /// Takes off the residuals what the bend of the outline makes of a point that does not lie in the middle of its cell.
    fn bend(&self, frame: &mut Frame, pose: &Matrix3<f64>) {
        let Some(inverse) = pose.try_inverse() else { return };
        for (m, p) in frame.measurements.iter_mut().zip(&frame.points).filter(|(m, _)| m.cell != NO_CELL) {
            let cell = &self.map.cells()[m.cell];
            let q = map_point(&inverse, p);
            let tangent = Vector2::new(-cell.normal.y, cell.normal.x);
            let most = tuning::BEND_REACHES * self.map.spacing();
            let along = tangent.dot(&(q - cell.centre)).clamp(-most, most);
            // The noise along the outline adds its variance to the square, and a different one as the plane comes nearer or tilts.
            let noise = self.sigma() * pull_back(&inverse, p, &q, &tangent).norm();
            let square = along * along - noise * noise;
            m.residual -= 0.5 * self.curvatures[m.cell] * square * m.by_offset;
        }
    }

    /// The pose in which the loaded frame shows the outline that is believed, from one near it, and what the frame tells of it.
    pub(super) fn find_pose(
        &self,
        belief: &Belief,
        frame: &mut Frame,
        near: &Matrix3<f64>,
    ) -> Option<(Matrix3<f64>, Matrix8)> {
        let mut pose = *near;
        for _ in 0..tuning::MOST_POSE_STEPS {
            self.measure(belief, frame, &pose);
            let PoseInformation { information, right } = PoseInformation::of(&frame.measurements);
            let step = freeform_estimate::scaled_solution(&information, &right)?;
            let next = moved(&pose, &step)?;
            let size = step.amax();
            pose = next;
            if size < tuning::POSE_SETTLED * self.sigma() {
                return Some((pose, information));
            }
        }
        self.measure(belief, frame, &pose);
        Some((pose, PoseInformation::of(&frame.measurements).information))
    }
}

/// A pose after a step of its error; `None` where there is no such pose.
pub(super) fn moved(pose: &Matrix3<f64>, step: &Vector8) -> Option<Matrix3<f64>> {
    let moved = MODEL.flow(step.as_slice(), 1.0).into_inner() * pose;
    let moved = moved / moved[(2, 2)];
    moved.iter().all(|entry| entry.is_finite()).then_some(moved)
}

/// The error of a pose, on its left, that leads from one to another near it, to first order.
pub(super) fn error_between(from: &Matrix3<f64>, to: &Matrix3<f64>) -> Option<Vector8> {
    let step = to * from.try_inverse()?;
    let step = step * (3.0 / step.trace()) - Matrix3::identity();
    let error = Vector8::from(MODEL.parameters_of(&step));
    error.iter().all(|entry| entry.is_finite()).then_some(error)
}

/// Matrix of a change of the frame on the left error of a pose.
pub(super) fn adjoint(flow: &Matrix3<f64>) -> Option<Matrix8> {
    let rows = MODEL.adjoint(flow, &flow.try_inverse()?);
    Some(Matrix8::from_fn(|i, j| rows[i][j]))
}

impl PoseInformation {
    pub(super) fn of(measurements: &[Measurement]) -> Self {
        let mut sum = Self { information: Matrix8::zeros(), right: Vector8::zeros() };
        for m in measurements.iter().filter(|m| m.cell != NO_CELL && m.weight > 0.0) {
            let h = Vector8::from(m.jacobian);
            sum.information.ger(m.weight, &h, &h, 1.0);
            sum.right.axpy(m.weight * m.residual, &h, 1.0);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::drawn_curves::{lobed, outline, polar};

    #[test]
    fn motions_that_put_the_horizon_of_the_plane_through_the_outline_or_turn_its_back_are_not_seen() {
        let centre = Vector2::new(320.0, 240.0);
        let seen = outline(200, |t| polar(150.0 * lobed(t, &[(3.0, [0.2, 0.0])]), t) + centre);
        let track = Track::begin(MODEL, &seen, 0.0, &mut Frame::default()).expect("a track");
        let camera = PinholeCamera::new(800.0, Point2::from(centre)).expect("a camera");
        let scenery = Scenery::of(&track, &camera).expect("a scenery");
        let shows = |motion: [f64; 8]| scenery.shows(&PlaneMotion::of_parameters(motion), 1.0);
        // Tilted by 0, 50 and 70 degrees; beyond 79 the horizon lies on the outline.
        for tilt in [0.0, 1.2, 2.7] {
            assert!(shows([0.1, -0.1, 0.5, 0.1, 0.1, 0.1, tilt, 0.0]), "{tilt}");
        }
        for tilt in [5.0, 6.0, -6.0, 50.0] {
            assert!(!shows([0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, tilt]), "{tilt}");
            assert!(shows([0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, tilt]), "{tilt}");
        }
        assert!(!shows([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    }
}
