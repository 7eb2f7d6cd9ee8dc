//! The hot path takes no memory from the heap. A program of its own, whose allocator counts.
use freeform_motion::{
    Pipeline, PipelineSettings,
    identify::{AdaptiveLaw, PairChoice},
    outline_filter::{FilterSettings, MotionFilter},
    riccati::MotionModel,
    sim_camera::{Frame, Occlusion, PaperExperiment, SequenceLength, Settings, Simulator},
};

/// Four seconds of the flight bird.
fn frames() -> Vec<Frame> {
    frames_with(&Settings::default())
}

fn frames_with(settings: &Settings) -> Vec<Frame> {
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).expect("a scene");
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
            let mut filter =
                MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("settings");
            for (index, frame) in frames.iter().enumerate() {
                let mut accepted = false;
                let counts = allocation_counter::measure(|| {
                    accepted = filter.step(frame.time, &frame.outline).expect("increasing times").is_accepted();
                });
                assert!(accepted, "{name}, {model:?}, frame {index}");
                assert!(index < 6 || counts.count_total == 0, "{name}, {model:?}, frame {index}: {counts:?}");
            }
            assert_eq!(filter.standing_edges().len(), 0, "{name}, {model:?}");
        }
    }
}
