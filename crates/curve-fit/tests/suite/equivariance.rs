//! Fits move with their data: the property that all of motion identification rests on.
use crate::support::{affine, any_similarity, any_star, any_visibility, closed};
use freeform_curve_fit::{
    BoundedPolynomial, CircleRange, Degree, Fit, FitSettings, Fitter, ImplicitPolynomial, Method, Moments, OpenArc,
    OpenOutline, Outline, exponents, outward_normals,
};
use nalgebra::{Affine2, Matrix3, Point2, Projective2, Rotation2};
use proptest::prelude::*;

const METHODS: [Method; 3] = [
    Method::ThreeLevel,
    Method::GloballyStabilised { ridge_weight: 1e-3 },
    // So large a margin that the constraint is active on most outlines.
    Method::Bounded { margin: 0.45, ridge_weight: 0.0 },
];

fn fit(points: Vec<Point2<f64>>, degree: Degree, method: Method) -> Fit {
    fit_outline(&closed(points), degree, method)
}

fn fit_outline(outline: &Outline, degree: Degree, method: Method) -> Fit {
    let settings = FitSettings { degree, method, ..FitSettings::default() };
    Fitter::new(settings).expect("good settings").fit(outline).expect("a fit")
}

/// The fit of the moved outline in the working coordinates of the fit of the outline, where both should be the same function.
fn brought_back(still: &Fit, moved: &Fit, map: &Affine2<f64>) -> ImplicitPolynomial {
    let to_working = still.normalisation().image_from_working().inverse()
        * map.inverse()
        * moved.normalisation().image_from_working();
    moved.working().moved(&to_working).expect("a similarity")
}

/// Largest difference between a fit and another polynomial over the three level sets of the outline, where the fit is about
/// -1, 0 and 1: what the least-squares problem is about.
fn difference_on_level_sets(outline: &Outline, fit: &Fit, other: &ImplicitPolynomial) -> f64 {
    let settings = FitSettings::default();
    let normals = outward_normals(outline, settings.normal_half_window);
    let working = outline.points().map(|p| fit.normalisation().to_working(p));
    let level_sets = working.zip(&normals).flat_map(|(p, n)| [-1.0, 0.0, 1.0].map(|l| p + l * settings.offset * n));
    level_sets.map(|p| (fit.working().evaluate(&p) - other.evaluate(&p)).abs()).fold(0.0, f64::max)
}

/// How much a fit may change when the coordinates are rounded anew: the Gram matrix of a least-squares matrix with the
/// condition number K has the condition `K^2`, by which it magnifies rounding. The coordinates moved by `any_similarity` are
/// up to a hundred sizes away, and the estimate of K is a lower bound; over 200 outlines the factor was at most 2e3.
fn promised(fit: &Fit) -> f64 {
    1e4 * f64::EPSILON * fit.diagnostics().condition.powi(2)
}

