//! What the motion filter says of parameters that outlines do not show.
use crate::filter_support::{filter, filtered, frames_of, settings};
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_filter::{Dynamics, FilterSettings, MotionFilter};
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Frame, Scene, SequenceLength, Settings, Shape, Simulator};
use nalgebra::{Affine2, Matrix3, Point2, Vector2};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

#[test]
fn a_circle_has_no_turn_whether_it_rests_or_moves_straight_or_along_an_arc_and_its_velocity_is_stated() {
    for (omega, b1, noise, seconds) in
        [(1.0, 0.5, 0.005, 3), (1.0, 0.5, 0.0005, 3), (1.0, 0.1, 0.005, 3), (-3.0, 0.5, 0.002, 3), (0.0, 0.5, 0.005, 3)]
    {
        let motion = RigidMotion { omega, b1, b2: 0.0 };
        for seed in 0..5 {
            let settings = Settings { noise, ..settings(30 * seconds, seed) };
            let frames = frames_of(BuiltInShape::Circle, motion, settings);
            let run = filtered(MotionModel::Rigid, &frames);
            let context = format!("{motion:?} {noise}, seed {seed}");
            assert!(run.frames_rejected() <= 2, "{context}: {}", run.frames_rejected());
            let found = run.estimate().expect("an estimate").parameters().next().expect("omega comes first");
            assert_eq!(found.value, None, "{context}");
            let velocity = run.velocity().unwrap_or_else(|| panic!("a velocity: {context}"));
            let truth = motion.generator() * velocity.point.to_homogeneous();
            let error = velocity.velocity - truth.xy();
            // On an arc the velocity is followed as it changes, from frame to frame: half a frame late.
            let late = 0.5 / 30.0 * omega.abs() * truth.xy().norm();
            let std = velocity.standard_deviations().norm();
            assert!(error.norm() < 5.0 * std + 1.5 * late && std < 0.1, "{context}: {error:?} {std} {late}");
        }
    }
}

#[test]
fn the_path_of_a_circle_tells_its_turn_to_whoever_asks_for_a_constant_generator() {
    let (mut inside, mut all) = (0, 0);
    for (omega, b1) in [(1.5, 0.6), (-0.8, 0.5), (0.0, 0.4)] {
        for seed in 0..8 {
            let motion = RigidMotion { omega, b1, b2: -0.3 };
            let settings = FilterSettings { dynamics: Dynamics::Generator, ..FilterSettings::default() };
            let mut run = MotionFilter::new(settings).expect("settings");
            for frame in frames_of(BuiltInShape::Circle, motion, Settings { noise: 0.005, ..self::settings(90, seed) })
            {
                let step = run.step(frame.time, &frame.outline).expect("increasing times");
                assert!(step.is_accepted(), "{motion:?} {seed} {step:?}");
            }
            assert!(run.turn_is_told_by_path() && !run.motion_changed());
            let estimate = run.estimate().expect("an estimate");
            for (parameter, truth) in estimate.parameters().zip([omega, b1, -0.3]) {
                let value = parameter.value.unwrap_or_else(|| panic!("{motion:?} {seed} {}", parameter.name));
                let error = (value - truth).abs() / parameter.standard_deviation.expect("with its deviation");
                assert!(error < 5.0, "{motion:?} {seed} {parameter:?}");
                inside += usize::from(error < 1.96);
                all += 1;
            }
        }
    }
    // Of 72 values; of 24 runs that are as good as 50 independent ones, 80 % or fewer once in a hundred.
    assert!(inside as f64 > 0.8 * f64::from(all), "{inside} of {all}");
}

#[test]
fn a_circle_at_rest_keeps_its_turn_unknown_and_its_place_known_whatever_the_noise() {
    for noise in [0.0, 0.0005, 0.005, 0.02] {
        for seed in 0..6 {
            let settings = Settings { noise, ..settings(30, seed) };
            let run = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Circle, RigidMotion::default(), settings));
            assert!(!observable(&run)[0], "noise {noise}, seed {seed}");
            let velocity = run.velocity().expect("a velocity of the centroid");
            let std = velocity.standard_deviations().norm();
            assert!(velocity.velocity.norm() < 5.0 * std && std < 0.1, "noise {noise}, seed {seed}: {velocity:?}");
            assert_eq!(run.frames_rejected(), 0, "noise {noise}, seed {seed}");
        }
    }
}

