//! Reports that other programs read.
#![cfg(feature = "serde")]
use freeform_experiments::{
    figure::{Curve, Figure, Look, Panel},
    monte_carlo::{AcquisitionSetting, Method, Report, Setting, Study},
    stress::{StressStudy, Summary, kinds_containing},
};
use freeform_riccati::{MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Sampling};

fn report() -> Report {
    let (model, sampling) = (MotionModel::Rigid, Sampling::Independent);
    let setting = Setting {
        name: "three frames".to_owned(),
        model,
        motion: RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 }.into(),
        plane: None,
        frames: 3,
        fps: 30.0,
        points: 100,
        noise: 0.005,
        occlusion: 0.0,
        outliers: 0.0,
        wrong_frames: 0.0,
        sampling,
    };
    let name = "two frames".to_owned();
    let acquisition =
        AcquisitionSetting { name, model, points: 100, noise: 0.005, occlusion: 0.0, outliers: 0.0, sampling };
    let study = Study {
        shapes: vec![BuiltInShape::Bird.shape()],
        settings: vec![setting],
        acquisitions: vec![acquisition],
        methods: vec![Method::Filter, Method::Moments],
        runs: 1,
        acquisition_runs: 1,
        seed: 1,
    };
    study.run(&|| ()).expect("a report")
}

#[test]
fn a_report_of_a_study_comes_back_with_every_figure() {
    let bytes = postcard::to_allocvec(&report()).expect("memory");
    let read: Report = postcard::from_bytes(&bytes).expect("what was written");
    assert_eq!(read.evaluations[0].methods[1].method, Method::Moments);
    assert_eq!(postcard::to_allocvec(&read).expect("memory"), bytes);
}

#[test]
fn a_summary_of_a_stress_study_comes_back_and_its_report_can_be_written() {
    let study = StressStudy { runs: 1, ..StressStudy::new(kinds_containing("plain/3 frames").expect("a kind")) };
    let report = study.run(&|| ()).expect("a report");
    let summary = postcard::to_allocvec(&report.overall).expect("memory");
    assert_eq!(postcard::from_bytes::<Summary>(&summary).expect("what was written"), report.overall);
    assert!(postcard::to_allocvec(&report).is_ok_and(|bytes| bytes.len() > summary.len()));
}

#[test]
fn a_figure_comes_back() {
    let curve = Curve { name: "omega".to_owned(), look: Look::Series(2), runs: vec![vec![[0.0, 1.0], [1.0, 1.5]]] };
    let panel = Panel { title: "turn".to_owned(), curves: vec![curve], ..Panel::default() };
    let figure = Figure { panels: vec![panel], columns: 1, panel_size: [300.0, 200.0], ..Figure::default() };
    let bytes = postcard::to_allocvec(&figure).expect("memory");
    assert_eq!(postcard::from_bytes::<Figure>(&bytes).expect("what was written"), figure);
}
