//! What is chosen to be followed where no option says it.
use std::sync::Arc;

use freeform_outline_io::{
    Channel, GrayImage, Margins, PictureError, PictureFrame, PictureSample, PictureSettings, Selection, TraceError,
    TraceSettings, TracedOutline, TracingChoice, TracingEvidence, TracingWarning, TracingWay, choose_tracing,
    trace_objects,
};
use image::Luma;

/// Noise of a few grey values, the same whenever it is asked for.
pub(crate) fn noise(x: u32, y: u32, frame: u32) -> f64 {
    let mut mixed = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ frame.wrapping_mul(0xc2b2_ae3d);
    mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d);
    f64::from((mixed ^ (mixed >> 13)) % 7) - 3.0
}

/// A picture of what is light at some places, with edges of a pixel.
fn picture(frame: u32, light: impl Fn(f64, f64) -> f64) -> GrayImage {
    GrayImage::from_fn(320, 240, |x, y| {
        let outside = light(f64::from(x) + 0.5, f64::from(y) + 0.5);
        Luma([(40.0 + 140.0 * (0.5 - outside).clamp(0.0, 1.0) + noise(x, y, frame)).round() as u8])
    })
}

/// Distance from a disc.
fn disc(x: f64, y: f64, [cx, cy, radius]: [f64; 3]) -> f64 {
    (x - cx).hypot(y - cy) - radius
}

/// Distance from a ruler that stands upright.
fn ruler(x: f64, y: f64) -> f64 {
    ((x - 150.0).abs() - 8.0).max((y - 120.0).abs() - 90.0)
}

fn chosen(pictures: &[GrayImage]) -> TracingEvidence {
    choice(pictures).best().expect("a way").clone()
}

pub(crate) fn choice(pictures: &[GrayImage]) -> TracingChoice {
    let sample = PictureSample::read(&[Channel::Luminance], |_| {
        let frame = |(frame, picture): (u64, GrayImage)| {
            let time = frame as f64 / 30.0;
            Ok::<_, PictureError>(PictureFrame { frame, time, file: "memory".to_owned(), picture: picture.into() })
        };
        Some((0..).zip(pictures.to_vec()).map(frame))
    });
    let trace = TraceSettings { minimum_area: 64, ..TraceSettings::default() };
    choose_tracing(&sample, &PictureSettings { trace, ..PictureSettings::default() }, &[])
}

#[test]
fn of_a_disc_and_a_smaller_one_the_share_of_the_smaller_is_told() {
    for (radius, expected) in [(15.0, 0.25), (0.0, 0.0)] {
        let pictures = (0..12).map(|frame| {
            let shift = 4.0 * f64::from(frame);
            let large = [60.0 + shift, 80.0, 30.0];
            let small = [240.0 - shift, 180.0, radius];
            picture(frame, |x, y| disc(x, y, large).min(disc(x, y, small) + if radius > 0.0 { 0.0 } else { 9.0 }))
        });
        let best = chosen(&pictures.collect::<Vec<_>>());
        assert_eq!(best.selection, Selection::Largest);
        assert!((best.second - expected).abs() < 0.03, "{radius}: {}", best.second);
    }
}

#[test]
fn a_small_disc_that_moves_is_followed_where_something_larger_rests() {
    // By its own size, and by four times that, from picture to picture.
    for (step, radius) in [(6.0, 8.0), (24.0, 6.0)] {
        let pictures = (0..12).map(|frame| {
            let place = [16.0 + step * f64::from(frame), 30.0 + 1.5 * f64::from(frame), radius];
            picture(frame, |x, y| ruler(x, y).min(disc(x, y, place)))
        });
        let best = chosen(&pictures.collect::<Vec<_>>());
        assert!(matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "step {step}: {best:?}");
        assert!(best.movement > 3.0 * step, "step {step}: {best:?}");
    }
}

#[test]
fn what_rests_is_told_to_rest_where_nothing_moves() {
    let best = chosen(&(0..12).map(|frame| picture(frame, ruler)).collect::<Vec<_>>());
    assert!(best.rests && best.selection == Selection::Largest, "{best:?}");
}