#[test]
fn a_circle_under_affine_motion_shows_no_turn_and_what_is_stated_is_right() {
    let moving = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -0.3, b2: 0.4 };
    let in_place = AffineMotion { a1: 0.1, a2: 0.3, a3: -0.2, a4: 0.1, b1: 0.0, b2: 0.0 };
    for motion in [moving, in_place] {
        for (seed, noise) in (0..6).zip([0.0005, 0.005].into_iter().cycle()) {
            let frames = frames_of(BuiltInShape::Circle, motion, Settings { noise, ..settings(60, seed) });
            let run = filtered(MotionModel::Affine, &frames);
            let known = observable(&run);
            assert_eq!([known[1], known[2]], [false; 2], "{motion:?} {noise}, seed {seed}");
            let estimate = run.estimate().expect("an estimate");
            let truth = [motion.a1, motion.a2, motion.a3, motion.a4, motion.b1, motion.b2];
            for (parameter, truth) in estimate.parameters().zip(truth) {
                let Some((value, std)) = parameter.value.zip(parameter.standard_deviation) else { continue };
                assert!((value - truth).abs() < 6.0 * std, "{motion:?} {noise}, seed {seed}: {value} {truth} {std}");
            }
        }
    }
}

#[test]
fn a_slender_ellipse_under_affine_motion_shows_no_turn_and_loses_no_frame() {
    // Along itself it slides unseen, which takes part in all rates.
    let motion = AffineMotion { a1: 0.05, a2: 0.6, a3: -0.8, a4: -0.08, b1: -0.3, b2: 0.4 };
    let (sine, cosine) = 0.4_f64.sin_cos();
    for (seed, noise) in (0..4).zip([0.0005, 0.002].into_iter().cycle()) {
        let slender = Matrix3::new(cosine, -0.2 * sine, 0.0, sine, 0.2 * cosine, 0.0, 0.0, 0.0, 1.0);
        let scene = Scene::new(BuiltInShape::Circle, motion, Camera::default())
            .with_initial_pose(Affine2::from_matrix_unchecked(slender));
        let settings = Settings { noise, ..settings(40, seed) };
        let frames: Vec<_> = Simulator::new(scene, settings).expect("good settings").frames().collect();
        let run = filtered(MotionModel::Affine, &frames);
        assert_eq!(observable(&run)[..4], [false; 4], "noise {noise}, seed {seed}");
        assert_eq!(run.frames_rejected(), 0, "noise {noise}, seed {seed}");
    }
}

#[test]
fn a_circle_of_points_at_even_angles_does_not_show_its_turn_either() {
    for (seed, noise) in (0..12).zip([0.00005, 0.001, 0.005, 0.02].into_iter().cycle()) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let noise = Normal::new(0.0, noise).expect("a deviation");
        let mut resting = filter(MotionModel::Rigid);
        for frame in 0..20 {
            let mut point = |i: i32| {
                let angle = std::f64::consts::TAU * f64::from(i) / 300.0;
                Point2::new(angle.cos() + noise.sample(&mut random), angle.sin() + noise.sample(&mut random))
            };
            let outline = Outline::closed((0..300).map(&mut point).collect()).expect("an outline");
            resting.step(f64::from(frame) / 30.0, &outline).expect("increasing times");
        }
        assert!(!observable(&resting)[0] && resting.velocity().is_some(), "{noise:?}, seed {seed}");
        assert_eq!(resting.frames_rejected(), 0, "{noise:?}, seed {seed}");
    }
}

fn observable(run: &MotionFilter) -> Vec<bool> {
    run.estimate().expect("an estimate").parameters().map(|p| p.value.is_some()).collect()
}

#[test]
fn the_slide_of_an_edge_is_reported_as_unobservable() {
    // Points are 0.005 apart.
    for (seed, noise) in (0..20).zip([0.00002, 0.0002, 0.001, 0.002, 0.005].into_iter().cycle()) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut line = |shift: f64| {
            let noise = Normal::new(0.0, noise).expect("a deviation");
            let mut point = |i: i32| Point2::new(0.005 * f64::from(i) - 0.5, noise.sample(&mut random) + shift);
            let arc = OpenArc::new((0..200).map(&mut point).collect()).expect("an arc");
            Outline::Open(OpenOutline::new(vec![arc]).expect("one arc"))
        };
        let mut edge = filter(MotionModel::Rigid);
        for frame in 0..20 {
            let time = f64::from(frame) / 30.0;
            edge.step(time, &line(0.1 * time)).expect("increasing times");
        }
        assert_eq!(observable(&edge), [true, false, true], "noise {noise}, seed {seed}");
        assert_eq!(edge.frames_rejected(), 0, "noise {noise}, seed {seed}");
        let b2 = edge.estimate().expect("an estimate").values()[2];
        assert!((b2 - 0.1).abs() < 0.02, "noise {noise}, seed {seed}: {b2}");
    }
}

