//! Bodies that fly straight and spin: the velocity of their centroid, of frames whose points are evenly spaced.
use freeform_curve_fit::{AreaMoments, ClosedOutline, Outline};
use freeform_outline_filter::MotionFilter;
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{filter_support::filter, gaps::points_with_noise};

const FRAME_RATE: f64 = 30.0;
const FRAMES: u32 = 60;

/// A smooth body about the centroid of its area, of a radius of about 1, drawn finely.
fn body(random: &mut ChaCha8Rng) -> Vec<Point2<f64>> {
    let waves: Vec<[f64; 3]> = (2..=5)
        .map(|times| [f64::from(times), 0.2 / f64::from(times), random.random_range(0.0..std::f64::consts::TAU)])
        .collect();
    let place = |i: u32| {
        let t = std::f64::consts::TAU * f64::from(i) / 2000.0;
        let radius = 1.0 + waves.iter().map(|[times, size, phase]| size * (times * t + phase).cos()).sum::<f64>();
        Point2::new(radius * t.cos(), 0.8 * radius * t.sin())
    };
    let outline = ClosedOutline::new((0..2000).map(place).collect()).expect("an outline");
    let centroid = AreaMoments::of(&outline).expect("an area").centroid;
    outline.points().iter().map(|p| p - centroid.coords).collect()
}

/// A body that flies straight, with a spin that is positive where it turns clockwise.
struct Flight {
    body: Vec<Point2<f64>>,
    spin: f64,
    velocity: Vector2<f64>,
    points: u32,
    noise: f64,
}

impl Flight {
    fn new(seed: u64) -> (Self, ChaCha8Rng) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let body = body(&mut random);
        let side = if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
        let spin = side * random.random_range(0.8..3.0);
        let velocity = Vector2::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
        let (points, noise) = ([60, 100][seed as usize / 2 % 2], [0.002, 0.006][seed as usize / 4 % 2]);
        (Self { body, spin, velocity, points, noise }, random)
    }

    fn outline(&self, frame: u32, random: &mut ChaCha8Rng) -> Outline {
        let time = f64::from(frame) / FRAME_RATE;
        let pose = (-self.spin * time, self.velocity * time);
        Outline::closed(points_with_noise(self.noise, &self.body, self.points, pose, random)).expect("an outline")
    }

    fn run(&self, random: &mut ChaCha8Rng) -> MotionFilter {
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..FRAMES {
            let outline = self.outline(frame, random);
            run.step(f64::from(frame) / FRAME_RATE, &outline).expect("increasing times");
        }
        run
    }

    /// Deviation of the velocity of a line through all places, each known as well as the points of its frame tell it.
    fn of_line(&self) -> f64 {
        let of_place = self.noise * (2.0 / f64::from(self.points)).sqrt();
        let frames = f64::from(FRAMES);
        of_place * FRAME_RATE * (12.0 / frames.powi(3)).sqrt()
    }
}

#[test]
fn the_velocity_of_a_body_that_flies_and_spins_is_that_of_the_centroid_of_its_area() {
    let (mut squared, mut count, mut widths) = (0.0, 0, Vec::new());
    for seed in 0..24 {
        let (flight, mut random) = Flight::new(seed);
        let run = flight.run(&mut random);
        let Some(found) = run.velocity() else { continue };
        let off = (found.velocity - flight.velocity).component_div(&found.standard_deviations());
        assert!(off.amax() < 4.5, "seed {seed}: {found:?}, {off}");
        squared += off.norm_squared();
        count += 2;
        widths.push(found.standard_deviations().x / flight.of_line());
    }
    assert!(count > 44, "{count}");
    let spread = (squared / f64::from(count)).sqrt();
    assert!((0.5..1.3).contains(&spread), "{spread}");
    widths.sort_by(f64::total_cmp);
    assert!(widths[widths.len() / 2] < 15.0, "{widths:?}");
}
