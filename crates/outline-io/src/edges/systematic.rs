//! How far the edges of a side may lie off together.
use super::step_fit::StepFit;

/// What the model leaves of bodies with bends and corners, in widths of the edge: poses of simulated bodies without noise are off by 0.002 pixels at
/// a blur of one pixel, as they would be with sides that are off by so much.
const OF_MODEL: f64 = 0.003;

/// Of edges along the rows, columns and diagonals of the pixels, which share their place between them: measured in pictures of straight edges with a
/// blur of 0.1 to 1 pixel, in pixels at this width, and how it falls with the width, per pixel. Below the least width none is told
/// from sharper ones.
const OF_GRID: f64 = 0.0118;
const AT_WIDTH: f64 = 0.7;
const FALLS_BY: f64 = 8.0;
const SHARPEST: f64 = 0.57;

/// Points of a stretch, over which the light changes little and the noise much, and points between stretches, so that they share no pixel.
const STRETCH: usize = 12;
const BETWEEN: usize = 4;

/// Variance of the rounding to whole grey values.
const ROUNDING: f64 = 1.0 / 12.0;

/// Share of the square of the noise told that is there at least.
const NOISE_SURE: f64 = 0.8;

/// All of it, for edges fitted like these, with this noise and contrast, from what each edge shows of light that changes on one side, in the
/// order of the contour; pixels. Noise that neighbouring points share has no part in it: it is another one in the next picture.
pub(super) fn of(fits: &[StepFit], noise: f64, contrast: f64, one_sided: impl Iterator<Item = f64>) -> f64 {
    let most = |of: &dyn Fn(&StepFit) -> f64| fits.iter().map(of).fold(0.0, f64::max);
    let of_grey_value = most(&StepFit::deviation_of_place) / contrast;
    let parts = [most(&|fit| of_grid(fit.width())), of_rounding(noise) * of_grey_value, of_light(one_sided)];
    parts.into_iter().fold(0.0, f64::hypot)
}

/// Of the grid of pixels and the model, for edges of this width, in pixels.
fn of_grid(width: f64) -> f64 {
    let of_grid = OF_GRID * (FALLS_BY * (AT_WIDTH - width.max(SHARPEST))).exp();
    (OF_MODEL * width.max(1.0)).hypot(of_grid)
}

/// Deviation of what rounding to grey values leaves alike along a side, in grey values, for this noise, which includes it. Rounding is as
/// good as noise where there is noise enough; in pictures without any it is the same in all rows that an edge crosses alike.
fn of_rounding(noise: f64) -> f64 {
    let sensor = (NOISE_SURE * noise * noise - ROUNDING).max(0.0);
    // The mean of what is rounded, as a series in sines of the grey value (B. Widrow and I. Kollar, Quantization Noise, 2008): its first term.
    let share = (-4.0 * std::f64::consts::PI.powi(2) * sensor).exp();
    (ROUNDING * share).sqrt()
}

/// Of light that changes on one side of the edge: from how much farther out each edge is seen for it, in pixels and in the order of the contour.
fn of_light(shifts: impl Iterator<Item = f64>) -> f64 {
    let shifts: Vec<f64> = shifts.collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let means: Vec<f64> = shifts.chunks_exact(STRETCH + BETWEEN).map(|chunk| mean(&chunk[..STRETCH])).collect();
    // The noise of neighbouring stretches is not the same, so that their product has none in the mean.
    let products = means.windows(2).map(|pair| pair[0] * pair[1]);
    let count = products.len().max(1) as f64;
    (products.sum::<f64>() / count).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_that_neighbours_share_leaves_little_and_what_all_share_stays() {
        // A generator of numbers that have nothing in common (Lehmer).
        let mut state = 1_u64;
        let mut uniform = || {
            state = state * 48_271 % 2_147_483_647;
            state as f64 / 2_147_483_647.0 - 0.5
        };
        let noise: Vec<f64> = (0..4_801).map(|_| 0.2 * uniform()).collect();
        let shared: Vec<f64> = noise.windows(2).map(|pair| pair[0] + pair[1]).collect();
        let of_noise = of_light(shared.iter().copied());
        assert!(of_noise < 0.01, "{of_noise}");
        let of_both = of_light(shared.iter().enumerate().map(|(i, n)| n + if i < 2_400 { 0.03 } else { -0.03 }));
        assert!((of_both / 0.03 - 1.0).abs() < 0.1, "{of_both}");
    }

    #[test]
    fn rounding_counts_where_there_is_no_noise_to_spread_it() {
        assert!((of_rounding(0.0) - ROUNDING.sqrt()).abs() < 1e-12);
        assert!(of_rounding(1.0) < 1e-4);
    }
}