#[test]
fn all_are_followed_where_something_smaller_turns_in_its_place_beside_what_rests() {
    for (length, turn) in [(34.0, 0.08), (22.0, -0.05)] {
        let pictures = (0..24).map(|frame| {
            picture(frame, |x, y| {
                let (sine, cosine) = (turn * f64::from(frame)).sin_cos();
                let (x0, y0) = (x - 80.0, y - 110.0);
                let (along, across) = (cosine * x0 + sine * y0, cosine * y0 - sine * x0);
                let bar = (along.abs() - length).max(across.abs() - 9.0);
                bar.min(disc(x, y, [225.0, 130.0, 40.0]))
            })
        });
        let choice = choice(&pictures.collect::<Vec<_>>());
        let best = choice.best().expect("a way");
        assert!(best.rests && best.selection == Selection::All, "{length}: {best:?}");
        assert!(!matches!(best.tracing.way, TracingWay::Median(_)), "{length}: {best:?}");
        assert_eq!(choice.warnings().next(), None, "{length}");
    }
}

/// A picture of a light disc, and a dark one, on a ground between them.
fn light_and_dark(frame: u32, light: [f64; 3], dark: [f64; 3]) -> GrayImage {
    GrayImage::from_fn(320, 240, |x, y| {
        let covered = |at| (0.5 - disc(f64::from(x) + 0.5, f64::from(y) + 0.5, at)).clamp(0.0, 1.0);
        let grey = 120.0 + (60.0 - 120.0) * covered(dark);
        Luma([(grey + (200.0 - grey) * covered(light) + noise(x, y, frame)).round() as u8])
    })
}

#[test]
fn a_dark_thing_that_moves_beside_a_light_one_is_told_and_a_shadow_is_not() {
    let told = |dark: fn(f64) -> [f64; 3]| {
        let pictures = (0..40).map(|frame| {
            let time = f64::from(frame);
            light_and_dark(frame, [50.0 + 2.0 * time, 60.0, 26.0], dark(time))
        });
        let choice = choice(&pictures.collect::<Vec<_>>());
        assert_eq!(choice.best().expect("a way").tracing.way, TracingWay::Lighter);
        choice.warnings().next()
    };
    let beside = told(|time| [270.0 - 2.0 * time, 180.0, 22.0]);
    assert!(
        matches!(beside, Some(TracingWarning::MovesBeside { seen, pictures }) if 2 * seen > pictures),
        "{beside:?}"
    );
    assert_eq!(told(|time| [62.0 + 2.0 * time, 76.0, 25.0]), None);
}

#[test]
fn the_largest_is_followed_where_something_smaller_rests_beside_it() {
    let resting = |x, y| disc(x, y, [225.0, 130.0, 40.0]).min(disc(x, y, [80.0, 110.0, 18.0]));
    let best = chosen(&(0..24).map(|frame| picture(frame, resting)).collect::<Vec<_>>());
    assert!(best.rests && best.selection == Selection::Largest, "{best:?}");
}

#[test]
fn a_toothed_wheel_that_turns_in_its_place_is_followed_and_not_its_teeth() {
    for turn in [0.02, 0.2] {
        let wheel = |frame: u32| {
            picture(frame, move |x, y| {
                let (x, y) = (x - 160.0, y - 120.0);
                let along = y.atan2(x) - turn * f64::from(frame);
                x.hypot(y) - 60.0 - 8.0 * (5.0 * along).cos()
            })
        };
        let best = chosen(&(0..24).map(wheel).collect::<Vec<_>>());
        assert!(!matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "{turn}: {best:?}");
        assert!((0.12..0.2).contains(&best.area_share), "{turn}: {best:?}");
    }
}

#[test]
fn teeth_of_a_wheel_that_turns_about_a_middle_that_hardly_moves_are_nothing_that_moves_beside_it() {
    for (turn, step) in [(0.034, 0.2), (0.023, 0.05), (-0.06, 0.3)] {
        let wheel = |frame: u32| {
            picture(frame, move |x, y| {
                let frame = f64::from(frame);
                let (x, y) = (x - 160.0 - step * frame, y - 120.0 + 0.5 * step * frame);
                let along = y.atan2(x) - turn * frame;
                // One of 17 is missing.
                let is_tooth =
                    (17.0 * along).cos() > 0.0 && !(0.0..0.3).contains(&along.rem_euclid(std::f64::consts::TAU));
                (x.hypot(y) - if is_tooth { 72.0 } else { 64.0 }).clamp(-1.0, 1.0)
            })
        };
        let choice = choice(&(0..24).map(wheel).collect::<Vec<_>>());
        let best = choice.best().expect("a way");
        assert!(!matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "{turn}: {best:?}");
        let warned: Vec<TracingWarning> = choice.warnings().collect();
        assert!(warned.is_empty(), "{turn}: {warned:?}");
    }
}

