//! Random fields along a contour and in time, of unit variance.
use rand::{Rng, RngExt as _};
use rand_distr::StandardNormal;

/// Numbers along a closed contour of so many cells, smooth over `reach` cells: white noise through a Gaussian window with a standard
/// deviation of half of that, so that cells `reach` apart have a correlation of 1/e. White for a reach of 0.
pub(super) fn along_contour(cells: usize, reach: f64, rng: &mut impl Rng) -> Vec<f64> {
    let white: Vec<f64> = (0..cells).map(|_| rng.sample(StandardNormal)).collect();
    if reach <= 0.0 {
        return white;
    }
    let width = 0.5 * reach;
    let half = ((4.0 * width).ceil() as usize).min(cells.saturating_sub(1) / 2);
    let window: Vec<f64> = (0..=2 * half).map(|k| (-0.5 * ((k as f64 - half as f64) / width).powi(2)).exp()).collect();
    let norm = window.iter().map(|w| w * w).sum::<f64>().sqrt();
    let at = |cell: usize| {
        let terms = window.iter().enumerate().map(|(k, w)| w * white[(cell + k + cells - half) % cells]);
        terms.sum::<f64>() / norm
    };
    (0..cells).map(at).collect()
}

/// Carries values to the next frame, of which a share `keep` stays: `v <- keep v + sqrt(1 - keep^2) fresh`.
pub(super) fn carry(values: &mut [f64], keep: f64, fresh: &[f64]) {
    let renewed = (1.0 - keep * keep).sqrt();
    values.iter_mut().zip(fresh).for_each(|(value, fresh)| *value = keep * *value + renewed * fresh);
}

/// The value at a place, a fraction of the perimeter: linear between the cells.
pub(super) fn between_cells(values: &[f64], place: f64) -> f64 {
    let position = place.rem_euclid(1.0) * values.len() as f64;
    let (cell, share) = (position.floor() as usize % values.len(), position.fract());
    values[cell] * (1.0 - share) + values[(cell + 1) % values.len()] * share
}

/// The value of the nearest cell.
pub(super) fn of_cell(values: &[f64], place: f64) -> f64 {
    let position = (place.rem_euclid(1.0) * values.len() as f64).round();
    values[position as usize % values.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    /// Mean of the products of values so many cells apart.
    fn covariance(values: &[f64], apart: usize) -> f64 {
        let products = values.iter().zip(values.iter().cycle().skip(apart)).map(|(a, b)| a * b);
        products.sum::<f64>() / values.len() as f64
    }

    #[test]
    fn a_field_along_the_contour_has_unit_variance_and_the_reach_asked_for() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for reach in [0.0, 5.0, 20.0] {
            let field = along_contour(40_000, reach, &mut rng);
            assert!((covariance(&field, 0) - 1.0).abs() < 0.06, "{reach}");
            let apart = if reach == 0.0 { 1 } else { reach as usize };
            let expected = if reach == 0.0 { 0.0 } else { (-1.0_f64).exp() };
            assert!((covariance(&field, apart) - expected).abs() < 0.06, "{reach}");
        }
    }

    #[test]
    fn what_is_carried_on_keeps_its_variance_and_its_share() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let first = along_contour(20_000, 0.0, &mut rng);
        let mut later = first.clone();
        for _ in 0..3 {
            carry(&mut later, 0.8, &along_contour(20_000, 0.0, &mut rng));
        }
        assert!((covariance(&later, 0) - 1.0).abs() < 0.05);
        let kept = first.iter().zip(&later).map(|(a, b)| a * b).sum::<f64>() / 20_000.0;
        assert!((kept - 0.512).abs() < 0.03, "{kept}");
    }

    #[test]
    fn places_between_two_cells_have_a_value_between_theirs() {
        let values = [0.0, 1.0, 0.0, -1.0];
        assert!((between_cells(&values, 0.125) - 0.5).abs() < 1e-12);
        assert!((between_cells(&values, 1.9375) + 0.25).abs() < 1e-12);
        assert_eq!([of_cell(&values, 0.26), of_cell(&values, 0.99)], [1.0, 0.0]);
    }
}
