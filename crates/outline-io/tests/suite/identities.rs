//! Objects keep their names from picture to picture.
use std::collections::BTreeMap;

use crate::support::traced;
use freeform_outline_io::{
    AmongAlike, GrayImage, PictureFrame, PictureOutlines, PictureSettings, Selection, TraceError, TraceSettings,
    TracedFrame,
};
use image::Luma;
use nalgebra::Point2;

/// Discs at these places.
fn discs(places: &[(f64, f64, f64)]) -> GrayImage {
    GrayImage::from_fn(200, 100, |x, y| {
        let inside = |&(cx, cy, r): &(f64, f64, f64)| (f64::from(x) - cx).hypot(f64::from(y) - cy) < r;
        Luma([if places.iter().any(inside) { 220 } else { 10 }])
    })
}

#[test]
fn objects_keep_their_names_while_they_pass_each_other_vanish_and_come_back() {
    let pictures: Vec<GrayImage> = (0..40)
        .map(|frame| {
            let along = 4.0 * f64::from(frame);
            let mut places = vec![(20.0 + along, 30.0, 12.0), (180.0 - along, 56.0, 9.0)];
            if (12..16).contains(&frame) {
                places.remove(1);
            }
            discs(&places)
        })
        .collect();
    let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
    for (frame, traced) in traced(pictures, settings).iter().enumerate() {
        for (name, object) in traced.objects.as_ref().expect("objects") {
            let along = 4.0 * frame as f64;
            let expected = if *name == 0 { 20.0 + along } else { 180.0 - along };
            assert!(*name < 2 && (object.centre.x - expected).abs() < 1.5, "frame {frame}: {name} {}", object.centre);
        }
    }
}

#[test]
fn a_ball_keeps_its_name_while_it_moves_by_several_times_its_size_and_bounces() {
    let place = |frame: u32| {
        let along = if frame < 5 { 30.0 * f64::from(frame) } else { 270.0 - 30.0 * f64::from(frame) };
        (20.0 + along, 20.0 + 0.6 * f64::from(frame).powi(2))
    };
    let pictures: Vec<GrayImage> = (0..10)
        .map(|frame| {
            let (x, y) = place(frame);
            discs(&[(100.0, 90.0, 8.0), (x, y, 4.0)])
        })
        .collect();
    let trace = TraceSettings { y_up: false, minimum_area: 20, ..TraceSettings::default() };
    let settings = PictureSettings { selection: Selection::All, trace, ..PictureSettings::default() };
    for (frame, traced) in traced(pictures, settings).iter().enumerate() {
        let objects = traced.objects.as_ref().expect("both");
        let (x, y) = place(frame as u32);
        let names: Vec<u64> = objects.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, [0, 1], "frame {frame}");
        let ball = &objects.iter().min_by(|a, b| a.1.area.total_cmp(&b.1.area)).expect("a ball");
        assert!(ball.0 == 1 && (ball.1.centre - Point2::new(x, y)).norm() < 1.0, "frame {frame}: {}", ball.1.centre);
    }
}

#[test]
fn a_hole_and_the_ground_around_it_that_the_edge_of_the_picture_cuts_keep_their_names() {
    // Their middles are nearer to each other than the ground is wide, and in the first picture something else is all that is seen.
    let pictures: Vec<GrayImage> = (0..8)
        .map(|frame| {
            GrayImage::from_fn(200, 100, |x, y| {
                let far = (f64::from(x) - 80.0).hypot(f64::from(y) - 50.0);
                let is_light = if frame == 0 { x > 190 && y < 40 } else { far < 12.0 || far > 22.0 && x < 170 };
                Luma([if is_light { 220 } else { 10 }])
            })
        })
        .collect();
    let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
    let mut names = Vec::new();
    for traced in traced(pictures, settings).iter().skip(1) {
        let objects = traced.objects.as_ref().expect("both");
        assert_eq!(objects.len(), 2);
        names.push(objects.iter().min_by(|a, b| a.1.area.total_cmp(&b.1.area)).expect("the hole").0);
    }
    assert!(names.iter().all(|name| *name == names[0]), "{names:?}");
}

