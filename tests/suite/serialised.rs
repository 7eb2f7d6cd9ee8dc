//! Outlines, settings and results that other programs hand on with serde.
use std::fmt::Debug;

use freeform_motion::{
    curve_fit::FitSettings,
    outline_io::{Contours, Contrast, OutlineFrame, Ring, TraceSettings, WriterOptions},
    recognise::{Evidence, RecogniseSettings, Recogniser},
    riccati::{AffineMotion, CameraScale, PinholeCamera, PlaneMotion, ProjectiveMotion, RigidMotion, SimilarityMotion},
    sim_camera::{BuiltInShape, Occlusion, Sampling, Scene, SequenceLength, Settings, Simulator},
};
use nalgebra::{Point2, Vector3};
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
fn motions_and_cameras_come_back() {
    let rigid = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 };
    assert_comes_back(&rigid);
    assert_comes_back(&SimilarityMotion { sigma: 0.1, ..rigid.into() });
    let affine = AffineMotion { a1: 0.2, ..rigid.into() };
    assert_comes_back(&affine);
    assert_comes_back(&ProjectiveMotion { c1: 0.01, ..affine.into() });
    let [angular_velocity, velocity, normal] = [Vector3::x(), Vector3::y(), Vector3::new(0.2, 0.1, 1.0)];
    assert_comes_back(&PlaneMotion { angular_velocity, velocity, normal });
    assert_comes_back(&CameraScale::new(0.1).expect("a scale"));
    assert_comes_back(&PinholeCamera::new(800.0, Point2::new(320.0, 240.0)).expect("a camera"));
}

#[test]
fn cameras_that_cannot_be_are_refused_when_they_are_read() {
    let read = |bytes: &[f64]| {
        let bytes: Vec<u8> = bytes.iter().flat_map(|value| value.to_le_bytes()).collect();
        (postcard::from_bytes::<CameraScale>(&bytes), postcard::from_bytes::<PinholeCamera>(&bytes))
    };
    let (scale, camera) = read(&[800.0, 320.0, 240.0]);
    assert_eq!((scale.expect("a scale").value(), camera.expect("a camera").focal()), (800.0, 800.0));
    for focal in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let (scale, camera) = read(&[focal, 320.0, 240.0]);
        assert!(scale.is_err() && camera.is_err(), "{focal}");
    }
    assert!(read(&[800.0, f64::NAN, 240.0]).1.is_err());
}

#[test]
fn outlines_and_what_is_recognised_come_back() {
    let motion = RigidMotion { omega: 1.0, b1: 0.2, b2: 0.0 };
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
