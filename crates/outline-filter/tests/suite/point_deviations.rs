//! What points state of themselves: how they count by it, and what it may not do where it is wrong.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_filter::{FilterSettings, FilterStep, MotionFilter};
use nalgebra::{Isometry2, Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

const OMEGA: f64 = 1.2;
const NOISE: f64 = 0.005;
const POINTS: u32 = 240;

/// A point of the outline about its middle, and the normal there.
fn place(angle: f64) -> (Point2<f64>, Vector2<f64>) {
    let radius = 1.0 + 0.14 * (2.0 * angle).cos() + 0.1 * (3.0 * angle + 0.5).sin();
    let slope = -0.28 * (2.0 * angle).sin() + 0.3 * (3.0 * angle + 0.5).cos();
    let (sin, cos) = angle.sin_cos();
    let tangent = Vector2::new(slope * cos - radius * sin, slope * sin + radius * cos);
    (Point2::new(radius * cos, radius * sin), Vector2::new(tangent.y, -tangent.x).normalize())
}

/// What of a point is noise and what it states, by the frame, its angle on the body and a random number.
type Law = fn(u32, f64, f64) -> (f64, f64);

/// Outlines of a body that turns, each with the deviations stated.
fn frames(seed: u64, count: u32, law: Law) -> Vec<(f64, Outline, Vec<f64>)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let frame = |frame: u32| {
        let time = f64::from(frame) / 30.0;
        let pose = Isometry2::new(Vector2::new(0.3, -0.2), -OMEGA * time);
        let start: f64 = rng.random();
        let (mut points, mut stated) = (Vec::new(), Vec::new());
        for i in 0..POINTS {
            let angle = std::f64::consts::TAU * (f64::from(i) + start) / f64::from(POINTS);
            let (noise, states) = law(frame, angle, rng.random());
            let (point, normal) = place(angle);
            let error: f64 = StandardNormal.sample(&mut rng);
            points.push(pose * (point + noise * error * normal));
            stated.push(states);
        }
        (time, Outline::closed(points).expect("an outline"), stated)
    };
    (0..count).map(frame).collect()
}

fn followed<'a>(frames: impl IntoIterator<Item = (f64, &'a Outline)>) -> (MotionFilter, Vec<FilterStep>) {
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
    let steps = frames.into_iter().map(|(time, outline)| filter.step(time, outline).expect("a frame")).collect();
    (filter, steps)
}

fn stating(frames: &[(f64, Outline, Vec<f64>)], factor: f64) -> Vec<(f64, Outline)> {
    let of_frame = |(time, outline, stated): &(f64, Outline, Vec<f64>)| {
        let stated = stated.iter().map(|deviation| factor * deviation).collect();
        (*time, outline.clone().with_deviations(stated).expect("deviations"))
    };
    frames.iter().map(of_frame).collect()
}

/// Text of all that is stated, exact.
fn told(filter: &MotionFilter, steps: &[FilterStep]) -> String {
    format!("{:?} {:?} {:?} {steps:?}", filter.estimate(), filter.state(), filter.noise())
}

#[test]
fn points_that_all_state_the_same_count_as_those_that_state_nothing_and_a_factor_does_not_matter() {
    let alike = frames(1, 20, |_, _, _| (NOISE, 0.3));
    let (filter, steps) = followed(alike.iter().map(|(time, outline, _)| (*time, outline)));
    let nothing = told(&filter, &steps);
    let with = stating(&alike, 1.0);
    let (filter, steps) = followed(with.iter().map(|(time, outline)| (*time, outline)));
    assert_eq!(told(&filter, &steps), nothing);

    let various = frames(2, 20, |_, _, random| (NOISE * (0.5 + random), NOISE * (0.5 + random)));
    let [one, other] = [1.0, 1.0 / 64.0].map(|factor| {
        let with = stating(&various, factor);
        let (filter, steps) = followed(with.iter().map(|(time, outline)| (*time, outline)));
        told(&filter, &steps)
    });
    assert_eq!(one, other);
}

/// Root mean square error of omega, and that in stated deviations, over some runs of 24 frames.
fn errors(runs: u64, law: Law, is_stated: bool) -> (f64, f64) {
    let (mut squares, mut normalised) = (0.0, 0.0);
    for seed in 0..runs {
        let frames = frames(100 + seed, 24, law);
        let with = stating(&frames, 1.0);
        let outlines: Vec<_> = match is_stated {
            true => with.iter().map(|(time, outline)| (*time, outline)).collect(),
            false => frames.iter().map(|(time, outline, _)| (*time, outline)).collect(),
        };
        let (filter, steps) = followed(outlines);
        assert!(steps.iter().filter(|step| step.is_accepted()).count() >= 20, "{steps:?}");
        let omega = filter.estimate().and_then(|estimate| estimate.parameters().next()).expect("omega");
        let (value, deviation) = omega.value.zip(omega.standard_deviation).expect("a turn that is seen");
        squares += (value - OMEGA).powi(2);
        // A deviation that is too large hides none that is too small.
        normalised += ((value - OMEGA) / deviation).powi(2).min(16.0);
    }
    ((squares / runs as f64).sqrt(), (normalised / runs as f64).sqrt())
}

