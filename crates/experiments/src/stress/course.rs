use std::f64::consts::TAU;

use freeform_sim_camera::{Dynamics, Trajectory};
use nalgebra::{Point2, Vector2};
use rand::{Rng, RngExt as _};

use crate::ExperimentError;

/// How the object moves; what is a matter of chance is drawn for every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    /// Range of the angular velocity at time 0 in rad/s, either way round.
    pub(super) omega: (f64, f64),
    /// Range of the speed of the middle at time 0 in sizes per second, in any direction.
    pub(super) speed: (f64, f64),
    /// Radius of the disc about the origin of the picture in which the middle starts.
    pub(super) start: f64,
    pub(super) path: Path,
}

/// How spin and velocity of the middle change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Path {
    /// The paper's constant generator.
    Generator,
    /// Both constant.
    Velocity,
    /// The spin grows by `spin` rad/s^2, and the middle is accelerated by `middle` sizes/s^2 in any direction.
    Accelerating {
        spin: f64,
        middle: f64,
    },
    /// About a point half a size away that stays where it is, the spin growing by `spin` rad/s^2.
    Pivot {
        spin: f64,
    },
    /// Both constant, of a point that is so many sizes from the middle.
    Aside {
        distance: f64,
    },
    /// The spin is constant, and the middle falls by `gravity` sizes/s^2.
    Thrown {
        gravity: f64,
    },
    /// Along the horizontal on a circle of half a size, without slipping, slowed down by this share of its rates per second.
    Rolling {
        slowing: f64,
    },
    /// Both constant up to a time in seconds, and then nothing moves.
    Stop {
        time: f64,
    },
    StopAndGo {
        period: f64,
    },
    Oscillating {
        period: f64,
        share: f64,
    },
}

/// The motion of one run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) trajectory: Trajectory,
    /// Where the middle of the object is at time 0.
    pub(super) place: Point2<f64>,
}

impl Motion {
    /// The middle of the object at a time.
    pub(super) fn middle(&self, time: f64) -> Point2<f64> {
        self.trajectory.pose(time) * self.place
    }

    /// The point that a constant generator leaves where it is; `None` of other motions, and where nothing turns.
    pub(super) fn fixed_point(&self) -> Option<Point2<f64>> {
        let is_constant = self.trajectory.dynamics() == Dynamics::Generator;
        let omega = self.trajectory.omega(0.0);
        let b = self.velocity_at(0.0, &Point2::origin());
        (is_constant && omega != 0.0).then(|| Point2::new(b.y, -b.x) / omega)
    }

    /// Velocity of the plane of the object at a point.
    pub(super) fn velocity_at(&self, time: f64, point: &Point2<f64>) -> Vector2<f64> {
        (self.trajectory.motion(time).generator() * point.to_homogeneous()).xy()
    }
}

impl Course {
    /// The motion of one run.
    pub(super) fn draw(&self, rng: &mut impl Rng) -> Result<Motion, ExperimentError> {
        let within = |rng: &mut dyn FnMut() -> f64, (low, high): (f64, f64)| low + (high - low) * rng();
        let mut unit = || rng.random::<f64>();
        let sign = if unit() < 0.5 { -1.0 } else { 1.0 };
        let omega = sign * within(&mut unit, self.omega);
        let speed = within(&mut unit, self.speed);
        let velocity = direction(unit()) * speed;
        let start = Point2::from(direction(unit()) * self.start * unit().sqrt());
        let other = direction(unit());
        let new = |omega, velocity, dynamics| Trajectory::new(start, omega, velocity, dynamics);
        let trajectory = match self.path {
            Path::Generator => new(omega, velocity, Dynamics::Generator),
            Path::Velocity => new(omega, velocity, Dynamics::Velocity),
            Path::Accelerating { spin, middle } => {
                new(omega, velocity, Dynamics::Accelerating { spin: sign * spin, middle: middle * other })
            }
            Path::Pivot { spin } => {
                let dynamics = Dynamics::Accelerating { spin: sign * spin, middle: Vector2::zeros() };
                let trajectory = new(omega, Vector2::zeros(), dynamics)?;
                return Ok(Motion { trajectory, place: start + 0.5 * other });
            }
            Path::Aside { distance } => {
                let trajectory = new(omega, velocity, Dynamics::Velocity)?;
                return Ok(Motion { trajectory, place: start + distance * other });
            }
            Path::Thrown { gravity } => {
                new(omega, velocity, Dynamics::Accelerating { spin: 0.0, middle: Vector2::new(0.0, -gravity) })
            }
            Path::Rolling { slowing } => {
                // Clockwise to the right, with y up.
                let velocity = Vector2::new(0.5 * omega, 0.0);
                new(omega, velocity, Dynamics::Accelerating { spin: -slowing * omega, middle: -slowing * velocity })
            }
            Path::Stop { time } => new(omega, velocity, Dynamics::StopAndGo { period: 2.0 * time }),
            Path::StopAndGo { period } => new(omega, velocity, Dynamics::StopAndGo { period }),
            Path::Oscillating { period, share } => new(omega, velocity, Dynamics::Oscillating { period, share }),
        };
        Ok(Motion { trajectory: trajectory?, place: start })
    }
}

/// A unit vector, by a share of a full turn.
pub(super) fn direction(share: f64) -> Vector2<f64> {
    let (s, c) = (TAU * share).sin_cos();
    Vector2::new(c, s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    fn drawn(path: Path, seed: u64) -> Motion {
        let course = Course { omega: (1.0, 2.0), speed: (0.2, 0.4), start: 1.0, path };
        course.draw(&mut ChaCha8Rng::seed_from_u64(seed)).expect("a motion")
    }

    #[test]
    fn what_is_drawn_lies_in_its_ranges_and_turns_either_way() {
        let mut ways = [0, 0];
        for seed in 0..40 {
            let Motion { trajectory, place } = drawn(Path::Velocity, seed);
            let (omega, speed) = (trajectory.omega(0.0), trajectory.velocity(0.0).norm());
            assert!((1.0..2.0).contains(&omega.abs()) && (0.2..0.4).contains(&speed), "{omega} {speed}");
            assert!(place.coords.norm() <= 1.0);
            ways[usize::from(omega > 0.0)] += 1;
        }
        assert!(ways.iter().all(|count| *count > 5), "{ways:?}");
    }

    #[test]
    fn a_constant_generator_leaves_its_fixed_point_where_it_is() {
        let motion = drawn(Path::Generator, 2);
        let fixed = motion.fixed_point().expect("it turns");
        assert!(motion.velocity_at(1.0, &fixed).norm() < 1e-12);
        assert_eq!(drawn(Path::Velocity, 2).fixed_point(), None);
    }

    #[test]
    fn the_lowest_point_of_a_wheel_that_rolls_is_at_rest() {
        for seed in 0..10 {
            let motion = drawn(Path::Rolling { slowing: 0.2 }, seed);
            let lowest = motion.middle(1.0) - Vector2::new(0.0, 0.5);
            assert!(motion.velocity_at(1.0, &lowest).norm() < 1e-12);
        }
    }

    #[test]
    fn an_object_about_a_pivot_stays_at_its_distance_and_gains_spin_the_way_it_turns() {
        let motion = drawn(Path::Pivot { spin: 0.5 }, 3);
        let pivot = motion.trajectory.middle(0.0);
        assert!((0..5).all(|t| ((motion.middle(f64::from(t)) - pivot).norm() - 0.5).abs() < 1e-12));
        assert!((motion.trajectory.omega(2.0).abs() - motion.trajectory.omega(0.0).abs() - 1.0).abs() < 1e-12);
    }
}
