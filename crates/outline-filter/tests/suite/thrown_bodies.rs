//! Small bodies that are thrown: at 30 frames a second gravity bends the way of one of ten centimetres by a tenth of its size from step to step.
use freeform_curve_fit::Outline;
use freeform_estimate::PointVelocity;
use freeform_outline_filter::{Dynamics, FilterSettings, MotionFilter};
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{
    filter_support::filter,
    gaps::{points_on, points_with_noise},
};

const FRAME_RATE: f64 = 30.0;

/// What became of thrown bodies: of their frames, and of the velocities that were stated from the fifth frame on.
#[derive(Debug, Default)]
struct Throws {
    frames: u32,
    rejected: u32,
    stated: u32,
    off: u32,
}

/// A spanner that turns by up to a fifth of a radian a frame while it falls; lengths in pieces of its own, of which it is 2.6 long, time in frames.
struct Throw {
    spin: f64,
    throw: Vector2<f64>,
    fall: Vector2<f64>,
}

impl Throw {
    /// One whose way gravity changes by `bend` of its length from step to step.
    fn new(bend: std::ops::Range<f64>, random: &mut ChaCha8Rng) -> Self {
        let spin = random.random_range(-0.2..0.2);
        let fall = Vector2::new(0.0, -2.6 * random.random_range(bend));
        let throw = Vector2::new(random.random_range(-0.3..0.3), 0.0) - 12.0 * fall;
        Self { spin, throw, fall }
    }

    fn middle(&self, t: f64) -> Vector2<f64> {
        self.throw * t + 0.5 * self.fall * t * t
    }

    /// Its outline in a frame.
    fn outline(&self, frame: u32, random: &mut ChaCha8Rng) -> Outline {
        let spanner =
            [(-1.3, -0.12), (0.6, -0.12), (0.8, -0.4), (1.3, -0.4), (1.1, -0.1), (1.1, 0.1), (1.3, 0.5), (0.8, 0.4)];
        let spanner: Vec<_> =
            spanner.iter().chain(&[(0.6, 0.12), (-1.3, 0.12)]).map(|(x, y)| Point2::new(*x, *y)).collect();
        let t = f64::from(frame);
        let points = points_on(&spanner, 250, (self.spin * t, self.middle(t)), random);
        Outline::closed(points).expect("an outline")
    }

    /// Takes its outline in a frame.
    fn step(&self, run: &mut MotionFilter, frame: u32, random: &mut ChaCha8Rng) -> bool {
        let outline = self.outline(frame, random);
        run.step(f64::from(frame) / FRAME_RATE, &outline).expect("increasing times").is_accepted()
    }

    /// How far off a velocity is in a frame, in its deviations.
    fn off(&self, found: &PointVelocity, frame: u32) -> f64 {
        let t = f64::from(frame);
        let from_middle = found.point.coords - self.middle(t);
        let truth = (self.throw + self.fall * t + self.spin * Vector2::new(-from_middle.y, from_middle.x)) * FRAME_RATE;
        (found.velocity - truth).abs().component_div(&found.standard_deviations()).max()
    }
}

fn throws(bend: std::ops::Range<f64>) -> Throws {
    let mut found = Throws::default();
    for seed in 0..12 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let throw = Throw::new(bend.clone(), &mut random);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..24 {
            let is_accepted = throw.step(&mut run, frame, &mut random);
            found.frames += 1;
            found.rejected += u32::from(!is_accepted);
            let Some(velocity) = run.velocity().filter(|_| frame > 4 && is_accepted) else { continue };
            found.stated += 1;
            found.off += u32::from(throw.off(&velocity, frame) > 5.0);
        }
    }
    found
}

