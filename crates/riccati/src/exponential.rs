use nalgebra::{Complex, Matrix2, Matrix3, RowVector3};

/// Norm beyond which no digit of an exponential is left in f64: a turn by 1e15 rad has lost its phase.
const MEANINGFUL_NORM: f64 = 1e15;

/// Size up to which the second quotient is summed as a series; beyond, a difference loses no more than a few digits' worth of rounding.
const SERIES_SIZE: f64 = 0.5;
/// Last factorial of that series: the next term is below the rounding of the sum.
const SERIES_TERMS: u32 = 16;
/// Last factorials K that do for maps of norms up to n: the next term, `n^K / (K + 1)!`, is below half the rounding of `n / 2`, by which the mean
/// differs from the identity.
const FEWER_TERMS: [(f64, u32); 4] = [(1e-3, 6), (1e-2, 7), (0.1, 10), (0.25, 12)];

/// `expm(m)`; all NaN if `m` is not finite or too large for any accuracy. Where the last row of `m` is zero,
/// that of the result is exactly `(0, 0, 1)`.
pub(crate) fn exponential(m: &Matrix3<f64>) -> Matrix3<f64> {
    // The library scales by powers of two until the norm is small, which for an infinite norm never ends.
    if !m.iter().all(|e| e.abs() < MEANINGFUL_NORM) {
        return Matrix3::repeat(f64::NAN);
    }
    let mut map = m.exp();
    if m.row(2).iter().all(|&e| e == 0.0) {
        map.set_row(2, &RowVector3::new(0.0, 0.0, 1.0));
    }
    map
}

/// `expm(m)` of a linear map and `(expm(m) - 1) m^-1`, its mean over the way there, also of singular maps; all NaN as
/// [`exponential`].
///
/// The latter by its series where the map is small, and doubled otherwise: of `2 m` it is half of `(expm(m) + 1)` times that of m.
pub(crate) fn linear_exponential(m: &Matrix2<f64>) -> [Matrix2<f64>; 2] {
    if !m.iter().all(|e| e.abs() < MEANINGFUL_NORM) {
        return [Matrix2::repeat(f64::NAN); 2];
    }
    let norm = 2.0 * m.amax();
    let halvings = if norm > SERIES_SIZE { (norm / SERIES_SIZE).log2().ceil() as i32 } else { 0 };
    let small = m * 0.5_f64.powi(halvings);
    let last = FEWER_TERMS.iter().find(|(largest, _)| norm <= *largest).map_or(SERIES_TERMS, |(_, last)| *last);
    // Horner's scheme for the sum of m^k / (k + 1)!.
    let mut mean = Matrix2::identity();
    for k in (2..=last).rev() {
        mean = small * mean * (1.0 / f64::from(k)) + Matrix2::identity();
    }
    let mut map = small * mean + Matrix2::identity();
    for _ in 0..halvings {
        mean = (map + Matrix2::identity()) * mean * 0.5;
        map *= map;
    }
    [map, mean]
}

/// `(e^z - 1) / z`, without loss of digits near 0.
pub(crate) fn exponential_quotient(z: Complex<f64>) -> Complex<f64> {
    let half = z * 0.5;
    // e^z - 1 = 2 e^(z/2) sinh(z/2), and sinh keeps its digits at 0; below the square root of the rounding unit two
    // terms of the series are exact and spare the quotient of two subnormal numbers.
    if half.norm_sqr() < 1e-18 {
        return half + 1.0;
    }
    // Both have the same sine and cosine; of a turn without growth there is nothing else to them.
    let (sine, cosine) = half.im.sin_cos();
    let [exp, sinh, cosh] =
        if half.re == 0.0 { [1.0, half.re, 1.0] } else { [half.re.exp(), half.re.sinh(), half.re.cosh()] };
    Complex::new(exp * cosine, exp * sine) * Complex::new(sinh * cosine, cosh * sine) / half
}

