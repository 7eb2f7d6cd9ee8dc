//! What cannot be recognised, or cannot serve as a known outline.
use freeform_curve_fit::{FitError, OpenArc, OpenOutline, Outline};
use freeform_recognise::{Evidence, RecogniseError, RecogniseSettings, Recogniser};
use freeform_sim_camera::BuiltInShape;
use nalgebra::Point2;

use crate::support::{outline, recogniser};

/// The same error for learning and comparing.
fn refusal(outline: &Outline) -> RecogniseError {
    let mut recogniser = recogniser(&[BuiltInShape::Hat]);
    let error = recogniser.compare(outline).expect_err("cannot be compared");
    assert_eq!(recogniser.learn("again", outline), Err(error));
    assert_eq!(recogniser.names().len(), 1);
    error
}

#[test]
fn an_outline_of_which_a_part_is_hidden_is_refused() {
    let points = BuiltInShape::Hat.shape().sample(200, 0.0);
    let arc = OpenArc::new(points[..150].to_vec()).expect("an arc");
    let open = Outline::Open(OpenOutline::new(vec![arc]).expect("arcs"));
    assert_eq!(refusal(&open), RecogniseError::NotWhole);
}

#[test]
fn an_outline_that_encloses_no_region_is_refused() {
    let circle = |k: i32| (std::f64::consts::TAU * f64::from(k) / 200.0).sin_cos();
    let eight = (0..200)
        .map(|k| {
            let (s, c) = circle(k);
            Point2::new(s, s * c)
        })
        .collect();
    assert_eq!(refusal(&Outline::closed(eight).expect("an outline")), RecogniseError::NoRegion);
}

#[test]
fn an_outline_of_too_few_points_is_refused_with_the_reason_of_the_fit() {
    let error = refusal(&outline(BuiltInShape::Square, 4, 0.0));
    assert!(matches!(error, RecogniseError::Fit(FitError::TooFewPoints { .. })), "{error:?}");
}

#[test]
fn settings_outside_their_ranges_are_refused_with_their_values() {
    let default = RecogniseSettings::default();
    for value in [0.0, -1.0, 0.2, f64::NAN, f64::INFINITY] {
        let error = Recogniser::new(RecogniseSettings { tracing: value, ..default }).expect_err("out of range");
        assert!(matches!(error, RecogniseError::Setting { name: "tracing", .. }), "{error:?}");
    }
    for value in [0.0, 1.0, -0.5, f64::NAN] {
        let error = Recogniser::new(RecogniseSettings { unknown: value, ..default }).expect_err("out of range");
        assert!(matches!(error, RecogniseError::Setting { name: "unknown", .. }), "{error:?}");
        assert!(error.to_string().contains(&value.to_string()), "{error}");
    }
}

#[test]
fn before_the_first_frame_and_where_nothing_is_known_there_is_no_answer() {
    let settings = RecogniseSettings::default();
    assert_eq!(Evidence::new().recognition(&settings), None);
    let mut evidence = Evidence::new();
    let comparisons = recogniser(&[]).compare(&outline(BuiltInShape::Hat, 200, 0.0)).expect("a whole outline");
    evidence.add(&comparisons);
    assert_eq!((comparisons.len(), evidence.recognition(&settings)), (0, None));
}
