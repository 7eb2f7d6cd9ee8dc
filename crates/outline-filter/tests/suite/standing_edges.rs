//! Straight edges of what is in front of an object, that nobody has declared.
use freeform_curve_fit::Outline;
use freeform_outline_filter::{FilterSettings, MotionFilter, Phase, Rejection, StandingEdge};
use freeform_riccati::MotionModel;
use nalgebra::{Isometry2, Point2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use crate::filter_support::filter;

const NOISE: f64 = 0.003;
const FRAME_RATE: f64 = 30.0;
const POINTS: usize = 240;

/// A closed curve about the origin.
type Body = fn(f64) -> Point2<f64>;

/// Poses over time, s.
type Motion = fn(f64) -> Isometry2<f64>;

/// A body without symmetry and without straight sides.
fn pebble(angle: f64) -> Point2<f64> {
    let radius = 0.5 + 0.06 * (2.0 * angle + 0.4).cos() + 0.04 * (3.0 * angle).sin();
    Point2::new(radius * angle.cos(), radius * angle.sin())
}

/// A rectangle three times as long as wide, with rounded corners.
fn bar(angle: f64) -> Point2<f64> {
    let (c, s) = (angle.cos(), angle.sin());
    let reach = ((c / 0.6).abs().powi(20) + (s / 0.2).abs().powi(20)).powf(-0.05);
    Point2::new(reach * c, reach * s)
}

/// A disc with a flat.
fn disc_with_flat(angle: f64) -> Point2<f64> {
    Point2::new(0.5 * angle.cos(), (0.5 * angle.sin()).min(0.3))
}

/// A square with a notch on one of its sides.
fn square_with_notch(angle: f64) -> Point2<f64> {
    let p = bar(angle);
    let p = Point2::new(p.x, 3.0 * p.y);
    if p.x > 0.5 && p.y.abs() < 0.1 { Point2::new(p.x - 0.15, p.y) } else { p }
}

/// A triangle.
fn triangle(angle: f64) -> Point2<f64> {
    let corner = |i: f64| {
        Point2::new(0.6 * (std::f64::consts::TAU * i / 3.0).cos(), 0.5 * (std::f64::consts::TAU * i / 3.0).sin())
    };
    let at = 3.0 * angle / std::f64::consts::TAU;
    corner(at.floor()) + (corner(at.floor() + 1.0) - corner(at.floor())) * at.fract()
}

/// A half plane that hides what lies in it: points whose coordinate along the normal is above the offset in a frame.
#[derive(Clone, Copy)]
struct Hidden {
    normal: Vector2<f64>,
    offset: f64,
    drift: f64,
}

impl Hidden {
    fn offset_in(&self, frame: usize) -> f64 {
        self.offset + self.drift * frame as f64
    }
}

/// What is seen of a body in a pose: the outline is closed along the edge of what hides a part of it. Points are spaced evenly, and err.
fn seen(
    body: Body,
    pose: &Isometry2<f64>,
    hidden: impl IntoIterator<Item = (Hidden, usize)> + Copy,
    random: &mut ChaCha8Rng,
) -> Outline {
    const FINE: usize = 4000;
    let shown = |i: usize| {
        let p = pose * body(std::f64::consts::TAU * i as f64 / FINE as f64);
        hidden
            .into_iter()
            .fold(p, |p, (edge, frame)| p - edge.normal * (p.coords.dot(&edge.normal) - edge.offset_in(frame)).max(0.0))
    };
    let curve: Vec<_> = (0..=FINE).map(shown).collect();
    let mut along = vec![0.0];
    curve.windows(2).for_each(|pair| along.push(along[along.len() - 1] + (pair[1] - pair[0]).norm()));
    let begin: f64 = random.random();
    let mut point = |k: usize| {
        let at = (begin + k as f64) / POINTS as f64 * along[FINE];
        let i = along.partition_point(|s| *s <= at).clamp(1, FINE);
        let share = (at - along[i - 1]) / (along[i] - along[i - 1]).max(1e-12);
        let error = Vector2::from_fn(|_, _| NOISE * random.sample::<f64, _>(StandardNormal));
        curve[i - 1] + (curve[i] - curve[i - 1]) * share + error
    };
    Outline::closed((0..POINTS).map(&mut point).collect()).expect("an outline")
}

/// Turns anticlockwise about the origin, at so many rad/s, from a place beside it.
fn about_the_origin(rate: f64) -> impl Fn(f64) -> Isometry2<f64> {
    move |time| Isometry2::rotation(rate * time) * Isometry2::new(Vector2::new(0.3, -0.1), 0.2)
}

fn followed(
    body: Body,
    pose: impl Fn(f64) -> Isometry2<f64>,
    hidden: Option<Hidden>,
    (frames, seed): (usize, u64),
) -> MotionFilter {
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(seed));
    for frame in 0..frames {
        let time = frame as f64 / FRAME_RATE;
        let outline = seen(body, &pose(time), hidden.map(|edge| (edge, frame)), &mut random);
        run.step(time, &outline).expect("increasing times");
    }
    run
}

