//! Files that are no pictures, or damaged ones, give a typed error in one line and never a panic.
use std::io::Cursor;
use std::path::Path;

use freeform_outline_io::{GrayImage, PictureErrorKind, ReadShapeError, decode_picture, read_picture, read_shape};
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder as _, ImageFormat, Luma, LumaA, Rgb};

use crate::support::encoded;

fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(picture, ImageFormat::Png)
}

fn disc() -> GrayImage {
    GrayImage::from_fn(120, 100, |x, y| {
        let distance = (f64::from(x) - 60.0).hypot(f64::from(y) - 50.0);
        Luma([((40.0 - distance).clamp(0.0, 1.0) * 200.0) as u8 + (x % 7 + y % 5) as u8])
    })
}

fn decode(bytes: &[u8]) -> Result<GrayImage, PictureErrorKind> {
    decode_picture(Cursor::new(bytes), "test.png").map_err(|error| {
        let message = error.to_string();
        assert!(message.starts_with("test.png: ") && message.lines().count() == 1, "{message}");
        error.kind
    })
}

#[test]
fn a_picture_comes_back_as_its_grey_values() {
    assert_eq!(decode(&png(disc())).expect("a picture"), disc());
    let red = image::RgbImage::from_pixel(3, 2, Rgb([255, 0, 0]));
    assert_eq!(decode(&png(red)).expect("a picture").get_pixel(0, 0).0[0], 54);
}

#[test]
fn the_visible_part_of_a_transparent_picture_is_the_object() {
    let picture = image::GrayAlphaImage::from_fn(4, 1, |x, _| LumaA([0, if x == 2 { 255 } else { 0 }]));
    assert_eq!(decode(&png(picture)).expect("a picture").into_raw(), [0, 0, 255, 0]);
    let opaque = image::GrayAlphaImage::from_pixel(2, 1, LumaA([77, 255]));
    assert_eq!(decode(&png(opaque)).expect("a picture").into_raw(), [77, 77]);
}

#[test]
fn files_that_are_no_pictures_are_told_apart() {
    assert!(matches!(decode(b""), Err(PictureErrorKind::Empty)));
    assert!(matches!(decode(b"frame,time,x,y\n0,0,1,2\n"), Err(PictureErrorKind::NotAPicture)));
    assert!(matches!(decode(b"\x89"), Err(PictureErrorKind::NotAPicture)));
    let webp = b"RIFF\x10\x00\x00\x00WEBPVP8 ";
    assert!(matches!(decode(webp), Err(PictureErrorKind::Damaged(_) | PictureErrorKind::Io(_))));
    let avif = b"\0\0\0\x20ftypavif\0\0\0\0avifmif1";
    assert!(matches!(decode(avif), Err(PictureErrorKind::Unsupported { format: "image/avif" })));
    let missing = read_picture("/nowhere/mask.png").expect_err("no such file");
    assert_eq!(missing.to_string(), "/nowhere/mask.png: No such file or directory (os error 2)");
}

#[test]
fn a_grey_tiff_of_32_bits_is_refused_with_what_is_read_instead() {
    // Floats, whole numbers with and without sign; of the same without bits that are wrong nothing is refused.
    for (bits, format) in [(32_u16, 3_u16), (32, 2), (32, 1), (64, 3), (8, 1)] {
        let entry = |tag: u16, kind: u16, value: u32| {
            [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &1_u32.to_le_bytes(), &value.to_le_bytes()].concat()
        };
        let bytes = 4 * 3 * u32::from(bits) / 8;
        let entries = [
            entry(256, 3, 4),
            entry(257, 3, 3),
            entry(258, 3, bits.into()),
            entry(259, 3, 1),
            entry(262, 3, 1),
            entry(273, 4, 200),
            entry(277, 3, 1),
            entry(278, 3, 3),
            entry(279, 4, bytes),
            entry(339, 3, format.into()),
        ];
        let mut tiff = [&b"II*\0\x08\0\0\0"[..], &[entries.len() as u8, 0], &entries.concat(), &[0; 4]].concat();
        tiff.resize(200 + bytes as usize, 0);
        if bits == 8 {
            assert_eq!(decode(&tiff).expect("a picture").dimensions(), (4, 3));
            continue;
        }
        let refused = decode(&tiff).expect_err("too many bits");
        assert!(
            matches!(refused, PictureErrorKind::TiffBits { bits: told } if told == u64::from(bits)),
            "{bits}, {format}: {refused}"
        );
        let told = refused.to_string();
        assert!(told.contains("those of 1, 8 and 16 bits are"), "{told}");
    }
}

