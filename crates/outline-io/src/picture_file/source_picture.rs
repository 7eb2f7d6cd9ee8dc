//! The picture that outlines were found in, as it goes with them.
use std::sync::Arc;

use freeform_curve_fit::PixelGrid;
use image::GrayImage;

/// A picture that outlines were found in.
#[derive(Debug, Clone)]
pub struct SourcePicture {
    /// Number of the frame.
    pub frame: u64,
    /// Time in seconds.
    pub time: f64,
    /// The picture in the channel that was traced.
    pub picture: Arc<GrayImage>,
    /// Where its pixels are in the coordinates of the outlines.
    pub grid: PixelGrid,
}
