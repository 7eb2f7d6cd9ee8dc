//! Readers of files.
use std::io::{Cursor, Read};

use freeform_motion::outline_io::{
    GrayImage, OutlineFrame, OutlineReader, OutlineWriter, PictureSequence, SequenceSettings, TraceSettings,
    WriterOptions, decode_picture, trace_mask,
};

/// Pixels of the largest picture that is traced, so that a check takes milliseconds.
const TRACED_PIXELS: u32 = 1 << 16;

/// Pictures of the longest stream that is looked at.
const STREAMED_PICTURES: usize = 20;

/// Hands out one byte at a time, as a slow pipe may.
struct ByteByByte<'a>(&'a [u8]);

impl Read for ByteByByte<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = buffer.len().min(1);
        self.0.read(&mut buffer[..count])
    }
}

/// Any bytes as CSV: finite outlines, one-line messages, the same through any buffer, and read back as written.
pub(crate) fn csv_reader(bytes: &[u8]) {
    let (frames, messages) = read_all(bytes);
    let slowly = read_all(ByteByByte(bytes));
    assert_eq!((&frames, &messages), (&slowly.0, &slowly.1), "the buffer matters");
    for frame in &frames {
        assert!(frame.time.is_finite() && frame.outline.points().all(|p| p.x.is_finite() && p.y.is_finite()));
    }
    for message in &messages {
        assert!(message.starts_with("input") && message.lines().count() == 1, "{message:?}");
    }
    let mut writer = OutlineWriter::new(Vec::new(), WriterOptions::needed_for(&frames)).expect("memory takes it");
    if frames.iter().all(|frame| writer.write(frame).is_ok()) {
        let written = writer.finish().expect("memory takes it");
        let (again, messages) = read_all(written.as_slice());
        assert!(messages.is_empty(), "{messages:?}");
        assert_eq!(again, frames, "written and read back");
    }
}

fn read_all(source: impl Read) -> (Vec<OutlineFrame>, Vec<String>) {
    let (mut frames, mut messages) = (Vec::new(), Vec::new());
    match OutlineReader::new(source, "input") {
        Ok(reader) => {
            for frame in reader {
                match frame {
                    Ok(frame) => frames.push(frame),
                    Err(error) => messages.push(error.to_string()),
                }
            }
        }
        Err(error) => messages.push(error.to_string()),
    }
    (frames, messages)
}

/// Any bytes as a picture: a one-line message, or a picture that can be traced or not.
pub(crate) fn picture_reader(bytes: &[u8]) {
    match decode_picture(Cursor::new(bytes), "input") {
        Ok(picture) => trace(&picture),
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("input") && message.lines().count() == 1, "{message:?}");
        }
    }
}

/// Any bytes as a stream of pictures: an animation, a video or one picture.
pub(crate) fn picture_stream(bytes: &[u8]) {
    let stream = PictureSequence::from_stream(Cursor::new(bytes.to_vec()), "input", SequenceSettings::default());
    let (mut messages, mut last) = (Vec::new(), f64::NEG_INFINITY);
    match stream {
        Ok(pictures) => {
            for picture in pictures.take(STREAMED_PICTURES) {
                match picture {
                    Ok(picture) => {
                        assert!(picture.time.is_finite() && picture.time > last, "{} after {last}", picture.time);
                        last = picture.time;
                        trace(&picture.picture);
                    }
                    Err(error) => messages.push(error.to_string()),
                }
            }
        }
        Err(error) => messages.push(error.to_string()),
    }
    for message in messages {
        assert!(message.starts_with("input") && message.lines().count() == 1, "{message:?}");
    }
}

/// Any bytes as the pixels of a picture: width, then rows.
pub(crate) fn tracing(bytes: &[u8]) {
    let Some((&width, pixels)) = bytes.split_first() else { return };
    let width = usize::from(width).max(1);
    let height = pixels.len() / width;
    let picture = GrayImage::from_raw(width as u32, height as u32, pixels[..width * height].to_vec());
    trace(&picture.expect("as many pixels as it has"));
}

fn trace(picture: &GrayImage) {
    let (width, height) = picture.dimensions();
    if width.checked_mul(height).is_none_or(|pixels| pixels > TRACED_PIXELS) {
        return;
    }
    if let Ok(traced) = trace_mask(picture, &TraceSettings::default()) {
        let inside = |value: f64, end: u32| (0.0..=f64::from(end)).contains(&value);
        assert!(traced.outline.points().all(|p| inside(p.x, width) && inside(p.y, height)), "beyond the picture");
        assert!(traced.object_count > 0 && traced.pixel_count > 0 && traced.threshold.is_finite());
    }
}
