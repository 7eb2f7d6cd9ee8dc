//! Pictures, sequences and texts that the tests go through.
pub(crate) mod csv;

use freeform_outline_io::{GrayImage, PictureError, PictureFrame, PictureOutlines, PictureSettings, TracedFrame};
use image::{DynamicImage, ImageFormat};

/// The bytes of a picture file. They are written to a file, since encoders are compiled anew for each other kind of writer.
pub(crate) fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let file = tempfile::NamedTempFile::new().expect("a file");
    picture.into().save_with_format(file.path(), format).expect("a picture");
    std::fs::read(file.path()).expect("the file")
}

fn frames(pictures: Vec<GrayImage>) -> impl Iterator<Item = Result<PictureFrame, PictureError>> {
    (0_u64..).zip(pictures).map(|(frame, picture)| {
        Ok(PictureFrame { frame, time: frame as f64 / 30.0, file: "memory".to_owned(), picture: picture.into() })
    })
}

/// What is found in pictures that come at 30 frames per second.
pub(crate) fn traced(pictures: Vec<GrayImage>, settings: PictureSettings) -> Vec<TracedFrame> {
    let outlines = PictureOutlines::new(frames(pictures), settings).expect("settings");
    outlines.collect::<Result<_, _>>().expect("pictures in memory")
}
