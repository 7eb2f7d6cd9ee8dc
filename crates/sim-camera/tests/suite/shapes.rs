//! The built-in shapes and shapes from polygons.
use std::f64::consts::{PI, TAU};

use freeform_curve_fit::{OutlineError, share_along_side};
use freeform_sim_camera::{BuiltInShape, Shape, ShapeError};
use nalgebra::{Point2, Rotation2, Vector2};
use proptest::prelude::*;

fn shoelace(points: &[Point2<f64>]) -> f64 {
    let next = points.iter().cycle().skip(1);
    0.5 * points.iter().zip(next).map(|(p, q)| p.coords.perp(&q.coords)).sum::<f64>()
}

fn polygon_length(points: &[Point2<f64>]) -> f64 {
    points.iter().zip(points.iter().cycle().skip(1)).map(|(p, q)| (q - p).norm()).sum()
}

fn contains(polygon: &[Point2<f64>], p: &Point2<f64>) -> bool {
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossings =
        edges.filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x));
    crossings.count() % 2 == 1
}

fn distance_to(polygon: &[Point2<f64>], p: &Point2<f64>) -> f64 {
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let distances = edges.map(|(a, b)| (p - (a + share_along_side(a, b, p) * (b - a))).norm());
    distances.fold(f64::INFINITY, f64::min)
}

fn each_shape(check: impl Fn(BuiltInShape, &Shape)) {
    for built_in in BuiltInShape::ALL {
        check(built_in, &built_in.shape());
    }
}

#[test]
fn every_built_in_shape_is_a_simple_closed_curve() {
    each_shape(|name, shape| {
        let points = shape.sample(1500, 0.0);
        let side = |a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>| (b - a).perp(&(c - a)) > 0.0;
        let n = points.len();
        for i in 0..n - 2 {
            for j in i + 2..n {
                let (a, b, c, d) = (&points[i], &points[i + 1], &points[j], &points[(j + 1) % n]);
                let cross = side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
                assert!(!cross || (j + 1) % n == i, "{name}: stretches {i} and {j} of {n} cross");
            }
        }
    });
}

#[test]
fn every_built_in_shape_is_centred_of_unit_size_and_counter_clockwise() {
    each_shape(|name, shape| {
        let points = shape.sample(3000, 0.1);
        assert!(shoelace(&points) > 0.0, "{name}");
        assert!((shoelace(&points) - shape.area()).abs() < 1e-5, "{name}");
        assert!((shape.diameter() - 1.0).abs() < 1e-8, "{name}");
        let widest = points.iter().flat_map(|p| points.iter().map(move |q| (p - q).norm_squared())).fold(0.0, f64::max);
        assert!(widest.sqrt() < 1.0 + 1e-6 && widest.sqrt() > 1.0 - 5e-5, "{name}: {}", widest.sqrt());
        assert!(shape.centroid().coords.norm() < 1e-12, "{name}");
        let third = |(p, q): (&Point2<f64>, &Point2<f64>)| p.coords.perp(&q.coords) * (p.coords + q.coords);
        let moments: Vector2<f64> = points.iter().zip(points.iter().cycle().skip(1)).map(third).sum();
        assert!(moments.norm() / 6.0 / shape.area() < 1e-5, "{name}: centroid {moments}");
    });
}

#[test]
fn walking_a_shape_by_equal_fractions_covers_equal_lengths() {
    each_shape(|name, shape| {
        let points = shape.sample(20_000, 0.0);
        let total = polygon_length(&points);
        assert!((total / shape.perimeter() - 1.0).abs() < 2e-6, "{name}: {total} {}", shape.perimeter());
        let step = shape.perimeter() / points.len() as f64;
        for (k, pair) in points.windows(2).enumerate() {
            let length = (pair[1] - pair[0]).norm();
            let at_sharp_corner = name == BuiltInShape::Square && length < step;
            assert!((length / step - 1.0).abs() < 1e-3 || at_sharp_corner, "{name} at {k}: {length} of {step}");
        }
    });
}