#[test]
fn a_disc_that_swings_slowly_does_not_rest() {
    // From picture to picture by less than it would be seen to move, and back to where it was.
    for amplitude in [0.0, 7.0] {
        let swinging = |frame: u32| {
            let along = amplitude * (std::f64::consts::TAU * f64::from(frame) / 24.0).cos();
            picture(frame, move |x, y| disc(x, y, [160.0 + along, 120.0, 40.0]))
        };
        let best = chosen(&(0..24).map(swinging).collect::<Vec<_>>());
        assert_eq!(best.rests, amplitude == 0.0, "{best:?}");
    }
}

/// A ruler, to which something beside it is joined in some of the pictures, as a threshold between them joins things.
fn joined_ruler(x: f64, y: f64, frame: u32) -> f64 {
    let beside = ((x - 190.0).abs() - 36.0).max((y - 200.0).abs() - 9.0);
    if frame < 8 { ruler(x, y).min(beside) } else { ruler(x, y) }
}

#[test]
fn what_has_more_around_it_in_some_pictures_rests_where_it_lies_in_one_place_whenever_it_looks_the_same() {
    for step in [0.0, 1.5] {
        let moved = |frame: u32| picture(frame, |x, y| joined_ruler(x - step * f64::from(frame), y, frame));
        let best = chosen(&(0..24).map(moved).collect::<Vec<_>>());
        assert!(!matches!(best.tracing.way, TracingWay::Median(_)), "{step}: {best:?}");
        assert!(best.movement > 5.0, "{step}: {best:?}");
        assert_eq!(best.rests, step == 0.0, "{best:?}");
    }
}

#[test]
fn a_fast_thing_whose_area_is_never_the_same_is_followed_where_something_larger_rests() {
    let pictures = (0..24).map(|frame| {
        // To and fro, as a pendulum does.
        let along = 110.0 * (0.5 + 0.35 * f64::from(frame)).sin();
        let radius = [4.9, 5.88][frame as usize % 2];
        let place = [150.0 + along, 215.0 - 0.0009 * along * along, radius];
        picture(frame, |x, y| (ruler(x, y + 25.0)).min(disc(x, y, place)))
    });
    let best = chosen(&pictures.collect::<Vec<_>>());
    assert!(matches!(best.tracing.way, TracingWay::Median(_)) && !best.rests, "{best:?}");
    assert!(best.movement > 100.0, "{best:?}");
    // It is not told by its score, which is that of clutter.
    assert!(best.score < 0.005, "{best:?}");
}

#[test]
fn changes_beside_what_rests_are_warned_of_and_noise_is_not() {
    for changing in [false, true] {
        let pictures = (0..24).map(|frame| {
            // Here and there, in no way that goes on.
            let at = |k: u32| f64::from(frame * 7919 + k * 104_729).sin().abs();
            let place =
                [20.0 + 100.0 * at(1), 20.0 + 190.0 * at(2), if changing && frame % 2 == 0 { 9.0 } else { -9.0 }];
            picture(frame, |x, y| ruler(x - 60.0, y).min(disc(x, y, place)))
        });
        let choice = choice(&pictures.collect::<Vec<_>>());
        assert!(choice.best().is_some_and(|best| best.rests), "{choice:?}");
        let warned: Vec<TracingWarning> = choice.warnings().collect();
        let expected = if changing { vec![TracingWarning::MovesBesideRest { seen: 12, pictures: 24 }] } else { vec![] };
        assert_eq!(warned, expected);
    }
}

