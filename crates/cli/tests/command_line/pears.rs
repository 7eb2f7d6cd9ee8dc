//! Pictures of a pear that turns and drifts.
use std::path::Path;

use image::{GrayImage, ImageFormat, Luma};

/// A pear that has turned and drifted for so many frames, light on dark, with grey edges.
pub(crate) fn pear(frame: u32) -> GrayImage {
    let angle = 0.05 * f64::from(frame);
    GrayImage::from_fn(160, 120, |column, row| {
        let (x, y) = (f64::from(column) - 70.0 - f64::from(frame), f64::from(row) - 60.0);
        let (x, y) = (x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin());
        let depth = 1.0 - (x / 38.0).powi(2) - (y / (20.0 + 0.25 * x)).powi(2);
        Luma([(30.0 + 180.0 * (12.0 * depth + 0.5).clamp(0.0, 1.0)) as u8])
    })
}

pub(crate) fn encoded(picture: &GrayImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).expect("a picture");
    bytes.into_inner()
}

/// Pears of these frames in a folder of a folder, whose paths are given.
pub(crate) fn pears(base: &Path, name: &str, count: u32) -> (String, String) {
    let frames = base.join(name);
    std::fs::create_dir(&frames).expect("a folder");
    (0..count).for_each(|frame| pear(frame).save(frames.join(format!("{frame}.png"))).expect("a picture"));
    (frames.to_str().expect("UTF-8").to_owned(), base.to_str().expect("UTF-8").to_owned())
}

/// The names in a folder, in order.
pub(crate) fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into()).collect();
    names.sort();
    names
}

/// Twelve pictures of two grey values.
pub(crate) fn masks_of_pears(folder: &Path) -> (String, String) {
    let (frames, base) = pears(folder, "frames", 12);
    for frame in 0..12 {
        let picture = pear(frame);
        let mask =
            GrayImage::from_fn(160, 120, |x, y| Luma([if picture.get_pixel(x, y).0[0] > 120 { 255 } else { 0 }]));
        mask.save(format!("{frames}/{frame}.png")).expect("a picture");
    }
    (frames, base)
}
