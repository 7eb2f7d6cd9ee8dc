//! Pictures that are to be turned, that are several, or in unusual formats.
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use freeform_outline_io::{
    GrayImage, PictureErrorKind, PictureSequence, SequenceSettings, TraceError, TraceSettings, decode_picture,
    trace_mask, trace_objects,
};
use image::{DynamicImage, ImageFormat, Luma};

use crate::support::encoded;

/// A wedge of grey values that no turn or mirror leaves as it is.
fn wedge() -> GrayImage {
    GrayImage::from_fn(24, 16, |x, y| Luma([(8 * x + y * y / 2) as u8]))
}

fn decode(bytes: &[u8]) -> Result<GrayImage, PictureErrorKind> {
    decode_picture(Cursor::new(bytes), "test").map_err(|error| error.kind)
}

/// The JPEG with an EXIF segment that holds nothing but an orientation.
fn with_orientation(jpeg: &[u8], orientation: u8) -> Vec<u8> {
    let mut exif = b"Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    let length = (exif.len() + 2) as u16;
    [&jpeg[..2], b"\xff\xe1", &length.to_be_bytes(), &exif, &jpeg[2..]].concat()
}

#[test]
fn a_picture_is_turned_and_mirrored_as_its_file_says() {
    let jpeg = encoded(wedge(), ImageFormat::Jpeg);
    let plain = DynamicImage::ImageLuma8(decode(&jpeg).expect("a picture"));
    let expected = [
        plain.clone(),
        plain.fliph(),
        plain.rotate180(),
        plain.flipv(),
        plain.rotate90().fliph(),
        plain.rotate90(),
        plain.rotate270().fliph(),
        plain.rotate270(),
    ];
    for (orientation, expected) in (1..).zip(expected) {
        let found = decode(&with_orientation(&jpeg, orientation)).expect("a picture");
        assert_eq!(found, expected.into_luma8(), "orientation {orientation}");
    }
    // What is no orientation turns nothing.
    assert_eq!(decode(&with_orientation(&jpeg, 77)).expect("a picture"), plain.into_luma8());
}

#[test]
fn webp_and_pictures_of_16_bits_are_read() {
    assert_eq!(
        decode(&encoded(DynamicImage::ImageRgb8(DynamicImage::from(wedge()).into_rgb8()), ImageFormat::WebP))
            .expect("WebP"),
        wedge()
    );
    let deep = DynamicImage::ImageLuma16(DynamicImage::from(wedge()).into_luma16());
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        assert_eq!(decode(&encoded(deep.clone(), format)).expect("16 bits"), wedge(), "{format:?}");
    }
}

#[test]
fn masks_of_16_bits_with_values_of_8_are_read_as_these() {
    let labels = GrayImage::from_fn(24, 16, |x, y| Luma([u8::from(x > 5 && y > 3) * (1 + u8::from(x > 12))]));
    let wide = image::ImageBuffer::from_fn(24, 16, |x, y| Luma([u16::from(labels[(x, y)].0[0])]));
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        let mask = encoded(DynamicImage::ImageLuma16(wide.clone()), format);
        assert_eq!(decode(&mask).expect("16 bits"), labels, "{format:?}");
    }
}

/// A chunk of a PNG.
fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut crc = u32::MAX;
    for byte in name.iter().chain(content) {
        crc ^= u32::from(*byte);
        (0..8).for_each(|_| crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 });
    }
    [&(content.len() as u32).to_be_bytes(), &name[..], content, &(!crc).to_be_bytes()].concat()
}

