//! Outlines, settings and results that other programs hand on with serde.
use std::fmt::Debug;

use freeform_motion::{
    curve_fit::FitSettings,
    outline_io::{Contours, Contrast, OutlineFrame, Ring, TraceSettings, WriterOptions},
    recognise::{Evidence, RecogniseSettings, Recogniser},
    sim_camera::{BuiltInShape, Occlusion, Sampling, Scene, SequenceLength, Settings, Simulator},
};
use serde::{Serialize, de::DeserializeOwned};

fn assert_comes_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let bytes = postcard::to_allocvec(value).expect("memory");
    assert_eq!(&postcard::from_bytes::<T>(&bytes).expect("what was written"), value);
}

#[test]
fn settings_come_back() {
    assert_comes_back(&FitSettings::default());
    assert_comes_back(&RecogniseSettings { tracing: 0.004, ..RecogniseSettings::default() });
    assert_comes_back(&WriterOptions::default());
    let ring = Ring { contrast: Contrast::default(), width: Some(5.0) };
    assert_comes_back(&TraceSettings { contours: Contours::All, ring: Some(ring), ..TraceSettings::default() });
    assert_comes_back(&Settings {
        length: SequenceLength::Frames(3),
        sampling: Sampling::Regular { jitter: 0.5 },
        occlusion: Occlusion { fraction: 0.2, ..Occlusion::default() },
        ..Settings::default()
    });
}

#[test]
fn outlines_and_what_is_recognised_come_back() {
    let motion = freeform_motion::riccati::RigidMotion { omega: 1.0, b1: 0.2, b2: 0.0 };
    let occlusion = Occlusion { fraction: 0.2, first_frame: 1, ..Occlusion::default() };
    let settings = Settings { length: SequenceLength::Frames(2), outliers: 0.01, occlusion, ..Settings::default() };
    let scene = Scene::new(BuiltInShape::Bird, motion, Default::default());
    let frames: Vec<_> = Simulator::new(scene, settings).expect("a simulation").frames().collect();
    let mut recogniser = Recogniser::new(RecogniseSettings::default()).expect("settings");
    recogniser.learn("bird", &frames[0].outline).expect("a bird");
    for (number, frame) in (0..).zip(&frames) {
        assert_comes_back(frame);
        let outline = OutlineFrame { frame: number, time: 0.5, object: "bird".into(), outline: frame.outline.clone() };
        assert_comes_back(&outline);
    }
    let comparisons = recogniser.compare(&frames[0].outline).expect("a bird");
    assert_comes_back(&comparisons);
    let mut evidence = Evidence::new();
    evidence.add(&comparisons);
    let recognition = evidence.recognition(recogniser.settings()).expect("a frame");
    assert_eq!(recognition.known, Some(0));
    assert_comes_back(&recognition);
}
