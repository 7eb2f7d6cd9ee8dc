use image::{GrayImage, Luma};

/// A picture of means of `factor` x `factor` pixels; what is left over at the right and lower side is left out.
pub(super) fn scaled(picture: &GrayImage, factor: u32) -> GrayImage {
    let (width, height) = (picture.width() / factor, picture.height() / factor);
    if factor <= 1 || width == 0 || height == 0 {
        return picture.clone();
    }
    let pixels = picture.as_raw();
    let stride = picture.width() as usize;
    let area = factor * factor;
    GrayImage::from_fn(width, height, |column, row| {
        let rows = (0..factor).map(|k| (row * factor + k) as usize * stride + (column * factor) as usize);
        let sum: u32 = rows.map(|at| pixels[at..at + factor as usize].iter().map(|v| u32::from(*v)).sum::<u32>()).sum();
        Luma([((sum + area / 2) / area) as u8])
    })
}

/// By how much pictures of this size are scaled down to have at most so many pixels.
pub(super) fn factor_for(width: u32, height: u32, most: u64) -> u32 {
    let pixels = |factor: u32| u64::from(width / factor) * u64::from(height / factor);
    (1..=64).find(|factor| pixels(*factor) <= most).unwrap_or(64)
}
