//! Affine-normalised fits move with their data under every affine map.
use crate::support::{affine, any_star, any_visibility, closed, star};
use freeform_curve_fit::{
    AreaMoments, Degree, Fit, FitError, FitSettings, Fitter, ImplicitPolynomial, Method, Normalise, Outline, Residuals,
};
use nalgebra::{Affine2, Matrix2, Point2, Rotation2, Vector2};
use proptest::prelude::*;

const METHODS: [Method; 3] = [
    Method::ThreeLevel,
    Method::GloballyStabilised { ridge_weight: 1e-3 },
    Method::Bounded { margin: 0.45, ridge_weight: 0.0 },
];

fn fitter(degree: Degree, method: Method) -> Fitter {
    let settings = FitSettings { degree, method, normalise: Normalise::Affine, ..FitSettings::default() };
    Fitter::new(settings).expect("good settings")
}

/// Stretched, sheared and turned by any angle, mirrored or not, scaled by 0.1 to 10 and shifted.
fn any_affine() -> impl Strategy<Value = Affine2<f64>> {
    let linear = prop::array::uniform4(-0.35..0.35_f64);
    (linear, -3.2..3.2_f64, any::<bool>(), -1.0..1.0_f64, prop::array::uniform2(-10.0..10.0_f64)).prop_map(
        |(linear, turn, mirrored, scale, shift)| {
            let mirror = Matrix2::new(if mirrored { -1.0 } else { 1.0 }, 0.0, 0.0, 1.0);
            let stretch = Matrix2::identity() + Matrix2::from_row_slice(&linear);
            affine(10.0_f64.powf(scale) * Rotation2::new(turn).matrix() * stretch * mirror, Vector2::from(shift))
        },
    )
}