#[test]
fn half_an_outline_with_four_times_the_noise_that_says_so_is_found_better_and_within_its_deviations() {
    let law: Law = |_, angle, _| {
        let noise = if angle.cos() > 0.0 { 4.0 * NOISE } else { NOISE };
        (noise, noise)
    };
    let (unsaid, _) = errors(20, law, false);
    let (said, in_deviations) = errors(20, law, true);
    println!("{unsaid:.5} rad/s without, {said:.5} with, {in_deviations:.2} deviations");
    assert!(said < 0.75 * unsaid, "{said} {unsaid}");
    assert!((0.5..1.4).contains(&in_deviations), "{in_deviations}");
}

#[test]
fn deviations_that_are_wrong_leave_the_intervals_as_wide_as_they_must_be() {
    let laws: [(&str, Law); 5] = [
        ("ten times too little", |_, _, _| (NOISE, 0.1 * NOISE)),
        ("a quarter for half of the outline", |_, angle, _| {
            (NOISE, if angle.cos() > 0.0 { NOISE } else { 0.25 * NOISE })
        }),
        ("a twentieth for one point of twenty", |_, _, random| {
            (NOISE, if random < 0.05 { 0.05 * NOISE } else { NOISE })
        }),
        ("a tenth in one frame of three", |frame, _, _| (NOISE, if frame % 3 == 2 { 0.1 * NOISE } else { NOISE })),
        ("three times in every other frame", |frame, _, _| (NOISE, if frame % 2 == 1 { 3.0 * NOISE } else { NOISE })),
    ];
    for (how, law) in laws {
        let (error, in_deviations) = errors(12, law, true);
        println!("{how}: {error:.5} rad/s, {in_deviations:.2} deviations");
        assert!(in_deviations < 1.5, "{how}: {in_deviations}");
    }
}

#[test]
fn a_frame_in_a_tenth_of_the_light_is_used_with_little_weight_where_its_points_say_so_and_else_rejected() {
    let frames = frames(3, 24, |frame, _, _| {
        let noise = if frame == 15 { 10.0 * NOISE } else { NOISE };
        (noise, noise)
    });
    let (_, unsaid) = followed(frames.iter().map(|(time, outline, _)| (*time, outline)));
    assert_eq!(unsaid.iter().map(FilterStep::is_accepted).filter(|accepted| !accepted).count(), 1);
    assert!(!unsaid[15].is_accepted(), "{:?}", unsaid[15]);
    let with = stating(&frames, 1.0);
    let (_, said) = followed(with.iter().map(|(time, outline)| (*time, outline)));
    assert!(said.iter().all(FilterStep::is_accepted), "{:?}", said[15]);
    let measured = said[15].measurement.expect("measured");
    let noise = measured.noise.expect("known cells");
    assert!((noise / (10.0 * NOISE) - 1.0).abs() < 0.3 && (measured.weight - 0.01).abs() < 1e-9, "{measured:?}");
    // It may not show something else because it is dim.
    let far = |p: &Point2<f64>| p + Vector2::new(0.0, 0.9 * p.y.abs());
    let other = with[15].1.mapped(far).expect("another outline");
    let (_, steps) =
        followed(with.iter().enumerate().map(|(i, (time, outline))| (*time, if i == 15 { &other } else { outline })));
    assert!(!steps[15].is_accepted(), "{:?}", steps[15]);
}

#[test]
fn points_whose_edge_was_not_found_do_not_move_the_estimate() {
    // A fortieth of the outline lies elsewhere in every frame, at the same place of the picture.
    let lies_off = |frame: u32, angle: f64| {
        let in_picture = (angle - OMEGA * f64::from(frame) / 30.0).rem_euclid(std::f64::consts::TAU);
        in_picture < 0.5
    };
    let mut frames = frames(4, 24, |_, _, _| (NOISE, NOISE));
    for (number, (time, outline, stated)) in (0..).zip(&mut frames) {
        let pose = Isometry2::new(Vector2::new(0.3, -0.2), -OMEGA * *time);
        let points = outline.points().zip(stated.iter_mut()).map(|(p, stated)| {
            let in_body = pose.inverse() * p;
            if !lies_off(number, in_body.y.atan2(in_body.x)) {
                return *p;
            }
            *stated = 25.0 * NOISE;
            p + 8.0 * NOISE * (p - pose * Point2::origin()).normalize()
        });
        *outline = Outline::closed(points.collect()).expect("an outline");
    }
    let with = stating(&frames, 1.0);
    let (filter, steps) = followed(with.iter().map(|(time, outline)| (*time, outline)));
    assert!(steps.iter().all(FilterStep::is_accepted));
    let omega = filter.estimate().and_then(|estimate| estimate.parameters().next()).expect("omega");
    let (value, deviation) = omega.value.zip(omega.standard_deviation).expect("a turn that is seen");
    assert!((value - OMEGA).abs() < 3.0 * deviation && deviation < 0.01, "{value} +- {deviation}");
}

