//! Outlines traced in pictures: accuracy on discs, borders, choice of the object, and real silhouettes.
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use freeform_curve_fit::Outline;
use freeform_outline_io::{
    Clipping, Contrast, Edges, GrayImage, Smoothing, Threshold, TraceError, TraceSettings, TracedOutline, read_picture,
    trace_mask,
};
use image::Luma;
use nalgebra::Point2;
use proptest::prelude::*;

/// A disc with grey edges: each pixel's value is the part of it that the disc covers, from 32 x 32 samples.
fn grey_disc(size: u32, centre: (f64, f64), radius: f64) -> GrayImage {
    GrayImage::from_fn(size, size, |column, row| {
        let covered = (0..32 * 32).filter(|sample| {
            let x = f64::from(column) + (f64::from(sample % 32) + 0.5) / 32.0 - centre.0;
            let y = f64::from(row) + (f64::from(sample / 32) + 0.5) / 32.0 - centre.1;
            x.hypot(y) < radius
        });
        Luma([(covered.count() as f64 / 1024.0 * 255.0).round() as u8])
    })
}

/// A disc as a mask of two values.
fn disc_mask(size: u32, centre: (f64, f64), radius: f64) -> GrayImage {
    mask(size, size, |x, y| (x - centre.0).hypot(y - centre.1) < radius)
}

/// White where a function of the pixel's centre, y downwards, is true.
fn mask(width: u32, height: u32, inside: impl Fn(f64, f64) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |column, row| {
        Luma([if inside(f64::from(column) + 0.5, f64::from(row) + 0.5) { 255 } else { 0 }])
    })
}

fn trace(picture: &GrayImage) -> TracedOutline {
    trace_mask(picture, &TraceSettings::default()).expect("an object")
}

/// Mean and root mean square deviation of the distances from a centre.
fn radii(outline: &Outline, centre: Point2<f64>) -> (f64, f64) {
    let distances: Vec<f64> = outline.points().map(|point| (point - centre).norm()).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let square = distances.iter().map(|distance| (distance - mean).powi(2)).sum::<f64>();
    (mean, (square / distances.len() as f64).sqrt())
}

fn assert_closed_and_simple(outline: &Outline) {
    assert!(matches!(outline, Outline::Closed(_)));
    assert!(outline.signed_area() > 0.0);
    let points: Vec<_> = outline.points().collect();
    let side = |p: &Point2<f64>, q: &Point2<f64>, r: &Point2<f64>| (q - p).perp(&(r - p));
    let segment = |i: usize| (points[i], points[(i + 1) % points.len()]);
    for i in 0..points.len() {
        let (a, b) = segment(i);
        for j in i + 2..points.len() {
            let (c, d) = segment(j);
            if (a.x.max(b.x) < c.x.min(d.x)) || (c.x.max(d.x) < a.x.min(b.x)) {
                continue;
            }
            let crosses = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            assert!(!crosses, "segments {i} and {j} cross");
        }
    }
}

#[test]
fn a_disc_with_grey_edges_has_its_radius_to_a_fiftieth_of_a_pixel() {
    let mut worst = (0.0_f64, 0.0_f64);
    for (radius, shift) in [(10.0, 0.0), (20.3, 0.37), (35.5, 0.5), (60.1, 0.81)] {
        let centre = (70.0 + shift, 71.0 - 0.4 * shift);
        let traced = trace(&grey_disc(142, centre, radius));
        let (mean, scatter) = radii(&traced.outline, Point2::new(centre.0, 142.0 - centre.1));
        worst = (worst.0.max((mean - radius).abs()), worst.1.max(scatter));
        assert!((mean - radius).abs() < 0.02, "radius {radius}: {mean}");
        assert!(scatter < 0.04, "radius {radius}: scatter {scatter}");
        let area = PI * radius * radius;
        assert!((traced.outline.signed_area() / area - 1.0).abs() < 0.004);
        assert_closed_and_simple(&traced.outline);
    }
    println!("grey discs: radius within {:.4}, scatter up to {:.4} pixels", worst.0, worst.1);
}

#[test]
fn a_disc_mask_has_a_smooth_outline() {
    let mut worst = (0.0_f64, 0.0_f64);
    for (radius, shift) in [(10.0, 0.0), (20.3, 0.37), (35.5, 0.5), (60.1, 0.81)] {
        let centre = (70.0 + shift, 71.0 - 0.4 * shift);
        let picture = disc_mask(142, centre, radius);
        let centre = Point2::new(centre.0, 142.0 - centre.1);
        let (mean, scatter) = radii(&trace(&picture).outline, centre);
        let raw = TraceSettings { smoothing: Smoothing::Gaussian(0.0), ..TraceSettings::default() };
        let stairs = radii(&trace_mask(&picture, &raw).expect("a disc").outline, centre).1;
        worst = (worst.0.max((mean - radius).abs()), worst.1.max(scatter));
        println!("disc mask of radius {radius}: mean {mean:.3}, scatter {scatter:.3}, unsmoothed {stairs:.3} pixels");
        assert!((mean - radius).abs() < 0.1, "radius {radius}: {mean}");
        assert!(scatter < 0.17 && scatter < 0.7 * stairs, "radius {radius}: {scatter} against {stairs}");
    }
    println!("disc masks: radius within {:.4}, scatter up to {:.4} pixels", worst.0, worst.1);
}

