//! The hot path takes no memory from the heap. A program of its own, whose allocator counts.
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{OpenArc, OpenOutline, Outline},
    identify::{AdaptiveLaw, PairChoice},
    outline_filter::{FilterSettings, MotionFilter},
    riccati::MotionModel,
    sim_camera::{BuiltInShape, Camera, Frame, Occlusion, PaperExperiment, Scene, SequenceLength, Settings, Simulator},
};
use nalgebra::Point2;

/// Four seconds of the flight bird.
fn frames() -> Vec<Frame> {
    frames_with(&Settings::default())
}

fn frames_with(settings: &Settings) -> Vec<Frame> {
    frames_of(PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).expect("a scene"), settings)
}

fn frames_of(scene: Scene, settings: &Settings) -> Vec<Frame> {
    let settings = Settings { length: SequenceLength::Frames(120), seed: 1, ..*settings };
    Simulator::new(scene, settings).expect("a simulation").frames().collect()
}

#[test]
fn the_adaptive_identifier_allocates_in_the_first_frame_alone() {
    let frames = frames();
    for law in [AdaptiveLaw::Structured, AdaptiveLaw::Printed, AdaptiveLaw::FilteredLeastSquares] {
        for pairs in [PairChoice::All, PairChoice::Best, PairChoice::Given(0)] {
            let mut settings = PipelineSettings::default();
            (settings.identify.law, settings.identify.pairs) = (law, pairs);
            let mut pipeline = Pipeline::new(settings).expect("settings");
            for (index, frame) in frames.iter().enumerate() {
                let mut accepted = false;
                let counts = allocation_counter::measure(|| {
                    accepted = pipeline.push(frame.time, &frame.outline).is_ok();
                });
                assert!(accepted);
                assert!(index == 0 || counts.count_total == 0, "frame {index}, {law:?}, {pairs:?}: {counts:?}");
            }
        }
    }
}

/// The first four frames are kept, for the map is cut anew from them, and measured when the fifth has been taken. The sixth is the first that is looked
/// at for motions that are left out, whose history takes a place.
#[test]
fn once_the_outline_is_known_and_nothing_is_seen_in_front_of_it_no_step_of_the_motion_filter_allocates() {
    let hidden = Occlusion { fraction: 0.15, ..Occlusion::default() };
    for (name, settings) in [
        ("whole", Settings::default()),
        ("outliers", Settings { outliers: 0.1, ..Settings::default() }),
        ("hidden arc", Settings { occlusion: hidden, ..Settings::default() }),
    ] {
        let frames = frames_with(&settings);
        for model in [MotionModel::Affine, MotionModel::Rigid] {
            let frames = frames.iter().map(|frame| (frame.time, &frame.outline));
            let filter = allocates_no_more_from_the_seventh_frame_on(&format!("{name}, {model:?}"), model, frames);
            assert_eq!(filter.standing_edges().len(), 0, "{name}, {model:?}");
        }
    }
}

/// What a picture shows of a straight strip of 20 pixels that goes along itself and sinks: both ends are out of it, and points lie at other places
/// of the strip in each frame. From the seventh frame on its sides are seen for 8 pixels less at either end: four points beyond the ends of what is
/// known, as two sides have them, would have the map asked whether it grows.
fn straight_strip(frame: u32) -> Outline {
    const NOISE: f64 = 0.05;
    let seen = if frame < 6 { 0..150 } else { 4..146 };
    let side = |height: f64| {
        let points = seen.clone().map(|i| {
            let x = 2.0 * f64::from(i) + (1.7 * f64::from(frame)).rem_euclid(2.0);
            let error = NOISE * (12.9 * f64::from(i) + 31.0 * f64::from(frame * frame) + height).sin();
            Point2::new(x, height + 0.3 * f64::from(frame) + error)
        });
        OpenArc::new(points.collect()).expect("an arc")
    };
    Outline::Open(OpenOutline::new(vec![side(20.0), side(0.0)]).expect("arcs"))
}

#[test]
fn steps_do_not_allocate_for_what_an_outline_does_not_show() {
    let motion = PaperExperiment::FLIGHT_BIRD.motion;
    let camera = Camera::new(PaperExperiment::SCALE).expect("a scale");
    let circle = frames_of(Scene::new(BuiltInShape::Circle, motion, camera), &Settings::default());
    let strip: Vec<_> = (0..120).map(straight_strip).collect();
    for model in [MotionModel::Affine, MotionModel::Rigid] {
        let frames = circle.iter().map(|frame| (frame.time, &frame.outline));
        allocates_no_more_from_the_seventh_frame_on(&format!("circle, {model:?}"), model, frames);
        let frames = strip.iter().enumerate().map(|(index, outline)| (index as f64 / 30.0, outline));
        allocates_no_more_from_the_seventh_frame_on(&format!("strip, {model:?}"), model, frames);
    }
}

/// Follows outlines, all of which are accepted, and asserts that steps take memory from the heap in the first six frames alone.
fn allocates_no_more_from_the_seventh_frame_on<'a>(
    name: &str,
    model: MotionModel,
    frames: impl Iterator<Item = (f64, &'a Outline)>,
) -> MotionFilter {
    let mut filter = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("settings");
    for (index, (time, outline)) in frames.enumerate() {
        let mut accepted = false;
        let counts = allocation_counter::measure(|| {
            accepted = filter.step(time, outline).expect("increasing times").is_accepted();
        });
        assert!(accepted, "{name}, frame {index}");
        assert!(index < 6 || counts.count_total == 0, "{name}, frame {index}: {counts:?}");
    }
    filter
}