#[test]
fn open_arcs_and_repeated_points_keep_the_deviations_of_their_points() {
    let whole = frames(5, 20, |_, _, random| (NOISE * (0.5 + 3.0 * random), NOISE * (0.5 + 3.0 * random)));
    let arcs = |repeated: bool| -> Vec<(f64, Outline)> {
        let of_frame = |(time, outline, stated): &(f64, Outline, Vec<f64>)| {
            let points: Vec<_> = outline.points().copied().zip(stated.iter().copied()).collect();
            let arcs = [&points[..90], &points[100..220]].map(|arc| {
                let times = |i: usize| if repeated && i % 7 == 3 { 2 } else { 1 };
                let all = arc.iter().enumerate().flat_map(|(i, point)| std::iter::repeat_n(*point, times(i)));
                // The same point again states something else, which counts for nothing.
                let (points, mut stated): (Vec<_>, Vec<_>) = all.unzip();
                for i in 1..points.len() {
                    if points[i] == points[i - 1] {
                        stated[i] *= 1e-3;
                    }
                }
                OpenArc::new(points).and_then(|arc| arc.with_deviations(stated)).expect("an arc")
            });
            (*time, Outline::Open(OpenOutline::in_sequence(arcs.into()).expect("arcs")))
        };
        whole.iter().map(of_frame).collect()
    };
    let [once, twice] = [false, true].map(|repeated| {
        let arcs = arcs(repeated);
        let (filter, _) = followed(arcs.iter().map(|(time, outline)| (*time, outline)));
        filter.estimate().expect("an estimate").values().to_vec()
    });
    for (once, twice) in once.iter().zip(&twice) {
        assert!((once - twice).abs() < 1e-3, "{once} {twice}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn a_filter_that_is_saved_keeps_what_points_have_stated() {
    let frames = frames(6, 24, |frame, _, random| {
        let noise = NOISE * (0.5 + 3.0 * random) * if frame % 5 == 3 { 4.0 } else { 1.0 };
        (noise, noise)
    });
    let with = stating(&frames, 1.0);
    let (straight, _) = followed(with.iter().map(|(time, outline)| (*time, outline)));
    let mut interrupted = MotionFilter::new(FilterSettings::default()).expect("settings");
    for (time, outline) in &with {
        interrupted.step(*time, outline).expect("a frame");
        let bytes = interrupted.to_bytes().expect("memory takes it");
        interrupted = MotionFilter::from_bytes(&bytes).expect("a saved state");
    }
    assert_eq!(told(&interrupted, &[]), told(&straight, &[]));
}

#[cfg(feature = "serde")]
#[test]
fn a_first_frame_that_states_far_too_little_is_not_believed_for_ever_and_leaves_a_sound_state() {
    for factor in [0.1, 1e-3, 1e-80, 1e-200] {
        let all = frames(11, 60, |_, _, random| (NOISE, NOISE * (0.9 + 0.2 * random)));
        let mut with = stating(&all, 1.0);
        let first = all[0].2.iter().map(|deviation| factor * deviation).collect();
        with[0].1 = all[0].1.clone().with_deviations(first).expect("deviations");
        let (filter, steps) = followed(with.iter().map(|(time, outline)| (*time, outline)));
        assert!(steps.iter().all(FilterStep::is_accepted), "{factor}");
        let restored = MotionFilter::from_bytes(&filter.to_bytes().expect("memory")).expect("a sound state");
        assert_eq!(restored.estimate(), filter.estimate());
        let omega = filter.estimate().and_then(|estimate| estimate.parameters().next()).expect("omega");
        let (value, deviation) = omega.value.zip(omega.standard_deviation).expect("a turn that is seen");
        assert!((value - OMEGA).abs() < 4.0 * deviation && deviation < 0.01, "{factor}: {value} {deviation}");
        // Another object is none, whatever its points state.
        let mut square = filter.clone();
        let corners = (0..POINTS).map(|i| {
            let s = 8.0 * f64::from(i) / f64::from(POINTS);
            let along = (s % 2.0) - 1.0;
            match s as u32 / 2 {
                0 => Point2::new(along, -1.0),
                1 => Point2::new(1.0, along),
                2 => Point2::new(-along, 1.0),
                _ => Point2::new(-1.0, -along),
            }
        });
        let square_outline = Outline::closed(corners.collect()).expect("a square");
        let square_outline = square_outline.with_deviations(vec![NOISE; POINTS as usize]).expect("deviations");
        let step = square.step(2.1, &square_outline).expect("a frame");
        assert!(!step.is_accepted(), "{factor}");
    }
}
