//! Bad settings and bad frames, and what is left after them.
use crate::adaptive_support::{RIGID, even_times, run, starting_lines};
use freeform_estimate::TimeNotIncreasing;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, IdentifyError, PairChoice};
use freeform_riccati::MotionModel;
use nalgebra::Matrix4;

fn refused(settings: AdaptiveSettings) -> IdentifyError {
    AdaptiveIdentifier::new(settings).expect_err("bad settings")
}

#[test]
fn bad_settings_are_refused_with_the_reason() {
    let default = AdaptiveSettings::default;
    let error = refused(AdaptiveSettings { stability: Matrix4::identity(), ..default() });
    assert!(matches!(error, IdentifyError::NotStable { real_part } if (real_part - 1.0).abs() < 1e-12), "{error}");
    let error = refused(AdaptiveSettings { definite: -Matrix4::identity(), ..default() });
    assert_eq!(error, IdentifyError::NotPositiveDefinite { smallest: -1.0 });
    let law = AdaptiveLaw::Printed;
    let error = refused(AdaptiveSettings { model: MotionModel::Projective, law, ..default() });
    assert_eq!(error, IdentifyError::UnsupportedModel { model: MotionModel::Projective });
    let error = refused(AdaptiveSettings { initial_values: vec![1.0], ..default() });
    assert_eq!(error, IdentifyError::WrongInitialValueCount { needed: 3, found: 1 });
    let error = refused(AdaptiveSettings { initial_values: vec![1.0, 0.0, f64::NAN], ..default() });
    assert_eq!(error, IdentifyError::InitialValueNotFinite { index: 2 });
}

#[test]
fn bad_frames_are_refused_with_the_reason_and_change_nothing() {
    let lines = starting_lines();
    let mut identifier = AdaptiveIdentifier::new(AdaptiveSettings::default()).expect("settings");
    assert_eq!(identifier.step(0.0, &[]), Err(IdentifyError::NoSuchPair { index: 0, count: 0 }));
    assert!(matches!(identifier.step(f64::NAN, &lines), Err(IdentifyError::TimeNotIncreasing(_))));
    assert_eq!((identifier.pair_count(), identifier.estimate()), (0, None));
    run(&mut identifier, &lines, &RIGID, &even_times(1.0, 30.0), 0.0);
    let before = identifier.estimate();
    let error = identifier.step(1.0, &lines);
    assert_eq!(error, Err(IdentifyError::TimeNotIncreasing(TimeNotIncreasing { time: 1.0, previous: 1.0 })));
    assert!(identifier.step(f64::NAN, &lines).is_err());
    assert!(identifier.step(f64::INFINITY, &lines).is_err());
    assert_eq!(identifier.step(2.0, &lines[..1]), Err(IdentifyError::PairCountChanged { expected: 2, found: 1 }));
    assert_eq!(identifier.estimate(), before);
    let given = AdaptiveSettings { pairs: PairChoice::Given(2), ..AdaptiveSettings::default() };
    let mut identifier = AdaptiveIdentifier::new(given).expect("settings");
    assert_eq!(identifier.step(0.0, &lines), Err(IdentifyError::NoSuchPair { index: 2, count: 2 }));
}

#[test]
fn the_pair_chosen_is_the_one_asked_for() {
    for (pairs, chosen) in [(PairChoice::All, None), (PairChoice::Given(1), Some(1))] {
        let settings = AdaptiveSettings { pairs, ..AdaptiveSettings::default() };
        let mut identifier = AdaptiveIdentifier::new(settings).expect("settings");
        run(&mut identifier, &starting_lines(), &RIGID, &even_times(1.0, 30.0), 0.0);
        assert_eq!(identifier.chosen_pair(), chosen);
        assert!((identifier.rotation_content(0) - 0.5).abs() < 1e-12);
        assert!(identifier.is_observable());
    }
}
