//! Masks of outlines.
use freeform_curve_fit::{Outline, PixelGrid};
use freeform_sim_camera::{BuiltInShape, Mask, SimulationError};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

/// A grid whose middle lies at a point, y upwards.
fn centred([width, height]: [usize; 2], centre: Point2<f64>, pixels_per_unit: f64) -> PixelGrid {
    let pitch = 1.0 / pixels_per_unit;
    PixelGrid::new([0.5 * width as f64, 0.5 * height as f64], centre, Vector2::new(pitch, -pitch))
}

fn covered_area(mask: &Mask, pixels_per_unit: f64) -> f64 {
    let sum: f64 = mask.grey.iter().map(|&g| f64::from(g) / 255.0).sum();
    sum / (pixels_per_unit * pixels_per_unit)
}

fn outline_of(built_in: BuiltInShape) -> Outline {
    Outline::closed(built_in.shape().sample(2000, 0.0)).expect("a built-in shape is an outline")
}

#[test]
fn the_mask_of_every_shape_covers_its_area() {
    for built_in in BuiltInShape::ALL {
        let grid = centred([290, 280], Point2::origin(), 200.0);
        let mask = Mask::of_outline(&outline_of(built_in), [290, 280], &grid).expect("a good grid");
        let (area, truth) = (covered_area(&mask, 200.0), built_in.shape().area());
        // Rounding to 1/255 leaves at most 1/510 of each of the pixels along the outline, with random sign.
        assert!((area - truth).abs() < 2e-5, "{built_in}: {area} for {truth}");
        let binary = mask.binary();
        assert!(binary.grey.iter().all(|g| [0, 255].contains(g)));
        // A straight side along the rows can be off by half a pixel over its whole length.
        let worst = 0.5 / 200.0 * built_in.shape().perimeter();
        assert!((covered_area(&binary, 200.0) - truth).abs() < worst, "{built_in}");
    }
}

#[test]
fn the_top_row_shows_the_largest_y() {
    let tall = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let outline = Outline::closed(tall.to_vec()).expect("a triangle");
    let grid = centred([2, 2], Point2::new(0.5, 0.5), 2.0);
    // The diagonal halves the lower left and the upper right pixel.
    assert_eq!(Mask::of_outline(&outline, [2, 2], &grid).expect("a good grid").grey, [0, 128, 128, 255]);
}

#[test]
fn masks_without_sense_are_refused() {
    let outline = outline_of(BuiltInShape::Bird);
    let mask = |size, x, pitch| {
        Mask::of_outline(&outline, size, &PixelGrid::new([0.0; 2], Point2::new(x, 0.0), Vector2::repeat(pitch)))
    };
    assert!(matches!(mask([0, 5], 0.0, 1.0), Err(SimulationError::MaskSize { width: 0, height: 5, .. })));
    assert!(matches!(mask([usize::MAX, 5], 0.0, 1.0), Err(SimulationError::MaskSize { .. })));
    for (x, pitch) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (0.0, 0.0), (0.0, f64::NAN)] {
        assert!(matches!(mask([5, 5], x, pitch), Err(SimulationError::OutOfRange { .. })), "{x} {pitch}");
    }
}

proptest! {
    #[test]
    fn a_rectangle_partly_outside_the_picture_covers_what_is_inside(
        left in -30.0..25.0_f64, bottom in -30.0..25.0_f64, width in 0.1..60.0_f64, height in 0.1..60.0_f64,
    ) {
        let (right, top) = (left + width, bottom + height);
        let corners = [(left, bottom), (right, bottom), (right, top), (left, top)].map(|(x, y)| Point2::new(x, y));
        let outline = Outline::closed(corners.to_vec()).expect("a rectangle");
        let mask = Mask::of_outline(&outline, [40, 30], &centred([40, 30], Point2::origin(), 1.0)).expect("a good grid");
        let span = |from: f64, to: f64, half: f64| (to.min(half) - from.max(-half)).max(0.0);
        for row in 0..30_usize {
            for column in 0..40_usize {
                let (x, y) = (column as f64 - 20.0, 15.0 - row as f64);
                let across = span((left - x - 0.5).max(-0.5), (right - x - 0.5).min(0.5), 0.5);
                let up = span((bottom - y + 0.5).max(-0.5), (top - y + 0.5).min(0.5), 0.5);
                let grey = f64::from(mask.grey[row * 40 + column]);
                prop_assert!((grey - 255.0 * across * up).abs() < 0.501, "pixel {column}, {row}");
            }
        }
    }
}