#[test]
fn only_what_has_left_its_place_is_taken_where_what_moves_is_asked_for() {
    let pictures: Vec<GrayImage> = (0..12)
        .map(|frame| {
            let mut places = vec![(100.0, 80.0, 12.0), (20.0 + 6.0 * f64::from(frame), 20.0, 9.0)];
            // Something flickers.
            if frame % 2 == 0 {
                places.push((160.0, 50.0, 8.0));
            }
            discs(&places)
        })
        .collect();
    let settings = PictureSettings { selection: Selection::Moving, ..PictureSettings::default() };
    for (frame, traced) in traced(pictures, settings).iter().enumerate() {
        match &traced.objects {
            Ok(objects) => {
                assert!(frame > 2 && objects.len() == 1, "frame {frame}: {}", objects.len());
                assert!((objects[0].1.centre.x - 20.5 - 6.0 * frame as f64).abs() < 1.0, "frame {frame}");
            }
            Err(error) => assert!(frame < 4 && error == &TraceError::NothingMoved, "{frame}: {error}"),
        }
    }
}

/// A square and a triangle of like area at these places, each turned by an angle.
fn square_and_triangle(square: Option<(f64, f64)>, triangle: Option<(f64, f64)>, turn: f64) -> GrayImage {
    let (sin, cos) = turn.sin_cos();
    GrayImage::from_fn(240, 100, |x, y| {
        let body = |(cx, cy): (f64, f64)| {
            let (x, y) = (f64::from(x) - cx, f64::from(y) - cy);
            (cos * x + sin * y, cos * y - sin * x)
        };
        let in_square = square.map(body).is_some_and(|(x, y)| x.abs() < 12.0 && y.abs() < 12.0);
        let in_triangle =
            triangle.map(body).is_some_and(|(x, y)| y > -12.0 && y < 24.0 && x.abs() < (24.0 - y) * 16.0 / 36.0);
        Luma([if in_square || in_triangle { 220 } else { 10 }])
    })
}

#[test]
fn objects_of_like_size_keep_their_names_whether_they_pass_through_each_other_or_turn_back() {
    for turns_back in [false, true] {
        let along =
            |frame: u32| if turns_back && frame > 20 { 3.0 * f64::from(40 - frame) } else { 3.0 * f64::from(frame) };
        let pictures: Vec<GrayImage> = (0..40)
            .map(|frame| {
                let (square, triangle) = ((50.0 + along(frame), 46.0), (180.0 - along(frame), 50.0));
                square_and_triangle(Some(square), Some(triangle), 0.05 * f64::from(frame))
            })
            .collect();
        let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
        let seen = traced(pictures, settings);
        let first = seen[0].objects.as_ref().expect("both");
        let triangle = first.iter().find(|(_, object)| object.centre.x > 120.0).expect("the triangle").0;
        let mut touching = 0;
        for (frame, traced) in seen.iter().enumerate() {
            let objects = match &traced.objects {
                Ok(objects) => objects,
                Err(error) => {
                    assert_eq!(error, &TraceError::Touching { objects: 2 }, "frame {frame}");
                    touching += 1;
                    continue;
                }
            };
            for (name, object) in objects {
                let along = along(frame as u32);
                let expected = if *name == triangle { 180.0 - along } else { 50.0 + along };
                assert!(
                    *name < 2 && (object.centre.x - expected).abs() < 3.0,
                    "turns back: {turns_back}, frame {frame}: {name} at {}, not {expected}",
                    object.centre
                );
            }
        }
        assert!((3..15).contains(&touching), "{touching}");
    }
}

/// Two bars of 48 x 6 pixels, 10 pixels apart, that pass each other; in frame 10, when they are above each other, the camera is
/// knocked by 7 pixels, so that each seems to be near where the other was.
fn passing_bars(frame: u32) -> [(f64, f64); 2] {
    let (along, knock) = (3.0 * f64::from(frame), if frame >= 10 { 7.0 } else { 0.0 });
    [(70.0 + along, 40.0 + knock), (130.0 - along, 50.0 + knock)]
}

