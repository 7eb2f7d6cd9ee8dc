//! The bounded fit against a general conic solver on the same problem, stated over a dense set of directions.
use crate::support::any_visibility;
use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SupportedConeT},
};
use freeform_curve_fit::{CircleRange, Degree, FitSettings, Fitter, Method, evaluate_monomials, outward_normals};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Minimises `|M a - d|^2` subject to `h(t) >= floor` at the given directions.
fn constrained_by_directions(
    gram: &DMatrix<f64>,
    projection: &DVector<f64>,
    degree: usize,
    floor: f64,
    directions: &[f64],
) -> Vec<f64> {
    let size = projection.len();
    let scale = gram.norm();
    let dense = |matrix: &DMatrix<f64>| {
        let rows: Vec<Vec<f64>> = matrix.row_iter().map(|r| r.iter().copied().collect()).collect();
        CscMatrix::from(&rows)
    };
    let quadratic = (gram / scale).upper_triangle();
    let linear: Vec<f64> = projection.iter().map(|h| -h / scale).collect();
    let first = size - degree - 1;
    let mut constraint = DMatrix::zeros(directions.len(), size);
    for (row, t) in directions.iter().enumerate() {
        for j in 0..=degree {
            constraint[(row, first + j)] = -t.cos().powi((degree - j) as i32) * t.sin().powi(j as i32);
        }
    }
    let right = vec![-floor; directions.len()];
    let cones = [SupportedConeT::NonnegativeConeT(directions.len())];
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 1e-13,
        tol_gap_rel: 1e-13,
        tol_feas: 1e-13,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&dense(&quadratic), &linear, &dense(&constraint), &right, &cones, settings)
        .expect("a problem");
    solver.solve();
    solver.solution.x.clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_bounded_fit_agrees_with_a_conic_solver(
        outlines in any_visibility(),
        margin in 0.05..0.5_f64,
        which in 0..3_usize,
    ) {
        let outline = outlines[which].clone();
        for degree in [Degree::Quartic, Degree::Sextic, Degree::Octic] {
            let (n, size) = (degree.value(), degree.coefficient_count());
            let plain = FitSettings { degree, method: Method::ThreeLevel, ..FitSettings::default() };
            let free = Fitter::new(plain).expect("settings").fit(&outline).expect("a fit");
            let bounded = FitSettings { method: Method::Bounded { margin, ridge_weight: 0.0 }, ..plain };
            let fit = Fitter::new(bounded).expect("settings").fit(&outline).expect("a fit");
            if !fit.diagnostics().constraint_active {
                continue;
            }
            // The same least-squares problem, row by row.
            let normalisation = free.normalisation();
            let normals = outward_normals(&outline, plain.normal_half_window);
            let mut gram = DMatrix::zeros(size, size);
            let mut projection = DVector::zeros(size);
            let mut row = vec![0.0; size];
            for (p, normal) in outline.points().zip(&normals) {
                for level in [-1.0, 0.0, 1.0] {
                    let q = normalisation.to_working(p) + level * plain.offset * normal;
                    evaluate_monomials(n, q.x, q.y, &mut row);
                    let row = DVector::from_column_slice(&row);
                    gram += &row * row.transpose();
                    projection += level * row;
                }
            }
            let floor = margin * CircleRange::of(free.working().leading_form()).rms;
            // A coarse set of directions, then ever finer ones where the form touches the floor.
            let mut directions: Vec<f64> = (0..720).map(|i| std::f64::consts::PI * f64::from(i) / 720.0).collect();
            let mut width = std::f64::consts::PI / 720.0;
            let mut oracle = Vec::new();
            for _ in 0..3 {
                oracle = constrained_by_directions(&gram, &projection, n, floor, &directions);
                let form = &oracle[size - n - 1..];
                let value = |t: f64| (0..=n).map(|j| form[j] * t.cos().powi((n - j) as i32) * t.sin().powi(j as i32)).sum::<f64>();
                let touching: Vec<f64> = directions.iter().copied().filter(|&t| {
                    value(t) <= value(t - width) && value(t) <= value(t + width)
                }).collect();
                for t in touching {
                    directions.extend((-20..=20).map(|k| t + width * f64::from(k) / 20.0));
                }
                width /= 20.0;
            }
            // Compared by their values on the level sets, which the problem is about: the difference in the norm of its
            // Gram matrix. Single coefficients are less well determined, by both.
            let ours = DVector::from_column_slice(fit.working().coefficients());
            let theirs = DVector::from_vec(oracle);
            let norm = |a: &DVector<f64>| (&gram * a).dot(a).sqrt();
            let difference = norm(&(&ours - &theirs)) / norm(&theirs);
            // Measured over 200 outlines, whole and in one or two arcs: 5e-7, 7e-7 and 2e-5.
            let tolerance = match degree {
                Degree::Octic => 1e-4,
                Degree::Sextic => 1e-5,
                _ => 1e-6,
            };
            prop_assert!(difference < tolerance, "{degree}: {difference:e}");
        }
    }
}
