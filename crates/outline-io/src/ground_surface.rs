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
        // The conversion keeps to 0 to 255.
        values.extend(columns.iter().map(|x| (constant + x * (slope + bend * x)) as u8));
    }
    GrayImage::from_raw(width, height, values).unwrap_or_default()
}

/// The surface that fits the samples best, those with large residuals left out.
fn solved(samples: &[(SVector<f64, 6>, f64)], residuals: &[f64], scale: f64) -> Option<SVector<f64, 6>> {
    let (mut normal, mut right) = (SMatrix::<f64, 6, 6>::identity() * 1e-9, SVector::<f64, 6>::zeros());
    for ((terms, value), residual) in samples.iter().zip(residuals) {
        let residual = residual / scale;
        if residual.abs() < 1.0 {
            let weight = (1.0 - residual * residual).powi(2);
            let weighted = weight * terms;
            // What lies above the diagonal is not looked at where the matrix is factored.
            for column in 0..6 {
                for row in column..6 {
                    normal[(row, column)] += weighted[row] * terms[column];
                }
            }
            right += weight * *value * terms;
        }
    }
    Some(normal.cholesky()?.solve(&right))
}

fn middle(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(half, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