/// Asserts that omega is stated, near enough and within its deviations.
fn assert_turns(run: &MotionFilter, rate: f64, what: &str) {
    let estimate = run.estimate().unwrap_or_else(|| panic!("{what}: an estimate"));
    let omega = estimate.parameters().next().expect("omega comes first");
    let value = omega.value.unwrap_or_else(|| panic!("{what}: omega is stated"));
    let deviation = omega.standard_deviation.expect("with its deviation");
    // Omega is positive clockwise.
    assert!((value + rate).abs() < 5.0 * deviation && deviation < 0.05, "{what}: {value} +- {deviation} of {}", -rate);
}

#[test]
fn a_body_that_moves_behind_an_edge_at_rest_is_followed_without_the_points_along_it() {
    for seed in 0..6 {
        let angle = f64::from(seed as u32);
        let hidden = Hidden { normal: Vector2::new(angle.cos(), angle.sin()), offset: 0.25, drift: 0.0 };
        let run = followed(pebble, about_the_origin(0.9), Some(hidden), (80, seed));
        let edges: Vec<_> = run.standing_edges().collect();
        assert_eq!(edges.len(), 1, "{edges:?}");
        for end in [edges[0].from, edges[0].to] {
            assert!((end.coords.dot(&hidden.normal) - 0.25).abs() < 0.01, "seed {seed}: {end}");
        }
        assert!((edges[0].from - edges[0].to).norm() > 0.3, "seed {seed}: {edges:?}");
        assert_turns(&run, 0.9, &format!("seed {seed}"));
        let begun = about_the_origin(0.9)(0.0);
        let reach = |i: i32| (begun * pebble(0.01 * f64::from(i))).coords.dot(&hidden.normal);
        let is_cut_off_at_first = (0..629).map(reach).fold(0.0, f64::max) > 0.35;
        // Else the map is that of the whole body.
        assert!(!is_cut_off_at_first || run.segment() == 1, "seed {seed}: the map held the edge, and was begun anew");
        assert_eq!(run.restarts(), 0, "the object was not given up");
    }
}

#[test]
fn an_edge_that_moves_slowly_itself_is_followed_too() {
    for (seed, drift) in [(1, 0.0015), (2, -0.0015)] {
        let hidden = Hidden { normal: Vector2::new(0.6, 0.8), offset: 0.25 - 25.0 * drift, drift };
        let run = followed(pebble, about_the_origin(0.9), Some(hidden), (80, seed));
        let edges: Vec<_> = run.standing_edges().collect();
        assert_eq!(edges.len(), 1, "{edges:?}");
        assert_turns(&run, 0.9, &format!("drift {drift}"));
    }
}

#[test]
fn a_body_that_was_seen_as_a_whole_keeps_its_map_behind_an_edge() {
    let hidden = Hidden { normal: Vector2::x(), offset: 0.55, drift: 0.0 };
    let pose = |time: f64| Isometry2::new(Vector2::new(-0.3 + 0.25 * time, 0.0), 0.5 * time);
    let run = followed(pebble, pose, Some(hidden), (100, 5));
    assert_eq!(run.standing_edges().len(), 1);
    assert_eq!(run.segment(), 0, "all poses go back to the first outline");
    let turned = run.pose().expect("a pose");
    let angle = turned.matrix()[(1, 0)].atan2(turned.matrix()[(0, 0)]);
    assert!((angle - 0.5 * 99.0 / FRAME_RATE).abs() < 0.02, "{angle}");
}