/// `(e^z - 1 - z) / z^2`, without loss of digits near 0.
pub(crate) fn second_exponential_quotient(z: Complex<f64>) -> Complex<f64> {
    if z.norm_sqr() > SERIES_SIZE * SERIES_SIZE {
        return (exponential_quotient(z) - 1.0) / z;
    }
    // Horner's scheme for the sum of z^k / (k + 2)!.
    let mut sum = Complex::new(1.0, 0.0);
    for k in (3..=SERIES_TERMS).rev() {
        sum = z * sum / f64::from(k) + 1.0;
    }
    sum * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_quotient_agrees_with_a_long_series_on_both_sides_of_the_switch() {
        for size in [0.0, 1e-300, 1e-12, 1e-6, 1e-3, 0.3, 0.499, 0.501, 1.0, 3.0] {
            for phase in 0..8 {
                let z = Complex::from_polar(size, f64::from(phase));
                let (mut term, mut series) = (Complex::new(0.5, 0.0), Complex::new(0.0, 0.0));
                for k in 3..60 {
                    series += term;
                    term *= z / f64::from(k);
                }
                let found = second_exponential_quotient(z);
                assert!((found - series).norm() < 3e-15 * series.norm().max(0.1), "z = {z}: {found} {series}");
            }
        }
    }

    #[test]
    fn the_exponential_of_a_small_map_loses_nothing_by_the_terms_that_are_left_out() {
        for (largest, last) in FEWER_TERMS {
            let next = (2..=last + 1).fold(1.0, |term, k| term * largest / f64::from(k));
            assert!(next < 0.5 * f64::EPSILON * 0.5 * largest, "{largest}: {next}");
            for size in [largest, 0.7 * largest, 0.1 * largest] {
                let m = 0.5 * size * Matrix2::new(0.4, -1.0, 0.7, 0.3);
                let [map, mean] = linear_exponential(&m);
                let (mut term, mut series) = (Matrix2::identity(), Matrix2::identity());
                for k in 2..=30 {
                    term = m * term / f64::from(k);
                    series += term;
                }
                // Relative to what differs from the identity, but for the rounding of that.
                assert!((mean - series).amax() <= 2.0 * f64::EPSILON, "{size}: {mean} {series}");
                assert!((map - m * series - Matrix2::identity()).amax() <= 2.0 * f64::EPSILON, "{size}: {map}");
            }
        }
    }

    #[test]
    fn the_exponential_of_a_linear_map_and_its_mean_are_those_of_the_exponential_of_a_larger_matrix() {
        let shapes = [[0.0, 1.0, -1.0, 0.0], [0.3, -0.7, 0.2, 0.5], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.4, 0.4, -0.3]];
        for size in [0.0, 1e-12, 1e-3, 0.24, 0.26, 0.9, 3.0, 10.0] {
            for [a, b, c, d] in shapes.map(|shape| shape.map(|entry| entry * size)) {
                let [map, mean] = linear_exponential(&Matrix2::new(a, b, c, d));
                for (j, [x, y]) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                    let whole = exponential(&Matrix3::new(a, b, x, c, d, y, 0.0, 0.0, 0.0));
                    let tolerance = 1e-14 * (1.0 + size) * (1.0 + whole.amax());
                    assert!((whole.fixed_view::<2, 2>(0, 0) - map).amax() < tolerance, "{size}: {whole} {map}");
                    assert!(
                        (whole.fixed_view::<2, 1>(0, 2) - mean.column(j)).amax() < tolerance,
                        "{size}: {whole} {mean}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_quotient_agrees_with_its_series_on_both_sides_of_the_switch() {
        for size in [0.0, 1e-300, 1e-12, 0.9e-9, 2.1e-9, 1e-6, 1e-3, 0.3] {
            // A turn without growth is one of them.
            for z in (0..8).map(|phase| Complex::from_polar(size, f64::from(phase))).chain([Complex::new(0.0, size)]) {
                let (mut term, mut series) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0));
                for k in 1..20 {
                    series += term;
                    term *= z / f64::from(k + 1);
                }
                assert!((exponential_quotient(z) - series).norm() < 1e-15, "z = {z}");
            }
        }
    }

    #[test]
    fn an_exponential_of_something_not_finite_ends_and_is_nan() {
        for bad in [f64::NAN, f64::INFINITY, 1e200] {
            let map = exponential(&Matrix3::new(0.0, bad, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0));
            assert!(map.iter().all(|e| e.is_nan()));
        }
    }
}
