//! What outlines of masks are off by the rounding to pixels.
use crate::filter_support::{frames_of, settings};
use freeform_curve_fit::{Outline, PixelGrid};
use freeform_outline_filter::{FilterError, FilterSettings, MotionFilter};
use freeform_outline_io::{GrayImage, TraceSettings, trace_mask};
use freeform_riccati::{MotionModel, ProjectiveMotion, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Dynamics, Frame, Mask, Motion, Shape, Trajectory};
use nalgebra::{Point2, Rotation2, Vector2};
use proptest::prelude::*;

const FRAMES: usize = 31;

/// The velocity of the object at the end, its standard deviations, and their systematic parts.
fn stated(settings: FilterSettings, frames: &[Frame]) -> [Vec<f64>; 3] {
    let mut filter =
        MotionFilter::new(FilterSettings { adaptive: false, ..settings }).expect("settings in their ranges");
    for frame in frames {
        filter.step(frame.time, &frame.outline).expect("a good frame");
    }
    let estimate = filter.estimate().expect("a motion");
    let list = |value: &dyn Fn(freeform_estimate::ParameterEstimate) -> Option<f64>| {
        estimate.parameters().map(|p| value(p).expect("observable")).collect::<Vec<f64>>()
    };
    [list(&|p| p.value), list(&|p| p.standard_deviation), list(&|p| p.systematic_deviation)]
}