#[test]
fn turns_that_a_symmetric_outline_cannot_tell_apart_are_listed() {
    let turned = |shape| {
        let motion = RigidMotion { omega: -0.3, b1: 0.1, b2: 0.0 };
        let frames = frames_of(shape, motion, Settings { fps: 1.0, ..settings(2, 1) });
        filtered(MotionModel::Rigid, &frames).rival_turns().to_vec()
    };
    assert!(turned(BuiltInShape::Bird).is_empty());
    let ellipse = turned(BuiltInShape::Ellipse);
    assert!(ellipse.iter().any(|turn| (turn.abs() - (std::f64::consts::PI - 0.3)).abs() < 0.1), "{ellipse:?}");
}

/// A filter that has seen a shape at the times given.
fn seen_at(shape: BuiltInShape, omega: f64, b1: f64, times: &[f64]) -> MotionFilter {
    let motion = RigidMotion { omega, b1, b2: 0.0 };
    // A simulator has frames at even times only.
    let fps = 10.0;
    let count = (times[times.len() - 1] * fps).round() as usize + 1;
    let frames = frames_of(shape, motion, Settings { fps, ..settings(count, 1) });
    let mut filter = filter(MotionModel::Rigid);
    for time in times {
        let frame = &frames[(time * fps).round() as usize];
        assert!(filter.step(frame.time, &frame.outline).expect("increasing times").is_accepted(), "at {time} s");
    }
    filter
}

#[test]
fn a_third_frame_at_another_distance_decides_between_the_turns_of_a_symmetric_outline() {
    let two = seen_at(BuiltInShape::Ellipse, -0.3, 0.1, &[0.0, 1.0]);
    let three = seen_at(BuiltInShape::Ellipse, -0.3, 0.1, &[0.0, 1.0, 2.5]);
    assert_eq!((two.rival_turns().len(), three.rival_turns().len()), (1, 0));
    let omega = three.estimate().expect("an estimate").values()[0];
    assert!((omega + 0.3).abs() < 0.05, "{omega}");
}

#[test]
fn a_square_that_turns_by_50_degrees_may_have_turned_back_by_40_whatever_its_path() {
    let omega = |filter: &MotionFilter| filter.estimate().expect("an estimate").parameters().next().expect("omega");
    let turn = 50.0_f64.to_radians();
    let two = seen_at(BuiltInShape::Square, turn, 0.1, &[0.0, 1.0]);
    assert!(two.ambiguity().is_some() && omega(&two).value.is_none(), "{:?} {:?}", omega(&two), two.rival_turns());
    let ambiguity = two.ambiguity().expect("two turns");
    assert!(ambiguity.parameters.contains(&"omega") && two.velocity().is_none(), "{ambiguity:?}");
    let degrees = |turn: f64| turn.to_degrees().round();
    let rivals: Vec<f64> = ambiguity.rival_turns.iter().map(|turn| degrees(*turn)).collect();
    assert_eq!((degrees(ambiguity.turn), rivals), (40.0, vec![-50.0]));
    // It moves along an arc, which a constant generator with no other turn would. But wheels roll, and coins slide while they spin.
    let three = seen_at(BuiltInShape::Square, turn, 0.1, &[0.0, 1.0, 2.0]);
    assert!(three.ambiguity().is_some() && omega(&three).value.is_none(), "{:?}", three.rival_turns());
    // Nothing tells how often a square that stays in its place has turned, unless it is little.
    let in_place = seen_at(BuiltInShape::Square, turn, 0.0, &[0.0, 1.0, 2.0]);
    assert!(in_place.ambiguity().is_some() && omega(&in_place).value.is_none(), "{:?}", in_place.rival_turns());
    let little = seen_at(BuiltInShape::Square, 0.4 * turn, 0.0, &[0.0, 1.0, 2.0]);
    assert!(little.ambiguity().is_none() && (omega(&little).value.expect("stated") - 0.4 * turn).abs() < 0.02);
}