#[test]
fn names_are_not_swapped_where_one_object_is_nearest_to_the_place_of_the_other() {
    let pictures: Vec<GrayImage> = (0..20)
        .map(|frame| {
            let bars = passing_bars(frame);
            GrayImage::from_fn(200, 100, |x, y| {
                let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let inside = |&(cx, cy): &(f64, f64)| (x - cx).abs() < 24.0 && (y - cy).abs() < 3.0;
                Luma([if bars.iter().any(inside) { 220 } else { 10 }])
            })
        })
        .collect();
    let trace = TraceSettings { y_up: false, ..TraceSettings::default() };
    let settings = PictureSettings { selection: Selection::All, trace, ..PictureSettings::default() };
    let seen = traced(pictures, settings);
    let first = seen[0].objects.as_ref().expect("both bars");
    let upper = first.iter().find(|(_, object)| object.centre.y < 45.0).expect("the upper bar").0;
    for (frame, traced) in seen.iter().enumerate() {
        let objects = traced.objects.as_ref().expect("both bars");
        assert_eq!(objects.len(), 2, "frame {frame}");
        let [of_upper, of_lower] = passing_bars(frame as u32).map(|(x, y)| Point2::new(x, y));
        for (name, object) in objects {
            let expected = if *name == upper { of_upper } else { of_lower };
            assert!((object.centre - expected).norm() < 0.5, "frame {frame}: {name} at {}", object.centre);
        }
    }
}

#[test]
fn objects_that_come_back_elsewhere_are_told_by_their_shape() {
    // Where each was when they were last seen, the other comes back.
    let pictures: Vec<GrayImage> = (0..16)
        .map(|frame| match frame {
            0..6 => square_and_triangle(Some((100.0, 50.0)), Some((145.0, 50.0)), 0.0),
            6..10 => square_and_triangle(None, None, 0.0),
            _ => square_and_triangle(Some((145.0, 50.0)), Some((100.0, 50.0)), 0.3),
        })
        .collect();
    let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
    let seen = traced(pictures, settings);
    let place = |frame: usize, name: u64| {
        let objects = seen[frame].objects.as_ref().expect("objects");
        objects.iter().find(|(other, _)| *other == name).expect("both names").1.centre.x
    };
    for (name, other) in [(0, 1), (1, 0)] {
        let (before, after) = (place(0, other), place(15, name));
        assert!((after - before).abs() < 3.0, "object {name} at {after}, not {before}");
    }
}

#[test]
fn the_nearest_object_is_followed_where_a_larger_one_comes_in() {
    let pictures: Vec<GrayImage> = (0..20)
        .map(|frame| {
            let mut places = vec![(30.0 + 3.0 * f64::from(frame), 30.0, 10.0)];
            if frame > 5 {
                places.push((150.0, 70.0, 20.0));
            }
            discs(&places)
        })
        .collect();
    let mut with_gap = pictures.clone();
    with_gap[10] = discs(&[(150.0, 70.0, 20.0)]);
    let settings = PictureSettings { selection: Selection::Nearest, ..PictureSettings::default() };
    for (frame, traced) in traced(with_gap, settings).iter().enumerate() {
        match &traced.objects {
            Ok(objects) => assert!((objects[0].1.centre.x - 30.5 - 3.0 * frame as f64).abs() < 1.0, "frame {frame}"),
            Err(error) => assert!(frame == 10 && matches!(error, TraceError::NotNear { .. }), "{frame}: {error}"),
        }
    }
}

/// A number from 0 to 1, the same whenever it is asked for.
fn scattered(count: u32) -> f64 {
    let mixed = (count ^ (count >> 16)).wrapping_mul(0x85eb_ca6b);
    let mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
    f64::from(mixed ^ (mixed >> 16)) / f64::from(u32::MAX)
}