#[test]
fn a_file_of_several_pictures_is_refused_by_the_name_of_its_kind() {
    let png = encoded(wedge(), ImageFormat::Png);
    // Behind the signature and the header.
    let animated = [&png[..33], &chunk(b"acTL", &[0, 0, 0, 2, 0, 0, 0, 0]), &png[33..]].concat();
    let refused = |bytes: &[u8]| match decode(bytes) {
        Err(PictureErrorKind::SeveralPictures { format }) => format,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&animated), "an animated PNG");
    assert!(decode(&png).is_ok());

    // Two directories of one entry, the second of which leads nowhere; then the second as a thumbnail of the first.
    let directory = |kind: u8, next: u8| [&[1, 0, 254, 0, 4, 0, 1, 0, 0, 0, kind, 0, 0, 0, next, 0, 0, 0][..]].concat();
    let tiff = |kind: u8| [b"II\x2a\0\x08\0\0\0".to_vec(), directory(0, 26), directory(kind, 0)].concat();
    assert_eq!(refused(&tiff(2)), "a TIFF of several pages");
    assert!(matches!(decode(&tiff(1)), Err(PictureErrorKind::Damaged(_))));
    let circle = [b"II\x2a\0\x08\0\0\0".to_vec(), directory(1, 8)].concat();
    assert!(matches!(decode(&circle), Err(PictureErrorKind::Damaged(_))));
    assert!(decode(&encoded(wedge(), ImageFormat::Tiff)).is_ok());
}

#[test]
fn an_outline_of_millions_of_points_is_no_outline() {
    // A comb whose teeth and gaps are two pixels wide.
    let comb = GrayImage::from_fn(2048, 2048, |x, y| Luma([if y < 2 || x % 4 < 2 { 255 } else { 0 }]));
    let error = trace_mask(&comb, &TraceSettings::default()).expect_err("two million points");
    assert_eq!(error, TraceError::TooManyPoints { limit: 1 << 19 });
    let coarse = GrayImage::from_fn(1024, 1024, |x, y| Luma([if y < 2 || x % 8 < 4 { 255 } else { 0 }]));
    assert!(trace_mask(&coarse, &TraceSettings::default()).is_ok());
    // Bars of 4,000 points each, so many together as are bounded.
    let bars = GrayImage::from_fn(2048, 2048, |x, y| Luma([if (4..2044).contains(&y) && x % 8 < 4 { 255 } else { 0 }]));
    let traced = trace_objects(&bars, &TraceSettings::default(), 256).expect("bars");
    let points: usize = traced.iter().map(|traced| traced.outline.point_count()).sum();
    assert!(points < 1 << 19 && points > 500_000, "{} bars, {points} points", traced.len());
}

/// Frames found, and errors as text.
fn opened(path: PathBuf) -> (Vec<u64>, Vec<String>) {
    let sequence = PictureSequence::open(&[path], SequenceSettings::default()).expect("pictures");
    let (mut frames, mut errors) = (Vec::new(), Vec::new());
    for item in sequence {
        match item {
            Ok(frame) => frames.push(frame.frame),
            Err(error) => errors.push(error.to_string()),
        }
    }
    (frames, errors)
}

#[test]
#[cfg(unix)]
fn what_cannot_be_read_among_pictures_is_named_and_keeps_its_place_in_time() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for frame in [0, 3, 5, 7] {
        wedge().save(path(&format!("{frame}.png"))).expect("a picture");
    }
    symlink("nowhere.png", path("1.png")).expect("a link");
    let made = std::process::Command::new("mkfifo").arg(path("2.png")).status();
    assert!(made.is_ok_and(|status| status.success()), "mkfifo is there");
    symlink("/dev/zero", path("4.png")).expect("a link");
    fs::create_dir(path("6.png")).expect("a folder");
    for place in [folder.path().to_owned(), folder.path().join("*.png"), folder.path().join("**/*.png")] {
        let (frames, errors) = opened(place.clone());
        assert_eq!(frames, [0, 3, 5, 7], "{}", place.display());
        assert!(errors[0].contains("1.png: No such file"), "{errors:?}");
        let named = ["2.png", "4.png", "6.png"].map(|name| path(name).display().to_string() + ": not a file");
        assert_eq!(errors[1..], named);
    }
}

#[test]
#[cfg(unix)]
fn a_pattern_of_folders_within_each_other_ends_where_links_lead_back() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("a/b");
    fs::create_dir_all(&inner).expect("folders");
    for name in ["one", "two", "three"] {
        symlink(folder.path(), inner.join(name)).expect("a link");
    }
    wedge().save(inner.join("0.png")).expect("a picture");
    wedge().save(folder.path().join("1.png")).expect("a picture");
    let (frames, errors) = opened(folder.path().join("**/*.png"));
    assert_eq!((frames.len(), errors.len()), (2, 0), "{errors:?}");
    let (frames, _) = opened(folder.path().join("**/b/*.png"));
    assert_eq!(frames.len(), 1);
}