#[test]
fn a_turn_of_nearly_half_a_circle_that_later_frames_decide_for_may_have_been_the_other_way_round() {
    // Nearly the same after half a turn: two frames of few points do not tell, and the smaller turn is taken, without a doubt.
    let egg = |i: i32| {
        let t = std::f64::consts::TAU * f64::from(i) / 400.0;
        Point2::new(0.5 * t.cos(), 0.3 * t.sin() + 0.01 * (2.0 * t).cos())
    };
    let shape = Shape::from_polygon(&(0..400).map(egg).collect::<Vec<_>>()).expect("a shape");
    let turn = 175.0_f64.to_radians();
    let motion = RigidMotion { omega: -turn, b1: 0.0, b2: 0.0 };
    let omega = |run: &MotionFilter| run.estimate().expect("an estimate").values()[0];
    let mut exchanged = 0;
    for seed in 0..10 {
        let settings = Settings { fps: 1.0, points: 60, noise: 0.005, ..settings(20, seed) };
        let scene = Scene::new(shape.clone(), motion, Camera::default());
        let frames: Vec<_> = Simulator::new(scene, settings).expect("good settings").frames().collect();
        let [two, all] = [&frames[..2], &frames].map(|frames| filtered(MotionModel::Rigid, frames));
        if omega(&two).abs() > 0.3 || omega(&all).abs() < 2.9 {
            continue;
        }
        exchanged += 1;
        let ambiguity = all.ambiguity().unwrap_or_else(|| panic!("seed {seed}: {:?}", all.rival_turns()));
        let other = std::f64::consts::TAU - turn;
        assert!(ambiguity.rival_turns.iter().any(|rival| (rival.abs() - other).abs() < 0.1), "{ambiguity:?}");
        assert_eq!(all.estimate().expect("an estimate").parameters().next().expect("omega").value, None);
    }
    assert!(exchanged > 4, "{exchanged}");
}

#[test]
fn searches_that_began_apart_and_found_the_same_motion_are_no_rivals() {
    // In the few noisy points of the second frame the search finds two turns; from the next frames both tracks find the true one.
    let motion = RigidMotion { omega: 1.5, b1: 0.6, b2: -0.4 };
    let mut had_rivals = 0;
    for seed in [10, 18, 26, 32, 33] {
        let length = SequenceLength::Frames(30);
        let settings = Settings { length, seed, fps: 30.0, points: 40, noise: 0.02, ..Settings::default() };
        let frames = frames_of(BuiltInShape::Bird, motion, settings);
        let rivals_after = |count: usize| filtered(MotionModel::Rigid, &frames[..count]).rival_turns().len();
        had_rivals += usize::from((2..6).any(|count| rivals_after(count) > 0));
        let run = filtered(MotionModel::Rigid, &frames);
        assert!(run.rival_turns().is_empty() && run.aliases().is_empty(), "seed {seed}: {:?}", run.rival_turns());
        assert!(run.velocity().is_some(), "seed {seed}");
    }
    assert!(had_rivals > 0);
}

#[test]
fn a_circle_at_rest_far_from_the_origin_shows_the_velocity_of_its_centroid_though_not_its_turn() {
    for seed in 0..4 {
        let mut frames = frames_of(BuiltInShape::Circle, RigidMotion::default(), settings(30, seed));
        for frame in &mut frames {
            let moved = frame.outline.points().map(|p| p + Vector2::new(3.0, 4.0)).collect();
            frame.outline = Outline::closed(moved).expect("an outline");
        }
        let run = filtered(MotionModel::Rigid, &frames);
        assert!(!observable(&run)[0], "seed {seed}");
        let found = run.velocity().expect("known");
        let std = found.standard_deviations();
        let is_none = found.velocity.iter().zip(&std).all(|(velocity, std)| velocity.abs() < 5.0 * std);
        assert!(std.max() < 0.01 && is_none, "seed {seed}: {found:?}");
    }
}

