//! Outlines of labelled masks.
use freeform_curve_fit::Outline;
use freeform_outline_io::{
    Clipping, GrayImage, Identities, LabelMask, Margins, Selection, Smoothing, TraceError, TraceSettings, TracedLabel,
    TracedOutline, trace_mask,
};
use image::Luma;

const WIDTH: usize = 120;
const HEIGHT: usize = 90;

/// A mask with a label from a function of the pixel's centre, y downwards.
fn labels(label: impl Fn(f64, f64) -> i64) -> Vec<i64> {
    (0..WIDTH * HEIGHT).map(|i| label((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5)).collect()
}

fn egg(x: f64, y: f64) -> bool {
    let (u, v) = (x - 50.0, y - 40.0);
    (u / 25.0).powi(2) + (v / (14.0 + 0.2 * u)).powi(2) < 1.0
}

fn trace(labels: &[i64], settings: &TraceSettings) -> Vec<(i64, TracedOutline)> {
    let traced = LabelMask::new(labels, WIDTH, HEIGHT).expect("a mask").trace(settings).expect("settings");
    traced.into_iter().map(|traced| (traced.label, traced.outline.expect("an outline"))).collect()
}

#[test]
fn the_outline_of_a_label_is_that_of_a_mask_of_it_alone() {
    let with_others = labels(|x, y| {
        if egg(x, y) {
            7
        } else if x > 90.0 {
            2
        } else {
            -1
        }
    });
    let picture = GrayImage::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| {
        Luma([if egg(f64::from(x) + 0.5, f64::from(y) + 0.5) { 255 } else { 0 }])
    });
    let gaussian = TraceSettings { smoothing: Smoothing::Gaussian(2.0), ..TraceSettings::default() };
    let scaled = TraceSettings { y_up: false, pixel_size: 0.1, pixel_aspect: 1.5, ..TraceSettings::default() };
    for settings in [TraceSettings::default(), gaussian, scaled] {
        // Labels know of no margins.
        let margins = Some(Margins { left: 9, top: 5, right: 0, bottom: 0 });
        let traced = trace(&with_others, &TraceSettings { margins, ..settings });
        assert_eq!(traced.iter().map(|(label, _)| *label).collect::<Vec<_>>(), [2, 7]);
        let (of_label, alone) = (&traced[1].1, trace_mask(&picture, &settings).expect("an egg"));
        assert_eq!(of_label.pixel_count, alone.pixel_count);
        let points = of_label.outline.points().zip(alone.outline.points());
        assert_eq!(of_label.outline.point_count(), alone.outline.point_count());
        assert!(points.into_iter().all(|(p, q)| (p - q).norm() < 1e-4 * settings.pixel_size));
    }
}

#[test]
fn of_a_label_in_parts_the_largest_is_traced_with_its_holes_filled() {
    let mask =
        labels(|x, y| i64::from(egg(x, y) && (x - 50.0).hypot(y - 40.0) > 4.0 || (x - 100.0).hypot(y - 70.0) < 6.0));
    let whole = labels(|x, y| i64::from(egg(x, y)));
    let settings = TraceSettings::default();
    assert_eq!(trace(&mask, &settings)[0].1.outline, trace(&whole, &settings)[0].1.outline);
}

#[test]
fn of_a_label_in_parts_the_size_of_the_next_largest_is_told() {
    let disc = |x: f64, y: f64, radius: f64| (x - 95.0).hypot(y - 70.0) < radius;
    for (radius, expected) in [(0.0, 0..1), (1.0, 0..1), (6.0, 100..120)] {
        let mask = labels(|x, y| i64::from(egg(x, y) || disc(x, y, radius)));
        let traced = LabelMask::new(&mask, WIDTH, HEIGHT).expect("a mask").trace(&TraceSettings::default());
        let next = traced.expect("settings")[0].next_part;
        assert!(expected.contains(&next), "radius {radius}: {next} pixels");
    }
}

#[test]
fn grey_values_are_not_taken_for_labels_and_many_small_objects_are() {
    let smoothed_edge = labels(|x, y| ((30.0 - (x - 60.0).hypot(y - 45.0)) * 40.0 + 128.0).clamp(0.0, 255.0) as i64);
    let of_grey = LabelMask::new(&smoothed_edge, WIDTH, HEIGHT).expect("a mask").trace(&TraceSettings::default());
    assert!(
        matches!(of_grey, Err(TraceError::GreyValues { scattered, labels }) if 2 * scattered > labels),
        "{of_grey:?}"
    );
    // Specks of 2 by 2 pixels, 4 apart.
    let specks =
        labels(|x, y| if x % 4.0 < 2.0 && y % 4.0 < 2.0 { 1 + (x / 4.0) as i64 + 30 * (y / 4.0) as i64 } else { 0 });
    let of_specks = LabelMask::new(&specks, WIDTH, HEIGHT).expect("a mask").trace(&TraceSettings::default());
    assert!(of_specks.expect("labels").len() > 500);
}

#[test]
fn a_label_at_the_edge_is_told_and_left_open_where_asked_for() {
    let mask = labels(|x, y| i64::from(x.hypot(y - 45.0) < 20.0));
    let closed = trace(&mask, &TraceSettings::default()).remove(0).1;
    assert!(closed.touches_border && matches!(closed.outline, Outline::Closed(_)));
    let settings = TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() };
    assert!(matches!(trace(&mask, &settings).remove(0).1.outline, Outline::Open(_)));
}

#[test]
fn masks_without_pixels_or_of_another_size_and_small_labels_are_refused() {
    assert_eq!(LabelMask::new(&[], 0, 0).err(), Some(TraceError::NoPixels));
    assert_eq!(LabelMask::new(&[0; 7], 2, 4).err(), Some(TraceError::NoPixels));
    let mask = labels(|x, y| i64::from((x - 20.0).hypot(y - 20.0) < 1.0));
    let traced =
        LabelMask::new(&mask, WIDTH, HEIGHT).expect("a mask").trace(&TraceSettings::default()).expect("settings");
    assert!(matches!(traced[..], [TracedLabel { label: 1, outline: Err(TraceError::TooSmall { needed: 9, .. }), .. }]));
    let settings = TraceSettings { pixel_size: 0.0, ..TraceSettings::default() };
    assert!(matches!(
        LabelMask::new(&mask, WIDTH, HEIGHT).expect("a mask").trace(&settings),
        Err(TraceError::Setting { .. })
    ));
    let nothing = labels(|_, _| 0);
    assert_eq!(trace(&nothing, &TraceSettings::default()), []);
}

#[test]
fn objects_keep_their_names_when_their_labels_change() {
    let mut identities = Identities::new(Selection::All);
    for frame in 0..10_u64 {
        let shift = frame as f64;
        let (first, second) = if frame % 2 == 0 { (3, 8) } else { (8, 3) };
        let mask = labels(|x, y| match () {
            () if (x - 20.0 - shift).hypot(y - 20.0) < 10.0 => first,
            () if (x - 90.0 + shift).hypot(y - 60.0) < 13.0 => second,
            () => 0,
        });
        let mut found: Vec<_> = trace(&mask, &TraceSettings::default()).into_iter().map(|(_, traced)| traced).collect();
        found.sort_by_key(|traced| std::cmp::Reverse(traced.pixel_count));
        let named = identities.assign(frame, found).expect("two discs");
        assert_eq!(named.iter().map(|(name, _)| *name).collect::<Vec<_>>(), [0, 1]);
        assert!((named[0].1.centre.x - 90.0 + shift).abs() < 0.5 && (named[1].1.centre.x - 20.0 - shift).abs() < 0.5);
    }
}