#[test]
fn smoothing_shrinks_a_disc_as_documented() {
    let smoothing = Smoothing::Gaussian(2.0);
    let settings = TraceSettings { smoothing, edges: Edges::Isoline, ..TraceSettings::default() };
    let traced = trace_mask(&grey_disc(80, (40.0, 40.0), 25.0), &settings).expect("a disc");
    let (mean, _) = radii(&traced.outline, Point2::new(40.0, 40.0));
    assert!((25.0 - mean - 4.0 / 50.0).abs() < 0.02, "{mean}");
}

#[test]
fn coordinates_are_those_of_pixel_centres_in_the_unit_asked_for() {
    // Columns 10 to 29, rows 20 to 29 of a picture 50 high.
    let picture = mask(60, 50, |x, y| (10.0..30.0).contains(&x) && (20.0..30.0).contains(&y));
    let bounds = |settings: &TraceSettings| {
        let traced = trace_mask(&picture, settings).expect("a box");
        assert!(traced.outline.signed_area() > 0.0);
        let round = |value: f64| (value * 1e3).round() / 1e3;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in traced.outline.points() {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        (low.map(round), high.map(round))
    };
    let plain = TraceSettings { smoothing: Smoothing::Gaussian(0.0), ..TraceSettings::default() };
    assert_eq!(bounds(&plain), ([10.0, 20.0], [30.0, 30.0]));
    assert_eq!(bounds(&TraceSettings { y_up: false, ..plain }), ([10.0, 20.0], [30.0, 30.0]));
    let scaled = TraceSettings { pixel_size: 0.5, pixel_aspect: 1.14, ..plain };
    assert_eq!(bounds(&scaled), ([5.7, 10.0], [17.1, 15.0]));
    let high = mask(60, 50, |x, y| (10.0..30.0).contains(&x) && (5.0..30.0).contains(&y));
    let centroid = |y_up| trace_mask(&high, &TraceSettings { y_up, ..plain }).expect("a box").outline.centroid().y;
    assert!((centroid(true) - 32.5).abs() < 0.1 && (centroid(false) - 17.5).abs() < 0.1);
}

#[test]
fn dark_objects_on_light_ground_are_traced_on_request() {
    let light = disc_mask(64, (30.0, 33.0), 12.0);
    let dark = GrayImage::from_fn(64, 64, |x, y| Luma([255 - light.get_pixel(x, y).0[0]]));
    let settings = TraceSettings { contrast: Contrast::DarkOnLight, ..TraceSettings::default() };
    assert_eq!(trace_mask(&dark, &settings).expect("a disc").outline, trace(&light).outline);
}

/// A square of 40 pixels across on a ground that is lighter to one side, darker than it by 60, with something lighter by 120 that comes in from the
/// right; or all the other way round.
fn square_and_intruder(reach: f64, contrast: Contrast) -> GrayImage {
    GrayImage::from_fn(200, 150, |column, row| {
        let (x, y) = (f64::from(column), f64::from(row));
        let in_square = (x - 60.0).abs() < 20.0 && (y - 75.0).abs() < 20.0;
        let is_intruder = x > 199.0 - reach && (60.0..110.0).contains(&y);
        let ground = 90.0 + 0.05 * x + 3.0 * f64::from((7 * column + 5 * row) % 11) / 11.0;
        let dark = if in_square {
            30.0
        } else if is_intruder {
            210.0
        } else {
            ground
        };
        Luma([if contrast == Contrast::DarkOnLight { dark } else { 255.0 - dark } as u8])
    })
}

/// The threshold fell between the intruder and the ground, so that the ground was the object and its outline that of the intruder.
#[test]
fn an_object_is_traced_also_where_something_on_the_other_side_of_the_ground_comes_in() {
    for contrast in [Contrast::DarkOnLight, Contrast::LightOnDark] {
        for reach in [20.0, 60.0] {
            let settings = TraceSettings { contrast, ..TraceSettings::default() };
            let traced = trace_mask(&square_and_intruder(reach, contrast), &settings).expect("a square");
            assert!((traced.area / 1600.0 - 1.0).abs() < 0.05, "{reach}: {}", traced.area);
            assert!(!traced.touches_border, "{reach}");
        }
    }
}

#[test]
fn a_highlight_does_not_take_the_place_of_a_large_object() {
    // It has three corners of the picture.
    let picture = GrayImage::from_fn(200, 150, |column, row| {
        let is_glare = (100..107).contains(&column) && (70..77).contains(&row);
        let is_ground = column > 120 && row > 60;
        Luma([if is_glare {
            250
        } else if is_ground {
            30
        } else {
            150 + (column * 7 + row * 5) as u8 % 3
        }])
    });
    let traced = trace_mask(&picture, &TraceSettings::default()).expect("the object");
    assert!(traced.area > 15_000.0, "{}", traced.area);
}

#[test]
fn the_largest_object_is_traced_and_the_others_do_not_bend_it() {
    let alone = disc_mask(100, (40.0, 40.0), 20.0);
    let crowded = mask(100, 100, |x, y| {
        let disc = |cx: f64, cy: f64, radius: f64| (x - cx).hypot(y - cy) < radius;
        disc(40.0, 40.0, 20.0) || disc(80.0, 80.0, 10.0) || disc(62.5, 40.0, 1.6)
    });
    let (alone, crowded) = (trace(&alone), trace(&crowded));
    assert_eq!(crowded.outline, alone.outline);
    assert_eq!((alone.object_count, crowded.object_count), (1, 2));
    assert_eq!(crowded.pixel_count, alone.pixel_count);
}

#[test]
fn holes_are_ignored_however_thin_the_wall() {
    let full = disc_mask(100, (50.0, 50.0), 30.0);
    let ring = mask(100, 100, |x, y| (28.5..30.0).contains(&(x - 50.0).hypot(y - 50.0)));
    assert_eq!(trace(&ring).outline, trace(&full).outline);
}

#[test]
fn an_object_clipped_by_the_border_is_closed_along_it_or_open() {
    // A disc whose left part is outside the picture.
    let picture = disc_mask(100, (5.0, 50.0), 30.0);
    let closed = trace(&picture);
    assert!(closed.touches_border);
    assert_closed_and_simple(&closed.outline);
    let lowest = closed.outline.points().map(|point| point.x).fold(f64::INFINITY, f64::min);
    assert!(lowest.abs() < 1e-9, "closed along the edge of the picture, not at {lowest}");

    let settings = TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() };
    let open = trace_mask(&picture, &settings).expect("an arc");
    assert!(open.touches_border);
    assert!(matches!(open.outline, Outline::Open(_)));
    assert_eq!(open.outline.pieces().count(), 1);
    let (mean, scatter) = radii(&open.outline, Point2::new(5.0, 50.0));
    assert!((mean - 30.0).abs() < 0.1 && scatter < 0.17, "{mean} {scatter}");
    assert!(open.outline.points().all(|point| point.x >= 0.5));

    // A bar across the picture shows two arcs.
    let bar = mask(80, 60, |_, y| (20.0..40.0).contains(&y));
    let open = trace_mask(&bar, &settings).expect("two arcs").outline;
    assert_eq!(open.pieces().map(|piece| piece.points.len()).collect::<Vec<_>>(), [80, 80]);
    assert!(open.points().all(|point| (point.y - 20.0).abs() < 1e-3 || (point.y - 40.0).abs() < 1e-3));
}