#[test]
fn changes_within_the_outline_of_what_rests_are_warned_of() {
    for changing in [false, true] {
        let pictures = (0..24).map(|frame| {
            // Here and there on a plate, in no way that goes on.
            let at = |k: u32| f64::from(frame * 7919 + k * 104_729).sin().abs();
            let radius = if changing && frame % 2 == 0 { 6.0 } else { -9.0 };
            let place = [90.0 + 140.0 * at(1), 70.0 + 100.0 * at(2), radius];
            let plate = |x: f64, y: f64| ((x - 160.0).abs() - 110.0).max((y - 120.0).abs() - 90.0);
            picture(frame, |x, y| plate(x, y).max(-disc(x, y, place)))
        });
        let choice = choice(&pictures.collect::<Vec<_>>());
        assert!(choice.best().is_some_and(|best| best.rests && best.area_share > 0.3), "{choice:?}");
        let warned: Vec<TracingWarning> = choice.warnings().collect();
        let expected = if changing { vec![TracingWarning::MovesBesideRest { seen: 12, pictures: 24 }] } else { vec![] };
        assert_eq!(warned, expected);
    }
}

#[test]
fn a_puck_that_slides_on_a_plate_is_warned_of_where_an_arm_that_moves_over_the_edge_of_the_plate_changes_its_outline() {
    for moves in [false, true] {
        let pictures = (0..24).map(|frame| {
            let time = if moves { f64::from(frame) } else { 0.0 };
            let plate = |x: f64, y: f64| ((x - 180.0).abs() - 110.0).max((y - 120.0).abs() - 90.0);
            // It reaches over the left edge, and is nowhere twice.
            let arm = |x: f64, y: f64| (x - 150.0).max((y - 85.0 - 3.0 * time).abs() - 6.0);
            let along = 8.0 * time;
            let puck = [175.0 + (along + 50.0).min(150.0 - along), 60.0 + 0.3 * along, 6.0];
            picture(frame, |x, y| plate(x, y).max(-arm(x, y)).max(-disc(x, y, puck)))
        });
        let choice = choice(&pictures.collect::<Vec<_>>());
        let best = choice.best().expect("a way");
        // It is seen well, and only an outline that stays where it is tells that it rests.
        assert!(best.rests != moves && best.score > 0.3 && best.area_share > 0.4, "{best:?}");
        let warned: Vec<TracingWarning> = choice.warnings().collect();
        assert_eq!(matches!(warned[..], [TracingWarning::MovesBeside { .. }]), moves, "{warned:?}, {best:?}");
        assert_eq!(warned.is_empty(), !moves, "{warned:?}");
    }
}

/// A picture between even bars above and below, as of a video that was fitted into another shape.
fn between_bars(frame: u32, of_picture: &GrayImage, [above, below]: [u32; 2]) -> GrayImage {
    GrayImage::from_fn(320, 240, |x, y| {
        let is_bar = y < above || y >= 240 - below;
        if is_bar { Luma([(3.0 + 0.3 * noise(x, y, frame)).round() as u8]) } else { *of_picture.get_pixel(x, y) }
    })
}

#[test]
fn even_bars_at_the_sides_of_pictures_are_left_out_and_a_plain_ground_is_not() {
    for bars in [[0, 0], [30, 0], [24, 37]] {
        let frame = |frame: u32| {
            let place = [60.0 + 8.0 * f64::from(frame), 90.0, 21.0];
            between_bars(frame, &picture(frame, |x, y| disc(x, y, place)), bars)
        };
        let pictures: Vec<GrayImage> = (0..24).map(frame).collect();
        let choice = choice(&pictures);
        // With the rows in which bar and picture may be mixed.
        let [top, bottom] = bars.map(|rows| if rows > 0 { rows + 2 } else { 0 });
        assert_eq!(choice.margins, Margins { top, bottom, ..Margins::default() });
        let best = choice.best().expect("a way");
        assert_eq!((best.tracing.way, best.objects, best.clipped), (TracingWay::Lighter, 1, 0.0), "{best:?}");
        assert!(best.movement > 100.0, "{best:?}");
    }
}

