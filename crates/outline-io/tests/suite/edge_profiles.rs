//! Edges looked for near an outline that is expected: where they are seen they are found, and nowhere else.
use std::f64::consts::TAU;

use freeform_curve_fit::{Piece, PixelGrid};
use freeform_outline_io::{EdgeProfile, GrayImage, SoughtEdges};
use image::Luma;
use nalgebra::{Point2, Vector2};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

const SIZE: [u32; 2] = [160, 120];
const RADIUS: f64 = 30.0;

/// Pixels of 2 units, rows downwards.
fn grid() -> PixelGrid {
    PixelGrid::new([0.0, 0.0], Point2::origin(), Vector2::new(2.0, 2.0))
}

/// The grey value of a disc about a place in pixels, on a ground of 60.
fn disc(x: f64, y: f64, height: f64) -> impl Fn(f64, f64) -> f64 {
    move |column, row| 60.0 + height * (RADIUS + 0.5 - (column - x).hypot(row - y)).clamp(0.0, 1.0)
}

fn picture(seed: u64, noise: f64, value: impl Fn(f64, f64) -> f64) -> GrayImage {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    GrayImage::from_fn(SIZE[0], SIZE[1], |column, row| {
        let error: f64 = StandardNormal.sample(&mut rng);
        let value = value(f64::from(column) + 0.5, f64::from(row) + 0.5) + noise * error;
        Luma([value.round().clamp(0.0, 255.0) as u8])
    })
}

/// A circle about a place in pixels, in units.
fn circle(x: f64, y: f64) -> Vec<Point2<f64>> {
    let at = |t: f64| Point2::new(2.0 * (x + RADIUS * t.cos()), 2.0 * (y + RADIUS * t.sin()));
    (0..120).map(|i| at(f64::from(i) / 120.0 * TAU)).collect()
}

/// What a disc in the middle of the picture looks like.
fn learnt() -> EdgeProfile {
    let mut profile = EdgeProfile::default();
    for seed in 0..4 {
        let points = circle(80.0, 60.0);
        profile.take(&picture(seed, 2.0, disc(80.0, 60.0, 120.0)), &grid(), [Piece { points: &points, closed: true }]);
    }
    assert!(profile.is_known());
    profile
}

/// What is found within 6 pixels of a circle about a place.
fn sought(picture: &GrayImage, x: f64, y: f64) -> Option<SoughtEdges> {
    learnt().seek(picture, &grid(), [Piece { points: &circle(x, y), closed: true }], 12.0)
}

/// Farthest that a point lies from a circle about a place, in pixels.
fn farthest(edges: &SoughtEdges, x: f64, y: f64) -> f64 {
    let off = |p: &Point2<f64>| ((0.5 * p.x - x).hypot(0.5 * p.y - y) - RADIUS).abs();
    edges.outline.points().map(off).fold(0.0, f64::max)
}

#[test]
fn a_disc_is_found_where_it_has_moved_to_also_in_a_tenth_of_the_light() {
    for (height, noise, limit) in [(120.0, 2.0, 0.2), (12.0, 0.6, 0.6)] {
        let edges = sought(&picture(9, noise, disc(83.0, 58.0, height)), 80.0, 60.0).expect("all of it is there");
        assert!(edges.share > 0.9, "{}", edges.share);
        assert!(farthest(&edges, 83.0, 58.0) < limit, "{}", farthest(&edges, 83.0, 58.0));
    }
}

#[test]
fn where_a_neighbour_of_the_same_grey_touches_there_is_no_edge_and_no_point() {
    let alone = disc(80.0, 60.0, 120.0);
    // Everything to the right of the middle is as light as the disc.
    let touched = picture(5, 2.0, |column, row| if column > 80.0 { 180.0 } else { alone(column, row) });
    let edges = sought(&touched, 80.0, 60.0).expect("half of it is seen");
    assert!((0.35..0.55).contains(&edges.share), "{}", edges.share);
    assert!(edges.outline.points().all(|p| p.x < 2.0 * 80.0));
    assert!(farthest(&edges, 80.0, 60.0) < 0.3);
}

#[test]
fn noise_texture_an_empty_picture_and_edges_the_other_way_round_show_nothing() {
    let noise = picture(1, 30.0, |_, _| 120.0);
    let texture = picture(2, 2.0, |column, row| 120.0 + 50.0 * (0.9 * column).sin() * (0.8 * row).sin());
    let (empty, turned) = (picture(3, 0.0, |_, _| 60.0), picture(4, 2.0, disc(80.0, 60.0, -55.0)));
    // As steep as a blurred edge, and the same everywhere.
    let shading =
        |noise: f64, seed: u64| picture(seed, noise, |column, row| 3.0 * column.mul_add(0.8, 0.6 * row) - 90.0);
    let stripes = picture(6, 1.0, |column, _| if (column / 4.0) as i32 % 2 == 0 { 60.0 } else { 180.0 });
    let pictures = [
        ("noise", noise),
        ("texture", texture),
        ("empty", empty),
        ("turned", turned),
        ("shading", shading(0.0, 5)),
        ("noisy shading", shading(1.0, 6)),
        ("stripes", stripes),
    ];
    for (name, picture) in pictures {
        assert_eq!(sought(&picture, 80.0, 60.0), None, "{name}");
    }
}

#[test]
fn nothing_is_looked_for_before_the_object_has_been_seen_or_outside_of_the_picture() {
    let there = picture(1, 2.0, disc(80.0, 60.0, 120.0));
    let (points, outside) = (circle(80.0, 60.0), circle(500.0, 60.0));
    let [here, outside] = [&points, &outside].map(|points| [Piece { points, closed: true }]);
    let mut profile = EdgeProfile::default();
    assert_eq!(profile.seek(&there, &grid(), here, 12.0), None);
    profile.take(&there, &grid(), outside);
    assert_eq!(profile, EdgeProfile::default(), "nothing was seen");
    assert_eq!(learnt().seek(&there, &grid(), outside, 12.0), None);
    for points in [&[][..], &points[..1], &[points[0]; 5]] {
        assert_eq!(learnt().seek(&there, &grid(), [Piece { points, closed: true }], 12.0), None);
    }
    for reach in [0.0, -1.0] {
        let edges = learnt().seek(&there, &grid(), here, reach);
        assert!(edges.is_some_and(|edges| edges.share > 0.9), "{reach}: a pixel at least");
    }
    // Where it may be anywhere it is not looked for.
    for reach in [f64::NAN, f64::INFINITY, 40.0] {
        assert_eq!(learnt().seek(&there, &grid(), here, reach), None, "{reach}");
    }
}
