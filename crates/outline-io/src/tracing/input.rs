//! A picture and what it is compared with.
use image::GrayImage;

use crate::ground::background::Difference;
use crate::picture_file::error::TraceError;

/// A picture and what it is compared with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GroundComparison<'a> {
    pub(crate) picture: &'a GrayImage,
    pub(crate) ground: &'a GrayImage,
    pub(crate) difference: Difference,
}

/// What objects are looked for in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TracingInput<'a> {
    /// A picture, or its difference from what it is compared with.
    pub(crate) picture: &'a GrayImage,
    /// Of what it is the difference, if of anything.
    pub(crate) comparison: Option<GroundComparison<'a>>,
}

impl GroundComparison<'_> {
    /// How far each pixel differs, in grey values.
    ///
    /// # Errors
    /// The two are not of one size.
    pub(crate) fn difference(&self) -> Result<GrayImage, TraceError> {
        let [(width, height), (background_width, background_height)] =
            [self.picture, self.ground].map(GrayImage::dimensions);
        if (width, height) != (background_width, background_height) {
            return Err(TraceError::BackgroundSize { width, height, background_width, background_height });
        }
        Ok(self.difference.of(self.picture, self.ground))
    }
}

impl<'a> TracingInput<'a> {
    /// A picture as it is.
    pub(crate) fn plain(picture: &'a GrayImage) -> Self {
        Self { picture, comparison: None }
    }
}