#[test]
fn places_on_a_shape_are_periodic() {
    each_shape(|_, shape| {
        for fraction in [0.0, 0.25, 0.7182] {
            assert!((shape.point_at(fraction) - shape.point_at(fraction - 3.0)).norm() < 1e-12);
        }
        assert!((shape.point_at(1.0 - 1e-15) - shape.point_at(0.0)).norm() < 1e-12);
    });
}

#[test]
fn normals_point_outward_and_stand_upright_on_the_curve() {
    each_shape(|name, shape| {
        let dense = shape.sample(8000, 0.0);
        for k in 0..500 {
            let fraction = (f64::from(k) + 0.37) / 500.0;
            let (p, normal) = (shape.point_at(fraction), shape.normal_at(fraction));
            assert!(!contains(&dense, &(p + 1e-4 * *normal)), "{name} at {fraction}");
            assert!(contains(&dense, &(p - 1e-4 * *normal)), "{name} at {fraction}");
            let chord = shape.point_at(fraction + 1e-6) - shape.point_at(fraction - 1e-6);
            assert!(chord.normalize().dot(&normal).abs() < 1e-3, "{name} at {fraction}");
        }
    });
}

#[test]
fn normals_turn_without_a_jump_on_all_shapes_but_the_square() {
    let largest_turn = |shape: &Shape| {
        let normal = |k: u32| shape.normal_at(f64::from(k) / 40_000.0);
        (0..40_000).map(|k| normal(k).angle(&normal(k + 1))).fold(0.0, f64::max)
    };
    each_shape(|name, shape| match name {
        BuiltInShape::Square => assert!((largest_turn(shape) - 0.5 * PI).abs() < 1e-9),
        _ => assert!(largest_turn(shape) < 0.03, "{name}: {}", largest_turn(shape)),
    });
}

/// Mean distance from the shape, turned by `angle` or mirrored at the axis of that direction, to the shape itself.
fn asymmetry(shape: &Shape, angle: f64, mirror: bool) -> f64 {
    let outline = shape.sample(400, 0.0);
    let moved = shape.sample(60, 0.0).into_iter().map(|p| {
        if mirror {
            let flipped = Rotation2::new(-angle) * p;
            Rotation2::new(angle) * Point2::new(flipped.x, -flipped.y)
        } else {
            Rotation2::new(angle) * p
        }
    });
    moved.map(|p| distance_to(&outline, &p)).sum::<f64>() / 60.0
}

#[test]
fn the_shapes_have_the_symmetries_of_their_objects_and_no_others() {
    use BuiltInShape as B;
    const EXACT: f64 = 2e-4;
    each_shape(|name, shape| {
        let upright = asymmetry(shape, 0.5 * PI, true);
        let half_turn = asymmetry(shape, PI, false);
        match name {
            B::Boomerang | B::GlassVase | B::Vase => assert!(upright < EXACT && half_turn > 0.01, "{name}"),
            B::CdBox | B::Ellipse => assert!(upright < EXACT && half_turn < EXACT, "{name}"),
            B::Square => assert!(asymmetry(shape, 0.5 * PI, false) < EXACT),
            B::Circle => assert!(asymmetry(shape, 1.0, false) < EXACT),
            _ => {
                let turns = (15..=165).map(|degrees| asymmetry(shape, f64::from(degrees).to_radians(), false));
                let flips = (0..90).map(|k| asymmetry(shape, f64::from(2 * k).to_radians(), true));
                let closest = turns.chain(flips).fold(f64::INFINITY, f64::min);
                assert!(closest > 0.006, "{name} fits itself to {closest}");
            }
        }
    });
}

#[test]
fn names_are_read_in_any_common_spelling() {
    for built_in in BuiltInShape::ALL {
        let name = built_in.name();
        for spelling in [name.to_owned(), name.to_uppercase(), name.replace('_', "-"), name.replace('_', " ")] {
            assert_eq!(spelling.parse(), Ok(built_in));
        }
        assert_eq!(built_in.shape().name(), name);
        assert_eq!(built_in.to_string(), name);
    }
    assert_eq!("Cellular-Phone".parse(), Ok(BuiltInShape::Phone));
    assert_eq!("flight_bird".parse(), Ok(BuiltInShape::Bird));
    assert_eq!("glassvase".parse(), Ok(BuiltInShape::GlassVase));
}