#[test]
fn specks_that_come_and_go_anywhere_are_hardly_ever_taken_for_something_that_moves() {
    const FRAMES: u32 = 60;
    for specks in [2, 4, 8, 16] {
        let pictures: Vec<GrayImage> = (0..FRAMES)
            .map(|frame| {
                let at = |k: u32| {
                    let number = |n: u32| scattered(0x9e37_79b9_u32.wrapping_mul(3 * (64 * frame + k) + n + 1));
                    (10.0 + 180.0 * number(0), 10.0 + 80.0 * number(1), 3.0 + number(2))
                };
                discs(&(0..specks).map(at).collect::<Vec<_>>())
            })
            .collect();
        let trace = TraceSettings { minimum_area: 10, ..TraceSettings::default() };
        let settings = PictureSettings { selection: Selection::Moving, trace, ..PictureSettings::default() };
        let seen = traced(pictures, settings);
        let taken: usize = seen.iter().filter_map(|traced| Some(traced.objects.as_ref().ok()?.len())).sum();
        assert!(taken * 10 < (specks * FRAMES) as usize, "{taken} in {FRAMES} pictures of {specks} specks");
    }
}

#[test]
fn a_first_sighting_is_not_taken_for_one_far_away_where_something_else_is_like_it() {
    for (seen, is_known) in [(vec![(80.0, 50.0, 5.0)], true), (vec![(80.0, 50.0, 5.0), (30.0, 80.0, 5.0)], false)] {
        let pictures = vec![discs(&[(50.0, 50.0, 5.0)]), discs(&seen)];
        let trace = TraceSettings { minimum_area: 20, ..TraceSettings::default() };
        let settings = PictureSettings { selection: Selection::All, trace, ..PictureSettings::default() };
        let traced = traced(pictures, settings);
        let names: Vec<u64> = traced[1].objects.as_ref().expect("discs").iter().map(|(name, _)| *name).collect();
        assert_eq!(names.contains(&0), is_known, "{names:?}");
    }
}

/// Of each picture the names with their places, and whether the border cuts them.
type Named = Vec<Vec<(u64, f64, bool)>>;

/// The names of the parts of a row in so many pictures, and steps that may be others.
fn row_of_parts(places: &[f64], step: f64, pictures: u32) -> (Named, Vec<AmongAlike>) {
    let picture = |frame: u32| {
        GrayImage::from_fn(500, 60, |x, y| {
            let inside = |place: &f64| {
                let (x, y) = (f64::from(x) - place - step * f64::from(frame), f64::from(y) - 30.0);
                x.abs() < 20.0 && y.abs() < 12.0 && (x > -8.0 || y > -2.0)
            };
            Luma([if places.iter().any(inside) { 220 } else { 10 }])
        })
    };
    let frame = |frame: u32| {
        let (time, file, picture) = (f64::from(frame), String::new(), picture(frame).into());
        Ok(PictureFrame { frame: frame.into(), time, file, picture })
    };
    let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
    let mut outlines = PictureOutlines::new((0..pictures).map(frame), settings).expect("settings");
    let named = |traced: TracedFrame| {
        let objects = traced.objects.unwrap_or_default();
        objects.iter().map(|(name, object)| (*name, object.centre.x, object.touches_border)).collect()
    };
    let seen = outlines.by_ref().map(|traced| named(traced.expect("a picture"))).collect();
    (seen, outlines.among_alike().to_vec())
}

/// How many steps of one name from one picture to the next, whole in both, are and are not this one.
fn steps_of_names(seen: &Named, step: f64) -> [usize; 2] {
    let mut counts = [0, 0];
    for pair in seen.windows(2) {
        for (name, x, _) in pair[1].iter().filter(|object| !object.2) {
            let before = pair[0].iter().find(|object| object.0 == *name && !object.2);
            if let Some((_, from, _)) = before {
                counts[usize::from((x - from - step).abs() > 2.0)] += 1;
            }
        }
    }
    counts
}

