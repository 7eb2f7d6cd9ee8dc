//! Pictures of a pear that turns and drifts.
use std::path::Path;

use image::{GrayImage, ImageFormat, Luma};

/// How far within a pear, which turns by 0.05 rad and drifts by a pixel a frame, a pixel lies: 1 in its middle, 0 on its outline, and less
/// without. The middle is that of the first frame; half the length and half the width are in pixels, and the width grows along it.
pub(crate) fn depth_in_pear(
    frame: u32,
    [column, row]: [u32; 2],
    middle: [f64; 2],
    [length, width, growth]: [f64; 3],
) -> f64 {
    let angle = 0.05 * f64::from(frame);
    let (x, y) = (f64::from(column) - middle[0] - f64::from(frame), f64::from(row) - middle[1]);
    let (x, y) = (x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin());
    1.0 - (x / length).powi(2) - (y / (width + growth * x)).powi(2)
}

/// A pear that has turned and drifted for so many frames, light on dark, with grey edges.
pub(crate) fn pear(frame: u32) -> GrayImage {
    GrayImage::from_fn(160, 120, |column, row| {
        let depth = depth_in_pear(frame, [column, row], [70.0, 60.0], [38.0, 20.0, 0.25]);
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
