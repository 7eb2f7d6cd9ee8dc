//! Frames of one object, added up.
use freeform_recognise::{Comparison, Evidence, OutlineFit, RecogniseSettings, Recognition};
use freeform_sim_camera::BuiltInShape;
use nalgebra::Affine2;

use crate::support::{SHAPES, noisy, outline, recogniser};

fn frame(distances: &[Option<f64>]) -> Vec<Comparison> {
    let fit = |distance: f64| OutlineFit { map: Affine2::identity(), distance, expected: 0.01 };
    let compared = |(known, distance): (usize, &Option<f64>)| Comparison {
        known,
        invariant_distance: Some(1.0),
        fit: distance.map(fit),
    };
    distances.iter().enumerate().map(compared).collect()
}

fn told(frames: &[Vec<Comparison>]) -> Recognition {
    let mut evidence = Evidence::new();
    frames.iter().for_each(|frame| evidence.add(frame));
    assert_eq!(evidence.frames(), frames.len());
    evidence.recognition(&RecogniseSettings::default()).expect("frames and known outlines")
}

#[test]
fn the_probabilities_of_all_known_outlines_and_of_none_add_up_to_one() {
    for distance in [0.01, 0.02, 0.021, 0.022, 0.05] {
        let told = told(&[frame(&[Some(distance), Some(0.1), None])]);
        let sum: f64 = told.candidates.iter().map(|candidate| candidate.probability).sum();
        match told.known {
            None => assert!((sum + told.probability - 1.0).abs() < 1e-12, "{distance}: {told:?}"),
            Some(known) => {
                assert_eq!((known, told.candidates[0].probability), (0, told.probability));
                assert!((0.5..=1.0 + 1e-12).contains(&sum), "{distance}: {told:?}");
            }
        }
        assert!(told.candidates.windows(2).all(|two| two[0].probability >= two[1].probability));
    }
}

#[test]
fn a_distance_that_noise_explains_gives_the_name_and_one_that_it_does_not_gives_none() {
    assert_eq!(told(&[frame(&[Some(0.1), Some(0.01)])]).known, Some(1));
    assert_eq!(told(&[frame(&[Some(0.1), Some(0.03)])]).known, None);
    // Noise that was taken for too large is no reason against an outline.
    assert_eq!(told(&[frame(&[Some(0.1), Some(0.001)])]).known, Some(1));
}

#[test]
fn frames_add_up_whatever_their_order_and_make_the_answer_surer() {
    let frames = [frame(&[Some(0.011), Some(0.2)]), frame(&[Some(0.009), Some(0.1)]), frame(&[Some(0.01), None])];
    let backwards: Vec<_> = frames.iter().rev().cloned().collect();
    let (one, all, reversed) = (told(&frames[..1]), told(&frames), told(&backwards));
    assert_eq!((one.known, all.known, reversed.known), (Some(0), Some(0), Some(0)));
    assert!((all.probability - reversed.probability).abs() < 1e-12);
    assert!(all.probability > one.probability, "{} {}", all.probability, one.probability);
    let distance = all.candidates[0].distance.expect("compared");
    let expected = ((0.011_f64.powi(2) + 0.009_f64.powi(2) + 0.01_f64.powi(2)) / 3.0).sqrt();
    assert!((distance - expected).abs() < 1e-12);
}

#[test]
fn an_outline_that_the_invariants_left_out_in_all_frames_is_impossible_and_one_left_out_in_some_is_unlikely() {
    let told_of_one = told(&[frame(&[None, None])]);
    assert_eq!((told_of_one.known, told_of_one.probability), (None, 1.0));
    assert!(told_of_one.candidates.iter().all(|c| c.distance.is_none() && c.map.is_none() && c.probability == 0.0));
    let some = told(&[frame(&[Some(0.01), Some(0.01)]), frame(&[Some(0.01), None])]);
    let probability = |known| some.candidates.iter().find(|c| c.known == known).expect("both").probability;
    assert!(probability(0) > 0.9 && probability(1) < 0.01, "{some:?}");
}

#[test]
fn a_shape_that_one_noisy_frame_leaves_open_is_named_by_ten() {
    let mut recogniser = recogniser(&SHAPES);
    let index = SHAPES.iter().position(|shape| *shape == BuiltInShape::Phone).expect("one of them");
    let mut evidence = Evidence::new();
    for seed in 0..10 {
        let seen = noisy(&outline(BuiltInShape::Phone, 400, 0.1 * seed as f64), 0.008, seed);
        evidence.add(&recogniser.compare(&seen).expect("a whole outline"));
    }
    let recognition = evidence.recognition(recogniser.settings()).expect("ten frames");
    assert_eq!(recognition.known, Some(index), "{recognition:?}");
}

#[test]
fn outlines_that_are_known_to_the_last_bit_are_named_with_certainty() {
    let mut recogniser = recogniser(&SHAPES);
    for (index, shape) in SHAPES.iter().enumerate() {
        let mut evidence = Evidence::new();
        evidence.add(&recogniser.compare(&outline(*shape, 400, 0.0)).expect("a whole outline"));
        let recognition = evidence.recognition(recogniser.settings()).expect("one frame");
        assert_eq!(recognition.known, Some(index), "{recognition:?}");
        assert!(recognition.probability > 0.999, "{recognition:?}");
    }
}
