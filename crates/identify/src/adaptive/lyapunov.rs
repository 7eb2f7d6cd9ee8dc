use nalgebra::{Matrix4, SMatrix, SVector};

use crate::error::IdentifyError;

/// Solves `Am' P + P Am = -Q` for the symmetric positive-definite P (section 4 of the paper).
///
/// The paper's Am = diag(-0.5, -0.5, -1, -1) and Q = diag(0.5, 1, 2, 3) give P = diag(0.5, 1, 1, 1.5).
///
/// # Errors
/// Am has an eigenvalue with real part at or above 0, or Q is not symmetric positive definite.
pub fn solve_lyapunov(stability: &Matrix4<f64>, definite: &Matrix4<f64>) -> Result<Matrix4<f64>, IdentifyError> {
    if !stability.iter().all(|a| a.is_finite()) {
        return Err(IdentifyError::NotStable { real_part: f64::NAN });
    }
    let symmetric = 0.5 * (definite + definite.transpose());
    let asymmetry = (definite - symmetric).norm();
    // A norm that is not a number fails the comparison, before an eigenvalue iteration could hang on it.
    if asymmetry.is_nan() || asymmetry > 1e-12 * symmetric.norm() {
        return Err(IdentifyError::NotPositiveDefinite { smallest: f64::NAN });
    }
    let smallest = symmetric.symmetric_eigenvalues().min();
    if smallest <= 0.0 {
        return Err(IdentifyError::NotPositiveDefinite { smallest });
    }
    // The 16 equations for the entries of P: (I (x) Am' + Am' (x) I) vec P = -vec Q.
    let transposed = stability.transpose();
    let identity = Matrix4::identity();
    let operator: SMatrix<f64, 16, 16> = identity.kronecker(&transposed) + transposed.kronecker(&identity);
    let right = SVector::<f64, 16>::from_column_slice((-symmetric).as_slice());
    let solution = operator.lu().solve(&right);
    let solved = solution.map(|p| Matrix4::from_column_slice(p.as_slice())).map(|p| 0.5 * (p + p.transpose()));
    // Lyapunov's theorem: P is positive definite if and only if Am is stable.
    solved.filter(|p| p.cholesky().is_some()).ok_or_else(|| IdentifyError::NotStable { real_part: abscissa(stability) })
}

/// Largest real part of the eigenvalues.
fn abscissa(matrix: &Matrix4<f64>) -> f64 {
    let dense = faer::MatRef::from_column_major_slice(matrix.as_slice(), 4, 4);
    dense.eigenvalues().map_or(f64::NAN, |list| list.iter().map(|z| z.re).fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector4;

    use super::*;

    #[test]
    fn the_matrices_of_the_paper_give_its_p() {
        let stability = Matrix4::from_diagonal(&Vector4::new(-0.5, -0.5, -1.0, -1.0));
        let definite = Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 2.0, 3.0));
        let expected = Matrix4::from_diagonal(&Vector4::new(0.5, 1.0, 1.0, 1.5));
        let solved = solve_lyapunov(&stability, &definite).expect("stable");
        assert!((solved - expected).norm() < 1e-14);
    }

    #[test]
    fn an_unstable_matrix_is_refused_with_its_growth_rate() {
        let mut stability = -Matrix4::identity();
        (stability[(0, 0)], stability[(0, 1)]) = (0.25, 3.0);
        let result = solve_lyapunov(&stability, &Matrix4::identity());
        assert!(matches!(result, Err(IdentifyError::NotStable { real_part }) if (real_part - 0.25).abs() < 1e-12));
    }

    #[test]
    fn a_q_that_is_not_positive_definite_is_refused() {
        let indefinite = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 1.0, -2.0));
        let result = solve_lyapunov(&-Matrix4::identity(), &indefinite);
        assert_eq!(result, Err(IdentifyError::NotPositiveDefinite { smallest: -2.0 }));
        let unknown = Matrix4::from_element(f64::NAN);
        assert!(solve_lyapunov(&-Matrix4::identity(), &unknown).is_err());
        assert!(solve_lyapunov(&unknown, &Matrix4::identity()).is_err());
    }
}
