//! Outlines that are mostly one straight side: little of them shows how far they have gone along it.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_filter::{MotionFilter, Phase, Rejection};
use freeform_riccati::MotionModel;
use nalgebra::{Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::filter_support::filter;

const FRAME_RATE: f64 = 5.0;
/// Where the picture cuts the bar, pixels.
const CUT: f64 = 46.5;
/// Standard deviation of the points, pixels.
const NOISE: f64 = 0.05;

/// The long side of a bar that a border cuts, with its end, 12 pixels high, and a mark of 5 pixels beside the cut; moved along itself. Points err alike
/// in all frames where they lie on the bar alike, as pixels make them.
fn bar(moved: f64, at_rest: bool) -> Outline {
    let error = |number: usize, of: f64| if at_rest { 0.02 * (12.9 * number as f64 + of).sin() } else { 0.0 };
    let side = (0..711).map(|i| Point2::new(46.5 + f64::from(i) + moved, 597.0 + error(i as usize, 0.0)));
    let end = (0..12).map(|i| Point2::new(757.0 + moved + error(i as usize, 1.0), 597.5 + f64::from(i)));
    let mark = (0..36).map(|i| {
        let turn = std::f64::consts::TAU * f64::from(i) / 37.0;
        Point2::new(84.5 + moved + 4.7 * turn.cos(), 604.8 + 4.7 * turn.sin())
    });
    let seen = |points: Vec<Point2<f64>>| -> Vec<_> { points.into_iter().filter(|p| p.x >= CUT).collect() };
    let arcs: Vec<_> = [seen(side.chain(end).collect()), seen(mark.collect())]
        .into_iter()
        .filter_map(|points| OpenArc::new(points).ok())
        .collect();
    let count = arcs.iter().map(|arc| arc.points().len()).sum();
    let outline = Outline::Open(OpenOutline::new(arcs).expect("arcs"));
    outline.with_deviations(vec![NOISE; count]).expect("a deviation for each point")
}

#[test]
fn a_bar_that_a_border_cuts_goes_along_itself_as_its_end_and_its_mark_do() {
    for step in [0.0, 5.0, 13.0, 31.0, 51.0, 90.0, -20.0] {
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..5_u32 {
            let time = f64::from(frame) / FRAME_RATE;
            run.step(time, &bar(step * f64::from(frame), step == 0.0)).expect("increasing times");
        }
        let moved = run.pose().expect("a pose").matrix()[(0, 2)];
        assert!((moved - 4.0 * step).abs() < 0.5, "{step} pixels in a frame: {moved} after four");
    }
}

/// What a picture shows of a bar, bent along a large circle, that goes to the right by so many pixels from frame to frame. Its left end is out of it;
/// so is the right one, or it is this far to the right of the middle of the picture in the first frame.
fn bent_bar(frame: u32, step: f64, right_end: Option<f64>) -> Outline {
    const RADIUS: f64 = 6000.0;
    const MIDDLE: f64 = 150.0;
    let moved = step * f64::from(frame);
    let error = |number: f64, of: f64| NOISE * (12.9 * number + 31.0 * f64::from(frame * frame) + of).sin();
    // Points are seen at other places of the bar in each frame.
    let side = |radius: f64| {
        let places = (0..150).map(move |i| 2.0 * f64::from(i) + (1.7 * f64::from(frame)).rem_euclid(2.0));
        let seen = places.filter(move |x| right_end.is_none_or(|end| *x < MIDDLE + end + moved));
        seen.map(move |x| {
            let height = (radius.powi(2) - (x - MIDDLE - moved).powi(2)).sqrt() - RADIUS;
            Point2::new(x, height + error(0.5 * x, radius))
        })
    };
    let arc = |points: Vec<Point2<f64>>| OpenArc::new(points).expect("an arc");
    let [outer, inner] = [RADIUS + 20.0, RADIUS - 20.0];
    let arcs = match right_end {
        None => vec![arc(side(outer).collect()), arc(side(inner).collect())],
        Some(end) => {
            // Over 100 pixels the circle falls by less than a pixel.
            let heights = (0..20).map(|i| 19.0 - 2.0 * f64::from(i));
            let across = heights.map(|height| Point2::new(MIDDLE + end + moved + error(height, 3.0), height));
            let back: Vec<_> = side(inner).collect();
            vec![arc(side(outer).chain(across).chain(back.into_iter().rev()).collect())]
        }
    };
    Outline::Open(OpenOutline::new(arcs).expect("arcs"))
}

/// A filter that has taken a second of such a bar.
fn bent_bar_followed(step: f64, right_end: Option<f64>) -> MotionFilter {
    let mut run = filter(MotionModel::Rigid);
    for frame in 0..30_u32 {
        run.step(f64::from(frame) / 30.0, &bent_bar(frame, step, right_end)).expect("increasing times");
    }
    assert_eq!((run.phase(), run.ambiguity()), (Phase::Tracking, None));
    run
}

#[test]
fn how_fast_a_bent_bar_goes_along_itself_is_not_stated_of_its_middle_where_no_end_shows_it() {
    let run = bent_bar_followed(4.4, None);
    assert!(run.estimate().expect("a motion").parameters().any(|parameter| parameter.value.is_none()));
    assert_eq!(run.velocity().map(|velocity| velocity.velocity), None);
}

#[test]
fn how_fast_a_bent_bar_goes_along_itself_is_stated_where_an_end_shows_it() {
    let velocity = bent_bar_followed(4.4, Some(-20.0)).velocity().expect("a velocity");
    let (error, deviations) = (velocity.velocity - Vector2::new(132.0, 0.0), velocity.standard_deviations());
    assert!(deviations.max() < 1.0 && error.component_div(&deviations).amax() < 4.0, "{error} +- {deviations}");
}

/// A bar of 120 by 20 pixels that lies still for so many frames, and then goes along itself; every frame has its own points and its own noise.
fn starting_bar(frame: u32, rests_for: u32, step: f64, rng: &mut ChaCha8Rng) -> Outline {
    let moved = step * f64::from((frame + 1).saturating_sub(rests_for));
    let begun_at: f64 = rng.random_range(0.0..1.0);
    let (length, height) = (120.0, 20.0);
    let corners =
        [(0.0, 0.0, 1.0, 0.0), (length, 0.0, 0.0, 1.0), (length, height, -1.0, 0.0), (0.0, height, 0.0, -1.0)];
    let sides = corners.into_iter().zip([length, height, length, height]);
    let points = sides.flat_map(|((x, y, dx, dy), side)| {
        (0..side as u32).map(move |i| {
            let along = f64::from(i) + begun_at;
            Point2::new(x + dx * along, y + dy * along)
        })
    });
    let noise = Normal::new(0.0, NOISE).expect("a deviation");
    let seen = points.map(|p| p + Vector2::new(moved + noise.sample(rng), noise.sample(rng)));
    Outline::closed(seen.collect()).expect("a bar")
}

#[test]
fn a_bar_that_starts_along_itself_is_seen_elsewhere_and_its_rest_is_not_stated_any_more() {
    const RESTS_FOR: u32 = 15;
    let (mut elsewhere, mut stated) = (0, 0);
    for (step, seed) in [(3.0, 0), (4.0, 1), (-6.0, 2), (8.0, 3), (15.0, 4), (-30.0, 5)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut run = filter(MotionModel::Rigid);
        for frame in 0..RESTS_FOR + 6 {
            let outline = starting_bar(frame, RESTS_FOR, step, &mut rng);
            let taken = run.step(f64::from(frame) / FRAME_RATE, &outline).expect("increasing times");
            if frame < RESTS_FOR {
                assert!(taken.is_accepted(), "{step}, frame {frame}");
                continue;
            }
            if frame == RESTS_FOR {
                match taken.rejection {
                    None => assert_eq!(taken.phase, Phase::Acquiring, "{step}"),
                    Some(Rejection::Elsewhere { distance }) => {
                        elsewhere += 1;
                        assert!((distance - step.abs()).abs() < 0.3, "{step}: {distance}");
                    }
                    Some(other) => panic!("{step}: {other}"),
                }
            }
            let Some(estimate) = run.estimate() else { continue };
            let along = estimate.parameters().find(|parameter| parameter.name == "b1").expect("a velocity");
            if let Some((value, deviation)) = along.value.zip(along.standard_deviation) {
                let off = (value - step * FRAME_RATE).abs();
                assert!(off < 4.0 * deviation, "{step}, frame {frame}: {value} +- {deviation}");
                stated += u32::from(frame == RESTS_FOR + 5);
            }
        }
    }
    assert!(elsewhere > 0 && stated >= 5, "{elsewhere} {stated}");
}
