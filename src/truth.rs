use std::fmt;

use crate::tracker::MotionFamily;
use freeform_estimate::MotionEstimate;
use freeform_riccati::{CameraScale, MotionModel, PlaneMotion, ProjectiveMotion, RigidMotion};
use freeform_sim_camera::Simulator;
use nalgebra::Point2;

/// What the comment line begins with, after `#`.
const MARK: &str = "truth ";

/// Names of the parameters of a plane in space in such a comment.
const PLANE: [&str; PlaneMotion::PARAMETERS] = ["wx", "wy", "wz", "vx", "vy", "vz", "nx", "ny"];

/// The true motion of simulated outlines, as stated in a comment at the head of their file:
/// `# truth omega=1.57 b1=-3 b2=4 scale=0.1` or `# truth a1=0 ... a4=0 b1=-3 b2=4 scale=0.1`, projective ones with `c1=0.01
/// c2=0.02` before the scale; behind it `v1=-3 v2=4`, and `time=9.9` where the motion changes. Of a plane in space that motion is the one of
/// the picture, and `wx=0.1 wy=0 wz=0.5 vx=0.1 vy=0 vz=0.1 nx=0.5 ny=0` follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedMotion {
    /// In space: image velocities over the scale, c times the scale.
    pub motion: ProjectiveMotion,
    /// Camera scale f/Z0.
    pub scale: CameraScale,
    /// Velocity in space of the middle of the object, its area centroid, in the last frame.
    pub middle_velocity: Option<[f64; 2]>,
    /// The time in seconds at which the motion is that; `None`: at all times.
    pub time: Option<f64>,
    /// The motion of a plane in space, with its normal at the first frame.
    pub plane: Option<PlaneMotion>,
}

/// A true motion as it is shown next to a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// The motion in the last frame.
    pub motion: ProjectiveMotion,
    /// Velocity of the middle of the object in the last frame.
    pub middle_velocity: Option<[f64; 2]>,
    /// Whether the motion is the same in all frames.
    pub is_constant: bool,
    /// The motion of a plane in space, which is the same in all frames, with its normal at the first.
    pub plane: Option<PlaneMotion>,
}

impl Truth {
    /// The true parameters in a family of motions; `None` where it does not hold the motion.
    #[must_use]
    pub fn parameters_in(&self, family: MotionFamily) -> Option<Vec<f64>> {
        match family {
            MotionFamily::Picture(model) => model.parameters_of_motion(&self.motion),
            MotionFamily::Plane => self.plane.map(|plane| plane.parameters()[..PlaneMotion::NAMES.len()].to_vec()),
        }
    }

    /// The true parameters in a family of motions where they are the same in all frames.
    #[must_use]
    pub fn constant_parameters_in(&self, family: MotionFamily) -> Option<Vec<f64>> {
        self.parameters_in(family).filter(|_| self.is_constant || family == MotionFamily::Plane)
    }

    /// The motion in the image as an estimate without deviations, where it is the same in all frames and the model has it. `scale` is what its
    /// velocities were divided by.
    #[must_use]
    pub fn constant_in_image(&self, model: MotionModel, scale: Option<CameraScale>) -> Option<MotionEstimate> {
        self.constant_parameters_in(model.into())?;
        let in_image = scale.unwrap_or_default().generator_in_image(&self.motion.generator());
        Some(MotionEstimate::new(model, &model.parameters_of(&in_image)[..model.parameter_count()], None))
    }

    /// Velocity of the point of the object that is at `[x, y]` in the last frame.
    #[must_use]
    pub fn velocity_at(&self, point: &Point2<f64>) -> [f64; 2] {
        self.motion.velocity(point).into()
    }
}

impl<M: Into<ProjectiveMotion>> From<M> for Truth {
    fn from(motion: M) -> Self {
        Self { motion: motion.into(), middle_velocity: None, is_constant: true, plane: None }
    }
}

impl SimulatedMotion {
    /// That of the frames that a simulator makes: of the last one, where it changes.
    #[must_use]
    pub fn of(simulator: &Simulator) -> Self {
        let scene = simulator.scene();
        let last = (simulator.frame_count() - 1) as f64 / simulator.settings().fps;
        let scale = scene.camera().scale();
        let middle = (scene.true_pose(last) * scene.shape().centroid()) / scale.value();
        let motion = scene.motion().at(last);
        let middle_velocity = Some(motion.velocity(&middle).into());
        Self {
            motion,
            scale,
            middle_velocity,
            time: (!scene.motion().is_constant()).then_some(last),
            plane: scene.motion().plane(),
        }
    }

    /// The motion in the image, velocities divided by the scale of the one who asks, if any.
    #[must_use]
    pub fn seen_at(&self, scale: Option<CameraScale>) -> Truth {
        let scale = scale.unwrap_or_default();
        let per_velocity = self.scale.value() / scale.value();
        Truth {
            motion: self.motion.in_image(self.scale).in_space(scale),
            middle_velocity: self.middle_velocity.map(|velocity| velocity.map(|v| v * per_velocity)),
            is_constant: self.time.is_none(),
            plane: self.plane,
        }
    }