#[test]
fn a_body_that_has_gone_behind_an_edge_is_lost_and_found_when_it_comes_back() {
    let hidden = Hidden { normal: Vector2::x(), offset: 0.3, drift: 0.0 };
    // To a place 0.7 beyond the edge and back.
    let pose = |time: f64| {
        let away = 0.9 * (0.5 * std::f64::consts::PI * time).sin().abs();
        Isometry2::new(Vector2::new(0.1 + away, 0.0), 0.4 * time)
    };
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(8));
    let (mut lost, mut last) = (0, None);
    for frame in 0..60 {
        let time = frame as f64 / FRAME_RATE;
        let step =
            run.step(time, &seen(pebble, &pose(time), Some((hidden, frame)), &mut random)).expect("increasing times");
        let is_gone = pose(time).translation.x > 0.3 + 0.62;
        assert!(!is_gone || !step.is_accepted(), "frame {frame} shows nothing of the body");
        lost += usize::from(step.phase == Phase::Lost);
        last = Some(step);
    }
    assert!(lost > 10 && run.standing_edges().len() == 1, "{lost}");
    assert!(last.is_some_and(|step| step.is_accepted() && step.phase == Phase::Tracking), "{last:?}");
    assert_eq!((run.restarts(), run.segment()), (0, 1), "begun anew once, beside the edge, and not given up");
    let back = pose(59.0 / FRAME_RATE).inverse();
    for p in run.outline_points() {
        let own = back * p;
        let off = own.coords.norm() - pebble(own.y.atan2(own.x)).coords.norm();
        assert!(off.abs() < 0.03, "{p} is {off} off the body");
    }
}

#[test]
fn a_body_hidden_for_longer_than_any_is_searched_for_is_not_given_up() {
    let hidden = Hidden { normal: Vector2::x(), offset: 0.45, drift: 0.0 };
    // Behind the edge for three seconds.
    let pose = |time: f64| Isometry2::new(Vector2::new(0.1 + 0.9 * (1.3 * time).min(1.0), 0.0), 0.6 * time);
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(8));
    let mut hidden_frames = 0;
    for frame in 0..120 {
        let time = frame as f64 / FRAME_RATE;
        let outline = seen(pebble, &pose(time), Some((hidden, frame)), &mut random);
        let step = run.step(time, &outline).expect("increasing times");
        hidden_frames += usize::from(step.rejection == Some(Rejection::Hidden));
    }
    assert!(hidden_frames > 60, "{hidden_frames}");
    assert_eq!((run.phase(), run.restarts(), run.segment()), (Phase::Lost, 0, 0));
}

#[test]
fn two_edges_at_once_are_both_found() {
    for seed in [1, 2, 3] {
        let edges = [(Vector2::x(), 0.4), (Vector2::new(-0.6, 0.8), 0.4)].map(|(normal, offset)| Hidden {
            normal,
            offset,
            drift: 0.0,
        });
        let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(seed));
        for frame in 0..90 {
            let time = frame as f64 / FRAME_RATE;
            let outline = seen(pebble, &Isometry2::rotation(0.9 * time), edges.map(|edge| (edge, frame)), &mut random);
            run.step(time, &outline).expect("increasing times");
        }
        let found: Vec<_> = run.standing_edges().collect();
        assert_eq!(found.len(), 2, "seed {seed}: {found:?}");
        for edge in edges {
            let is_on = |p: &Point2<f64>| (p.coords.dot(&edge.normal) - edge.offset).abs() < 0.015;
            assert!(found.iter().any(|found| is_on(&found.from) && is_on(&found.to)), "seed {seed}: {found:?}");
        }
        assert_turns(&run, 0.9, &format!("seed {seed}"));
    }
}

#[test]
fn an_edge_that_has_left_is_dropped_and_the_whole_body_is_followed() {
    let hidden = Hidden { normal: Vector2::new(0.6, 0.8), offset: 0.25, drift: 0.0 };
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(2));
    for frame in 0..240 {
        let time = frame as f64 / FRAME_RATE;
        let there = (frame < 60).then_some((hidden, frame));
        run.step(time, &seen(pebble, &about_the_origin(0.9)(time), there, &mut random)).expect("increasing times");
        assert!(frame != 59 || run.standing_edges().len() == 1, "it was there");
    }
    assert_eq!(run.standing_edges().len(), 0, "{:?}", run.standing_edges().next());
    let former: Vec<_> = run.former_edges().collect();
    let [StandingEdge { since, until: Some(until), .. }] = former[..] else { panic!("{former:?}") };
    assert!(since < 60.0 / FRAME_RATE && until > 60.0 / FRAME_RATE, "{former:?}");
    assert_eq!(run.restarts(), 0);
    assert_turns(&run, 0.9, "afterwards");
}

#[test]
fn an_edge_that_moves_is_followed_where_frames_are_missing() {
    let hidden = Hidden { normal: Vector2::new(0.6, 0.8), offset: 0.25 - 25.0 * 0.0015, drift: 0.0015 };
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(3));
    // Every frame in the first third, then two of five.
    for frame in (0..120).filter(|frame| *frame < 40 || [0, 3].contains(&(frame % 5))) {
        let time = frame as f64 / FRAME_RATE;
        let outline = seen(pebble, &about_the_origin(0.9)(time), Some((hidden, frame)), &mut random);
        run.step(time, &outline).expect("increasing times");
    }
    assert_eq!(run.standing_edges().len(), 1);
    assert_turns(&run, 0.9, "with gaps");
}

