use std::f64::consts::{FRAC_PI_3, TAU};

use freeform_estimate::MotionEstimate;
use freeform_riccati::{MotionModel, ProjectiveMotion, RigidMotion};
use freeform_sim_camera::{Sampling, Shape};
use nalgebra::{Matrix2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::estimator::{Estimator, Method};
use super::evaluation::{Effort, MethodResult};
use super::setting::Setting;
use crate::ExperimentError;

/// Largest turn between the two frames, rad.
const LARGEST_TURN: f64 = FRAC_PI_3;
/// Largest shift of the centre, in diameters.
const LARGEST_SHIFT: f64 = 0.5;
/// A turn that is right to 6 degrees was found.
const TURN_TOLERANCE: f64 = TAU / 60.0;
/// And with it a centre that is right to so many diameters.
const SHIFT_TOLERANCE: f64 = 0.1;
/// Stream of random numbers for the pose, which the simulator does not use.
const POSE_STREAM: u64 = u64::MAX;

/// Two frames a second apart and far from each other, and how they are seen.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AcquisitionSetting {
    /// What reports call it.
    pub name: String,
    /// Family of motions that is identified.
    pub model: MotionModel,
    /// Points on the whole outline.
    pub points: usize,
    /// Standard deviation of the noise on each coordinate, image lengths.
    pub noise: f64,
    /// Share of the outline that is missing at a random place in either frame, in `[0, 1)`.
    pub occlusion: f64,
    /// Share of the points that are wrong, in `[0, 1)`.
    pub outliers: f64,
    /// How the points are spread along the outline.
    pub sampling: Sampling,
}

/// What was found of the poses in one setting.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Acquisition {
    /// Where the runs were made.
    pub setting: AcquisitionSetting,
    /// What each method found.
    pub methods: Vec<MethodResult<Found>>,
}

/// How often the second pose was found: the turn to 6 degrees and the centre to a tenth of the diameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Found {
    /// Runs in which it was.
    pub found: usize,
    /// Runs in all.
    pub runs: usize,
}

impl Found {
    /// Of several shapes together.
    fn pooled(list: &[Self]) -> Self {
        Self { found: list.iter().map(|f| f.found).sum(), runs: list.iter().map(|f| f.runs).sum() }
    }

    /// As a fraction of all runs.
    #[must_use]
    pub fn share(self) -> f64 {
        self.found as f64 / self.runs as f64
    }
}

impl AcquisitionSetting {
    /// Whether it can be simulated.
    pub(super) fn check(&self, shape: &Shape) -> Result<(), ExperimentError> {
        self.sequence(ProjectiveMotion::default()).simulator(shape, 0).map(drop)
    }

    /// Two frames a second apart.
    fn sequence(&self, motion: ProjectiveMotion) -> Setting {
        Setting {
            plane: None,
            name: self.name.clone(),
            model: self.model,
            motion,
            frames: 2,
            fps: 1.0,
            points: self.points,
            noise: self.noise,
            occlusion: self.occlusion,
            outliers: self.outliers,
            wrong_frames: 0.0,
            sampling: self.sampling,
        }
    }
}

/// All runs of one setting.
pub(super) fn evaluate(setting: &AcquisitionSetting, effort: &Effort<'_>) -> Result<Acquisition, ExperimentError> {
    let found = effort.run_all(|index, seed| run(setting, effort.methods, &effort.shapes[index], seed))?;
    let of_shape = |runs: &Vec<Vec<bool>>, index: usize| Found {
        found: runs.iter().filter(|methods| methods[index]).count(),
        runs: runs.len(),
    };
    let methods = effort.methods.iter().enumerate().map(|(index, &method)| {
        let shapes: Vec<Found> = found.iter().map(|runs| of_shape(runs, index)).collect();
        MethodResult { method, pooled: Found::pooled(&shapes), shapes }
    });
    Ok(Acquisition { setting: setting.clone(), methods: methods.collect() })
}