#[test]
fn a_ground_beyond_a_painted_line_is_no_bar() {
    for line in [4, 30] {
        let frame = |frame: u32| {
            let mut picture = picture(frame, |x, y| disc(x, y, [60.0 + 8.0 * f64::from(frame), 90.0, 21.0]));
            let bar = picture.get_pixel(0, 0).0[0];
            for (_, row, pixel) in picture.enumerate_pixels_mut().filter(|(_, row, _)| *row < 32 + line) {
                pixel.0[0] = if row < 32 { bar } else { 240 };
            }
            Arc::new(picture)
        };
        let pictures: Vec<Arc<GrayImage>> = (0..24).map(frame).collect();
        assert_eq!(Margins::of_bars(&pictures), Margins::default(), "{line} rows");
    }
}

#[test]
fn an_outline_has_the_same_points_with_margins_and_is_clipped_by_them() {
    let picture = picture(0, |x, y| disc(x, y, [120.0, 90.0, 30.0]));
    let traced = |margins: Margins| {
        let trace = TraceSettings { margins: Some(margins), pixel_size: 0.5, ..TraceSettings::default() };
        trace_objects(&picture, &trace, 2).expect("a disc").remove(0)
    };
    let [whole, within] = [Margins::default(), Margins { left: 40, top: 30, right: 60, bottom: 25 }].map(traced);
    assert!(!within.touches_border);
    let points = |traced: &TracedOutline| traced.outline.pieces().next().expect("a piece").points.to_vec();
    let [whole, within] = [whole, within].map(|traced| points(&traced));
    assert_eq!(within.len(), whole.len());
    // Up to rounding.
    assert!(whole.iter().zip(&within).all(|(p, q)| (p - q).norm() < 1e-9));
    assert!(traced(Margins { top: 80, ..Margins::default() }).touches_border);
}

#[test]
fn margins_that_leave_nothing_are_refused_and_margins_of_nothing_leave_bars_where_they_are() {
    let picture = picture(0, |x, y| disc(x, y, [120.0, 90.0, 30.0]));
    for margins in [
        Margins { left: 200, right: 120, ..Margins::default() },
        Margins { top: u32::MAX, bottom: u32::MAX, ..Margins::default() },
    ] {
        let trace = TraceSettings { margins: Some(margins), ..TraceSettings::default() };
        let refused = trace_objects(&picture, &trace, 2).expect_err("nothing is left");
        assert!(matches!(refused, TraceError::NothingLeft { columns: 320, rows: 240, .. }), "{refused}");
    }
    let pictures = [picture, GrayImage::new(20, 30)].map(Arc::new);
    assert_eq!(Margins::of_bars(&pictures), Margins::default());
}

#[test]
fn bars_between_pictures_side_by_side_are_left_as_they_are() {
    for between in [0, 8] {
        let pictures: Vec<GrayImage> = (0..24)
            .map(|frame| {
                let place = [60.0 + 2.0 * f64::from(frame), 90.0, 21.0];
                let picture = picture(frame, |x, y| disc(x, y, place));
                let is_bar =
                    |x: u32, y: u32| x.min(319 - x) < 14 || y.min(239 - y) < 14 || (200..200 + between).contains(&x);
                GrayImage::from_fn(320, 240, |x, y| if is_bar(x, y) { Luma([2]) } else { *picture.get_pixel(x, y) })
            })
            .collect();
        let margins =
            if between == 0 { Margins { left: 16, top: 16, right: 16, bottom: 16 } } else { Margins::default() };
        assert_eq!(choice(&pictures).margins, margins);
    }
}

#[test]
fn specks_at_random_places_do_not_go_straight_on_so_often_that_they_are_followed_for_that_alone() {
    let mut followed = 0;
    for seed in 0..12_u32 {
        let mut state = 1 + u64::from(seed);
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let pictures = (0..24).map(|frame| {
            let specks: Vec<[f64; 3]> =
                (0..8).map(|_| [10.0 + 300.0 * random(), 10.0 + 220.0 * random(), 4.8 + 2.0 * random()]).collect();
            picture(frame, |x, y| specks.iter().map(|speck| disc(x, y, *speck)).fold(ruler(x, y), f64::min))
        });
        let best = chosen(&pictures.collect::<Vec<_>>());
        // Some happen to be alike in area and shape too, which the score tells.
        followed += u32::from(matches!(best.tracing.way, TracingWay::Median(_)) && best.score < 0.005);
    }
    assert_eq!(followed, 0);
}
