//! Missing arcs, missing frames, uneven times and files, through the whole pipeline.
use crate::common::{frames, identified, rigid_errors, seconds};
use freeform_motion::{
    Pipeline, PipelineSettings,
    estimate::TimeNotIncreasing,
    identify::IdentifyError,
    outline_io::{DEFAULT_OBJECT, OutlineFrame, OutlineReader, OutlineWriter, WriterOptions},
    riccati::{AffineMotion, RigidMotion},
    sim_camera::{BuiltInShape, Camera, Occlusion, PaperExperiment, Scene, Settings, Simulator},
};
use nalgebra::{Matrix3, Point2};

const BIRD: PaperExperiment = PaperExperiment::FLIGHT_BIRD;

fn bird() -> Scene {
    BIRD.scene(PaperExperiment::SCALE).expect("a scene")
}

#[test]
fn the_fitted_curve_is_bounded_in_every_frame_of_every_shape() {
    for shape in BuiltInShape::ALL {
        for noise in [0.005, 0.02] {
            for fraction in [0.0, 0.2] {
                let occlusion = Occlusion { fraction, ..Occlusion::default() };
                let settings = Settings { noise, occlusion, ..frames(30) };
                let scene = Scene::new(shape, BIRD.motion, Camera::new(0.1).expect("a scale"));
                let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
                for frame in &Simulator::new(scene, settings).expect("a simulation") {
                    let result = pipeline.push(frame.time, &frame.outline);
                    let result = result.unwrap_or_else(|error| panic!("{shape}, {noise}, {fraction}: {error}"));
                    assert!(result.fit.is_bounded());
                    assert_eq!(result.decomposition.conjugate_pairs(4).count(), 2);
                }
            }
        }
    }
}

#[test]
fn a_fifth_of_the_frames_may_be_missing() {
    let settings = Settings { dropped_frames: 0.2, ..seconds(30.0) };
    let pipeline = identified(bird(), &settings, PipelineSettings::default());
    let (omega, b) = rigid_errors(&pipeline, &BIRD.motion, PaperExperiment::SCALE);
    println!("omega {omega}, b {b}");
    assert!(omega < 0.03 && b < 0.05, "omega {omega}, b {b}");
}

#[test]
fn frames_may_come_at_uneven_times() {
    // At 90 frames/s every first, third, and second frame in turn is kept: steps of 1, 2 or 3 times 1/90 s.
    let settings = Settings { fps: 90.0, ..seconds(30.0) };
    let simulator = Simulator::new(bird(), settings).expect("a simulation");
    let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
    let steps = [1, 3, 2].into_iter().cycle();
    let indices = steps.scan(0, |index, step| {
        *index += step;
        Some(*index)
    });
    for frame in indices.take_while(|index| *index < 2700).map_while(|index| simulator.frame(index)) {
        pipeline.push(frame.time, &frame.outline).expect("a good frame");
    }
    let (omega, b) = rigid_errors(&pipeline, &BIRD.motion, PaperExperiment::SCALE);
    println!("omega {omega}, b {b}");
    assert!(omega < 0.03 && b < 0.05, "omega {omega}, b {b}");
}

#[test]
fn a_frame_out_of_time_is_rejected_and_changes_nothing() {
    let simulator = Simulator::new(bird(), frames(20)).expect("a simulation");
    let (mut with, mut without) = (Pipeline::new(PipelineSettings::default()).expect("settings"), None);
    for frame in &simulator {
        with.push(frame.time, &frame.outline).expect("a good frame");
        if frame.index == 10 {
            without = Some(with.clone());
            let error = with.push(frame.time, &frame.outline).expect_err("the same time again");
            let expected =
                IdentifyError::TimeNotIncreasing(TimeNotIncreasing { time: frame.time, previous: frame.time });
            assert_eq!(error, expected.into());
        } else if let Some(other) = &mut without {
            other.push(frame.time, &frame.outline).expect("a good frame");
        }
    }
    assert_eq!(with.estimate(), without.expect("frame 10").estimate());
    assert_eq!((with.frames(), with.frames_rejected()), (21, 1));
}

#[test]
fn outlines_from_a_file_give_the_same_motion_as_the_frames_themselves() {
    let occlusion = Occlusion { fraction: 0.1, probability: 0.5, first_frame: 1 };
    let simulator = Simulator::new(bird(), Settings { occlusion, ..frames(60) }).expect("a simulation");
    let options = WriterOptions { arc_column: true, ..WriterOptions::default() };
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("a header");
    let mut directly = Pipeline::new(PipelineSettings::default()).expect("settings");
    for frame in &simulator {
        directly.push(frame.time, &frame.outline).expect("a good frame");
        let (number, object) = (frame.index as u64, DEFAULT_OBJECT.to_owned());
        let row = OutlineFrame { frame: number, time: frame.time, object, outline: frame.outline };
        writer.write(&row).expect("memory takes it");
    }
    let file = writer.finish().expect("memory takes it");
    let mut from_file = Pipeline::new(PipelineSettings::default()).expect("settings");
    for frame in OutlineReader::new(file.as_slice(), "memory").expect("a header") {
        let frame = frame.expect("a good row");
        from_file.push(frame.time, &frame.outline).expect("a good frame");
    }
    assert_eq!(from_file.estimate(), directly.estimate());
}

#[test]
fn an_object_may_travel_many_times_its_size() {
    // Straight on, slowly to fast; around points up to eight diameters away.
    let straight = [3.0, 5.0, 10.0, 15.0].map(|speed| RigidMotion { omega: 0.0, b1: 0.6 * speed, b2: 0.8 * speed });
    let around = [(0.3, 5.0, 0.0), (1.0, -7.0, 7.0), (1.5, -15.0, 10.0), (0.3, 25.0, 0.0), (1.0, -50.0, 50.0)]
        .map(|(omega, b1, b2)| RigidMotion { omega, b1, b2 });
    let motions = straight.into_iter().chain(around);
    for motion in motions {
        for shape in [BuiltInShape::Bird, BuiltInShape::Glider, BuiltInShape::Phone, BuiltInShape::Van] {
            let camera = Camera::new(PaperExperiment::SCALE).expect("a scale");
            let scene = Scene::new(shape, motion, camera);
            let end = scene.true_pose(30.0) * Point2::origin();
            let pipeline = identified(scene, &seconds(30.0), PipelineSettings::default());
            let found = pipeline.estimate().expect("an estimate").generator();
            let truth = camera.scale().generator_in_image(&AffineMotion::from(motion).generator());
            // The velocity where the object is: b, that at the origin, follows from it over the way to there.
            let velocity = |generator: &Matrix3<f64>| (generator * end.to_homogeneous()).xy();
            let off = (velocity(&found) - velocity(&truth)).norm() / velocity(&truth).norm();
            let omega = (found[(0, 1)] - motion.omega).abs();
            println!("{shape} {motion:?}: omega off by {omega}, velocity by {off}");
            assert!(omega < 0.03 && off < 0.06, "{shape} {motion:?}: omega off by {omega}, velocity by {off}");
        }
    }
}
