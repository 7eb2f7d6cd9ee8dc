//! The three laws over line pairs that move exactly.
use crate::adaptive_support::{
    AFFINE, PROJECTIVE, RIGID, SIMILARITY, even_times, parameters_after, run, starting_lines,
};
use freeform_decompose::Line;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice};
use freeform_riccati::{MotionModel, line_flow};
use nalgebra::{Affine2, Translation2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;

const LAWS: [AdaptiveLaw; 3] = [AdaptiveLaw::Printed, AdaptiveLaw::Structured, AdaptiveLaw::FilteredLeastSquares];

fn distance(found: &[f64], truth: &[f64]) -> f64 {
    let size = truth.iter().map(|t| t * t).sum::<f64>().sqrt();
    found.iter().zip(truth).map(|(f, t)| (f - t).powi(2)).sum::<f64>().sqrt() / size
}

#[test]
fn the_structured_law_converges_to_a_rigid_motion_over_any_choice_of_pairs() {
    for pairs in [PairChoice::All, PairChoice::Best, PairChoice::Given(0), PairChoice::Given(1)] {
        let settings = AdaptiveSettings { pairs, ..AdaptiveSettings::default() };
        let found = parameters_after(&settings, &RIGID, &even_times(60.0, 30.0));
        println!("{pairs:?}: {}", distance(&found, &RIGID));
        assert!(distance(&found, &RIGID) < 0.01, "{pairs:?}: {found:?}");
    }
}

#[test]
fn the_structured_law_converges_to_a_growing_turning_motion() {
    let settings = AdaptiveSettings { model: MotionModel::Similarity, ..AdaptiveSettings::default() };
    let found = parameters_after(&settings, &SIMILARITY, &even_times(60.0, 30.0));
    println!("{}", distance(&found, &SIMILARITY));
    assert!(distance(&found, &SIMILARITY) < 0.02, "{found:?}");
}

#[test]
fn the_structured_law_converges_to_an_affine_motion() {
    let settings = AdaptiveSettings { model: MotionModel::Affine, ..AdaptiveSettings::default() };
    let found = parameters_after(&settings, &AFFINE, &even_times(120.0, 30.0));
    println!("{}", distance(&found, &AFFINE));
    assert!(distance(&found, &AFFINE) < 0.02, "{found:?}");
}

#[test]
fn two_laws_converge_to_a_projective_motion_over_exact_lines() {
    for (law, seconds) in [(AdaptiveLaw::Structured, 400.0), (AdaptiveLaw::FilteredLeastSquares, 3.0)] {
        let settings = AdaptiveSettings { model: MotionModel::Projective, law, ..AdaptiveSettings::default() };
        let found = parameters_after(&settings, &PROJECTIVE, &even_times(seconds, 30.0));
        println!("{law:?} {}", distance(&found, &PROJECTIVE));
        assert!(distance(&found, &PROJECTIVE) < 0.02, "{law:?}: {found:?}");
    }
}

#[test]
fn filtered_least_squares_settles_to_two_percent_within_half_a_second() {
    let law = AdaptiveLaw::FilteredLeastSquares;
    let rigid = AdaptiveSettings { law, ..AdaptiveSettings::default() };
    let found = parameters_after(&rigid, &RIGID, &even_times(0.5, 30.0));
    println!("rigid {}", distance(&found, &RIGID));
    assert!(distance(&found, &RIGID) < 0.02, "{found:?}");
}

#[test]
fn the_true_motion_is_a_fixed_point_of_every_law() {
    let models = [
        (MotionModel::Rigid, &RIGID[..]),
        (MotionModel::Similarity, &SIMILARITY[..]),
        (MotionModel::Affine, &AFFINE[..]),
        (MotionModel::Projective, &PROJECTIVE[..]),
    ];
    for (model, truth) in models {
        for law in LAWS {
            if law == AdaptiveLaw::Printed && model == MotionModel::Projective {
                continue;
            }
            let settings =
                AdaptiveSettings { model, law, initial_values: truth.to_vec(), ..AdaptiveSettings::default() };
            let found = parameters_after(&settings, truth, &even_times(10.0, 200.0));
            println!("{law:?} {model}: {}", distance(&found, truth));
            assert!(distance(&found, truth) < 2e-3, "{law:?} {model}: {found:?}");
        }
    }
}

#[test]
fn the_printed_law_is_far_from_a_motion_that_the_structured_law_has_found_and_finds_it_in_half_an_hour() {
    for pairs in [PairChoice::Given(0), PairChoice::Given(1)] {
        let after = |law, seconds| {
            let settings = AdaptiveSettings { law, pairs, ..AdaptiveSettings::default() };
            distance(&parameters_after(&settings, &RIGID, &even_times(seconds, 30.0)), &RIGID)
        };
        let structured = after(AdaptiveLaw::Structured, 30.0);
        let (soon, late) = (after(AdaptiveLaw::Printed, 30.0), after(AdaptiveLaw::Printed, 1800.0));
        println!("{pairs:?}: structured {structured}, printed {soon}, after 1800 s {late}");
        assert!(structured < 0.05 && soon > 0.1, "{pairs:?}: {structured} {soon}");
        assert!(late < 0.05, "{pairs:?}: {late}");
    }
}

#[test]
fn a_fifth_of_the_frames_may_be_missing_and_times_may_be_uneven() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let mut times = even_times(60.0, 30.0);
    times.retain(|_| rng.random::<f64>() >= 0.2);
    times.iter_mut().for_each(|time| *time += 0.01 * rng.random::<f64>());
    for (law, seconds) in [(AdaptiveLaw::Structured, 60.0), (AdaptiveLaw::FilteredLeastSquares, 2.0)] {
        let settings = AdaptiveSettings { law, ..AdaptiveSettings::default() };
        let times: Vec<f64> = times.iter().copied().filter(|time| *time < seconds).collect();
        let found = parameters_after(&settings, &RIGID, &times);
        println!("{law:?}: {}", distance(&found, &RIGID));
        assert!(distance(&found, &RIGID) < 0.02, "{law:?}: {found:?}");
    }
}

