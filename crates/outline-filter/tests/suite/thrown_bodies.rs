//! Small bodies that are thrown: at 30 frames a second gravity bends the way of one of ten centimetres by a tenth of its size from step to step.
use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{filter_support::filter, gaps::points_on};

const FRAME_RATE: f64 = 30.0;

/// What became of thrown bodies: of their frames, and of the velocities that were stated from the fifth frame on.
#[derive(Debug, Default)]
struct Throws {
    frames: u32,
    rejected: u32,
    stated: u32,
    off: u32,
}

/// Throws a spanner that turns by up to a fifth of a radian a frame, while gravity changes its way by `bend` of its length from step to step.
fn throws(bend: std::ops::Range<f64>) -> Throws {
    let spanner =
        [(-1.3, -0.12), (0.6, -0.12), (0.8, -0.4), (1.3, -0.4), (1.1, -0.1), (1.1, 0.1), (1.3, 0.5), (0.8, 0.4)];
    let spanner: Vec<_> =
        spanner.iter().chain(&[(0.6, 0.12), (-1.3, 0.12)]).map(|(x, y)| Point2::new(*x, *y)).collect();
    let mut found = Throws::default();
    for seed in 0..12 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let spin = random.random_range(-0.2..0.2);
        let fall = Vector2::new(0.0, -2.6 * random.random_range(bend.clone()));
        let throw = Vector2::new(random.random_range(-0.3..0.3), 0.0) - 12.0 * fall;
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..24 {
            let t = f64::from(frame);
            let middle = throw * t + 0.5 * fall * t * t;
            let points = points_on(&spanner, 250, (spin * t, middle), &mut random);
            let outline = Outline::closed(points).expect("an outline");
            let step = run.step(t / FRAME_RATE, &outline).expect("increasing times");
            found.frames += 1;
            found.rejected += u32::from(!step.is_accepted());
            let Some(velocity) = run.velocity().filter(|_| frame > 4 && step.is_accepted()) else { continue };
            let from_middle = velocity.point.coords - middle;
            let truth = (throw + fall * t + spin * Vector2::new(-from_middle.y, from_middle.x)) * FRAME_RATE;
            found.stated += 1;
            found.off +=
                u32::from((velocity.velocity - truth).abs().component_div(&velocity.standard_deviations()).max() > 5.0);
        }
    }
    found
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
