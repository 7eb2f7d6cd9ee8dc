//! Maps from pairs of points.
use freeform_riccati::{HomographyError, ProjectiveMotion, homography};
use nalgebra::{Point2, Projective2};
use proptest::prelude::*;

fn points(list: &[(f64, f64)]) -> Vec<Point2<f64>> {
    list.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

fn paired(from: &[Point2<f64>], to: &[Point2<f64>]) -> Vec<(Point2<f64>, Point2<f64>)> {
    from.iter().copied().zip(to.iter().copied()).collect()
}

const SQUARE: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];

fn any_map() -> impl Strategy<Value = Projective2<f64>> {
    (prop::array::uniform6(-1.0..1.0_f64), prop::array::uniform2(-0.3..0.3_f64))
        .prop_map(|([a1, a2, a3, a4, b1, b2], [c1, c2])| ProjectiveMotion { a1, a2, a3, a4, b1, b2, c1, c2 }.flow(1.0))
}

proptest! {
    #[test]
    fn four_points_or_more_give_back_the_map_that_moved_them_whatever_their_unit_and_place(
        map in any_map(), scale in -3.0..3.0_f64, shift in prop::array::uniform2(-5.0..5.0_f64), more in 0..6_usize,
        places in prop::array::uniform12(0.1..0.9_f64),
    ) {
        let unit = 10.0_f64.powf(scale);
        let body = points(&SQUARE);
        prop_assume!(body.iter().all(|p| (map.matrix() * p.to_homogeneous()).z > 0.1));
        let inner = places.chunks_exact(2).map(|p| Point2::new(p[0], p[1])).take(more);
        let body: Vec<_> = body.into_iter().chain(inner).collect();
        let seen: Vec<_> = body.iter().map(|p| unit * (map * p + nalgebra::Vector2::from(shift))).collect();
        let found = homography(&paired(&body, &seen)).expect("four good points");
        for (p, q) in [(0.3, 0.4), (0.9, 0.05)].map(|(x, y)| Point2::new(x, y)).iter()
            .map(|p| (found * p, unit * (map * p + nalgebra::Vector2::from(shift)))) {
            prop_assert!((p - q).norm() < 1e-9 * unit, "{p} {q}");
        }
        let back = homography(&paired(&seen, &body)).expect("four good points");
        let there_and_back = back.matrix() * found.matrix();
        let there_and_back = there_and_back / there_and_back[(2, 2)];
        prop_assert!((there_and_back - nalgebra::Matrix3::identity()).amax() < 1e-7 * unit.max(1.0 / unit), "{there_and_back}");
    }
}

#[test]
fn of_more_points_than_four_the_errors_are_averaged() {
    let grid: Vec<_> = (0..100).map(|k| Point2::new(f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0)).collect();
    // Errors that sum up to nothing, point by point.
    let off = |k: usize| if (k + k / 10).is_multiple_of(2) { 0.01 } else { -0.01 };
    let seen: Vec<_> = grid.iter().enumerate().map(|(k, p)| p + nalgebra::Vector2::new(off(k), -off(k))).collect();
    let found = homography(&paired(&grid, &seen)).expect("a hundred points");
    assert!((found * Point2::new(0.5, 0.5) - Point2::new(0.5, 0.5)).norm() < 1e-3);
}

#[test]
fn points_that_fix_no_map_are_refused_with_the_reason() {
    let square = points(&SQUARE);
    let refused = |to: &[(f64, f64)]| homography(&paired(&square, &points(to))).expect_err("no map");
    assert_eq!(refused(&SQUARE[..3]), HomographyError::TooFewPairs { found: 3 });
    assert_eq!(
        refused(&[(0.0, 0.0), (1.0, 0.0), (f64::NAN, 1.0), (0.0, 1.0)]),
        HomographyError::NotFinite { index: 2 }
    );
    assert_eq!(refused(&[(0.0, 0.0); 4]), HomographyError::Degenerate);
    assert_eq!(refused(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0)]), HomographyError::Degenerate);
    // Two corners swapped: a bow tie is no view of a square.
    assert_eq!(refused(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]), HomographyError::Folded);
}
