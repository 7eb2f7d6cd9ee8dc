//! Readers of files.
use std::io::{Cursor, Read};

use freeform_motion::outline_io::{
    GrayImage, OutlineFrame, OutlineReader, OutlineWriter, PictureSequence, SequenceSettings, TraceSettings,
    WriterOptions, decode_picture, readable, trace_mask,
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
    check_outlines(&frames, &messages);
    let mut writer = OutlineWriter::new(Vec::new(), WriterOptions::needed_for(&frames)).expect("memory takes it");
    if frames.iter().all(|frame| writer.write(frame).is_ok()) {
        let written = writer.finish().expect("memory takes it");
        let (again, messages) = read_all(written.as_slice());
        assert!(messages.is_empty(), "{messages:?}");
        assert_eq!(again, frames, "written and read back");
    }
}

/// Any bytes as Parquet: finite outlines, one-line messages, and read back as written.
#[cfg(feature = "parquet")]
pub(crate) fn parquet_reader(bytes: &[u8]) {
    use freeform_motion::outline_io::{ParquetReader, ParquetWriter};
    let read = |bytes: &[u8]| -> (Vec<OutlineFrame>, Vec<String>) {
        let (mut frames, mut messages) = (Vec::new(), Vec::new());
        match ParquetReader::from_bytes(bytes.to_vec(), "input") {
            Ok(reader) => reader.for_each(|frame| match frame {
                Ok(frame) => frames.push(frame),
                Err(error) => messages.push(error.to_string()),
            }),
            Err(error) => messages.push(error.to_string()),
        }
        (frames, messages)
    };
    let (frames, messages) = read(bytes);
    check_outlines(&frames, &messages);
    let mut writer = ParquetWriter::new(Vec::new(), WriterOptions::needed_for(&frames), &[]).expect("memory takes it");
    if frames.iter().all(|frame| writer.write(frame).is_ok()) {
        let (mut again, messages) = read(&writer.finish().expect("memory takes it"));
        assert!(messages.is_empty(), "{messages:?}");
        let mut frames = frames;
        for list in [&mut frames, &mut again] {
            list.sort_by(|a, b| (a.frame, &a.object).cmp(&(b.frame, &b.object)));
        }
        assert_eq!(again, frames, "written and read back");
    }
}

/// Any bytes as polygons: finite outlines and one-line messages.
pub(crate) fn polygon_reader(bytes: &[u8]) {
    use freeform_motion::outline_io::{OutlineFile, PolygonSettings};
    let (mut frames, mut messages) = (Vec::new(), Vec::new());
    match OutlineFile::polygons_from(bytes, "input", &PolygonSettings::default()) {
        Ok(file) => file.for_each(|frame| match frame {
            Ok(frame) => frames.push(frame),
            Err(error) => messages.push(error.to_string()),
        }),
        Err(error) => messages.push(error.to_string()),
    }
    check_outlines(&frames, &messages);
}

fn check_outlines(frames: &[OutlineFrame], messages: &[String]) {
    for frame in frames {
        assert!(frame.time.is_finite() && frame.outline.points().all(|p| p.x.is_finite() && p.y.is_finite()));
    }
    for message in messages {
        assert!(message.starts_with("input") && message.lines().count() == 1, "{message:?}");
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

/// Any bytes as a folder of pictures, each behind its length: every picture is read or told on one line, in the order of time.
pub(crate) fn picture_folder(bytes: &[u8]) {
    let Ok(folder) = tempfile::tempdir() else { return };
    let (mut rest, mut count) = (bytes, 0);
    while let Some((&length, after)) = rest.split_first()
        && count < STREAMED_PICTURES
    {
        let (picture, others) = after.split_at(after.len().min(4 * usize::from(length)));
        let name = ["png", "jpg", "gif", "tif", "bmp", "webp", "y4m"][count % 7];
        std::fs::write(folder.path().join(format!("{count}.{name}")), picture).expect("a temporary file");
        (rest, count) = (others, count + 1);
    }
    let Ok(pictures) = PictureSequence::open(&[folder.path().to_owned()], SequenceSettings::default()) else { return };
    let mut last = None;
    for picture in pictures.take(STREAMED_PICTURES) {
        match picture {
            Ok(picture) => {
                assert!(last.is_none_or(|last| picture.frame > last), "{} after {last:?}", picture.frame);
                last = Some(picture.frame);
                trace(&picture.picture);
            }
            Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error:?}"),
        }
    }
}

/// Any text as a name: what is shown of it has nothing that a terminal or a page acts upon, and is as it was where it had nothing.
pub(crate) fn names(bytes: &[u8]) {
    let name = String::from_utf8_lossy(bytes);
    let shown = readable(&name).to_string();
    let acts = |c: char| {
        c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    assert!(!shown.contains(acts), "{shown:?}");
    assert_eq!(readable(&shown).to_string(), shown);
    assert!(shown.len() >= name.len() || name.contains(acts), "{name:?} as {shown:?}");
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