#[test]
fn an_unknown_name_is_answered_with_all_known_ones() {
    let error = "teapot".parse::<BuiltInShape>().expect_err("not a built-in shape");
    assert!(
        matches!(&error, ShapeError::UnknownName { name, known } if name == "teapot" && known.len() == 15),
        "{error}"
    );
    let message = error.to_string();
    assert!(message.contains("teapot") && BuiltInShape::ALL.iter().all(|b| message.contains(b.name())), "{message}");
}

fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
    list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

#[test]
fn polygons_that_enclose_nothing_are_refused_with_the_reason() {
    let from = |list: &[(f64, f64)]| Shape::from_polygon(&points(list));
    let polygon = |error| Err(ShapeError::Polygon(error));
    assert_eq!(from(&[]), polygon(OutlineError::TooFewPoints { found: 0, needed: 3 }));
    assert_eq!(from(&[(1.0, 1.0); 7]), polygon(OutlineError::TooFewPoints { found: 1, needed: 3 }));
    assert_eq!(from(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]), polygon(OutlineError::Collinear { count: 3 }));
    assert_eq!(from(&[(0.0, 0.0), (f64::INFINITY, 1.0), (2.0, 0.0)]), polygon(OutlineError::NotFinite { index: 1 }));
    let eight = from(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
    assert!(matches!(eight, Err(ShapeError::NoArea { .. })), "{eight:?}");
}

#[test]
fn a_polygon_is_the_same_shape_either_way_round_and_with_repeated_points() {
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 3.0)];
    let plain = Shape::from_polygon(&points(&corners)).expect("a quadrilateral");
    assert!((plain.area() - 4.0).abs() < 1e-14);
    assert!((plain.perimeter() - (6.0 + 8.0_f64.sqrt())).abs() < 1e-12);
    assert_eq!(plain.name(), "polygon");
    let repeated = [corners[0], corners[0], corners[1], corners[2], corners[3], corners[3], corners[0]];
    assert_eq!(Shape::from_polygon(&points(&repeated)).expect("the same"), plain);
    let mut backwards = corners;
    backwards.reverse();
    let reversed = Shape::from_polygon(&points(&backwards)).expect("the same").with_name("gable");
    assert!((reversed.area() - 4.0).abs() < 1e-14);
    assert_eq!(reversed.name(), "gable");
    assert!(shoelace(&reversed.sample(50, 0.0)) > 0.0);
}

proptest! {
    #[test]
    fn the_diameter_is_the_largest_distance_between_two_corners(
        corners in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 3..40),
    ) {
        let corners = points(&corners);
        let shape = Shape::from_polygon(&corners);
        // A random polygon may cross itself so that its area cancels.
        prop_assume!(shape.is_ok());
        let pairs = corners.iter().flat_map(|p| corners.iter().map(move |q| (p - q).norm()));
        let largest = pairs.fold(0.0, f64::max);
        prop_assert!((shape.expect("checked").diameter() - largest).abs() < 1e-12);
    }

    #[test]
    fn normalising_a_polygon_forgets_its_place_and_size(
        angles in prop::collection::vec((0.05..1.0_f64, 0.5..1.5_f64), 5..30),
        x in -1e3..1e3_f64, y in -1e3..1e3_f64, size in 1e-3..1e3_f64,
    ) {
        let total: f64 = angles.iter().map(|(step, _)| step).sum();
        let mut angle = 0.0;
        let star: Vec<Point2<f64>> = angles.iter().map(|(step, radius)| {
            angle += step / total * TAU;
            Point2::new(radius * angle.cos(), radius * angle.sin())
        }).collect();
        let moved: Vec<_> = star.iter().map(|p| Point2::new(x + size * p.x, y + size * p.y)).collect();
        let (here, there) = (Shape::from_polygon(&star), Shape::from_polygon(&moved));
        let here = here.expect("a star about the origin").normalised();
        let there = there.expect("a star about another point").normalised();
        prop_assert!((here.diameter() - 1.0).abs() < 1e-9);
        prop_assert!(here.centroid().coords.norm() < 1e-9);
        for k in 0..20 {
            let fraction = f64::from(k) / 20.0;
            prop_assert!((here.point_at(fraction) - there.point_at(fraction)).norm() < 1e-7);
        }
    }
}
