//! Simulated frames, and filters that have taken them.
use freeform_curve_fit::Outline;
use freeform_outline_filter::{FilterSettings, MotionFilter};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{Camera, Frame, Motion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator};
use nalgebra::{Point2, Rotation2, Vector2};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

pub(crate) fn frames_of(shape: impl Into<Shape>, motion: impl Into<Motion>, settings: Settings) -> Vec<Frame> {
    let scene = Scene::new(shape, motion, Camera::default());
    Simulator::new(scene, settings).expect("good settings").frames().collect()
}

pub(crate) fn settings(frames: usize, seed: u64) -> Settings {
    Settings { length: SequenceLength::Frames(frames), sampling: Sampling::Independent, seed, ..Settings::default() }
}

pub(crate) fn filter(model: MotionModel) -> MotionFilter {
    MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("good settings")
}

pub(crate) fn filtered(model: MotionModel, frames: &[Frame]) -> MotionFilter {
    let mut filter = filter(model);
    for frame in frames {
        filter.step(frame.time, &frame.outline).expect("increasing times");
    }
    filter
}

/// What a filter says of a frame and of itself.
pub(crate) fn told(filter: &mut MotionFilter, frame: &Frame) -> String {
    let step = filter.step(frame.time, &frame.outline);
    format!("{step:?} {}", stated(filter))
}

/// What a filter says of itself.
pub(crate) fn stated(filter: &MotionFilter) -> String {
    // Debug text of a number is exact.
    let motion = (filter.estimate(), filter.state(), filter.velocity(), filter.pose());
    let doubts = (filter.ambiguity(), filter.aliases(), filter.dynamics(), filter.wrong_family(), filter.unstated());
    format!("{motion:?} {doubts:?}")
}

/// The angular velocity that is stated, with its deviation.
pub(crate) fn omega_of(filter: &MotionFilter) -> Option<(f64, f64)> {
    let omega = filter.estimate()?.parameters().next()?;
    omega.value.zip(omega.standard_deviation)
}

/// Points of a [`bent_outline`].
pub(crate) const BENT_POINTS: u16 = 300;

/// An outline with bends, of a radius of about 1, that has turned about the origin, anticlockwise; `noise` is the deviation of independent errors of both
/// coordinates, `across` are errors across the outline, by the number of the point and the normal.
pub(crate) fn bent_outline(
    turn: f64,
    noise: f64,
    random: &mut ChaCha8Rng,
    across: impl Fn(usize, &Vector2<f64>) -> f64,
) -> Outline {
    let body = |angle: f64| {
        let radius = 1.0 + 0.2 * (2.0 * angle).cos() + 0.15 * (3.0 * angle + 1.0).sin() + 0.1 * (5.0 * angle).cos();
        Point2::from(radius * Vector2::new(angle.cos(), angle.sin()))
    };
    let pose = Rotation2::new(turn);
    let mut point = |i: u16| {
        let angle = std::f64::consts::TAU * (f64::from(i) + random.random::<f64>()) / f64::from(BENT_POINTS);
        let tangent = pose * (body(angle + 1e-4) - body(angle - 1e-4));
        let normal = Vector2::new(tangent.y, -tangent.x).normalize();
        let errors = Vector2::from_fn(|_, _| noise * random.sample::<f64, _>(StandardNormal));
        pose * body(angle) + across(usize::from(i), &normal) * normal + errors
    };
    Outline::closed((0..BENT_POINTS).map(&mut point).collect()).expect("an outline")
}
