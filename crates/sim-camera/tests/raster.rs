//! Masks of outlines.
use freeform_curve_fit::Outline;
use freeform_sim_camera::{BuiltInShape, Mask, PixelGrid, SimulationError};
use nalgebra::Point2;
use proptest::prelude::*;

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
        let grid = PixelGrid::new(290, 280, Point2::origin(), 200.0).expect("a good grid");
        let mask = Mask::of_outline(&outline_of(built_in), &grid);
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
    let grid = PixelGrid::new(2, 2, Point2::new(0.5, 0.5), 2.0).expect("a good grid");
    // The diagonal halves the lower left and the upper right pixel.
    assert_eq!(Mask::of_outline(&outline, &grid).grey, [0, 128, 128, 255]);
}

#[test]
fn grids_without_sense_are_refused() {
    let grid = |w, h, x, scale| PixelGrid::new(w, h, Point2::new(x, 0.0), scale);
    assert!(matches!(grid(0, 5, 0.0, 1.0), Err(SimulationError::MaskSize { width: 0, height: 5, .. })));
    assert!(matches!(grid(usize::MAX, 5, 0.0, 1.0), Err(SimulationError::MaskSize { .. })));
    assert!(matches!(grid(5, 5, f64::NAN, 1.0), Err(SimulationError::OutOfRange { .. })));
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(grid(5, 5, 0.0, scale), Err(SimulationError::OutOfRange { .. })));
    }
}

proptest! {
    #[test]
    fn pixel_coordinates_go_there_and_back(
        x in -5.0..5.0_f64, y in -5.0..5.0_f64, width in 1..500_usize, height in 1..500_usize, scale in 0.1..500.0_f64,
    ) {
        let grid = PixelGrid::new(width, height, Point2::new(0.3, -0.2), scale).expect("a good grid");
        let p = Point2::new(x, y);
        prop_assert!((grid.point_of(&grid.pixel_of(&p)) - p).norm() < 1e-9);
    }

    #[test]
    fn a_rectangle_partly_outside_the_picture_covers_what_is_inside(
        left in -30.0..25.0_f64, bottom in -30.0..25.0_f64, width in 0.1..60.0_f64, height in 0.1..60.0_f64,
    ) {
        let (right, top) = (left + width, bottom + height);
        let corners = [(left, bottom), (right, bottom), (right, top), (left, top)].map(|(x, y)| Point2::new(x, y));
        let outline = Outline::closed(corners.to_vec()).expect("a rectangle");
        let grid = PixelGrid::new(40, 30, Point2::origin(), 1.0).expect("a good grid");
        let mask = Mask::of_outline(&outline, &grid);
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