/// A mean over the step is not the velocity at its end.
#[test]
fn what_one_step_tells_of_a_thrown_body_is_within_its_deviations_and_told_as_well_as_ever_for_a_constant_generator() {
    let (mut stated, mut largest) = (0, 0.0_f64);
    for (seed, dynamics) in (0..12).flat_map(|seed| [(seed, Dynamics::Auto), (seed, Dynamics::Generator)]) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let throw = Throw::new(0.02..0.05, &mut random);
        let mut run = MotionFilter::new(FilterSettings { dynamics, ..FilterSettings::default() }).expect("settings");
        (0..2).for_each(|frame| assert!(throw.step(&mut run, frame, &mut random)));
        if dynamics == Dynamics::Generator {
            let estimate = run.estimate().expect("an estimate");
            for parameter in estimate.parameters() {
                let [all, random] =
                    [parameter.standard_deviation, parameter.random_deviation].map(|d| d.expect("known"));
                assert!((all / random - 1.0).abs() < 1e-9, "{estimate:?}");
            }
        } else if let Some(velocity) = run.velocity() {
            (stated, largest) = (stated + 1, largest.max(throw.off(&velocity, 1)));
        }
    }
    assert!(stated > 6 && (0.5..4.0).contains(&largest), "{stated} {largest}");
}

#[test]
fn a_picture_that_is_stored_twice_after_the_second_frame_leaves_its_motion_three_times_less_known() {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let throw = Throw::new(0.001..0.002, &mut random);
    let mut run = filter(MotionModel::Rigid);
    assert!(throw.step(&mut run, 0, &mut random));
    let second = throw.outline(1, &mut random);
    let systematic = [1, 2].map(|frame| {
        run.step(f64::from(frame) / FRAME_RATE, &second).expect("increasing times");
        let omega = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
        let [all, random] = [omega.standard_deviation, omega.random_deviation].map(|d| d.expect("known"));
        (all * all - random * random).sqrt()
    });
    assert!((systematic[1] / systematic[0] - 3.0).abs() < 1e-6, "{systematic:?}");
}

/// Of 288 frames each 24 and 88 were not used, in fits of two of four: nothing led to an object that lies so far from where it was expected, and
/// a change of the motion asked for two such frames in a row.
#[test]
fn a_thrown_body_is_followed_from_the_third_frame_on() {
    for bend in [0.02..0.05, 0.05..0.1] {
        let found = throws(bend);
        println!("{found:?}");
        assert!(found.rejected < found.frames / 20, "{found:?}");
        assert!(found.stated > found.frames / 2 && found.off < found.stated / 20, "{found:?}");
    }
}

/// One frame in four stands for all of them in what is left out of the model, and corrected it by more than it had found: after 55 frames the
/// deviation of the place was 0.2 radii, and no velocity was stated.
#[test]
fn a_ball_that_is_thrown_is_known_as_well_at_the_end_of_its_way_as_in_the_middle() {
    const NOISE: f64 = 0.001;
    let circle: Vec<_> =
        (0..720).map(|i| f64::from(i).to_radians() / 2.0).map(|t| Point2::new(t.cos(), t.sin())).collect();
    for seed in 0..4 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let middle = |t: f64| Vector2::new(0.53 * t, 1.3 * t - 0.5 * 0.048 * t * t);
        let velocity = |t: f64| Vector2::new(0.53, 1.3 - 0.048 * t) * FRAME_RATE;
        let mut run = filter(MotionModel::Rigid);
        let mut deviations = Vec::new();
        for frame in 0..60 {
            let t = f64::from(frame);
            let outline = Outline::closed(points_with_noise(NOISE, &circle, 80, (0.0, middle(t)), &mut random));
            run.step(t / FRAME_RATE, &outline.expect("an outline")).expect("increasing times");
            if frame == 25 || frame == 59 {
                let PointVelocity { velocity: found, .. } = run.velocity().expect("known");
                let std = run.velocity().expect("known").standard_deviations();
                assert!((found - velocity(t)).norm() < 4.0 * std.norm(), "seed {seed}, frame {frame}: {found} {std}");
                deviations.push(std.norm());
            }
        }
        assert!(deviations[1] < 1.5 * deviations[0], "seed {seed}: {deviations:?}");
    }
}