#[test]
fn a_law_keeps_its_estimate_where_its_origin_moves() {
    let origin = Vector2::new(0.7, -1.3);
    let old_from_new = nalgebra::convert::<_, Affine2<f64>>(Translation2::from(origin));
    let models = [
        (MotionModel::Rigid, &RIGID[..]),
        (MotionModel::Affine, &AFFINE[..]),
        (MotionModel::Projective, &PROJECTIVE[..]),
    ];
    for (model, truth) in models {
        // The numbers of the printed law need not belong to any motion: they have a test of their own.
        for law in [AdaptiveLaw::Structured, AdaptiveLaw::FilteredLeastSquares] {
            let settings = AdaptiveSettings { model, law, ..AdaptiveSettings::default() };
            let mut identifier = AdaptiveIdentifier::new(settings).expect("settings");
            run(&mut identifier, &starting_lines(), truth, &even_times(3.0, 30.0), 0.0);
            let before = identifier.estimate().expect("an estimate");
            identifier.shift_origin(origin);
            let after = identifier.estimate().expect("an estimate").in_coordinates(&old_from_new);
            assert!(distance(after.values(), before.values()) < 1e-9, "{law:?} {model}: {before:?} and {after:?}");
        }
    }
}

#[test]
fn the_structured_law_finds_no_rotation_in_an_object_that_only_travels_when_its_origin_follows() {
    let motion = [0.0, 0.4, 0.3];
    let generator = MotionModel::Rigid.generator(&motion);
    let mut identifier = AdaptiveIdentifier::new(AdaptiveSettings::default()).expect("settings");
    let mut origin = Vector2::zeros();
    for time in even_times(60.0, 30.0) {
        // Where the object is by now.
        let place = Vector2::new(motion[1], motion[2]) * time;
        if (place - origin).norm() > 1.0 {
            identifier.shift_origin(place - origin);
            origin = place;
        }
        let lines = starting_lines().map(|line| {
            let Line { l, k } = line_flow(&generator, &line, time).expect("complex lines stay").0;
            Line { l, k: k + l * origin.y + origin.x }
        });
        identifier.step(time, &lines).expect("a good frame");
    }
    let found = identifier.estimate().expect("an estimate");
    assert!(distance(found.values(), &motion) < 0.01, "{found:?}");
}

#[test]
fn the_origin_of_time_does_not_matter() {
    for law in LAWS {
        let settings = AdaptiveSettings { law, ..AdaptiveSettings::default() };
        let lines = starting_lines();
        let mut now = AdaptiveIdentifier::new(settings.clone()).expect("settings");
        let mut later = AdaptiveIdentifier::new(settings).expect("settings");
        run(&mut now, &lines, &RIGID, &even_times(5.0, 32.0), 0.0);
        run(&mut later, &lines, &RIGID, &even_times(5.0, 32.0), 1024.0);
        let (now, later) = (now.estimate().expect("an estimate"), later.estimate().expect("an estimate"));
        assert!(distance(now.values(), later.values()) < 1e-12, "{law:?}: {now:?} and {later:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn every_start_leads_to_the_same_motion(start in prop::array::uniform3(-2.0..2.0_f64)) {
        for (law, seconds) in [(AdaptiveLaw::Structured, 80.0), (AdaptiveLaw::FilteredLeastSquares, 2.0)] {
            let settings = AdaptiveSettings { law, initial_values: start.to_vec(), ..AdaptiveSettings::default() };
            let found = parameters_after(&settings, &RIGID, &even_times(seconds, 30.0));
            prop_assert!(distance(&found, &RIGID) < 0.02, "{:?} from {:?}: {:?}", law, start, found);
        }
    }
}
