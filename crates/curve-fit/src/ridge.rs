use crate::{degree::MAX_COEFFICIENTS, moments::Moments, monomials::monomial_index};

/// Diagonal of the Euclidean-invariant ridge (Tasdizen, Tarel, Cooper 2000):
/// `D_ij = beta_(i+j) i! j! / (i+j)!` with `beta_d = sum over the data of (x^2 + y^2)^d`.
///
/// `V' D V = D` for the coefficient map V of any rotation, which a plain identity ridge does not satisfy. `data` holds
/// the moments of the outline points up to at least `2 degree`. The first `(n+1)(n+2)/2` entries are filled.
///
/// # Panics
/// If `degree` exceeds 8 or twice that the total degree of the moments.
#[must_use]
pub fn rotation_invariant_ridge(degree: usize, data: &Moments) -> [f64; MAX_COEFFICIENTS] {
    ridge_of_radial_sums(degree, |d| (0..=d).map(|k| binomial(d, k) * data.get(2 * k, 2 * (d - k))).sum())
}

/// The diagonal of the ridge from the radial sums `beta_d`.
pub(crate) fn ridge_of_radial_sums(degree: usize, beta: impl Fn(usize) -> f64) -> [f64; MAX_COEFFICIENTS] {
    let mut diagonal = [0.0; MAX_COEFFICIENTS];
    for d in 0..=degree {
        let beta = beta(d);
        (0..=d).for_each(|j| diagonal[monomial_index(d - j, j)] = beta / binomial(d, j));
    }
    diagonal
}

/// Binomial coefficient `n over k`.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}