#[test]
fn an_object_inside_the_picture_is_closed_whatever_the_setting() {
    let picture = disc_mask(64, (32.0, 32.0), 12.0);
    let settings = TraceSettings { clipping: Clipping::Open, ..TraceSettings::default() };
    let traced = trace_mask(&picture, &settings).expect("a disc");
    assert!(!traced.touches_border);
    assert_closed_and_simple(&traced.outline);
}

#[test]
fn the_automatic_threshold_is_half_way_between_ground_and_object() {
    let picture = grey_disc(100, (50.0, 50.0), 20.0);
    let flat = GrayImage::from_fn(100, 100, |x, y| {
        Luma([60 + (f64::from(picture.get_pixel(x, y).0[0]) * 100.0 / 255.0).round() as u8])
    });
    let traced = trace(&flat);
    assert_eq!(traced.threshold, 110.0);
    let (mean, _) = radii(&traced.outline, Point2::new(50.0, 50.0));
    assert!((mean - 20.0).abs() < 0.02, "{mean}");
}

#[test]
fn pictures_without_an_object_say_why() {
    let flat = |value| GrayImage::from_pixel(20, 10, Luma([value]));
    let with = |picture: &GrayImage, settings: TraceSettings| trace_mask(picture, &settings).map(|_| ());
    let default = TraceSettings::default();
    assert_eq!(with(&flat(0), default), Err(TraceError::Uniform { value: 0 }));
    assert_eq!(with(&flat(255), default), Err(TraceError::Uniform { value: 255 }));
    assert_eq!(with(&GrayImage::new(0, 0), default), Err(TraceError::NoPixels));
    assert_eq!(with(&GrayImage::new(0, 7), default), Err(TraceError::NoPixels));

    let level = |level| TraceSettings { threshold: Threshold::Level(level), ..default };
    assert_eq!(with(&flat(100), level(128.0)), Err(TraceError::NoObject { threshold: 128.0 }));
    let dark = TraceSettings { contrast: Contrast::DarkOnLight, ..level(50.0) };
    assert_eq!(with(&flat(100), dark), Err(TraceError::NoObject { threshold: 50.0 }));
    let open = TraceSettings { clipping: Clipping::Open, ..level(50.0) };
    assert_eq!(with(&flat(100), open), Err(TraceError::FillsPicture));
    let corner = GrayImage::from_raw(2, 2, vec![0, 0, 0, 255]).expect("four pixels");
    let smallest = TraceSettings { minimum_area: 1, smoothing: Smoothing::Gaussian(0.0), ..open };
    assert_eq!(with(&corner, smallest), Err(TraceError::VisiblePartStraight { points: 2 }));

    let speck = mask(30, 30, |x, y| x < 2.0 && y < 2.0);
    assert_eq!(with(&speck, default), Err(TraceError::TooSmall { pixels: 4, needed: 9 }));
    let thread = mask(60, 60, |x, y| (10.0..50.0).contains(&x) && (30.0..31.0).contains(&y));
    assert_eq!(with(&thread, default), Err(TraceError::SmoothedAway { sigma: 1.0 }));
    assert!(with(&thread, TraceSettings { smoothing: Smoothing::Gaussian(0.0), ..default }).is_ok());
}

