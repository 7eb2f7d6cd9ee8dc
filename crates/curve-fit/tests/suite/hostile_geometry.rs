//! Outlines as nobody would choose them: the fit moves with them all the same, or is refused with a typed error.
use crate::support::{similarity, star};
use freeform_curve_fit::{Degree, Fit, FitError, FitSettings, Fitter, Method, Outline, OutlineError};
use nalgebra::{Affine2, Point2, Vector2};
use proptest::prelude::*;

/// The kind of outline that runs to and fro on one line, and the even figure of eight.
const THERE_AND_BACK: usize = 4;
const EIGHT: usize = 0;

/// Points that make trouble, each around the origin and of size about 1.
fn hostile(kind: usize, waves: &[(f64, f64)], count: usize, seed: u64) -> Vec<Point2<f64>> {
    let points = star(waves, count, 0.003, seed);
    let turn = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
    match kind {
        // A figure of eight, which crosses itself.
        EIGHT => (0..count).map(|i| Point2::new(turn(i).sin(), (2.0 * turn(i)).sin() / 2.0)).collect(),
        // Two lobes that touch in one point.
        1 => {
            (0..count).map(|i| Point2::from(Vector2::new(turn(i).cos(), turn(i).sin()) * turn(i).cos().abs())).collect()
        }
        // Every point three times.
        2 => points.iter().flat_map(|p| [*p; 3]).collect(),
        // One point as often as all others.
        3 => points.iter().copied().chain(std::iter::repeat_n(points[0], count)).collect(),
        // There and back again along the same way.
        THERE_AND_BACK => points.iter().chain(points.iter().rev()).copied().collect(),
        // Pixel stairs.
        5 => points.iter().map(|p| Point2::new((20.0 * p.x).round() / 20.0, (20.0 * p.y).round() / 20.0)).collect(),
        // A sliver a thousand times as long as wide.
        6 => points.iter().map(|p| Point2::new(p.x, 1e-3 * p.y)).collect(),
        // A long thin spike.
        7 => points.iter().copied().chain([Point2::new(30.0, 0.0)]).collect(),
        // A perfect circle.
        _ => (0..count).map(|i| Point2::new(turn(i).cos(), turn(i).sin())).collect(),
    }
}

fn fit(points: &[Point2<f64>], degree: Degree, method: Method) -> Result<Fit, FitError> {
    let outline = Outline::closed(points.to_vec()).expect("an outline");
    Fitter::new(FitSettings { degree, method, ..FitSettings::default() }).expect("settings").fit(&outline)
}

fn moved(points: &[Point2<f64>], map: &Affine2<f64>) -> Vec<Point2<f64>> {
    points.iter().map(|p| map * p).collect()
}

/// Largest difference of the values of two fits of the same points, the second seen through a map, at these points;
/// relative to the level that stands an offset away.
fn difference(first: &Fit, second: &Fit, points: &[Point2<f64>], map: &Affine2<f64>) -> f64 {
    let at = |p: &Point2<f64>| {
        let here = first.working().evaluate(&first.normalisation().to_working(p));
        let there = second.working().evaluate(&second.normalisation().to_working(&(map * p)));
        (here - there).abs()
    };
    points.iter().map(at).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_fit_moves_with_any_outline_or_is_refused_in_both_places(
        kind in 0..9_usize,
        waves in prop::collection::vec((-0.15..0.15_f64, -0.15..0.15_f64), 3),
        count in 40..300_usize,
        seed in any::<u64>(),
        turn in -3.2..3.2_f64,
        unit in -6.0..6.0_f64,
        far in prop::bool::ANY,
    ) {
        let points = hostile(kind, &waves, count, seed);
        let unit = 10.0_f64.powf(unit);
        let shift = if far { Vector2::new(1e6, -7e5) * unit } else { Vector2::zeros() };
        let map = similarity(turn, unit, shift);
        for degree in [Degree::Conic, Degree::Quartic] {
            let method = Method::Bounded { margin: 0.05, ridge_weight: 1e-3 };
            let (here, there) = (fit(&points, degree, method), fit(&moved(&points, &map), degree, method));
            match (here, there) {
                (Ok(here), Ok(there)) => {
                    prop_assert!(here.is_bounded() && there.is_bounded());
                    let error = difference(&here, &there, &points, &map);
                    // Coordinates a million sizes away are themselves rounded to 1e-10 of the size.
                    let tolerance = if far { 1e-4 } else { 1e-7 };
                    prop_assert!(error < tolerance, "kind {kind}, {degree}: {error:e}");
                }
                (here, there) => prop_assert!(
                    here.is_err() && there.is_err(), "kind {kind}, {degree}: {here:?} beside {there:?}"
                ),
            }
        }
    }

    #[test]
    fn the_start_and_the_direction_of_any_outline_do_not_matter(
        kind in 0..9_usize,
        waves in prop::collection::vec((-0.15..0.15_f64, -0.15..0.15_f64), 3),
        count in 40..300_usize,
        seed in any::<u64>(),
        start in 0..40_usize,
    ) {
        let points = hostile(kind, &waves, count, seed);
        let mut other_way = points.clone();
        other_way.rotate_left(start);
        other_way.reverse();
        let method = Method::Bounded { margin: 0.05, ridge_weight: 1e-3 };
        let (here, there) = (fit(&points, Degree::Quartic, method), fit(&other_way, Degree::Quartic, method));
        if kind == THERE_AND_BACK {
            prop_assert_eq!((here.err(), there.err()), (Some(FitError::NoInside), Some(FitError::NoInside)));
            return Ok(());
        }
        // An even figure of eight may have an area of a rounding or so, and then has none the other way round either.
        match (here, there) {
            (Ok(here), Ok(there)) => {
                let error = difference(&here, &there, &points, &Affine2::identity());
                prop_assert!(error < 1e-7, "kind {kind}: {error:e}");
            }
            (here, there) => {
                prop_assert!(kind == EIGHT, "kind {kind}: {here:?} beside {there:?}");
                prop_assert_eq!((here.err(), there.err()), (Some(FitError::NoInside), Some(FitError::NoInside)));
            }
        }
    }
}

#[test]
fn a_million_points_give_the_curve_of_a_thousand() {
    let waves = [(0.1, 0.05), (0.0, -0.08)];
    let few = star(&waves, 1000, 0.0, 1);
    let many = star(&waves, 1_000_000, 0.0, 1);
    let method = Method::Bounded { margin: 0.05, ridge_weight: 1e-3 };
    let few_fit = fit(&few, Degree::Quartic, method).expect("a fit");
    let many_fit = fit(&many, Degree::Quartic, method).expect("a fit");
    assert_eq!(many_fit.diagnostics().point_count, 1_000_000);
    let error = difference(&few_fit, &many_fit, &few, &Affine2::identity());
    assert!(error < 1e-3, "{error:e}");
}

#[test]
fn points_that_are_no_outline_are_refused_by_name() {
    let line = |count: i32| (0..count).map(|i| Point2::new(1e6 + f64::from(i), 2e6)).collect::<Vec<_>>();
    assert!(matches!(Outline::closed(line(9)), Err(OutlineError::Collinear { count: 9 })));
    assert!(matches!(Outline::closed(vec![Point2::new(3.0, 3.0); 5]), Err(OutlineError::Coincident { count: 5 })));
    let triangle = [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)];
    let method = Method::Bounded { margin: 0.05, ridge_weight: 1e-3 };
    assert!(matches!(fit(&triangle, Degree::Quartic, method), Err(FitError::TooFewPoints { found: 3, .. })));
}
