//! What encoders of drawn pictures do where there is no picture, no room, or a sink that fails.
use std::io::{self, Cursor, Write};

use freeform_drawing::{DrawingError, GifAnimation, Y4mVideo, is_marked_png, marked_png};
use image::{Rgb, RgbImage};

/// A sink that is full from the beginning.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::Error::from(io::ErrorKind::StorageFull))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn where_there_was_no_picture_no_sink_is_handed_back() {
    assert!(GifAnimation::new(Vec::new()).finish().expect("nothing to fail").is_none());
    assert!(Y4mVideo::new(Vec::new()).finish().is_none());
}

#[test]
fn a_sink_that_fails_is_told_as_such() {
    let picture = RgbImage::new(8, 8);
    let is_full =
        |error: &DrawingError| matches!(error, DrawingError::Io(error) if error.kind() == io::ErrorKind::StorageFull);
    assert!(is_full(&GifAnimation::new(Full).write(&picture, None).expect_err("a full sink")));
    assert!(is_full(&Y4mVideo::new(Full).write(&picture, None).expect_err("a full sink")));
}

#[test]
fn an_animation_refuses_pictures_that_its_format_cannot_hold_or_of_another_size_than_the_first() {
    let mut animation = GifAnimation::new(Vec::new());
    let refused = |animation: &mut GifAnimation<_>, width, height| {
        let error = animation.write(&RgbImage::new(width, height), None).expect_err("refused");
        let is_told = matches!(error, DrawingError::PictureSize { width: w, height: h } if (w, h) == (width, height));
        assert!(is_told, "{error}");
    };
    refused(&mut animation, 70_000, 1);
    refused(&mut animation, 0, 4);
    animation.write(&RgbImage::new(6, 4), None).expect("a picture");
    refused(&mut animation, 4, 6);
    assert!(animation.finish().expect("memory").is_some());
}

#[test]
fn a_video_refuses_pictures_of_another_size_than_the_first() {
    let mut video = Y4mVideo::new(Vec::new());
    let is_refused = |video: &mut Y4mVideo<_>, width, height| {
        let error = video.write(&RgbImage::new(width, height), None).expect_err("refused");
        matches!(error, DrawingError::PictureSize { width: w, height: h } if (w, h) == (width, height))
    };
    assert!(is_refused(&mut video, 0, 4));
    video.write(&RgbImage::new(6, 4), None).expect("a picture");
    assert!(is_refused(&mut video, 4, 6));
    video.write(&RgbImage::new(6, 4), None).expect("a picture");
    let bytes = video.finish().expect("pictures");
    assert_eq!(bytes.windows(5).filter(|word| word == b"FRAME").count(), 2);
}

#[test]
fn a_drawn_picture_is_known_again_as_a_file_and_others_are_not() {
    let mut picture = RgbImage::new(5, 4);
    picture.put_pixel(2, 1, Rgb([255, 230, 60]));
    let png = marked_png(&picture).expect("a picture");
    assert!(is_marked_png(Cursor::new(&png)));
    assert_eq!(image::load_from_memory(&png).expect("a picture").to_rgb8(), picture);
    let mut other = Cursor::new(Vec::new());
    picture.write_to(&mut other, image::ImageFormat::Png).expect("a picture");
    assert!(!is_marked_png(Cursor::new(other.into_inner())));
    assert!(matches!(marked_png(&RgbImage::new(0, 4)), Err(DrawingError::Png(_))));
}
