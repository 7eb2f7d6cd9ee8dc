//! Pictures scaled down by means of whole pixels.
use image::GrayImage;

/// A picture of means of `factor` x `factor` pixels; what is left over at the right and lower side is left out.
pub(super) fn scaled(picture: &GrayImage, factor: u32) -> GrayImage {
    let (width, height) = (picture.width() / factor, picture.height() / factor);
    if factor <= 1 || width == 0 || height == 0 {
        return picture.clone();
    }
    let stride = picture.width() as usize;
    let area = factor * factor;
    let mut means = Vec::with_capacity((width * height) as usize);
    let mut sums = vec![0_u32; width as usize];
    for rows in picture.as_raw().chunks_exact(stride * factor as usize) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, values) in sums.iter_mut().zip(row.chunks_exact(factor as usize)) {
                *sum += values.iter().map(|value| u32::from(*value)).sum::<u32>();
            }
        }
        means.extend(sums.iter().map(|sum| ((sum + area / 2) / area) as u8));
    }
    GrayImage::from_raw(width, height, means).unwrap_or_default()
}

/// By how much pictures of this size are scaled down to have at most so many pixels.
pub(super) fn factor_for(width: u32, height: u32, most: u64) -> u32 {
    let pixels = |factor: u32| u64::from(width / factor) * u64::from(height / factor);
    (1..=64).find(|factor| pixels(*factor) <= most).unwrap_or(64)
}

#[cfg(test)]
mod tests {
    use image::Luma;

    use super::*;

    #[test]
    fn pixels_are_means_of_squares_and_what_is_left_over_is_left_out() {
        let picture = GrayImage::from_fn(11, 8, |x, y| Luma([((x * 37 + y * 101 + x * y * 13) % 256) as u8]));
        for factor in 2..=4 {
            let small = scaled(&picture, factor);
            assert_eq!(small.dimensions(), (11 / factor, 8 / factor));
            for (x, y, mean) in small.enumerate_pixels() {
                let within = |k: u32| picture.get_pixel(x * factor + k % factor, y * factor + k / factor).0[0];
                let sum: f64 = (0..factor * factor).map(|k| f64::from(within(k))).sum();
                assert_eq!(f64::from(mean.0[0]), (sum / f64::from(factor * factor) + 0.5).floor());
            }
        }
        assert_eq!(scaled(&picture, 1), picture);
    }
}
