//! What cannot be fitted is refused with a reason; what can is finite, however far, small or large.
use crate::support::{any_star, closed, similarity, star};
use freeform_curve_fit::{
    ClosedOutline, Degree, Factorisation, FitError, FitSettings, Fitter, Method, OpenArc, OpenOutline, Outline,
    SettingsError,
};
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

#[test]
fn too_few_points_are_refused_with_the_number_needed() {
    let triangle = closed(vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)]);
    let mut fitter = Fitter::new(FitSettings::default()).expect("settings");
    let expected = FitError::TooFewPoints { found: 3, needed: 5, degree: Degree::Quartic };
    assert_eq!(fitter.fit(&triangle), Err(expected));
}

#[test]
fn a_perfect_circle_has_a_bounded_quartic_but_no_sextic() {
    let circle = closed(star(&[], 200, 0.0, 0));
    let fit = |degree, method| {
        let settings = FitSettings { degree, method, ..FitSettings::default() };
        Fitter::new(settings).expect("settings").fit(&circle)
    };
    // The distance from a circle is concave in r^2, so plain 3L opens outwards.
    assert!(!fit(Degree::Quartic, Method::ThreeLevel).expect("a fit").is_bounded());
    let bounded = fit(Degree::Quartic, Method::Bounded { margin: 0.02, ridge_weight: 0.0 }).expect("a fit");
    assert!(bounded.diagnostics().boundedness_margin > 0.999);
    assert!(matches!(fit(Degree::Sextic, Method::ThreeLevel), Err(FitError::RankDeficient { .. })));
    let ridge = Method::GloballyStabilised { ridge_weight: 1e-3 };
    assert!(fit(Degree::Sextic, ridge).expect("a fit").is_bounded());
}

#[test]
fn settings_outside_their_range_are_refused_by_name() {
    let refuse = |settings: FitSettings| Fitter::new(settings).expect_err("refused");
    let good = FitSettings::default();
    assert_eq!(refuse(FitSettings { offset: 0.0, ..good }), SettingsError::Offset { value: 0.0 });
    assert_eq!(refuse(FitSettings { normal_half_window: 0.3, ..good }), SettingsError::NormalHalfWindow { value: 0.3 });
    let ridge = Method::GloballyStabilised { ridge_weight: -1.0 };
    assert_eq!(refuse(FitSettings { method: ridge, ..good }), SettingsError::RidgeWeight { value: -1.0 });
    let margin = Method::Bounded { margin: 0.0, ridge_weight: 0.0 };
    assert_eq!(refuse(FitSettings { method: margin, ..good }), SettingsError::Margin { value: 0.0 });
}

#[test]
fn an_ill_conditioned_gram_matrix_falls_back_to_the_orthogonal_factorisation() {
    // A short arc: the monomials of an octic are nearly dependent on it.
    let arc = OpenArc::new(star(&[(0.1, 0.0)], 800, 0.0001, 7)[..40].to_vec()).expect("an arc");
    let outline = Outline::Open(OpenOutline::new(vec![arc]).expect("one arc"));
    let settings = FitSettings { degree: Degree::Octic, method: Method::ThreeLevel, ..FitSettings::default() };
    let fit = Fitter::new(settings).expect("settings").fit(&outline).expect("a fit");
    assert_eq!(fit.diagnostics().factorisation, Factorisation::Orthogonal);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn offsets_and_units_do_not_change_the_fit(points in any_star(), unit in -6.0..6.0_f64, x in -1.0..1.0_f64) {
        let unit = 10.0_f64.powf(unit);
        let map = similarity(0.0, unit, Vector2::new(1e6 * x * unit, -1e6 * unit));
        let mut fitter = Fitter::new(FitSettings::default()).expect("settings");
        let near = fitter.fit(&closed(points.clone())).expect("a fit");
        let far = fitter.fit(&closed(points.iter().map(|p| map * p).collect())).expect("a fit");
        // The coordinates themselves are rounded to 1e-10 of the size there.
        for (a, b) in near.working().coefficients().iter().zip(far.working().coefficients()) {
            prop_assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
        prop_assert!((near.diagnostics().geometric_residual * unit / far.diagnostics().geometric_residual - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_fit_of_arbitrary_points_is_finite_or_an_error(
        list in prop::collection::vec((-1e3..1e3_f64, -1e3..1e3_f64), 3..60),
        scale in -80.0..80.0_f64,
        degree in 0..4_usize,
    ) {
        let scale = 10.0_f64.powf(scale);
        let points = list.into_iter().map(|(x, y)| Point2::new(x * scale, y * scale)).collect();
        let Ok(outline) = Outline::closed(points) else { return Ok(()) };
        let settings = FitSettings { degree: Degree::ALL[degree], ..FitSettings::default() };
        if let Ok(fit) = Fitter::new(settings).expect("settings").fit(&outline) {
            prop_assert!(fit.working().coefficients().iter().all(|a| a.is_finite()));
            prop_assert!(fit.is_bounded());
            let d = fit.diagnostics();
            prop_assert!(d.geometric_residual.is_finite() && d.algebraic_residual.is_finite());
        }
    }
}

#[test]
fn the_sides_of_a_polygon_have_points_as_close_as_asked_and_a_damaged_corner_does_not_ask_for_all_memory() {
    let polygon = |corners: &[(f64, f64)]| {
        ClosedOutline::new(corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect()).expect("a polygon")
    };
    let square = polygon(&[(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]);
    let filled = square.with_sides(1.0);
    assert_eq!(filled.points().len(), 12);
    assert_eq!((filled.length(), filled.signed_area()), (12.0, 9.0));
    assert_eq!(square.with_sides(-1.0), square);
    let damaged = polygon(&[(0.0, 0.0), (1e90, 0.0), (0.0, 1e90)]);
    assert!((5_000..20_000).contains(&damaged.with_sides(1e-3).points().len()));
    let measured = square.with_deviations(vec![0.1; 4]).expect("deviations");
    assert_eq!(measured.with_sides(1.0), measured);
}