#[test]
fn a_circle_shows_no_turn_however_many_radii_it_is_from_the_origin() {
    let motion = RigidMotion { omega: 0.0, b1: 0.4, b2: -0.2 };
    let frames = frames_of(BuiltInShape::Circle, motion, settings(20, 3));
    for distance in [10.0, 100.0, 1e3, 1e4] {
        let mut run = filter(MotionModel::Rigid);
        for frame in &frames {
            let moved = frame.outline.points().map(|p| p + Vector2::new(0.6, -0.8) * distance).collect();
            run.step(frame.time, &Outline::closed(moved).expect("an outline")).expect("increasing times");
            assert!(run.estimate().is_none_or(|_| !observable(&run)[0]), "{distance}, frame {}", frame.index);
        }
        assert!(run.estimate().is_some(), "{distance}");
        let found = run.velocity().expect("known");
        let error = found.velocity - Vector2::new(0.4, -0.2);
        assert!(error.norm() < 5.0 * found.standard_deviations().norm(), "{distance}: {found:?}");
    }
}

/// What of an outline lies left of `edge`.
fn left_of(edge: f64, outline: &Outline) -> Option<Outline> {
    let points: Vec<Point2<f64>> = outline.points().copied().collect();
    let is_seen = |i: usize| points[i % points.len()].x < edge;
    if (0..points.len()).all(is_seen) {
        return Some(outline.clone());
    }
    let start = (0..points.len()).find(|i| is_seen(i + 1) && !is_seen(*i))?;
    let order: Vec<usize> = (start + 1..=start + points.len()).collect();
    let runs = order.chunk_by(|i, j| is_seen(*i) == is_seen(*j)).filter(|run| is_seen(run[0]) && run.len() > 5);
    let arc = |run: &[usize]| OpenArc::new(run.iter().map(|i| points[i % points.len()]).collect()).expect("an arc");
    Some(Outline::Open(OpenOutline::new(runs.map(arc).collect()).ok()?))
}

/// A filter that has seen a shape come out from behind an edge that moves to the right.
fn entered(shape: impl Into<Shape>, motion: RigidMotion, settings: Settings, from: f64) -> MotionFilter {
    let simulator = Simulator::new(Scene::new(shape, motion, Camera::default()), settings).expect("good settings");
    let mut filter = filter(MotionModel::Rigid);
    for Frame { time, outline, .. } in simulator.frames() {
        if let Some(seen) = left_of(from + 1.2 * time, &outline).filter(|seen| seen.point_count() >= 8) {
            filter.step(time, &seen).expect("increasing times");
        }
    }
    filter
}

fn assert_right(run: &MotionFilter, motion: RigidMotion, context: &str) {
    let estimate = run.estimate().expect("an estimate");
    for (parameter, truth) in estimate.parameters().zip([motion.omega, motion.b1, motion.b2]) {
        let (value, std) = (parameter.value.expect("known"), parameter.standard_deviation.expect("known"));
        assert!((value - truth).abs() < 6.0 * std && std < 0.1, "{context}: {value} {truth} {std}");
    }
}

const MOTIONS: [RigidMotion; 4] = [
    RigidMotion { omega: 0.0, b1: 0.0, b2: 0.0 },
    RigidMotion { omega: 0.6, b1: 0.0, b2: 0.0 },
    RigidMotion { omega: 2.0, b1: -0.3, b2: 0.2 },
    RigidMotion { omega: 2.0, b1: 0.0, b2: 0.0 },
];

#[test]
fn a_disc_of_which_a_bump_is_seen_last_tells_its_turn_then() {
    let rim = (0..720).map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / 720.0;
        let off = (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let radius = 0.5 * (1.0 + 0.35 * (-0.5 * (off / 0.25).powi(2)).exp());
        Point2::new(radius * angle.cos(), radius * angle.sin())
    });
    let disc = Shape::from_polygon(&rim.collect::<Vec<_>>()).expect("a shape");
    for motion in MOTIONS {
        for (seed, noise) in (0..4).zip([0.0005, 0.005].into_iter().cycle()) {
            let run = entered(disc.clone(), motion, Settings { noise, ..settings(30, seed) }, -0.1);
            assert_right(&run, motion, &format!("{motion:?} {noise}, seed {seed}"));
        }
    }
}

#[test]
fn a_square_of_which_one_side_is_seen_first_tells_its_slide_with_the_others() {
    for motion in MOTIONS {
        for (seed, noise) in (0..4).zip([0.0005, 0.005].into_iter().cycle()) {
            let run = entered(BuiltInShape::Square, motion, Settings { noise, ..settings(36, seed) }, -0.3);
            assert_right(&run, motion, &format!("{motion:?} {noise}, seed {seed}"));
        }
    }
}
