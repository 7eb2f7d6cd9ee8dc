//! The graded order of monomials that every coefficient vector in this crate uses:
//! `1; x, y; x^2, xy, y^2; x^3, x^2 y, ...`: by total degree, then by falling power of x.

/// Position of `x^i y^j` in the graded order.
#[must_use]
pub const fn monomial_index(i: usize, j: usize) -> usize {
    let degree = i + j;
    degree * (degree + 1) / 2 + j
}

/// The exponents `(i, j)` of all monomials up to `degree`, in graded order.
pub fn exponents(degree: usize) -> impl Iterator<Item = (usize, usize)> + Clone {
    (0..=degree).flat_map(|d| (0..=d).map(move |j| (d - j, j)))
}

/// Values of all monomials up to `degree` at `(x, y)`, written in graded order to the front of `out`.
///
/// # Panics
/// If `out` is shorter than the number of monomials.
pub fn evaluate_monomials(degree: usize, x: f64, y: f64, out: &mut [f64]) {
    out[0] = 1.0;
    for d in 1..=degree {
        let (start, previous) = (d * (d + 1) / 2, d * (d - 1) / 2);
        for j in 0..d {
            out[start + j] = x * out[previous + j];
        }
        out[start + d] = y * out[previous + d - 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_counts_the_exponents_in_graded_order() {
        for (position, (i, j)) in exponents(8).enumerate() {
            assert_eq!(monomial_index(i, j), position);
        }
    }

    #[test]
    fn monomial_values_are_powers_of_the_coordinates() {
        let mut values = [0.0; 45];
        evaluate_monomials(8, 1.25, -0.5, &mut values);
        for (i, j) in exponents(8) {
            let expected = 1.25_f64.powi(i as i32) * (-0.5_f64).powi(j as i32);
            assert!((values[monomial_index(i, j)] - expected).abs() < 1e-14);
        }
    }
}
