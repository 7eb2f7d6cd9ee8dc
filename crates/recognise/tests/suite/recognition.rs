//! What is recognised under affine maps, and what is not.
use freeform_curve_fit::Outline;
use freeform_recognise::{Evidence, OutlineFit, RecogniseSettings, Recogniser, Recognition};
use freeform_sim_camera::BuiltInShape;
use nalgebra::{Affine2, Point2};
use proptest::prelude::*;

use crate::support::{SHAPES, any_affine, noisy, outline, recogniser, reversed};

/// What one frame tells.
fn recognised(recogniser: &mut Recogniser, seen: &Outline) -> Recognition {
    let mut evidence = Evidence::new();
    evidence.add(&recogniser.compare(seen).expect("a whole outline"));
    evidence.recognition(recogniser.settings()).expect("one frame")
}

/// Largest distance of points of a shape, moved by the map that was found, from the shape as it was moved, in its diameters before.
fn largest_distance(shape: BuiltInShape, found: &Affine2<f64>, truth: &Affine2<f64>) -> f64 {
    let dense = shape.shape().sample(4000, 0.0);
    let back = truth.inverse() * found;
    let distance = |p: &Point2<f64>| {
        let p = back * p;
        dense.iter().map(|q| (q - p).norm()).fold(f64::INFINITY, f64::min)
    };
    dense.iter().step_by(20).map(distance).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_shape_is_recognised_under_every_affine_map_whatever_point_it_begins_with_and_whichever_way_round(
        index in 0..SHAPES.len(), map in any_affine(), begin in 0.0..1.0_f64, backwards in any::<bool>(), seed in any::<u64>(),
    ) {
        let seen = noisy(&outline(SHAPES[index], 350, begin), 0.002, seed).moved(&map).expect("a regular map");
        let seen = if backwards { reversed(&seen) } else { seen };
        let recognition = recognised(&mut recogniser(&SHAPES), &seen);
        prop_assert_eq!(recognition.known, Some(index));
        prop_assert!(recognition.probability > 0.9, "{}", recognition.probability);
        let found = recognition.candidates[0].map.expect("compared");
        let distance = largest_distance(SHAPES[index], &found, &map);
        prop_assert!(distance < 0.01, "{}: {distance}", SHAPES[index]);
    }

    #[test]
    fn an_outline_that_is_not_among_the_known_has_no_name(
        index in 0..SHAPES.len(), map in any_affine(), begin in 0.0..1.0_f64, seed in any::<u64>(),
    ) {
        let others: Vec<_> = SHAPES.into_iter().filter(|shape| *shape != SHAPES[index]).collect();
        let seen = noisy(&outline(SHAPES[index], 350, begin), 0.002, seed).moved(&map).expect("a regular map");
        let recognition = recognised(&mut recogniser(&others), &seen);
        prop_assert_eq!(recognition.known, None);
        prop_assert!(recognition.probability > 0.9, "{}", recognition.probability);
    }

    #[test]
    fn distances_do_not_depend_on_the_affine_map_between(
        index in 0..SHAPES.len() - 1, other in 0..SHAPES.len() - 1, map in any_affine(), seed in any::<u64>(),
    ) {
        // The circle is left out: where its lines lie is a matter of rounding.
        let mut recogniser = recogniser(&[SHAPES[other]]);
        let still = noisy(&outline(SHAPES[index], 300, 0.0), 0.002, seed);
        let moved = still.moved(&map).expect("a regular map");
        let mut of = |seen: &Outline| recogniser.compare(seen).expect("a whole outline")[0];
        let (still, moved) = (of(&still), of(&moved));
        if let (Some(a), Some(b)) = (still.invariant_distance, moved.invariant_distance) {
            prop_assert!((a - b).abs() < 1e-3 * a.max(1.0), "{a} {b}");
        }
        let (OutlineFit { distance: a, expected: s, .. }, OutlineFit { distance: b, expected: t, .. }) =
            (still.fit.expect("the only one"), moved.fit.expect("the only one"));
        prop_assert!((a - b).abs() < 1e-6 + 1e-3 * a, "{a} {b}");
        prop_assert!((s - t).abs() < 1e-9 + 1e-6 * s, "{s} {t}");
    }
}

/// Where tracing is next to exact, what is left between the invariants of two frames is their noise: the square of their distance
/// would be chi-square with three degrees of freedom (four values of unit length), whose median is 2.37. The deviations are of
/// first order and one or two times too small.
#[test]
fn the_invariant_distance_of_the_outline_shown_is_that_of_noise_within_a_factor_of_two() {
    let settings = RecogniseSettings { tracing: 1e-5, ..RecogniseSettings::default() };
    for shape in [BuiltInShape::Plane, BuiltInShape::Hat, BuiltInShape::Glider, BuiltInShape::Bird] {
        let mut distances: Vec<f64> = (0..60)
            .map(|seed| {
                let mut recogniser = Recogniser::new(settings).expect("good settings");
                let [known, seen] = [0, 1].map(|k| noisy(&outline(shape, 400, 0.0), 0.0005, 2 * seed + k));
                recogniser.learn("known", &known).expect("a whole outline");
                let distance = recogniser.compare(&seen).expect("a whole outline")[0].invariant_distance;
                distance.expect("separate lines")
            })
            .collect();
        distances.sort_by(f64::total_cmp);
        let ratio = distances[30] / 2.37_f64.sqrt();
        assert!((0.8..2.0).contains(&ratio), "{shape}: {ratio}");
    }
}

#[test]
fn outliers_lead_to_no_name_rather_than_to_a_wrong_one() {
    let mut recogniser = recogniser(&SHAPES);
    for (index, shape) in SHAPES.into_iter().enumerate() {
        let mut points: Vec<Point2<f64>> = outline(shape, 400, 0.0).points().copied().collect();
        points.iter_mut().step_by(20).for_each(|p| *p *= 1.4);
        let known = recognised(&mut recogniser, &Outline::closed(points).expect("an outline")).known;
        assert!(known.is_none_or(|known| known == index), "{shape}: {known:?}");
    }
}

#[test]
fn outlines_that_an_affine_map_takes_to_each_other_share_the_probability() {
    let shapes = [BuiltInShape::Ellipse, BuiltInShape::Hat, BuiltInShape::Circle];
    let seen = noisy(&outline(BuiltInShape::Circle, 300, 0.0), 0.002, 5);
    let recognition = recognised(&mut recogniser(&shapes), &seen);
    assert!(matches!(recognition.known, Some(0 | 2)), "{recognition:?}");
    let probability =
        |known| recognition.candidates.iter().find(|c| c.known == known).expect("one of each").probability;
    assert!(probability(0) > 0.1 && probability(2) > 0.1 && probability(1) < 0.01, "{recognition:?}");
    assert!(probability(0) + probability(2) > 0.95);
}

#[test]
fn a_recogniser_that_has_learnt_an_outline_twice_knows_two_of_one_name() {
    let recogniser = recogniser(&[BuiltInShape::Hat, BuiltInShape::Hat]);
    assert_eq!(recogniser.names().collect::<Vec<_>>(), ["hat", "hat"]);
}