    /// Reads a comment line without its `#`; `None` where it is another comment or not complete.
    #[must_use]
    pub fn parse(comment: &str) -> Option<Self> {
        let fields = comment.trim().strip_prefix(MARK)?;
        let value = |name: &str| -> Option<f64> {
            let mut pairs = fields.split_whitespace().filter_map(|field| field.split_once('='));
            let number: f64 = pairs.find(|(key, _)| *key == name)?.1.parse().ok()?;
            number.is_finite().then_some(number)
        };
        let (b1, b2) = (value("b1")?, value("b2")?);
        let motion = match value("omega") {
            Some(omega) => RigidMotion { omega, b1, b2 }.into(),
            None => {
                let [a1, a2, a3, a4] = [value("a1")?, value("a2")?, value("a3")?, value("a4")?];
                let [c1, c2] = ["c1", "c2"].map(|name| value(name).unwrap_or(0.0));
                ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 }
            }
        };
        let scale = CameraScale::new(value("scale")?).ok()?;
        let middle_velocity = value("v1").zip(value("v2")).map(|(x, y)| [x, y]);
        let plane = PLANE.map(&value);
        let plane =
            plane.iter().all(Option::is_some).then(|| PlaneMotion::of_parameters(plane.map(Option::unwrap_or_default)));
        Some(Self { motion, scale, middle_velocity, time: value("time"), plane })
    }
}

impl fmt::Display for SimulatedMotion {
    /// The comment line without its `#`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 } = self.motion;
        f.write_str(MARK)?;
        match MotionModel::Rigid.parameters_of_motion(&self.motion) {
            Some(_) => write!(f, "omega={a2}")?,
            None => write!(f, "a1={a1} a2={a2} a3={a3} a4={a4}")?,
        }
        write!(f, " b1={b1} b2={b2}")?;
        if self.motion.as_affine().is_none() {
            write!(f, " c1={c1} c2={c2}")?;
        }
        write!(f, " scale={}", self.scale)?;
        if let Some([x, y]) = self.middle_velocity {
            write!(f, " v1={x} v2={y}")?;
        }
        if let Some(time) = self.time {
            write!(f, " time={time}")?;
        }
        let Some(plane) = self.plane else { return Ok(()) };
        PLANE.into_iter().zip(plane.parameters()).try_for_each(|(name, value)| write!(f, " {name}={value}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_written_as_a_comment_reads_back_to_the_last_bit() {
        let rigid: ProjectiveMotion = RigidMotion { omega: 0.1 + 0.2, b1: -3.0, b2: 1e-17 }.into();
        let affine = ProjectiveMotion { a1: 0.3, ..rigid };
        let projective = ProjectiveMotion { c1: 0.1 + 0.2, c2: -1e-17, ..rigid };
        let scale = CameraScale::new(0.1).expect("a scale");
        let known = SimulatedMotion {
            motion: rigid,
            scale,
            middle_velocity: Some([0.1 + 0.7, -1e-9]),
            time: Some(9.9),
            plane: None,
        };
        let always = SimulatedMotion { time: None, ..known };
        let affine = SimulatedMotion { motion: affine, middle_velocity: None, ..always };
        for written in [known, always, affine, SimulatedMotion { motion: projective, ..always }] {
            assert_eq!(SimulatedMotion::parse(&written.to_string()), Some(written));
        }
        assert!(known.to_string().starts_with("truth omega="));
    }

    #[test]
    fn other_comments_and_incomplete_ones_hold_no_motion() {
        for comment in ["", "made by hand", "truth", "truth omega=1", "truth omega=NaN b1=0 b2=0 scale=1"] {
            assert_eq!(SimulatedMotion::parse(comment), None, "{comment}");
        }
    }

    #[test]
    fn the_scale_of_the_one_who_asks_divides_the_velocity_and_multiplies_the_perspective() {
        let motion = ProjectiveMotion { c1: 0.1, ..RigidMotion { omega: 2.0, b1: -3.0, b2: 4.0 }.into() };
        let half = CameraScale::new(0.5).expect("a scale");
        let truth =
            SimulatedMotion { motion, scale: half, middle_velocity: Some([3.0, -1.0]), time: None, plane: None };
        let in_image = truth.seen_at(None);
        assert_eq!(in_image.motion, ProjectiveMotion { b1: -1.5, b2: 2.0, c1: 0.2, ..motion });
        assert_eq!(in_image.middle_velocity, Some([1.5, -0.5]));
        assert_eq!(
            truth.seen_at(Some(half)),
            Truth { motion, middle_velocity: Some([3.0, -1.0]), is_constant: true, plane: None }
        );
    }
}
