//! Arcs that are found near where an object is expected, in frames that do not show it as a whole.
use freeform_motion::curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::ExpectedOutline;
use freeform_motion::{Tracker, TrackerSettings};
use nalgebra::{Isometry2, Point2, Vector2};

/// An egg that turns anticlockwise at 0.5 rad/s and drifts to the right at 0.2/s, anywhere on its outline.
fn egg(time: f64, t: f64) -> Point2<f64> {
    let pose = Isometry2::new(Vector2::new(0.2 * time, 0.0), 0.5 * time);
    pose * Point2::new(t.cos() + 0.1 * (2.0 * t).cos(), 0.6 * t.sin())
}

fn angles(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..200).map(move |i| from + (to - from) * f64::from(i) / 200.0)
}

fn frame(number: u64, outline: Outline) -> OutlineFrame {
    OutlineFrame { frame: number, time: time_of(number), object: "egg".to_owned(), outline }
}

fn time_of(frame: u64) -> f64 {
    frame as f64 / 30.0
}

fn whole(number: u64) -> OutlineFrame {
    let points = angles(0.0, std::f64::consts::TAU).map(|t| egg(time_of(number), t)).collect();
    frame(number, Outline::closed(points).expect("an egg"))
}

/// A square elsewhere.
fn something_else(number: u64) -> OutlineFrame {
    let side = |x: f64, y: f64, dx: f64, dy: f64| {
        (0..50).map(move |i| Point2::new(x + dx * f64::from(i) / 50.0, y + dy * f64::from(i) / 50.0))
    };
    let sides = side(3.0, 3.0, 2.0, 0.0).chain(side(5.0, 3.0, 0.0, 2.0)).chain(side(5.0, 5.0, -2.0, 0.0));
    frame(number, Outline::closed(sides.chain(side(3.0, 5.0, 0.0, -2.0)).collect()).expect("a square"))
}

/// Two thirds of the egg.
fn arcs(time: f64) -> Option<Outline> {
    let arc = OpenArc::new(angles(0.3, 4.5).map(|t| egg(time, t)).collect()).ok()?;
    Some(OpenOutline::in_sequence(vec![arc]).ok()?.into())
}

fn tracker() -> Tracker {
    let mut tracker = Tracker::new(TrackerSettings::default()).expect("default settings");
    (0..10).for_each(|number| assert!(tracker.push(&whole(number)).is_accepted()));
    tracker
}

/// Largest distance of an expected outline from the egg.
fn farthest(expected: &ExpectedOutline, time: f64) -> f64 {
    let egg: Vec<_> = angles(0.0, std::f64::consts::TAU).map(|t| egg(time, t)).collect();
    let distance = |p: &Point2<f64>| egg.iter().map(|q| (p - q).norm()).fold(f64::MAX, f64::min);
    expected.pieces.iter().flat_map(|piece| &piece.points).map(distance).fold(0.0, f64::max)
}

#[test]
fn an_outline_is_expected_where_the_motion_has_led_it_less_and_less_certainly() {
    let tracker = tracker();
    let now = tracker.expected_outline("egg", time_of(9)).expect("a tracked egg");
    let later = tracker.expected_outline("egg", time_of(24)).expect("a tracked egg");
    assert!(farthest(&now, time_of(9)) < 0.03 && farthest(&later, time_of(24)) < 0.05);
    assert!(0.0 < now.deviation && 2.0 * now.deviation < later.deviation, "{} {}", now.deviation, later.deviation);
    assert!(later.pieces.len() == 1 && later.pieces[0].closed);
    assert_eq!(tracker.expected_outline("another", time_of(24)), None);
    assert_eq!(tracker.expected_outline("egg", f64::NAN), None);
}

#[test]
fn arcs_are_taken_in_place_of_something_else_and_what_is_no_arc_of_the_object_is_not() {
    let mut tracker = tracker();
    let (observation, taken) = tracker.push_or_seek(&something_else(10), |expected| {
        assert!(farthest(expected, time_of(10)) < 0.03);
        arcs(time_of(10))
    });
    assert!(observation.is_accepted());
    assert_eq!(taken.map(|taken| taken.outline), arcs(time_of(10)));

    let mut without = tracker.clone();
    let alone = without.push(&something_else(11));
    // What was found lies where the egg was a second ago.
    let (observation, taken) = tracker.push_or_seek(&something_else(11), |_| arcs(time_of(11) - 1.0));
    assert!(!observation.is_accepted() && taken.is_none());
    assert_eq!((observation, tracker.results()), (alone, without.results()), "as if nothing had been looked for");
    let (observation, taken) = tracker.push_or_seek(&whole(12), |_| unreachable!("all of it is there"));
    assert!(observation.is_accepted() && taken.is_none());
}

#[test]
fn an_object_that_is_not_in_a_frame_is_looked_for_and_nothing_changes_where_it_is_not_found() {
    let mut tracker = tracker();
    let before = tracker.results();
    assert!(tracker.seek("egg", 10, time_of(10), |_| None).is_none());
    assert!(tracker.seek("egg", 10, time_of(10), |_| arcs(time_of(10) + 2.0)).is_none());
    assert!(tracker.seek("another", 10, time_of(10), |_| unreachable!("nobody knows it")).is_none());
    assert_eq!(tracker.results(), before);
    let (observation, _) = tracker.seek("egg", 10, time_of(10), |_| arcs(time_of(10))).expect("two thirds of it");
    assert!(observation.is_accepted());
    assert_eq!(tracker.results()[0].frames, before[0].frames + 1);
}

/// A bar of 120 by 20 that lies still for fifteen frames and then goes along itself by so much a frame; its points lie anywhere on it.
fn starting_bar(number: u64, step: f64) -> OutlineFrame {
    let moved = step * (number as f64 - 14.0).max(0.0);
    let corners = [(0.0, 0.0, 1.0, 0.0), (120.0, 0.0, 0.0, 1.0), (120.0, 20.0, -1.0, 0.0), (0.0, 20.0, 0.0, -1.0)];
    let begun_at = (0.618 * number as f64).fract();
    let sides = corners.into_iter().zip([120, 20, 120, 20]).flat_map(|((x, y, dx, dy), points)| {
        (0..points).map(move |i| {
            let (along, error) = (f64::from(i) + begun_at, 0.05 * (12.9 * f64::from(i) + 3.1 * number as f64).sin());
            Point2::new(x + dx * along + dy * error + moved, y + dy * along + dx * error)
        })
    });
    OutlineFrame { object: "bar".to_owned(), ..frame(number, Outline::closed(sides.collect()).expect("a bar")) }
}

#[test]
fn nothing_is_looked_for_where_a_bar_was_if_all_of_it_is_seen_where_it_has_gone() {
    let mut elsewhere = 0;
    for step in [3.0, 4.0, -6.0, 8.0, 15.0, -30.0] {
        let mut tracker = Tracker::new(TrackerSettings::default()).expect("default settings");
        for number in 0..18 {
            let bar = starting_bar(number, step);
            let (observation, _) = tracker.push_or_seek(&bar, |_| unreachable!("{step}: all of it is there"));
            let told = observation.rejection.map(|rejection| rejection.to_string()).unwrap_or_default();
            elsewhere += u32::from(told.contains("shows the object at a distance of"));
        }
    }
    assert!(elsewhere > 0);
}