/// Of parts of which the neighbour was nearer than they were themselves, every second picture was left out, and two steps less the distance to the
/// neighbour were stated for one.
#[test]
fn parts_in_a_row_keep_their_names_however_fast_they_move_together() {
    for step in [30.0, 45.0, 55.0, -45.0] {
        let (seen, doubts) = row_of_parts(&[140.0, 240.0, 340.0], step, 3);
        assert_eq!(steps_of_names(&seen, step)[1], 0, "{step}: {seen:?}");
        assert!(seen.iter().flatten().all(|object| object.0 < 3), "{step}: {seen:?}");
        assert!(doubts.is_empty(), "{step}: {doubts:?}");
    }
}

#[test]
fn parts_of_a_belt_make_the_smallest_step_and_it_is_said_where_that_may_be_another() {
    let belt: Vec<f64> = (-20..25).map(|i| 100.0 * f64::from(i) + 13.0).collect();
    for (step, taken, is_told) in
        [(0.0, 0.0, false), (12.0, 12.0, false), (30.0, 30.0, false), (42.0, 42.0, true), (60.0, -40.0, true)]
    {
        let (seen, doubts) = row_of_parts(&belt, step, 20);
        let [right, wrong] = steps_of_names(&seen, taken);
        assert!(wrong == 0 && right >= 50, "{step}: {right} {wrong}");
        assert_eq!(!doubts.is_empty(), is_told, "{step}: {doubts:?}");
        // Every name is that of one part, cut by the border or not: which one its place says, up to what is cut of it.
        let mut parts: BTreeMap<u64, i64> = BTreeMap::new();
        for (frame, objects) in seen.iter().enumerate() {
            for (name, x, _) in objects {
                let part = ((x - 13.0 - taken * frame as f64) / 100.0).round() as i64;
                assert_eq!(*parts.entry(*name).or_insert(part), part, "{step}: {name} in {frame}");
            }
        }
    }
}

#[test]
fn parts_that_go_their_own_way_beside_a_row_keep_their_names() {
    let part = |x: f64, y: f64, (cx, cy): (f64, f64)| (x - cx).abs() < 20.0 && (y - cy).abs() < 12.0;
    let picture = |frame: f64| {
        let row = [40.0, 140.0, 240.0, 340.0].map(|x| (x + 60.0 * frame, 30.0));
        let loose = [(100.0 + 12.0 * frame, 90.0), (200.0 - 12.0 * frame, 90.0)];
        let places: Vec<_> = row.into_iter().chain(loose).collect();
        GrayImage::from_fn(500, 120, |x, y| {
            let inside = |place: &(f64, f64)| part(f64::from(x), f64::from(y), *place);
            Luma([if places.iter().any(inside) { 220 } else { 10 }])
        })
    };
    let settings = PictureSettings { selection: Selection::All, ..PictureSettings::default() };
    let seen = traced(vec![picture(0.0), picture(1.0)], settings);
    let [first, second] = [0, 1].map(|k| seen[k].objects.as_ref().expect("objects"));
    for (name, object) in first {
        let moved = second.iter().find(|other| other.0 == *name).expect("its name").1.centre - object.centre;
        // y points up: the row is above.
        let expected = match object.centre {
            place if place.y > 60.0 => 60.0,
            place if place.x < 150.0 => 12.0,
            _ => -12.0,
        };
        assert!((moved.x - expected).abs() < 1.0, "{name} at {}: {}", object.centre, moved.x);
    }
}

/// A belt that comes into an empty picture shows one part alone that is new at a time.
#[test]
fn a_part_that_comes_in_first_is_not_taken_for_the_one_after_it() {
    let belt: Vec<f64> = (0..20).map(|i| -40.0 - 100.0 * f64::from(i)).collect();
    let (seen, _) = row_of_parts(&belt, 55.0, 12);
    let [right, wrong] = steps_of_names(&seen, 55.0);
    assert!(wrong == 0 && right > 20, "{right} {wrong}: {seen:?}");
}
