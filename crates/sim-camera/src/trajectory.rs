use std::f64::consts::TAU;

use freeform_riccati::RigidMotion;
use nalgebra::{Affine2, Isometry2, Point2, Rotation2, Translation2, Vector2};

use crate::error::SimulationError::{self, OutOfRange};

/// How spin and velocity of the middle change with time from their values at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Dynamics {
    /// The paper's constant generator (equation 4): the spin is constant, and the velocity of the middle turns with it.
    Generator,
    /// Both are constant: the middle runs straight, as that of a wheel that rolls or a coin that slides.
    Velocity,
    /// Both change at constant rates.
    Accelerating {
        /// Rate of the spin in rad/s^2.
        spin: f64,
        /// Acceleration of the middle, space lengths per second squared.
        middle: Vector2<f64>,
    },
    /// The object moves with constant spin and velocity in the first half of every period and rests in the second.
    StopAndGo {
        /// Length of a period in seconds, above 0.
        period: f64,
    },
    /// Both are multiplied by `1 - share + share cos(2 pi t / period)`: with a share of 1 the object swings to and fro.
    Oscillating {
        /// Length of a period in seconds, above 0.
        period: f64,
        /// Share of the rates that oscillates, from 0 to 1.
        share: f64,
    },
}

/// A rigid motion whose middle has a path of its own, in closed form: the turn and the place of the middle at any time, and
/// the generator then. The middle is any point that goes along with the object.
///
/// ```
/// use freeform_sim_camera::{Dynamics, Trajectory};
/// use nalgebra::{Point2, Vector2};
///
/// // A wheel of radius 0.5 that rolls to the right at 2 rad/s (clockwise, y up).
/// let wheel = Trajectory::new(Point2::origin(), 2.0, Vector2::new(1.0, 0.0), Dynamics::Velocity)?;
/// assert_eq!(wheel.middle(3.0), Point2::new(3.0, 0.0));
/// // The velocity at the origin of the image is another one: it depends on where the wheel is.
/// let motion = wheel.motion(3.0);
/// assert_eq!([motion.omega, motion.b1, motion.b2], [2.0, 1.0, 6.0]);
/// # Ok::<(), freeform_sim_camera::SimulationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trajectory {
    start: Point2<f64>,
    omega: f64,
    velocity: Vector2<f64>,
    dynamics: Dynamics,
}

impl Trajectory {
    /// The motion of an object whose middle is at `start` at time 0 (space lengths), where it has the angular velocity `omega`
    /// (rad/s, positive clockwise in a y-up frame) and its middle the `velocity` (space lengths per second).
    ///
    /// # Errors
    /// A number that is not finite, a period that is not above 0, a share outside `[0, 1]`.
    pub fn new(
        start: Point2<f64>,
        omega: f64,
        velocity: Vector2<f64>,
        dynamics: Dynamics,
    ) -> Result<Self, SimulationError> {
        let check = |setting, value: f64, range, is_good: bool| {
            if is_good { Ok(()) } else { Err(OutOfRange { setting, value, range }) }
        };
        let finite = |setting, value: f64| check(setting, value, "finite", value.is_finite());
        let above = |setting, value: f64| check(setting, value, "finite and above 0", value.is_finite() && value > 0.0);
        start.iter().try_for_each(|value| finite("start of the middle", *value))?;
        finite("angular velocity", omega)?;
        velocity.iter().try_for_each(|value| finite("velocity of the middle", *value))?;
        match dynamics {
            Dynamics::Generator | Dynamics::Velocity => {}
            Dynamics::Accelerating { spin, middle } => {
                finite("angular acceleration", spin)?;
                middle.iter().try_for_each(|value| finite("acceleration of the middle", *value))?;
            }
            Dynamics::StopAndGo { period } => above("period", period)?,
            Dynamics::Oscillating { period, share } => {
                above("period", period)?;
                check("share that oscillates", share, "from 0 to 1", (0.0..=1.0).contains(&share))?;
            }
        }
        Ok(Self { start, omega, velocity, dynamics })
    }

    /// How its rates change.
    #[must_use]
    pub fn dynamics(&self) -> Dynamics {
        self.dynamics
    }

    /// Turn since time 0 in radians, positive clockwise in a y-up frame.
    #[must_use]
    pub fn turn(&self, time: f64) -> f64 {
        match self.dynamics {
            Dynamics::Accelerating { spin, .. } => time * (self.omega + 0.5 * spin * time),
            _ => self.omega * self.progress(time),
        }
    }

    /// Place of the middle, space lengths.
    #[must_use]
    pub fn middle(&self, time: f64) -> Point2<f64> {
        match self.dynamics {
            Dynamics::Generator => self.motion(0.0).flow(time) * self.start,
            Dynamics::Accelerating { middle, .. } => self.start + time * (self.velocity + 0.5 * time * middle),
            _ => self.start + self.velocity * self.progress(time),
        }
    }

    /// Angular velocity in rad/s. Where it jumps, that after the jump.
    #[must_use]
    pub fn omega(&self, time: f64) -> f64 {
        match self.dynamics {
            Dynamics::Accelerating { spin, .. } => self.omega + spin * time,
            _ => self.omega * self.pace(time),
        }
    }

    /// Velocity of the middle, space lengths per second. Where it jumps, that after the jump.
    #[must_use]
    pub fn velocity(&self, time: f64) -> Vector2<f64> {
        match self.dynamics {
            Dynamics::Generator => Rotation2::new(-self.turn(time)) * self.velocity,
            Dynamics::Accelerating { middle, .. } => self.velocity + time * middle,
            _ => self.velocity * self.pace(time),
        }
    }

    /// The generator at a time: the spin, and the velocity of the plane of the object at the origin, `b = v - omega (y, -x)`.
    #[must_use]
    pub fn motion(&self, time: f64) -> RigidMotion {
        let (middle, velocity) = match self.dynamics {
            // The same at all times.
            Dynamics::Generator => (self.start, self.velocity),
            _ => (self.middle(time), self.velocity(time)),
        };
        let omega = self.omega(time);
        RigidMotion { omega, b1: velocity.x - omega * middle.y, b2: velocity.y + omega * middle.x }
    }

    /// The map of the plane from time 0 to a time.
    #[must_use]
    pub fn pose(&self, time: f64) -> Affine2<f64> {
        if self.dynamics == Dynamics::Generator {
            return self.motion(0.0).flow(time);
        }
        let there = Isometry2::new(self.middle(time).coords, -self.turn(time));
        nalgebra::convert(there * Translation2::from(-self.start.coords))
    }

    /// Seconds for which the object has moved at its first rates, weighted by the pace.
    fn progress(&self, time: f64) -> f64 {
        match self.dynamics {
            Dynamics::StopAndGo { period } => {
                let half = 0.5 * period;
                (time / period).floor() * half + time.rem_euclid(period).min(half)
            }
            Dynamics::Oscillating { period, share } => {
                (1.0 - share) * time + share * period / TAU * (TAU * time / period).sin()
            }
            Dynamics::Generator | Dynamics::Velocity | Dynamics::Accelerating { .. } => time,
        }
    }

    /// Rate of the progress.
    fn pace(&self, time: f64) -> f64 {
        match self.dynamics {
            Dynamics::StopAndGo { period } => f64::from(u8::from(time.rem_euclid(period) < 0.5 * period)),
            Dynamics::Oscillating { period, share } => 1.0 - share + share * (TAU * time / period).cos(),
            Dynamics::Generator | Dynamics::Velocity | Dynamics::Accelerating { .. } => 1.0,
        }
    }
}