#[test]
fn a_picture_that_is_too_large_is_refused_before_its_pixels_are_read() {
    let mut header = Vec::from(b"\x89PNG\r\n\x1a\n");
    let mut chunk = Vec::from(b"IHDR");
    chunk.extend(20_000_u32.to_be_bytes());
    chunk.extend(20_000_u32.to_be_bytes());
    chunk.extend([8, 0, 0, 0, 0]);
    header.extend(13_u32.to_be_bytes());
    header.extend(&chunk);
    header.extend(checksum(&chunk).to_be_bytes());
    // The beginning of the pixel data, where the decoder stops reading the header.
    header.extend([0, 0, 1, 0]);
    header.extend(b"IDAT");
    let error = decode(&header).expect_err("too large");
    assert_eq!(error.to_string(), "20000 x 20000 pixels, more than 67108864 in all");
}

/// The checksum of a PNG chunk (CRC-32).
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    })
}

#[test]
fn a_colour_profile_of_any_length_leaves_the_pixels_as_they_are() {
    for length in [1_000, 40_000_000] {
        let mut bytes = Vec::new();
        let mut encoder = PngEncoder::new(&mut bytes);
        encoder.set_icc_profile(vec![0; length]).expect("PNG has profiles");
        let picture = disc();
        encoder.write_image(&picture, picture.width(), picture.height(), ExtendedColorType::L8).expect("memory");
        assert_eq!(decode(&bytes).expect("a picture"), picture);
    }
}

#[test]
fn a_picture_of_many_bytes_a_pixel_may_have_fewer_pixels() {
    // A TIFF of 8192 x 8192 pixels of three numbers of 32 bits: its head is all that is looked at.
    let entry = |tag: u16, kind: u16, count: u32, value: u32| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    let entries = [
        entry(256, 4, 1, 8192),
        entry(257, 4, 1, 8192),
        entry(258, 3, 3, 200),
        entry(259, 3, 1, 1),
        entry(262, 3, 1, 2),
        entry(273, 4, 1, 300),
        entry(277, 3, 1, 3),
        entry(278, 4, 1, 8192),
        entry(279, 4, 1, 8192 * 8192 * 12),
        entry(339, 3, 3, 206),
    ];
    let mut tiff = [&b"II*\0\x08\0\0\0"[..], &[entries.len() as u8, 0], &entries.concat(), &[0; 4]].concat();
    tiff.resize(200, 0);
    tiff.extend([32, 0, 32, 0, 32, 0, 3, 0, 3, 0, 3, 0]);
    tiff.resize(1000, 0);
    let error = decode(&tiff).expect_err("805 million bytes");
    assert_eq!(error.to_string(), "8192 x 8192 pixels, more than 44739242 in all");
}

#[test]
fn a_png_cut_anywhere_is_an_error() {
    let whole = png(disc());
    // The last 12 bytes are the end marker, without which all pixels are there.
    for length in (1..whole.len() - 12).step_by(97).chain([whole.len() - 40]) {
        assert!(decode(&whole[..length]).is_err(), "cut to {length} of {} bytes", whole.len());
    }
}

#[test]
fn a_jpeg_cut_anywhere_is_an_error_and_what_follows_a_whole_one_is_not() {
    let whole = encoded(disc(), ImageFormat::Jpeg);
    let expected = decode(&whole).expect("a picture");
    for length in (1..whole.len()).step_by(41).chain([whole.len() - 2, whole.len() - 1]) {
        assert!(decode(&whole[..length]).is_err(), "cut to {length} of {} bytes", whole.len());
    }
    let half = decode(&whole[..whole.len() / 2]).expect_err("half a picture");
    assert_eq!(half.to_string(), "the picture is damaged: the file ends within it");
    // Filled up, as by a copy that was broken off.
    let filled: Vec<u8> = whole[..whole.len() / 2].iter().copied().chain(std::iter::repeat_n(0, 5000)).collect();
    assert!(decode(&filled).is_err());
    let followed = [&whole[..], b"a preview, or the next picture"].concat();
    assert_eq!(decode(&followed).expect("a picture"), expected);
}

#[test]
fn a_small_picture_within_a_jpeg_does_not_stand_for_its_end() {
    let (whole, small) = (encoded(disc(), ImageFormat::Jpeg), encoded(GrayImage::new(8, 8), ImageFormat::Jpeg));
    // As cameras write a preview: a segment behind the start of the file.
    let length = u16::try_from(small.len() + 2).expect("small").to_be_bytes();
    let with_preview = [&whole[..2], &[0xff, 0xe2], &length, &small, &whole[2..]].concat();
    assert_eq!(decode(&with_preview).expect("a picture"), decode(&whole).expect("a picture"));
    assert!(matches!(decode(&with_preview[..with_preview.len() / 2 + 200]), Err(PictureErrorKind::CutShort)));
}

