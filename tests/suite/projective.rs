//! Projective motion through the whole chain.
use freeform_motion::{
    Pipeline, PipelineSettings, Tracker, TrackerSettings, Warning,
    outline_filter::FilterSettings,
    outline_io::OutlineFrame,
    riccati::{MotionModel, ProjectiveMotion},
    sim_camera::{BuiltInShape, Camera, Occlusion, Scene, SequenceLength, Settings, Simulator},
    tracker::{MethodSettings, ObjectResult},
};

/// A turntable that is tilted: its generator has the eigenvalues 0 and +-1.59 j.
const MOTION: ProjectiveMotion =
    ProjectiveMotion { a1: 0.0, a2: 1.6, a3: -1.6, a4: 0.0, b1: -0.3, b2: 0.4, c1: -0.12, c2: 0.16 };

fn truth() -> Vec<f64> {
    MotionModel::Projective.parameters_of_motion(&MOTION).expect("projective")
}

fn simulator(shape: BuiltInShape, seconds: f64, noise: f64, hidden: f64) -> Simulator {
    let occlusion = Occlusion { fraction: hidden, first_frame: 1, ..Occlusion::default() };
    let settings = Settings { length: SequenceLength::Seconds(seconds), noise, occlusion, ..Settings::default() };
    Simulator::new(Scene::new(shape, MOTION, Camera::default()), settings).expect("a simulation")
}

/// Largest errors of the rates, of b and of c by the adaptive method.
fn adaptive_errors(shape: BuiltInShape, seconds: f64, noise: f64, hidden: f64) -> [f64; 3] {
    let mut pipeline = Pipeline::new(PipelineSettings::for_model(MotionModel::Projective)).expect("settings");
    for frame in simulator(shape, seconds, noise, hidden).frames() {
        pipeline.push(frame.time, &frame.outline).expect("a good frame");
    }
    let estimate = pipeline.estimate().expect("an estimate");
    let errors: Vec<f64> = estimate.values().iter().zip(truth()).map(|(found, truth)| (found - truth).abs()).collect();
    let largest = |range: std::ops::Range<usize>| errors[range].iter().copied().fold(0.0, f64::max);
    [largest(0..4), largest(4..6), largest(6..8)]
}

#[test]
fn the_adaptive_method_finds_eight_parameters() {
    for shape in [BuiltInShape::Bird, BuiltInShape::Van] {
        for (noise, limits) in [(0.0, [0.02, 0.01, 0.01]), (0.002, [0.05, 0.02, 0.04])] {
            let errors = adaptive_errors(shape, 4.0, noise, 0.0);
            println!("{shape} {noise}: {errors:?}");
            assert!(errors.iter().zip(limits).all(|(error, limit)| *error < limit), "{shape}, {noise}: {errors:?}");
        }
    }
}

#[test]
fn a_fifth_of_the_outline_may_be_hidden_under_projective_motion() {
    let errors = adaptive_errors(BuiltInShape::Bird, 3.0, 0.001, 0.2);
    println!("{errors:?}");
    assert!(errors.iter().all(|error| *error < 0.1), "{errors:?}");
}

#[test]
fn a_motion_that_shrinks_the_object_to_nothing_over_a_gap_does_not_end_the_program() {
    for (model, shrinking) in [(MotionModel::Affine, 6), (MotionModel::Projective, 8)] {
        let mut settings = PipelineSettings::for_model(model);
        settings.identify.initial_values = vec![0.0; shrinking];
        (settings.identify.initial_values[0], settings.identify.initial_values[3]) = (-0.5, -0.5);
        let mut pipeline = Pipeline::new(settings).expect("settings");
        let frames: Vec<_> = simulator(BuiltInShape::Bird, 0.2, 0.001, 0.2).frames().collect();
        for gap in [0.0, 1e4, 1e6, 1e9] {
            for frame in &frames {
                // Any answer will do.
                let _ = pipeline.push(gap + frame.time, &frame.outline);
            }
        }
        assert_eq!(pipeline.frames(), 4 * frames.len());
    }
}

/// What the motion filter makes of a second.
fn filtered(settings: FilterSettings, shape: BuiltInShape) -> ObjectResult {
    let settings = TrackerSettings { method: MethodSettings::Filter(settings), ..TrackerSettings::default() };
    let mut tracker = Tracker::new(settings).expect("good settings");
    for frame in simulator(shape, 1.0, 0.002, 0.0).frames() {
        let (number, time, object) = (frame.index as u64, frame.time, "0".to_owned());
        tracker.push(&OutlineFrame { frame: number, time, object, outline: frame.outline });
    }
    tracker.results().remove(0)
}

#[test]
fn that_affine_motion_leaves_perspective_out_is_told_and_projective_motion_leaves_nothing_out() {
    for shape in [BuiltInShape::Bird, BuiltInShape::Van] {
        let found = |model| filtered(FilterSettings { model, ..FilterSettings::default() }, shape);
        let affine = found(MotionModel::Affine).warnings;
        let is_told = |warning: &Warning| matches!(warning, Warning::WrongFamily { motion: MotionModel::Affine, .. });
        assert!(affine.iter().any(is_told), "{shape}: {affine:?}");
        let projective = found(MotionModel::Projective);
        assert!(projective.warnings.is_empty(), "{shape}: {:?}", projective.warnings);
        assert!(projective.dynamics.is_some_and(|weights| weights.generator > 0.5) && projective.aliases.is_empty());
    }
}

#[test]
fn an_uncertain_edge_widens_the_deviations_of_all_eight_parameters() {
    let found = |edge_uncertainty| {
        let settings = FilterSettings { model: MotionModel::Projective, edge_uncertainty, ..FilterSettings::default() };
        filtered(settings, BuiltInShape::Bird).estimate.expect("a motion")
    };
    let [certain, uncertain] = [0.0, 0.002].map(found);
    for (p, q) in certain.parameters().zip(uncertain.parameters()) {
        assert_eq!(p.value, q.value, "{}", p.name);
        let [without, with] = [p, q].map(|p| p.standard_deviation.expect("by the filter"));
        assert!(with > 1.05 * without, "{}: {with} {without}", p.name);
    }
}

#[test]
fn the_motion_filter_holds_the_eight_parameters_within_their_deviations() {
    for shape in [BuiltInShape::Bird, BuiltInShape::Van] {
        let result = filtered(FilterSettings { model: MotionModel::Projective, ..FilterSettings::default() }, shape);
        let estimate = result.estimate.expect("a motion");
        for (p, truth) in estimate.parameters().zip(truth()) {
            let (value, deviation) = (p.value.expect("observable"), p.standard_deviation.expect("by the filter"));
            assert!((value - truth).abs() < 4.5 * deviation, "{shape} {}: {value} +- {deviation}, {truth}", p.name);
            assert!(deviation < 0.02, "{shape} {}: {deviation}", p.name);
        }
    }
}