/// Teeth of the rounding that a coordinate shows which moves on by a step in pixels, in so many steps: of all fractions, near which it shows as
/// many phases as the denominator says and new ones as it drifts, the fewest.
fn teeth_seen(step: f64, steps: f64) -> f64 {
    let near = |phases: f64| steps * phases * (phases * step - (phases * step).round()).abs();
    let others = (2..=steps as u32).map(f64::from).map(|phases| near(phases).max(phases));
    others.fold(near(1.0), f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn the_rounding_of_masks_counts_the_less_the_more_of_its_teeth_the_frames_show(
        omega in -1.5..1.5_f64, b1 in -0.5..0.5_f64, pixel in 0.003..0.05_f64, seed in 0..1000_u64,
    ) {
        let rounding = pixel / 12.0_f64.sqrt();
        for pace in [0.0, 0.01, 0.3, 1.0] {
            let motion = RigidMotion { omega: pace * omega, b1: pace * b1, b2: 0.1 * pace };
            let frames = frames_of(BuiltInShape::Bird, motion, settings(FRAMES, seed));
            // A family that leaves nothing out: what cameras do besides is a systematic part of the others.
            let model = MotionModel::Projective;
            let of_masks = FilterSettings { model, mask_pixel: pixel, ..FilterSettings::default() };
            let with_edges = FilterSettings { edge_uncertainty: rounding, ..of_masks };
            let [mask, both] = [of_masks, with_edges].map(|settings| stated(settings, &frames));
            prop_assert_eq!(&mask[0], &both[0]);

            // The teeth of the rounding that frames show of the points, root mean square: all of them move at a constant speed.
            let (last, velocity) = (&frames[FRAMES - 1], ProjectiveMotion::of_generator(&motion.generator()));
            let step = last.time - frames[FRAMES - 2].time;
            let steps = (last.time - frames[0].time) / step;
            let seen = |p: &Point2<f64>| (velocity.velocity(p) * step / pixel).map(|along| teeth_seen(along, steps));
            let points: Vec<Point2<f64>> = last.outline.pieces().flat_map(|piece| piece.points.to_vec()).collect();
            let mean = points.iter().map(|p| seen(p).norm_squared()).sum::<f64>() / points.len() as f64;
            let teeth = mean.sqrt().max(1.0);
            // An edge uncertainty of the same size does not fall.
            for (mask, both) in mask[2].iter().zip(&both[2]) {
                let share = (both * both - mask * mask) / (mask * mask);
                prop_assert!((share.sqrt() / teeth - 1.0).abs() < 0.3, "{} {}", share.sqrt(), teeth);
            }
        }
    }
}

#[test]
fn masks_of_a_body_that_turns_and_travels_tell_its_turn_as_well_as_of_one_that_only_turns() {
    let deviation = |velocity: Vector2<f64>| {
        let path = Trajectory::new(Point2::origin(), 0.9, velocity, Dynamics::Velocity).expect("finite numbers");
        let frames = frames_of(BuiltInShape::Van, Motion::varying(move |t| path.motion(t)), settings(60, 4));
        let mut filter =
            MotionFilter::new(FilterSettings { mask_pixel: 0.02, ..FilterSettings::default() }).expect("settings");
        for frame in &frames {
            filter.step(frame.time, &frame.outline).expect("a good frame");
        }
        let omega = filter.estimate().expect("a motion").parameters().next().expect("omega");
        omega.systematic_deviation.expect("a value")
    };
    let [resting, travelling] = [Vector2::zeros(), Vector2::new(0.4, 0.2)].map(deviation);
    // It moves on more pixels.
    assert!(travelling < 1.2 * resting, "{travelling} {resting}");
}

#[test]
fn a_pixel_without_a_size_is_refused() {
    for mask_pixel in [-1.0, f64::NAN, f64::INFINITY] {
        let error = MotionFilter::new(FilterSettings { mask_pixel, ..FilterSettings::default() }).expect_err("no size");
        assert!(matches!(error, FilterError::Setting { setting: "mask pixel", .. }), "{error}");
    }
}

/// Outlines of a body that turns slowly about its middle, traced in two-valued masks, 40 pixels to a size.
fn traced_in_masks(omega: f64, frames: usize) -> Vec<(f64, Outline)> {
    const PIXELS: f64 = 40.0;
    let shape = Shape::from(BuiltInShape::Van);
    let grid = PixelGrid::new([0.0, 80.0], Point2::new(-1.0, -1.0), Vector2::new(1.0, -1.0) / PIXELS);
    let outline_at = |time: f64| {
        let turn = Rotation2::new(-omega * time);
        let points = (0..800).map(|i| turn * shape.point_at(f64::from(i) / 800.0)).collect();
        let mask =
            Mask::of_outline(&Outline::closed(points).expect("points"), [80, 80], &grid).expect("a mask").binary();
        let picture = GrayImage::from_raw(80, 80, mask.grey).expect("a picture");
        trace_mask(&picture, &TraceSettings { pixel_size: 1.0 / PIXELS, ..TraceSettings::default() })
            .expect("an object")
    };
    let times = (0..frames).map(|frame| frame as f64 / 30.0);
    times.map(|time| (time, outline_at(time).outline)).collect()
}

#[test]
fn masks_whose_pixels_nobody_tells_are_found_to_be_masks() {
    let frames = traced_in_masks(0.03, 60);
    let omega = |mask_pixel: f64| {
        let mut filter =
            MotionFilter::new(FilterSettings { mask_pixel, ..FilterSettings::default() }).expect("good settings");
        for (time, outline) in &frames {
            filter.step(*time, outline).expect("a good frame");
        }
        filter.estimate().expect("a motion").parameters().next().expect("omega")
    };
    let [told, found] = [1.0 / 40.0, 0.0].map(omega);
    let (told, found_deviation) =
        (told.systematic_deviation.expect("a value"), found.systematic_deviation.expect("a value"));
    assert!((0.6..1.1).contains(&(found_deviation / told)), "{found_deviation} {told}");
    let (value, deviation) = (found.value.expect("a value"), found.standard_deviation.expect("a value"));
    assert!((value - 0.03).abs() < 3.0 * deviation, "{value} +- {deviation}");
}

#[test]
fn points_that_lie_on_no_lattice_are_no_masks() {
    let motion = RigidMotion { omega: 0.03, b1: 0.0, b2: 0.0 };
    let frames = frames_of(BuiltInShape::Van, motion, settings(40, 2));
    let as_of_masks = FilterSettings { mask_pixel: 0.02, ..FilterSettings::default() };
    let [none, masks] = [FilterSettings::default(), as_of_masks].map(|settings| stated(settings, &frames));
    let ratios = none[2].iter().zip(&masks[2]).map(|(none, masks)| none / masks);
    assert!(ratios.clone().all(|ratio| ratio < 0.1), "{:?}", ratios.collect::<Vec<_>>());
}
