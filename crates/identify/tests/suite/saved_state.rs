//! An identifier saved and restored goes on as before to the last bit, and no bytes make one that cannot be worked with.
use crate::adaptive_support::{AFFINE, PROJECTIVE, RIGID, SIMILARITY, even_times, starting_lines};
use freeform_decompose::Line;
use freeform_estimate::StateFormat;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, StateError};
use freeform_riccati::{MotionModel, line_flow};
use nalgebra::Vector2;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const LAWS: [AdaptiveLaw; 3] = [AdaptiveLaw::Structured, AdaptiveLaw::Printed, AdaptiveLaw::FilteredLeastSquares];
const PAIRS: [PairChoice; 3] = [PairChoice::All, PairChoice::Best, PairChoice::Given(1)];

/// The header as it stands in the bytes.
const FORMAT: StateFormat = StateFormat { version: 1, kind: *b"adap", name: "adaptive identifier" };
const HEADER: usize = 16;

fn settings() -> impl Iterator<Item = AdaptiveSettings> {
    let all = MotionModel::ALL.into_iter().flat_map(|model| LAWS.map(|law| (model, law)));
    let all = all.filter(|(model, law)| (*model, *law) != (MotionModel::Projective, AdaptiveLaw::Printed));
    all.flat_map(|(model, law)| PAIRS.map(|pairs| AdaptiveSettings { model, law, pairs, ..Default::default() }))
}

/// Lines of a constant motion of a model, each time with its own.
fn frames(model: MotionModel) -> Vec<(f64, Vec<Line>)> {
    let motion: &[f64] = match model {
        MotionModel::Rigid => &RIGID,
        MotionModel::Similarity => &SIMILARITY,
        MotionModel::Affine => &AFFINE,
        MotionModel::Projective => &PROJECTIVE,
    };
    let generator = model.generator(motion);
    let lines = |time: f64| {
        starting_lines().iter().map(|line| line_flow(&generator, line, time).expect("complex lines stay").0).collect()
    };
    even_times(1.0, 30.0).into_iter().map(|time| (time, lines(time))).collect()
}

fn saved(settings: AdaptiveSettings, count: usize) -> Vec<u8> {
    let frames = frames(settings.model);
    let mut identifier = AdaptiveIdentifier::new(settings).expect("settings");
    frames[..count].iter().for_each(|(time, lines)| identifier.step(*time, lines).expect("a good frame"));
    identifier.to_bytes().expect("memory takes it")
}

/// What an identifier says of itself; debug text of a number is exact.
fn told(identifier: &AdaptiveIdentifier) -> String {
    let counts = (identifier.frames(), identifier.intervals_followed(), identifier.pair_count());
    let pairs = (identifier.chosen_pair(), identifier.rotation_content(1), identifier.is_observable());
    format!("{:?} {counts:?} {pairs:?}", identifier.estimate())
}

#[test]
fn a_restored_identifier_goes_on_to_the_last_bit_for_every_model_law_and_choice_of_pairs() {
    for settings in settings() {
        let identifier = || AdaptiveIdentifier::new(settings.clone()).expect("settings");
        let (mut straight, mut interrupted) = (identifier(), identifier());
        for (index, (time, lines)) in frames(settings.model).iter().enumerate() {
            interrupted =
                AdaptiveIdentifier::from_bytes(&interrupted.to_bytes().expect("memory")).expect("a saved state");
            for identifier in [&mut straight, &mut interrupted] {
                identifier.step(*time, lines).expect("a good frame");
                if index % 10 == 9 {
                    identifier.shift_origin(Vector2::new(0.1, 2.0));
                }
            }
            assert_eq!(told(&interrupted), told(&straight), "{settings:?}, frame {index}");
            assert_eq!(interrupted.to_bytes(), straight.to_bytes());
        }
        assert!(straight.estimate().is_some_and(|estimate| estimate.is_finite()));
    }
}

#[test]
fn after_a_frame_that_is_refused_a_restored_identifier_is_as_the_saved_one() {
    let mut straight = AdaptiveIdentifier::from_bytes(&saved(AdaptiveSettings::default(), 10)).expect("a saved state");
    let before = straight.to_bytes();
    assert!(straight.step(0.0, &starting_lines()).is_err());
    assert!(straight.step(1.0, &starting_lines()[..1]).is_err());
    assert_eq!(straight.to_bytes(), before);
}

#[test]
fn bytes_cut_off_added_changed_or_of_another_version_or_kind_are_refused() {
    let bytes = saved(AdaptiveSettings::default(), 10);
    assert!((300..5000).contains(&bytes.len()), "{}", bytes.len());
    let error = |bytes: &[u8]| AdaptiveIdentifier::from_bytes(bytes).err();
    for length in 0..bytes.len() {
        let expected =
            if length < 16 { StateError::TooShort { found: length, needed: 16 } } else { StateError::Damaged };
        assert_eq!(error(&bytes[..length]), Some(expected), "{length} bytes");
    }
    for place in 8..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x10;
        assert_eq!(error(&changed), Some(StateError::Damaged), "byte {place}");
    }
    assert_eq!(error(&[&bytes[..], &[0]].concat()), Some(StateError::Damaged));
    let mut later = bytes.clone();
    later[0] += 1;
    assert_eq!(error(&later), Some(StateError::Version { found: 2, supported: 1 }));
    let other = StateFormat { kind: *b"else", ..FORMAT }.with_header(&bytes[HEADER..]);
    assert_eq!(error(&other), Some(StateError::Kind { expected: "adaptive identifier" }));
    let longer = FORMAT.with_header(&[&bytes[HEADER..], &[0]].concat());
    assert_eq!(error(&longer), Some(StateError::Inconsistent { part: "bytes left over" }));
}

#[test]
fn forged_states_are_refused_or_can_be_worked_with() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut accepted, mut refused) = (0, 0);
    for settings in settings() {
        let (bytes, frames) = (saved(settings.clone(), 12), frames(settings.model));
        for _ in 0..60 {
            let mut state = bytes[HEADER..].to_vec();
            for _ in 0..rng.random_range(1..4) {
                let place = rng.random_range(0..state.len());
                match rng.random_range(0..3) {
                    0 => state[place] = rng.random(),
                    1 => state[place] ^= 1 << rng.random_range(0..8),
                    _ => state[place..(place + 8).min(bytes.len() - HEADER)].fill([0, 255][rng.random_range(0..2)]),
                }
            }
            let Ok(mut identifier) = AdaptiveIdentifier::from_bytes(&FORMAT.with_header(&state)) else {
                refused += 1;
                continue;
            };
            accepted += 1;
            for (time, lines) in &frames[12..] {
                // Any answer will do that is a number.
                let _ = identifier.step(*time, lines);
                assert!(identifier.estimate().is_none_or(|estimate| estimate.is_finite()));
                let _ = (identifier.is_observable(), identifier.chosen_pair(), identifier.rotation_content(0));
            }
        }
    }
    assert!(accepted > 100 && refused > 100, "{accepted} {refused}");
}