#[test]
fn compressed_video_is_told_from_pictures_by_its_content() {
    for (start, name) in [
        (&b"\x00\x00\x00\x20ftypisom\x00\x00\x02\x00"[..], "MP4"),
        (b"\x00\x00\x00\x14ftypqt  \x00\x00\x02\x00", "QuickTime"),
        (b"\x1a\x45\xdf\xa3\x01\x00\x00\x00\x00\x00\x00\x1f", "Matroska or WebM"),
        (b"RIFF\x24\x10\x00\x00AVI LIST", "AVI"),
    ] {
        assert!(matches!(decode(start), Err(PictureErrorKind::CompressedVideo { format }) if format == name), "{name}");
    }
    assert!(matches!(decode(b"x,y,free,time\n"), Err(PictureErrorKind::NotAPicture)));
}

#[test]
fn a_png_with_flipped_bytes_never_panics() {
    let whole = png(disc());
    let mut refused = 0;
    for at in 0..whole.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] ^= flip;
            refused += usize::from(decode(&bytes).is_err());
        }
    }
    println!("{refused} of {} damaged files refused", 3 * whole.len());
    assert!(refused > whole.len());
}

fn shape_of(name: &str, content: &[u8]) -> Result<freeform_curve_fit::Outline, ReadShapeError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a file");
    read_shape(&path)
}

/// The message without the folder.
#[track_caller]
fn no_shape(name: &str, content: &[u8], message: &str) {
    let error = shape_of(name, content).expect_err("no shape").to_string();
    let from = error.find(name).expect("the file is named");
    assert_eq!(&error[from..], message);
}

#[test]
fn a_shape_comes_from_csv_points_or_pictures() {
    let bare = shape_of("a.csv", b"y,x\n0,0\n0,2\n1,0\n").expect("a triangle");
    let sequence = b"frame,time,x,y\n0,0,0,0\n0,0,2,0\n0,0,0,1\n1,1,0,0\n1,1,2,0\n1,1,0,oops\n";
    assert_eq!(shape_of("a.csv", sequence).expect("the first triangle"), bare);
    assert_eq!(bare.signed_area(), 1.0);
    assert_eq!(shape_of("a.csv", b"# y,x\n0e0,0e0\n0e0,2e0\n1e0,0e0\n").expect("a header in a comment"), bare);
    assert!(shape_of("a.png", &png(disc())).is_ok());
    assert!(shape_of("a", &png(disc())).is_ok(), "the content tells a picture without an extension");
}

const ROW_OF_NUMBERS: &str = "a.csv:1: missing column(s) x, y, the header is \"1,2\"; that is a row of numbers: add a line before it that names the \
                              columns, without # (numpy.savetxt: comments='')";

#[test]
fn a_file_without_a_shape_says_why() {
    let black = png(GrayImage::new(30, 30));
    no_shape("a.png", &black, "a.png: no object: every pixel has the grey value 0");
    no_shape("a.png", b"x,y\n0,0\n", "a.png: not a picture");
    no_shape("a.png", b"", "a.png: the file is empty");
    no_shape("a.csv", b"", "a.csv: the file is empty, expected a header such as frame,time,x,y");
    no_shape("a.csv", b"x,y\n", "a.csv: no outline in the file");
    no_shape("a.csv", b"1,2\n3,4\n", ROW_OF_NUMBERS);
    no_shape(
        "a.csv",
        b"frame,x,y\n",
        "a.csv:1: missing column(s) time, the header is \"frame,x,y\"; give the time of each frame in seconds in a column named time",
    );
    no_shape("a.csv", b"x,y\n0,0\n1,nan\n", "a.csv:3: column y: \"nan\" is not a finite number: leave out the point");
    no_shape("a.csv", b"x,y\n0,0\n1,1\n", "a.csv:2-3: frame 0 of object \"0\": 2 point(s), at least 3 are needed");
    let open = b"frame,time,x,y,arc\n0,0,0,0,1\n0,0,2,0,1\n0,0,2,1,1\n";
    no_shape("a.csv", open, "a.csv: the first outline is made of open arcs, a shape needs a closed one");
    assert!(read_shape(Path::new("/nowhere/a.csv")).is_err());
}
