//! Options of how a simulated motion changes with time.
use clap::{Args, ValueEnum};
use freeform_motion::riccati::MotionModel;
use freeform_motion::sim_camera::{Dynamics, Motion, Trajectory};
use nalgebra::{Point2, Vector2};

use super::simulated::TrueMotionArgs;
use super::values::{numbers, positive, share};
use crate::failure::Failure;

/// Period in seconds where none is given.
const PERIOD: f64 = 2.0;

/// How spin and velocity change with time.
#[derive(Debug, Args)]
pub(crate) struct DynamicsArgs {
    /// How the angular velocity and the velocity of the middle of the object change with time
    #[arg(long, value_enum, default_value_t = DynamicsChoice::Generator)]
    dynamics: DynamicsChoice,

    /// Velocity of the middle of the object at time 0, in space lengths per second; not for 'generator' [default: that of --b]
    #[arg(long, value_name = "VX,VY", value_parser = numbers::<2>("VX,VY"), allow_hyphen_values = true,
          conflicts_with_all = ["b", "affine", "projective"])]
    velocity: Option<[f64; 2]>,

    /// Angular acceleration in rad/s^2, and acceleration of the middle in space lengths per second squared, for 'accelerating'
    #[arg(long, value_name = "ALPHA,AX,AY", value_parser = numbers::<3>("ALPHA,AX,AY"), allow_hyphen_values = true)]
    acceleration: Option<[f64; 3]>,

    /// Period in seconds, for 'stop-and-go' and 'oscillating' [default: 2]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    period: Option<f64>,

    /// Share of the velocities that oscillates, 0 to 1, for 'oscillating' [default: 1]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    amplitude: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DynamicsChoice {
    /// Constant omega and b: the velocity of the middle turns with the object, as on a turntable
    Generator,
    /// Constant spin, and constant velocity of the middle: the object runs straight, as it rolls or slides
    Velocity,
    /// Spin and velocity of the middle change at the rates of --acceleration, as of a thrown object
    Accelerating,
    /// Constant spin and velocity of the middle in the first half of every --period, rest in the second
    StopAndGo,
    /// Spin and velocity of the middle times 1 - A + A cos(2 pi t / P), with --amplitude A and --period P
    Oscillating,
}

impl DynamicsChoice {
    const fn name(self) -> &'static str {
        match self {
            Self::Generator => "generator",
            Self::Velocity => "velocity",
            Self::Accelerating => "accelerating",
            Self::StopAndGo => "stop-and-go",
            Self::Oscillating => "oscillating",
        }
    }
}

impl DynamicsArgs {
    /// The motion in space of an object whose middle starts at the origin.
    pub(crate) fn motion(&self, start: &TrueMotionArgs) -> Result<Motion, Failure> {
        use DynamicsChoice as Choice;
        let choice = self.dynamics;
        let given = [
            ("affine", start.family() == MotionModel::Affine, choice == Choice::Generator),
            ("projective", start.family() == MotionModel::Projective, choice == Choice::Generator),
            ("velocity", self.velocity.is_some(), choice != Choice::Generator),
            ("acceleration", self.acceleration.is_some(), choice == Choice::Accelerating),
            ("period", self.period.is_some(), matches!(choice, Choice::StopAndGo | Choice::Oscillating)),
            ("amplitude", self.amplitude.is_some(), choice == Choice::Oscillating),
        ];
        if let Some((option, ..)) = given.into_iter().find(|(_, is_given, is_meant)| *is_given && !is_meant) {
            return Err(Failure::unusable(format_args!("--{option} is not for --dynamics {}", choice.name())));
        }
        let at_zero = start.motion();
        let period = self.period.unwrap_or(PERIOD);
        let dynamics = match choice {
            Choice::Generator => return Ok(at_zero.into()),
            Choice::Velocity => Dynamics::Velocity,
            Choice::Accelerating => {
                let missing = || Failure::unusable("--dynamics accelerating needs --acceleration ALPHA,AX,AY");
                let [spin, x, y] = self.acceleration.ok_or_else(missing)?;
                Dynamics::Accelerating { spin, middle: Vector2::new(x, y) }
            }
            Choice::StopAndGo => Dynamics::StopAndGo { period },
            Choice::Oscillating => Dynamics::Oscillating { period, share: self.amplitude.unwrap_or(1.0) },
        };
        // At the origin, where the middle starts, its velocity is b.
        let velocity = self.velocity.unwrap_or([at_zero.b1, at_zero.b2]);
        let trajectory = Trajectory::new(Point2::origin(), at_zero.a2, velocity.into(), dynamics);
        trajectory.map(Motion::from).map_err(Failure::unusable)
    }
}
