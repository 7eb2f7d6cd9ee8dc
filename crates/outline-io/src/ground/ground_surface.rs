//! The ground as a smooth surface through the grey values of one picture.
use image::GrayImage;
use nalgebra::{SMatrix, SVector};

/// Pixels that the surface is fitted to, at most.
const SAMPLES: usize = 2500;

/// Rounds of weights.
const ROUNDS: usize = 8;

/// The grey values of the ground as a surface of the second degree, fitted so that objects, as long as they have less than half of the
/// picture, do not pull it: Tukey's weights on the scale of the median residual.
pub(crate) fn ground_surface(picture: &GrayImage) -> GrayImage {
    let (width, height) = picture.dimensions();
    let pixels = (width as usize) * (height as usize);
    // A step in both directions that visits rows and columns evenly.
    let step = ((pixels as f64 / SAMPLES as f64).sqrt().ceil() as u32).max(1);
    let unit = |index: u32, count: u32| 2.0 * (f64::from(index) + 0.5) / f64::from(count) - 1.0;
    let terms = |x: f64, y: f64| SVector::<f64, 6>::from([1.0, x, y, x * x, x * y, y * y]);
    let places = (step / 2..height)
        .step_by(step as usize)
        .flat_map(|row| (step / 2..width).step_by(step as usize).map(move |column| (column, row)));
    let samples: Vec<(SVector<f64, 6>, f64)> = places
        .map(|(column, row)| {
            let value = f64::from(picture.get_pixel(column, row).0[0]);
            (terms(unit(column, width), unit(row, height)), value)
        })
        .collect();
    let mut values: Vec<f64> = samples.iter().map(|(_, value)| *value).collect();
    let mut surface = SVector::<f64, 6>::zeros();
    surface[0] = middle(&mut values);
    let mut residuals = Vec::with_capacity(samples.len());
    for _ in 0..ROUNDS {
        residuals.clear();
        residuals.extend(samples.iter().map(|(terms, value)| value - surface.dot(terms)));
        let mut sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
        let scale = 4.685 * (1.4826 * middle(&mut sizes)).max(1.0);
        match solved(&samples, &residuals, scale) {
            Some(solution) => surface = solution,
            None => break,
        }
    }
    let columns: Vec<f32> = (0..width).map(|column| unit(column, width) as f32).collect();
    let mut values = Vec::with_capacity(pixels);
    for row in 0..height {
        let y = unit(row, height);
        let constant = (surface[0] + surface[2] * y + surface[5] * y * y + 0.5) as f32;
        let (slope, bend) = ((surface[1] + surface[4] * y) as f32, surface[3] as f32);
        values.extend(columns.iter().map(|x| whole_grey_value(constant + x * (slope + bend * x))));
    }
    GrayImage::from_raw(width, height, values).unwrap_or_default()
}

/// The whole part of a number, kept to 0 to 255: what `as` says, which is worked out one number after the other.
#[inline(always)]
fn whole_grey_value(number: f32) -> u8 {
    // Numbers that this is added to are rounded to whole ones, which are in the last bits of the sum.
    const ROUNDS: f32 = (1_u32 << (f32::MANTISSA_DIGITS - 1)) as f32;
    let kept = if number > 0.0 { number } else { 0.0 };
    let kept = if kept < 255.0 { kept } else { 255.0 };
    let nearest = (kept + ROUNDS) - ROUNDS;
    let whole = if nearest > kept { nearest - 1.0 } else { nearest };
    (whole + ROUNDS).to_bits() as u8
}

/// The surface that fits the samples best, those with large residuals left out.
fn solved(samples: &[(SVector<f64, 6>, f64)], residuals: &[f64], scale: f64) -> Option<SVector<f64, 6>> {
    // Of the matrix, which is symmetric, what lies above the diagonal is not looked at where it is factored.
    let (mut columns, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
    (0..6).for_each(|k| columns[k][k] = 1e-9);
    for ((terms, value), residual) in samples.iter().zip(residuals) {
        let residual = residual / scale;
        if residual.abs() < 1.0 {
            let weight = (1.0 - residual * residual).powi(2);
            let terms: [f64; 6] = (*terms).into();
            let weighted = terms.map(|term| weight * term);
            for (column, term) in columns.iter_mut().zip(terms) {
                column.iter_mut().zip(weighted).for_each(|(sum, weighted)| *sum += weighted * term);
            }
            let weight = weight * *value;
            right.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        }
    }
    let normal = SMatrix::<f64, 6, 6>::from_fn(|row, column| columns[column][row]);
    Some(normal.cholesky()?.solve(&SVector::from(right)))
}

fn middle(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(half, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_values_are_kept_to_their_range_and_cut_as_the_library_does() {
        let beside = |value: f32| [value.next_down(), value, value.next_up()];
        let values = (-6..=1030).flat_map(|quarter: i16| beside(0.25 * f32::from(quarter)));
        for value in values.chain([f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e20, -1e20]) {
            assert_eq!(whole_grey_value(value), value as u8, "{value}");
        }
    }

    #[test]
    fn the_light_of_a_lamp_is_found_in_spite_of_an_object() {
        let light = |x: u32, y: u32| 60.0 + 0.2 * f64::from(x) + 0.1 * f64::from(y) - 5e-4 * f64::from(x * x);
        let picture = GrayImage::from_fn(200, 150, |x, y| {
            let is_object = (40..110).contains(&x) && (30..120).contains(&y);
            image::Luma([(light(x, y) + if is_object { 80.0 } else { 0.0 }).round() as u8])
        });
        let ground = ground_surface(&picture);
        for (x, y) in [(0, 0), (199, 149), (75, 75), (10, 140), (180, 20)] {
            assert!((f64::from(ground.get_pixel(x, y).0[0]) - light(x, y)).abs() < 3.0, "{x} {y}");
        }
    }
}
