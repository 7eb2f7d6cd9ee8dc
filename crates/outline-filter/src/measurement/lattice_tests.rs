//! Lattices are found in what tracers of masks and of grey pictures give.
use freeform_curve_fit::Outline;
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::lattice::{PixelLattice, PlaceOnLattice};

/// How much of a pixel a disc covers at most, told by the distance of its middle from the border.
fn coverage(centre: Point2<f64>, radius: f64, x: i32, y: i32) -> f64 {
    let from_border = radius - (Point2::new(f64::from(x), f64::from(y)) - centre).norm();
    (0.5 + from_border).clamp(0.0, 1.0)
}

/// Places where the lines between pixels beside each other cross the border, in order about the centre: marching squares.
fn crossings(centre: Point2<f64>, radius: f64, of_mask: bool) -> Vec<Point2<f64>> {
    let value = |x: i32, y: i32| {
        let covered = coverage(centre, radius, x, y);
        if of_mask { f64::from(u8::from(covered >= 0.5)) } else { covered }
    };
    let reach = radius as i32 + 3;
    let mut points = Vec::new();
    for x in -reach..=reach {
        for y in -reach..=reach {
            for (dx, dy) in [(1, 0), (0, 1)] {
                let (here, next) = (value(x, y), value(x + dx, y + dy));
                if (here >= 0.5) != (next >= 0.5) {
                    let t = (0.5 - here) / (next - here);
                    points.push(Point2::new(f64::from(x) + t * f64::from(dx), f64::from(y) + t * f64::from(dy)));
                }
            }
        }
    }
    points.sort_by(|a, b| {
        let angle = |p: &Point2<f64>| (p.y - centre.y).atan2(p.x - centre.x);
        angle(a).total_cmp(&angle(b))
    });
    points
}

/// The lattice of points of pixels of a size, away from the origin.
fn found(points: &[Point2<f64>], pixel: f64, origin: Vector2<f64>) -> Option<PixelLattice> {
    PixelLattice::of(&Outline::closed(points.iter().map(|p| p * pixel + origin).collect()).expect("an outline"))
}

proptest! {
    #[test]
    fn the_pixels_of_masks_and_of_interpolated_outlines_are_found_at_any_scale(
        radius in 8.0..40.0_f64, x in -0.49..0.49_f64, y in -0.49..0.49_f64, scale in -4.0..4.0_f64, offset in -1e3..1e3_f64,
    ) {
        let (centre, pixel) = (Point2::new(x, y), 10.0_f64.powf(scale));
        let origin = Vector2::new(offset, -0.3 * offset) * pixel;
        for of_mask in [false, true] {
            let lattice = found(&crossings(centre, radius, of_mask), pixel, origin);
            let place = if of_mask { PlaceOnLattice::Chain } else { PlaceOnLattice::Lines };
            let lattice = lattice.expect("a lattice");
            prop_assert_eq!(lattice.place, place);
            prop_assert!((lattice.pixel / pixel - 1.0).abs() < 1e-6, "{}", lattice.pixel);
        }
        // What OpenCV gives: pixels at the border, of which every third is another matter.
        let mut nodes: Vec<_> = crossings(centre, radius, true).iter().map(|p| p.map(f64::round_ties_even)).collect();
        nodes.dedup();
        let lattice = found(&nodes, pixel, origin).expect("a lattice");
        prop_assert!((lattice.pixel / pixel - 1.0).abs() < 1e-6, "{}", lattice.pixel);
    }

    #[test]
    fn points_anywhere_lie_on_no_lattice_and_rounded_ones_are_no_chain(
        radii in prop::collection::vec(0.8..1.2_f64, 60..300), digits in 2..7_i32,
    ) {
        let count = radii.len() as f64;
        let place = |(i, radius): (usize, &f64)| {
            let angle = std::f64::consts::TAU * i as f64 / count;
            Point2::new(radius * angle.cos(), radius * angle.sin())
        };
        let points: Vec<_> = radii.iter().enumerate().map(place).collect();
        prop_assert_eq!(found(&points, 1.0, Vector2::zeros()), None);
        let unit = 10.0_f64.powi(-digits);
        let rounded: Vec<_> = points.iter().map(|p| p.map(|v| (v / unit).round() * unit)).collect();
        if let Some(lattice) = found(&rounded, 1.0, Vector2::zeros()) {
            prop_assert!(lattice.place != PlaceOnLattice::Chain);
            prop_assert!(lattice.pixel < 2.1 * unit, "{}", lattice.pixel);
        }
    }
}

#[test]
fn points_along_a_contour_that_are_rounded_to_pixels_are_a_chain_also_where_they_repeat() {
    let at = |i: u16| {
        let angle = std::f64::consts::TAU * f64::from(i) / 200.0;
        Point2::new((16.3 * angle.cos()).round(), (12.1 * angle.sin()).round())
    };
    let points: Vec<_> = (0..200).map(at).collect();
    assert!(points.windows(2).filter(|pair| pair[0] == pair[1]).count() > 80);
    let lattice = found(&points, 0.025, Vector2::zeros()).expect("a lattice");
    assert_eq!((lattice.place, (lattice.pixel / 0.025).round()), (PlaceOnLattice::Chain, 1.0));
}

/// A rectangle with sides along the pixels, as it is found in a smoothed mask: its corners are rounded off, and its sides lie between two pixels.
#[test]
fn sides_along_the_pixels_that_lie_half_way_between_two_are_those_of_a_mask() {
    let rectangle = |off: f64| {
        let side = |from: [f64; 2], step: [f64; 2]| {
            (0..30_u8).map(move |i| Point2::new(from[0] + f64::from(i) * step[0], from[1] + f64::from(i) * step[1]))
        };
        let sides = [([1.0, off], [1.0, 0.0]), ([31.0 + off, 1.0], [0.0, 1.0]), ([30.0, 31.0 + off], [-1.0, 0.0])];
        let mut points: Vec<_> = sides.into_iter().flat_map(|(from, step)| side(from, step)).collect();
        points.extend(side([off, 30.0], [0.0, -1.0]));
        for i in 0..4_usize {
            points[30 * i] += Vector2::new([0.0, -0.13, 0.0, 0.11][i], [0.17, 0.0, -0.19, 0.0][i]);
        }
        points
    };
    let place = |off: f64| found(&rectangle(off), 0.025, Vector2::zeros()).map(|lattice| lattice.place);
    assert_eq!(place(0.5), Some(PlaceOnLattice::LinesOfMask));
    // That of a grey picture lies anywhere between.
    assert_eq!(place(0.37), Some(PlaceOnLattice::Lines));
}

#[test]
fn points_with_noise_that_are_rounded_to_pixels_are_no_chain_however_dense_they_are() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for count in [200_u16, 1000, 5000] {
        let points: Vec<_> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                let noise = [0, 1].map(|_| 0.35 * random.sample::<f64, _>(StandardNormal));
                Point2::new((16.3 * angle.cos() + noise[0]).round(), (12.1 * angle.sin() + noise[1]).round())
            })
            .collect();
        let lattice = found(&points, 0.025, Vector2::zeros()).expect("a lattice");
        assert_eq!(lattice.place, PlaceOnLattice::Nodes, "{count} points");
    }
}