/// Largest difference between a fit and the fit of the moved outline moved back, in the ring between half and one and a half RMS
/// radii, where f is between about -5 and 5.
fn difference(still: &Fit, moved: &Fit, map: &Affine2<f64>) -> f64 {
    let back = still.normalisation().image_from_working().inverse() * map.inverse();
    let back = moved.working().moved(&(back * moved.normalisation().image_from_working())).expect("a regular map");
    let at = |k: i32| {
        let (sin, cos) = (0.7 * f64::from(k)).sin_cos();
        (0.5 + 0.01 * f64::from(k)) * Point2::new(cos, sin)
    };
    let values = |f: &ImplicitPolynomial| (0..100).map(at).map(|p| f.evaluate(&p)).collect::<Vec<_>>();
    values(still.working()).iter().zip(values(&back)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_fit_of_an_affinely_moved_outline_is_the_moved_fit(points in any_star(), map in any_affine(), start in 0..150_usize) {
        let outline = closed(points.clone());
        let mut shuffled = points;
        shuffled.rotate_left(start);
        shuffled.reverse();
        let moved_outline = closed(shuffled).moved(&map).expect("a regular map");
        for method in METHODS {
            let mut fitter = fitter(Degree::Quartic, method);
            let still = fitter.fit(&outline).expect("a fit");
            let moved = fitter.fit(&moved_outline).expect("a fit");
            let error = difference(&still, &moved, &map);
            prop_assert!(error < 1e-9, "{method:?}: {error:e}");
        }
    }

    #[test]
    fn a_sextic_moves_as_exactly_as_its_condition_promises(points in any_star(), map in any_affine()) {
        let outline = closed(points);
        let mut fitter = fitter(Degree::Sextic, Method::GloballyStabilised { ridge_weight: 1e-3 });
        let still = fitter.fit(&outline).expect("a fit");
        let moved = fitter.fit(&outline.moved(&map).expect("a regular map")).expect("a fit");
        prop_assert!(difference(&still, &moved, &map) < 1e-8);
    }

    #[test]
    fn arcs_are_fitted_in_the_frame_of_the_whole_and_move_with_it(outlines in any_visibility(), map in any_affine()) {
        let [one, two, whole] = outlines;
        let mut fitter = fitter(Degree::Quartic, Method::Bounded { margin: 0.3, ridge_weight: 0.01 });
        let frame = fitter.fit(&whole).expect("a fit").normalisation().image_from_working();
        for arcs in [one, two] {
            prop_assert_eq!(fitter.fit(&arcs).err(), Some(FitError::NoAreaMoments));
            let still = fitter.fit_in(&arcs, &frame).expect("a fit");
            let moved = fitter.fit_in(&arcs.moved(&map).expect("a regular map"), &(map * frame)).expect("a fit");
            prop_assert!(difference(&still, &moved, &map) < 1e-8);
        }
    }

    #[test]
    fn the_polynomial_in_the_image_has_the_values_of_the_working_one(points in any_star(), map in any_affine()) {
        let outline = closed(points).moved(&map).expect("a regular map");
        let fit = fitter(Degree::Quartic, METHODS[1]).fit(&outline).expect("a fit");
        for p in outline.points() {
            let working = fit.normalisation().to_working(p);
            prop_assert!((fit.normalisation().to_image(&working) - p).norm() < 1e-11 * (1.0 + p.coords.norm()));
            prop_assert!((fit.polynomial().evaluate(p) - fit.working().evaluate(&working)).abs() < 1e-5);
        }
    }

    #[test]
    fn area_moments_move_with_the_polygon(points in any_star(), map in any_affine()) {
        let outline = closed(points);
        let moved = outline.moved(&map).expect("a regular map");
        let moments = |outline: &Outline| match outline {
            Outline::Closed(outline) => AreaMoments::of(outline).expect("an area"),
            Outline::Open(_) => panic!("closed"),
        };
        let (still, moved) = (moments(&outline), moments(&moved));
        let linear = map.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let size = linear.norm();
        prop_assert!((moved.area / (still.area * linear.determinant().abs()) - 1.0).abs() < 1e-9);
        prop_assert!((moved.centroid - map * still.centroid).norm() < 1e-11 * (10.0 + size));
        let covariance = linear * still.covariance * linear.transpose();
        prop_assert!((moved.covariance - covariance).norm() < 1e-10 * covariance.norm());
    }
}

#[test]
fn how_the_points_are_spread_along_a_dense_outline_matters_little() {
    let harmonics = [(0.1, 0.05), (-0.12, 0.02), (0.03, 0.08)];
    let outlines = [star(&harmonics, 2000, 0.0, 1), star(&harmonics, 3000, 0.0, 1)].map(closed);
    // Four times as dense on one side as on the other.
    let every = |k: &usize| *k < 1000 || k.is_multiple_of(4);
    let uneven = outlines[0].points().copied().enumerate().filter(|(k, _)| every(k)).map(|(_, p)| p).collect();
    let mut fitter = fitter(Degree::Quartic, METHODS[0]);
    let reference = fitter.fit(&outlines[0]).expect("a fit");
    for outline in [&outlines[1], &closed(uneven)] {
        let fit = fitter.fit(outline).expect("a fit");
        let error = difference(&reference, &fit, &Affine2::identity());
        assert!(error < 5e-3, "{error:e}");
    }
}

#[test]
fn the_distance_of_a_stretched_outline_from_its_curve_is_that_in_the_image() {
    let stretch = affine(Matrix2::new(20.0, 3.0, 0.0, 0.5), Vector2::new(3.0, -2.0));
    let outline = closed(star(&[(0.1, 0.05), (-0.12, 0.02)], 400, 0.01, 3)).moved(&stretch).expect("a regular map");
    let fit = fitter(Degree::Quartic, METHODS[0]).fit(&outline).expect("a fit");
    let (xs, ys): (Vec<f64>, Vec<f64>) = outline.points().map(|p| (p.x, p.y)).unzip();
    let expected = Residuals::of(&fit.polynomial(), &xs, &ys).geometric;
    let residual = fit.diagnostics().geometric_residual;
    assert!((residual / expected - 1.0).abs() < 1e-6, "{residual} {expected}");
}

#[test]
fn a_frame_without_an_inverse_is_refused() {
    let outline = closed(star(&[(0.1, 0.0)], 100, 0.0, 1));
    let flat = affine(Matrix2::new(1.0, 2.0, 2.0, 4.0), Vector2::zeros());
    let arcs = crate::support::open(&star(&[(0.1, 0.0)], 100, 0.0, 1), &[0.0..0.6]);
    for outline in [outline, arcs] {
        let refused = fitter(Degree::Quartic, METHODS[0]).fit_in(&outline, &flat);
        assert_eq!(refused.err(), Some(FitError::SingularNormalisation));
    }
}

/// Root mean square ratio of the stated standard deviations of the coefficients to those over many draws of the noise.
fn stated_over_true(normalise: Normalise) -> (f64, f64) {
    let settings =
        FitSettings { normalise, method: Method::GloballyStabilised { ridge_weight: 1e-3 }, ..FitSettings::default() };
    let mut fitter = Fitter::new(settings).expect("settings");
    let (noise, draws) = (0.004, 200_u32);
    let harmonics = [(0.1, 0.05), (-0.12, 0.02), (0.03, 0.08)];
    let fits: Vec<_> = (0..draws)
        .map(|seed| fitter.fit_with_covariance(&closed(star(&harmonics, 400, noise, u64::from(seed)))).expect("a fit"))
        .collect();
    let size = Degree::Quartic.coefficient_count();
    let mean = |of: &dyn Fn(usize) -> f64| (0..fits.len()).map(of).sum::<f64>() / f64::from(draws);
    let ratios = (0..size).map(|k| {
        let value = |i: usize| fits[i].0.working().coefficients()[k];
        let average = mean(&value);
        let variance = mean(&|i| (value(i) - average).powi(2));
        mean(&|i| fits[i].1.coefficients()[(k, k)]) / variance
    });
    let ratio = (ratios.sum::<f64>() / size as f64).sqrt();
    (ratio, mean(&|i| fits[i].1.noise()) / noise)
}

#[test]
fn the_covariance_of_the_coefficients_is_that_of_many_draws_of_the_noise() {
    for normalise in [Normalise::Similarity, Normalise::Affine] {
        let (ratio, noise) = stated_over_true(normalise);
        println!("{normalise:?}: {ratio} {noise}");
        assert!((0.7..1.4).contains(&ratio), "{normalise:?}: {ratio}");
        // In working coordinates, where a star of radius 1 is about of radius 1.
        assert!((0.6..1.3).contains(&noise), "{normalise:?}: {noise}");
    }
}
