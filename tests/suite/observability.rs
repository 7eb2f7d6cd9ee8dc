//! What the pipeline says of outlines that do not tell the motion.
use crate::common::{frames, identified, seconds};
use freeform_motion::{
    Pipeline, PipelineSettings, Warning,
    curve_fit::Outline,
    identify::AdaptiveLaw,
    sim_camera::{BuiltInShape, Camera, PaperExperiment, Scene, Settings},
};
use nalgebra::Point2;

fn scene(shape: BuiltInShape) -> Scene {
    Scene::new(shape, PaperExperiment::FLIGHT_BIRD.motion, Camera::new(0.1).expect("a scale"))
}

fn unknown(pipeline: &Pipeline) -> usize {
    let estimate = pipeline.estimate().expect("an estimate");
    estimate.parameters().filter(|parameter| parameter.value.is_none()).count()
}

#[test]
fn a_circle_never_tells_its_motion() {
    for noise in [0.001, 0.005, 0.02] {
        for (seed, count) in [(1, 60), (2, 60), (3, 60), (4, 300), (5, 300)] {
            let settings = Settings { noise, seed, ..frames(count) };
            let pipeline = identified(scene(BuiltInShape::Circle), &settings, PipelineSettings::default());
            assert_eq!(unknown(&pipeline), 3, "noise {noise}, seed {seed}, {count} frames");
            let warning = "rotation is not observable from these outlines; unknown: omega, b1, b2";
            assert_eq!(pipeline.warnings()[0].to_string(), warning);
        }
    }
}

#[test]
fn every_other_built_in_shape_tells_its_motion() {
    for shape in BuiltInShape::ALL.into_iter().filter(|shape| *shape != BuiltInShape::Circle) {
        for count in [60, 300] {
            let pipeline = identified(scene(shape), &frames(count), PipelineSettings::default());
            assert_eq!(unknown(&pipeline), 0, "{shape}, {count} frames");
        }
    }
}

#[test]
fn frames_whose_lines_coincide_make_the_motion_unobservable() {
    let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
    for frame in 0..20 {
        let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / 400.0;
        let points = (0..400).map(|i| Point2::new(angle(i).cos(), angle(i).sin())).collect();
        assert!(pipeline.push(0.1 * f64::from(frame), &Outline::closed(points).expect("a circle")).is_err());
    }
    assert_eq!(unknown(&pipeline), 3);
    assert!(
        pipeline.warnings().contains(&Warning::FramesRejected { rejected: 20, frames: 20 }),
        "{:?}",
        pipeline.warnings()
    );
}

#[test]
fn a_short_run_of_the_structured_law_comes_with_a_warning_and_one_of_least_squares_does_not() {
    let mut settings = PipelineSettings::default();
    let pipeline = identified(scene(BuiltInShape::Bird), &seconds(5.0), settings.clone());
    let texts: Vec<String> = pipeline.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(texts, ["the adaptive law may not have settled after 5.0 s"]);
    settings.identify.law = AdaptiveLaw::FilteredLeastSquares;
    let pipeline = identified(scene(BuiltInShape::Bird), &seconds(5.0), settings);
    assert_eq!(pipeline.warnings(), []);
}

#[test]
fn a_square_that_turns_by_an_eighth_of_a_circle_per_frame_is_matched_ambiguously() {
    let motion = freeform_motion::riccati::RigidMotion {
        omega: 30.0 * std::f64::consts::FRAC_PI_4,
        ..PaperExperiment::FLIGHT_BIRD.motion
    };
    let scene = Scene::new(BuiltInShape::Square, motion, Camera::new(0.1).expect("a scale"));
    let pipeline = identified(scene, &frames(100), PipelineSettings::default());
    let warnings = pipeline.warnings();
    assert!(warnings.iter().any(|warning| warning.code() == "ambiguous_correspondence"), "{warnings:?}");
}