/// Largest difference between two polynomials over a few points around the unit circle, relative to the largest value.
fn difference(f: &ImplicitPolynomial, g: &ImplicitPolynomial) -> f64 {
    let points = (0..40).map(|i| {
        let t = 0.7 * f64::from(i);
        Point2::new((0.5 + 0.02 * f64::from(i)) * t.cos(), (0.5 + 0.02 * f64::from(i)) * t.sin())
    });
    let (mut largest, mut worst) = (0.0_f64, 0.0_f64);
    for p in points {
        largest = largest.max(f.evaluate(&p).abs());
        worst = worst.max((f.evaluate(&p) - g.evaluate(&p)).abs());
    }
    worst / largest
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_fit_of_a_moved_outline_is_the_moved_fit(points in any_star(), map in any_similarity()) {
        for method in METHODS {
            for degree in Degree::ALL {
                let still = fit(points.clone(), degree, method);
                let moved = fit(points.iter().map(|p| map * p).collect(), degree, method);
                let brought_back = brought_back(&still, &moved, &map);
                let tolerance = promised(&still).max(promised(&moved));
                let error = difference(still.working(), &brought_back);
                prop_assert!(error < tolerance, "{method:?} {degree}: {error:e}");
            }
        }
    }

    #[test]
    fn every_fit_moves_with_what_is_seen_as_exactly_as_its_condition_promises(
        outlines in any_visibility(),
        map in any_similarity(),
    ) {
        for outline in &outlines {
            let moved_outline = outline.moved(&map).expect("a similarity");
            for method in METHODS {
                for degree in Degree::ALL {
                    let still = fit_outline(outline, degree, method);
                    let moved = fit_outline(&moved_outline, degree, method);
                    let error = difference_on_level_sets(outline, &still, &brought_back(&still, &moved, &map));
                    let (tolerance, condition) = (promised(&still).max(promised(&moved)), still.diagnostics().condition);
                    prop_assert!(error < tolerance, "{method:?} {degree}: {error:e}, condition {condition:e}");
                }
            }
        }
    }

    #[test]
    fn it_does_not_matter_which_way_round_each_arc_is_given(outlines in any_visibility(), reversed in 0..4_usize) {
        let Outline::Open(two) = &outlines[1] else { panic!("two arcs") };
        let turned = two.arcs().iter().enumerate().map(|(i, arc)| {
            let mut points = arc.points().to_vec();
            if reversed >> i & 1 == 1 {
                points.reverse();
            }
            OpenArc::new(points).expect("an arc")
        });
        let turned = Outline::Open(OpenOutline::new(turned.collect()).expect("two arcs"));
        let [reference, again] = [&outlines[1], &turned].map(|o| fit_outline(o, Degree::Quartic, Method::ThreeLevel));
        prop_assert!(difference_on_level_sets(&outlines[1], &reference, again.working()) < 1e-8);
    }

    #[test]
    fn neither_the_starting_point_nor_the_direction_matters(points in any_star(), start in 0..150_usize) {
        let reference = fit(points.clone(), Degree::Quartic, Method::ThreeLevel);
        let mut shuffled = points;
        shuffled.rotate_left(start);
        shuffled.reverse();
        let again = fit(shuffled, Degree::Quartic, Method::ThreeLevel);
        prop_assert!(difference(reference.working(), again.working()) < 1e-10);
    }

    #[test]
    fn the_moments_give_the_same_fit_as_the_orthogonal_factorisation(points in any_star()) {
        for method in METHODS {
            for degree in Degree::ALL {
                let settings = FitSettings { degree, method, ..FitSettings::default() };
                let mut fitter = Fitter::new(settings).expect("good settings");
                let outline = closed(points.clone());
                let fast = fitter.fit(&outline).expect("a fit");
                let reference = fitter.fit_by_orthogonal_factorisation(&outline).expect("a fit");
                let error = difference(reference.working(), fast.working());
                let tolerance = 1e-9_f64.max(promised(&fast));
                prop_assert!(error < tolerance, "{method:?} {degree}: {error:e}");
            }
        }
    }

    #[test]
    fn a_moved_polynomial_has_the_old_values_at_the_moved_points(
        coefficients in prop::collection::vec(-1.0..1.0_f64, 45),
        linear in prop::array::uniform4(-1.0..1.0_f64),
        shift in prop::array::uniform2(-1.0..1.0_f64),
        bottom in prop::array::uniform2(-0.3..0.3_f64),
    ) {
        let linear = nalgebra::Matrix2::from_row_slice(&linear) + 2.0 * nalgebra::Matrix2::identity();
        let map = affine(linear, shift.into());
        let mut matrix: Matrix3<f64> = map.into_inner();
        (matrix[(2, 0)], matrix[(2, 1)]) = (bottom[0], bottom[1]);
        let projective = Projective2::from_matrix_unchecked(matrix);
        for degree in Degree::ALL {
            let f = ImplicitPolynomial::new(degree, &coefficients[..degree.coefficient_count()]).expect("finite");
            let moved = f.moved(&map).expect("regular");
            let projected = f.projected(&projective).expect("regular");
            for p in [Point2::new(0.3, -0.4), Point2::new(-0.9, 0.2), Point2::new(0.0, 0.7)] {
                let value = f.evaluate(&p);
                prop_assert!((moved.evaluate(&(map * p)) - value).abs() < 1e-9);
                let image = matrix * p.to_homogeneous();
                let weight = image.z.powi(degree.value() as i32);
                let there = Point2::new(image.x / image.z, image.y / image.z);
                // Far out, large terms cancel.
                let terms = exponents(degree.value()).zip(projected.coefficients());
                let size: f64 =
                    terms.map(|((i, j), a)| (a * there.x.powi(i as i32) * there.y.powi(j as i32)).abs()).sum();
                let error = (weight * projected.evaluate(&there) - value).abs();
                prop_assert!(error < 1e-8 + 1e-10 * weight.abs() * size, "{error:e}");
            }
        }
    }

    #[test]
    fn the_ridge_is_the_same_in_every_rotated_frame(points in any_star(), turn in -3.0..3.0_f64) {
        let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.x, p.y)).unzip();
        let rotation = affine(*Rotation2::new(turn).matrix(), nalgebra::Vector2::zeros());
        for degree in Degree::ALL {
            let size = degree.coefficient_count();
            let data = Moments::of(2 * degree.value(), &xs, &ys);
            let ridge = freeform_curve_fit::rotation_invariant_ridge(degree.value(), &data);
            // Column k of V is the moved k-th monomial; V' D V = D.
            let moved = |k: usize| {
                let mut unit = vec![0.0; size];
                unit[k] = 1.0;
                ImplicitPolynomial::new(degree, &unit).expect("finite").moved(&rotation).expect("a rotation")
            };
            let columns: Vec<ImplicitPolynomial> = (0..size).map(moved).collect();
            for (k, a) in columns.iter().enumerate() {
                for (l, b) in columns.iter().enumerate() {
                    let product: f64 = (0..size).map(|r| a.coefficients()[r] * ridge[r] * b.coefficients()[r]).sum();
                    let expected = if k == l { ridge[k] } else { 0.0 };
                    prop_assert!((product - expected).abs() <= 1e-9 * (ridge[k] * ridge[l]).sqrt());
                }
            }
        }
    }

    #[test]
    fn gradient_and_hessian_are_the_derivatives_of_the_value(
        coefficients in prop::collection::vec(-1.0..1.0_f64, 45),
        x in -1.2..1.2_f64,
        y in -1.2..1.2_f64,
    ) {
        let step = 1e-5;
        for degree in Degree::ALL {
            let f = ImplicitPolynomial::new(degree, &coefficients[..degree.coefficient_count()]).expect("finite");
            let (value, gradient, hessian) = f.value_and_derivatives(&Point2::new(x, y));
            prop_assert!((value - f.evaluate(&Point2::new(x, y))).abs() < 1e-12);
            for axis in 0..2 {
                let mut ends = [Point2::new(x, y); 2];
                ends[0][axis] -= step;
                ends[1][axis] += step;
                let slope = (f.evaluate(&ends[1]) - f.evaluate(&ends[0])) / (2.0 * step);
                prop_assert!((slope - gradient[axis]).abs() < 1e-5);
                let bend = (f.gradient(&ends[1]) - f.gradient(&ends[0])) / (2.0 * step);
                prop_assert!((bend - hessian.column(axis)).norm() < 1e-5);
            }
        }
    }

    #[test]
    fn every_bounded_fit_to_arcs_is_bounded_by_its_margin(outlines in any_visibility()) {
        for outline in &outlines {
            for degree in Degree::ALL {
                let fit = fit_outline(outline, degree, Method::Bounded { margin: 0.05, ridge_weight: 0.0 });
                prop_assert!(fit.is_bounded());
                // The margin is one of the unconstrained form.
                let free = fit_outline(outline, degree, Method::ThreeLevel);
                let [range, free] = [&fit, &free].map(|fit| CircleRange::of(fit.working().leading_form()));
                prop_assert!(range.minimum > 0.999_999 * 0.05 * free.rms, "{range:?} {free:?}");
                prop_assert!(BoundedPolynomial::try_from(fit.polynomial()).is_ok());
            }
        }
    }

    #[test]
    fn every_bounded_fit_is_bounded_by_its_margin(points in any_star(), keep in 0.3..1.0_f64) {
        // Part of the outline only: there the unconstrained fit is often unbounded.
        let kept = (keep * points.len() as f64) as usize;
        for degree in [Degree::Conic, Degree::Quartic, Degree::Sextic, Degree::Octic] {
            let fit = fit(points[..kept].to_vec(), degree, Method::Bounded { margin: 0.05, ridge_weight: 0.0 });
            prop_assert!(fit.is_bounded());
            prop_assert!(BoundedPolynomial::try_from(fit.polynomial()).is_ok());
        }
    }
}