/// One pair of frames, seen by every method.
fn run(
    setting: &AcquisitionSetting,
    methods: &[Method],
    shape: &Shape,
    seed: u64,
) -> Result<Vec<bool>, ExperimentError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(POSE_STREAM);
    let turn = LARGEST_TURN * rng.random_range(-1.0..=1.0);
    let length = LARGEST_SHIFT * shape.diameter() * rng.random_range(0.0..=1.0);
    let direction: f64 = rng.random_range(0.0..TAU);
    let motion = motion_with(turn, shape.centroid().coords, length * Vector2::new(direction.cos(), direction.sin()));
    let simulator = setting.sequence(motion).simulator(shape, seed)?;
    let frames: Vec<_> = simulator.frames().collect();
    let found = methods.iter().map(|method| {
        let mut estimator = Estimator::new(*method, setting.model)?;
        for frame in &frames {
            estimator.push(frame.time, &frame.outline);
        }
        Ok(estimator.estimate().is_some_and(|estimate| is_found(&estimate, &motion, shape)))
    });
    found.collect()
}

/// The motion that in one second turns by an angle (rad, clockwise) and moves the centre by a shift.
fn motion_with(turn: f64, centre: Vector2<f64>, shift: Vector2<f64>) -> ProjectiveMotion {
    let flow = |b1, b2| RigidMotion { omega: turn, b1, b2 }.flow(1.0).matrix().fixed_view::<2, 3>(0, 0).into_owned();
    let rotation = flow(0.0, 0.0).fixed_columns::<2>(0).into_owned();
    let columns = [flow(1.0, 0.0), flow(0.0, 1.0)].map(|map| map.column(2).into_owned());
    let by_velocity = Matrix2::from_columns(&columns);
    // Regular for turns short of a whole one.
    let b = by_velocity.try_inverse().unwrap_or_default() * (centre + shift - rotation * centre);
    RigidMotion { omega: turn, b1: b.x, b2: b.y }.into()
}

fn is_found(estimate: &MotionEstimate, motion: &ProjectiveMotion, shape: &Shape) -> bool {
    let (found, truth) = (estimate.model().flow(estimate.values(), 1.0).into_inner(), motion.flow(1.0));
    let turn = (found[(0, 1)] - found[(1, 0)]).atan2(found[(0, 0)] + found[(1, 1)]);
    let off = (turn - motion.a2).sin().atan2((turn - motion.a2).cos());
    let centre = shape.centroid();
    let shift = nalgebra::Projective2::from_matrix_unchecked(found).transform_point(&centre) - truth * centre;
    off.abs() <= TURN_TOLERANCE && shift.norm() <= SHIFT_TOLERANCE * shape.diameter()
}

#[cfg(test)]
mod tests {
    use freeform_sim_camera::BuiltInShape;

    use super::*;

    #[test]
    fn the_centre_is_shifted_and_the_outline_turned_as_asked() {
        let (centre, shift) = (Vector2::new(0.7, -0.2), Vector2::new(0.3, 0.1));
        let map = motion_with(-0.9, centre, shift).flow(1.0);
        assert!((map * nalgebra::Point2::from(centre) - nalgebra::Point2::from(centre + shift)).norm() < 1e-12);
        assert!((map.matrix()[(1, 0)] - 0.9_f64.sin()).abs() < 1e-12);
    }

    #[test]
    fn a_pose_is_found_within_the_tolerances_only() {
        let shape = BuiltInShape::Bird.shape();
        let motion = motion_with(0.5, Vector2::zeros(), Vector2::new(0.3, 0.0));
        let found = |turn: f64, b1: f64| {
            let values = [motion.a2 + turn, motion.b1 + b1, motion.b2];
            is_found(&MotionEstimate::new(MotionModel::Rigid, &values, None), &motion, &shape)
        };
        assert!(found(0.0, 0.0) && found(0.1, 0.0) && found(0.0, 0.09));
        assert!(!found(0.11, 0.0) && !found(0.0, 0.12) && !found(std::f64::consts::PI, 0.0) && !found(f64::NAN, 0.0));
    }
}
