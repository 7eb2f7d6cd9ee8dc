//! Options of the simulation, shared by several commands.
use clap::Args;
use freeform_motion::riccati::{AffineMotion, MotionModel, ProjectiveMotion, RigidMotion};
use freeform_motion::sim_camera::{Camera, SimulationError};

use super::space::PlaneArgs;
use super::values::{affine, finite, fraction, not_negative, pair, positive, projective};

/// The true motion in space and the camera.
#[derive(Debug, Args)]
pub(crate) struct TrueMotionArgs {
    /// Angular velocity in rad/s, positive clockwise (y up)
    #[arg(long, value_name = "W", value_parser = finite, allow_hyphen_values = true,
          default_value_t = std::f64::consts::FRAC_PI_2)]
    omega: f64,

    /// Velocity at the origin, in space lengths per second
    #[arg(long, value_name = "B1,B2", value_parser = pair, allow_hyphen_values = true, default_value = "-3,4")]
    b: [f64; 2],

    /// An affine motion instead of --omega and --b
    #[arg(long, value_name = "A1,A2,A3,A4,B1,B2", value_parser = affine, allow_hyphen_values = true,
          conflicts_with_all = ["omega", "b"])]
    affine: Option<AffineMotion>,

    /// A projective motion instead of --omega and --b: x' = a1 x + a2 y + b1 - x (c1 x + c2 y), y' = a3 x + a4 y + b2 - y (c1 x +
    /// c2 y)
    #[arg(long, value_name = "A1,...,A4,B1,B2,C1,C2", value_parser = projective, allow_hyphen_values = true,
          conflicts_with_all = ["omega", "b", "affine"])]
    projective: Option<ProjectiveMotion>,

    /// Camera scale f/Z0: image lengths per space length
    #[arg(long, value_name = "F_OVER_Z0", value_parser = positive, default_value_t = 0.1)]
    scale: f64,

    #[command(flatten)]
    pub(crate) in_space: PlaneArgs,
}

/// Noise where none is given: of a unit-size object, and of a plane in pixels.
const NOISE: f64 = 0.005;
const NOISE_IN_PIXELS: f64 = 0.3;

impl TrueMotionArgs {
    /// The motion in space.
    pub(crate) fn motion(&self) -> ProjectiveMotion {
        let rigid = RigidMotion { omega: self.omega, b1: self.b[0], b2: self.b[1] };
        self.projective.or(self.affine.map(Into::into)).unwrap_or_else(|| rigid.into())
    }

    /// The family of the option that gave the motion.
    pub(crate) const fn family(&self) -> MotionModel {
        match (self.affine, self.projective) {
            (_, Some(_)) => MotionModel::Projective,
            (Some(_), None) => MotionModel::Affine,
            (None, None) => MotionModel::Rigid,
        }
    }

    pub(crate) fn camera(&self) -> Result<Camera, SimulationError> {
        Camera::new(self.scale)
    }
}

/// What disturbs the points of an outline.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct DisturbanceArgs {
    /// Standard deviation of the noise on each coordinate, in image lengths [default: 0.005; with --motion plane 0.3 pixels]
    #[arg(long, value_name = "SIGMA", value_parser = not_negative)]
    noise: Option<f64>,

    /// Share of the outline that is hidden, at a random place in every frame
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.0)]
    pub(crate) occlusion: f64,

    /// Share of the points that are outliers
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.0)]
    pub(crate) outliers: f64,
}

impl DisturbanceArgs {
    /// The noise that is given, or the default, that of pixels for a plane in space.
    pub(crate) fn noise(&self, is_plane: bool) -> f64 {
        self.noise.unwrap_or(if is_plane { NOISE_IN_PIXELS } else { NOISE })
    }
}