#[test]
fn settings_out_of_range_are_named() {
    let picture = disc_mask(64, (32.0, 32.0), 12.0);
    let default = TraceSettings::default();
    let refused = |settings| match trace_mask(&picture, &settings) {
        Err(TraceError::Setting { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    for level in [0.0, -1.0, 255.5, f64::NAN] {
        assert_eq!(refused(TraceSettings { threshold: Threshold::Level(level), ..default }), "threshold");
    }
    for sigma in [-0.1, 101.0, f64::NAN] {
        assert_eq!(refused(TraceSettings { smoothing: Smoothing::Gaussian(sigma), ..default }), "smoothing");
    }
    for size in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        assert_eq!(refused(TraceSettings { pixel_size: size, ..default }), "pixel_size");
        assert_eq!(refused(TraceSettings { pixel_aspect: size, ..default }), "pixel_aspect");
    }
}

/// A folder of real pictures beside the workspace, which may be absent.
fn real_data(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(folder);
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no {}", folder.display());
        return vec![];
    };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    paths.sort();
    paths
}

#[test]
fn real_silhouettes_give_one_simple_outline_of_their_area() {
    for path in real_data("silhouettes") {
        let picture = read_picture(&path).expect("a silhouette");
        let traced = trace(&picture);
        assert_closed_and_simple(&traced.outline);
        let ratio = traced.outline.signed_area() / traced.pixel_count as f64;
        println!(
            "{}: {} points, area over pixels {ratio:.4}, touches the border: {}",
            path.display(),
            traced.outline.point_count(),
            traced.touches_border
        );
        assert!((ratio - 1.0).abs() < 0.01, "{}: {ratio}", path.display());
    }
}

#[test]
fn masks_of_a_real_sequence_are_all_traced() {
    for path in real_data("sequences/microrobot_h/masks").iter().step_by(5) {
        let traced = trace(&read_picture(path).expect("a mask"));
        assert_closed_and_simple(&traced.outline);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_picture_gives_a_simple_outline_or_a_reason(
        (width, height, pixels) in (1..20_u32, 1..20_u32).prop_flat_map(|(width, height)| {
            let count = (width * height) as usize;
            let value = prop_oneof![Just(0), Just(255), any::<u8>()];
            (Just(width), Just(height), prop::collection::vec(value, count))
        }),
        sigma in prop_oneof![Just(0.0), 0.3..3.0],
        clipping in prop_oneof![Just(Clipping::Close), Just(Clipping::Open)],
        contrast in prop_oneof![Just(Contrast::LightOnDark), Just(Contrast::DarkOnLight)],
    ) {
        let picture = GrayImage::from_raw(width, height, pixels).expect("as many values as pixels");
        let smoothing = Smoothing::Gaussian(sigma);
        let settings = TraceSettings { smoothing, clipping, contrast, minimum_area: 1, ..TraceSettings::default() };
        match trace_mask(&picture, &settings) {
            Ok(TracedOutline { outline: outline @ Outline::Closed(_), .. }) => assert_closed_and_simple(&outline),
            Ok(traced) => prop_assert!(traced.touches_border),
            Err(error) => prop_assert!(!matches!(error, TraceError::Degenerate(_)), "{error}"),
        }
    }
}
