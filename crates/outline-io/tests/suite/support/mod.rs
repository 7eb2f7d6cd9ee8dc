//! Sequences that the tests go through.
use freeform_outline_io::{GrayImage, PictureError, PictureFrame, PictureOutlines, PictureSettings, TracedFrame};

fn frames(pictures: Vec<GrayImage>) -> impl Iterator<Item = Result<PictureFrame, PictureError>> {
    (0_u64..).zip(pictures).map(|(frame, picture)| {
        Ok(PictureFrame { frame, time: frame as f64 / 30.0, file: "memory".to_owned(), picture })
    })
}

/// What is found in pictures that come at 30 frames per second.
pub(crate) fn traced(pictures: Vec<GrayImage>, settings: PictureSettings) -> Vec<TracedFrame> {
    let outlines = PictureOutlines::new(frames(pictures), settings).expect("settings");
    outlines.collect::<Result<_, _>>().expect("pictures in memory")
}