#[test]
fn a_hand_in_front_of_a_box_at_rest_makes_no_edges_of_its_sides() {
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(9));
    // Two sides of what moves hide a corner of the square.
    let square: Body = |angle| bar(angle).coords.component_mul(&Vector2::new(1.0, 3.0)).into();
    for frame in 0..90 {
        let time = f64::from(frame) / FRAME_RATE;
        let turn = 0.7 + 0.5 * (2.0 * time).sin();
        let hand = Hidden {
            normal: Vector2::new(turn.cos(), turn.sin()),
            offset: 0.55 + 0.1 * (3.0 * time).cos(),
            drift: 0.0,
        };
        let outline = seen(square, &Isometry2::identity(), Some((hand, 0)), &mut random);
        run.step(time, &outline).expect("increasing times");
    }
    assert_eq!(run.standing_edges().len(), 0, "{:?}", run.standing_edges().next());
    assert_eq!(run.former_edges().len(), 0);
}

#[test]
fn straight_sides_of_the_object_itself_are_no_edges_however_it_moves() {
    let bodies: [(&str, Body); 4] = [
        ("bar", bar),
        ("disc with a flat", disc_with_flat),
        ("square with a notch", square_with_notch),
        ("pebble", pebble),
    ];
    let motions: [(&str, Motion); 6] = [
        ("rest", |_| Isometry2::identity()),
        ("slide along a side", |t| Isometry2::new(Vector2::new(0.4 * t, 0.0), 0.0)),
        ("to and fro along a side", |t| Isometry2::new(Vector2::new(0.3 * (3.0 * t).sin(), 0.0), 0.0)),
        ("turn about its middle", |t| Isometry2::rotation(1.1 * t)),
        ("a quarter of a turn in each frame", |t| Isometry2::rotation(std::f64::consts::FRAC_PI_2 * FRAME_RATE * t)),
        ("about a point of its side", |t| {
            let centre = Vector2::new(0.0, 0.2);
            Isometry2::new(centre, 0.0) * Isometry2::rotation(0.7 * t) * Isometry2::new(-centre, 0.0)
        }),
    ];
    for (name, body) in bodies {
        for (motion, pose) in motions {
            let run = followed(body, pose, None, (90, 11));
            assert_eq!(run.standing_edges().len(), 0, "{name}, {motion}: {:?}", run.standing_edges().next());
        }
    }
}

#[test]
fn where_one_straight_line_moves_and_the_rest_stays_nothing_says_which_of_them_is_the_object() {
    // In front of a triangle at rest: its sides are none of what moves.
    let hidden = Hidden { normal: -Vector2::x(), offset: 0.25, drift: -0.004 };
    let run = followed(triangle, |_| Isometry2::identity(), Some(hidden), (80, 6));
    assert_eq!(run.standing_edges().len(), 0, "{:?}", run.standing_edges().next());
    assert_eq!(run.former_edges().len(), 0);
}

#[test]
fn where_outlines_may_be_stretched_no_side_at_rest_is_an_edge() {
    let settings = FilterSettings { model: MotionModel::Affine, ..FilterSettings::default() };
    let mut run = MotionFilter::new(settings).expect("good settings");
    let hidden = Hidden { normal: Vector2::new(0.6, 0.8), offset: 0.25, drift: 0.0 };
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for frame in 0..60 {
        let time = f64::from(frame) / FRAME_RATE;
        let outline = seen(pebble, &about_the_origin(0.9)(time), Some((hidden, 0)), &mut random);
        run.step(time, &outline).expect("increasing times");
    }
    assert_eq!(run.standing_edges().len(), 0);
}

#[cfg(feature = "serde")]
#[test]
fn a_filter_that_is_saved_finds_the_same_edge_afterwards() {
    let hidden = Hidden { normal: Vector2::new(0.6, 0.8), offset: 0.25, drift: 0.0 };
    let (mut run, mut random) = (filter(MotionModel::Rigid), ChaCha8Rng::seed_from_u64(4));
    let mut restored = run.clone();
    for frame in 0..60 {
        let time = f64::from(frame) / FRAME_RATE;
        let outline = seen(pebble, &about_the_origin(0.9)(time), Some((hidden, 0)), &mut random);
        let step = run.step(time, &outline).expect("increasing times");
        assert_eq!(restored.step(time, &outline).expect("increasing times"), step);
        restored = MotionFilter::from_bytes(&run.to_bytes().expect("bytes")).expect("a filter");
    }
    assert_eq!(run.standing_edges().len(), 1);
    assert!(run.standing_edges().eq(restored.standing_edges()));
    assert_eq!(run.state(), restored.state());
}
