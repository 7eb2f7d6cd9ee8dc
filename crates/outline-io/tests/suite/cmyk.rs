//! Pictures of inks: cyan, magenta, yellow and black.
use std::io::Cursor;

use freeform_outline_io::{GrayImage, PictureErrorKind, decode_picture};
use image::{ImageFormat, Rgb, RgbImage};

use crate::support::encoded;

/// Two blocks of 8 x 8 pixels beside each other, by their inks: 0 for none, 255 for all of it.
type Inks = [[u8; 4]; 2];

fn decode(bytes: &[u8]) -> Result<GrayImage, PictureErrorKind> {
    decode_picture(Cursor::new(bytes), "test").map_err(|error| error.kind)
}

/// The grey values in the middle of the two blocks, which are all over the blocks.
fn blocks(bytes: &[u8]) -> [u8; 2] {
    let picture = decode(bytes).expect("a picture");
    assert_eq!(picture.dimensions(), (16, 8));
    let shades = [3, 11].map(|x| picture.get_pixel(x, 4).0[0]);
    assert!(picture.enumerate_pixels().all(|(x, _, grey)| grey.0[0].abs_diff(shades[usize::from(x > 7)]) <= 1));
    shades
}

/// A baseline JPEG of two blocks of one colour each, with as many components as the colours have and the marker of Adobe if there is
/// one (ISO/IEC 10918-1, annex B).
fn jpeg<const N: usize>(colours: [[u8; N]; 2], adobe_transform: Option<u8>) -> Vec<u8> {
    let segment =
        |marker: u8, content: &[u8]| [&[0xff, marker], &(content.len() as u16 + 2).to_be_bytes()[..], content].concat();
    let adobe = adobe_transform.map(|transform| segment(0xee, &[b"Adobe\0\x64\0\0\0\0", &[transform][..]].concat()));
    let quantisation = segment(0xdb, &[&[0, 8][..], &[1; 63]].concat());
    let components = |settings: &[u8]| (1..=N as u8).flat_map(|id| [&[id], settings].concat()).collect::<Vec<u8>>();
    let frame = segment(0xc0, &[&[8, 0, 8, 0, 16, N as u8][..], &components(&[0x11, 0])].concat());
    // Codes of four bits for numbers of up to eight bits, one bit for the end of a block.
    let of_means = segment(0xc4, &[&[0, 0, 0, 0, 9][..], &[0; 12], &[0, 1, 2, 3, 4, 5, 6, 7, 8]].concat());
    let of_waves = segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0]].concat());
    let scan = segment(0xda, &[&[N as u8][..], &components(&[0]), &[0, 63, 0]].concat());

    let mut bits = String::new();
    let mut before = [128; N];
    for (component, value) in colours.iter().flat_map(|colour| colour.iter().enumerate()) {
        let difference = i32::from(*value) - before[component];
        before[component] = i32::from(*value);
        let count = (i32::BITS - difference.unsigned_abs().leading_zeros()) as usize;
        let number = if difference < 0 { difference + (1 << count) - 1 } else { difference };
        let number = if count > 0 { format!("{number:0count$b}") } else { String::new() };
        bits += &format!("{count:04b}{number}0");
    }
    bits += &"1".repeat(bits.len().next_multiple_of(8) - bits.len());
    let bytes = bits.as_bytes().chunks(8).map(|byte| byte.iter().fold(0, |sum, bit| sum << 1 | (bit - b'0')));
    let pixels = bytes.flat_map(|byte| if byte == 0xff { vec![byte, 0] } else { vec![byte] }).collect();
    let start = vec![0xff, 0xd8];
    let parts = [start, adobe.unwrap_or_default(), quantisation, frame, of_means, of_waves, scan, pixels];
    [parts.concat(), vec![0xff, 0xd9]].concat()
}

/// What a TIFF is compressed by, and how its bytes stand.
enum Layout {
    /// The inks of each pixel together, in so many bytes each.
    Pixels { bytes: usize },
    /// One plane for each ink.
    Planes,
    /// A JPEG in one strip.
    Jpeg,
}

/// A TIFF of two blocks (TIFF 6.0, section 16).
fn tiff(inks: Inks, layout: &Layout) -> Vec<u8> {
    let pixels: Vec<[u8; 4]> = (0..8 * 16).map(|index| inks[index % 16 / 8]).collect();
    let (strips, bytes): (Vec<Vec<u8>>, usize) = match layout {
        Layout::Pixels { bytes } => (vec![pixels.concat().iter().flat_map(|ink| vec![*ink; *bytes]).collect()], *bytes),
        Layout::Planes => ((0..4).map(|plane| pixels.iter().map(|inks| inks[plane]).collect()).collect(), 1),
        Layout::Jpeg => (vec![jpeg(inks, None)], 1),
    };
    let is_planar = u32::from(matches!(layout, Layout::Planes));
    let compression = if matches!(layout, Layout::Jpeg) { 7 } else { 1 };
    let (count, entries) = (strips.len() as u32, 10);
    // Behind the directory: bits of the samples, where the strips begin and how long they are, the strips.
    let bits_at = 8 + 2 + 12 * entries + 4;
    let (starts_at, lengths_at) = (bits_at + 8, bits_at + 8 + 16);
    let lengths: Vec<u32> = strips.iter().map(|strip| strip.len() as u32).collect();
    let starts: Vec<u32> = (0..strips.len()).map(|k| lengths_at + 16 + lengths[..k].iter().sum::<u32>()).collect();
    let list = |values: &[u32]| values.iter().copied().chain([0; 4]).take(4).flat_map(u32::to_le_bytes).collect();
    let place = |values: &[u32], at: u32| if values.len() == 1 { values[0] } else { at };
    let directory = [
        (256, 4, 1, 16),
        (257, 4, 1, 8),
        (258, 3, 4, bits_at),
        (259, 3, 1, compression),
        (262, 3, 1, 5),
        (273, 4, count, place(&starts, starts_at)),
        (277, 3, 1, 4),
        (278, 4, 1, 8),
        (279, 4, count, place(&lengths, lengths_at)),
        (284, 3, 1, 1 + is_planar),
    ];
    let entry = |(tag, kind, count, value): (u16, u16, u32, u32)| {
        [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    let parts = [
        b"II\x2a\0\x08\0\0\0".to_vec(),
        (directory.len() as u16).to_le_bytes().to_vec(),
        directory.into_iter().flat_map(entry).collect(),
        vec![0; 4],
        [8 * bytes as u16; 4].into_iter().flat_map(u16::to_le_bytes).collect(),
        list(&starts),
        list(&lengths),
        strips.concat(),
    ];
    parts.concat()
}

/// The grey value that inks leave of white paper: what red, green and blue are reflected, and the luminance of those.
fn seen([cyan, magenta, yellow, black]: [u8; 4]) -> u8 {
    let colour = [cyan, magenta, yellow].map(|ink| {
        let reflected = (255.0 - f64::from(ink)) * (255.0 - f64::from(black)) / 255.0;
        reflected.round() as u8
    });
    image::Pixel::to_luma(&Rgb(colour)).0[0]
}

fn assert_is_seen(found: [u8; 2], inks: Inks) {
    let wanted = inks.map(seen);
    assert!((0..2).all(|block| found[block].abs_diff(wanted[block]) <= 2), "{found:?}, not {wanted:?}, of {inks:?}");
}

/// Paper and ink, colours and depths of black.
const PICTURES: [Inks; 4] = [
    [[0, 0, 0, 0], [0, 0, 0, 255]],
    [[255, 0, 0, 0], [0, 255, 0, 0]],
    [[0, 0, 200, 20], [90, 90, 90, 90]],
    [[255, 255, 255, 255], [10, 0, 0, 0]],
];

#[test]
fn a_jpeg_of_inks_is_read_as_adobe_writes_it() {
    for inks in PICTURES {
        let turned = inks.map(|inks| inks.map(|ink| 255 - ink));
        assert_is_seen(blocks(&jpeg(turned, Some(0))), inks);
        assert_is_seen(blocks(&jpeg(turned, None)), inks);
    }
    // The three inks as brightness and colour; those here have none.
    for [ink, black] in [[0, 0], [0, 255], [255, 0], [80, 30]] {
        let found = blocks(&jpeg([[ink, 128, 128, 255 - black]; 2], Some(2)));
        assert_is_seen(found, [[ink, ink, ink, black]; 2]);
    }
}

#[test]
fn a_jpeg_of_three_colours_is_read_whatever_adobe_says_of_them() {
    let colours = [[250, 10, 60], [0, 0, 0]];
    let seen = colours.map(|colour| image::Pixel::to_luma(&Rgb(colour)).0[0]);
    let found = blocks(&jpeg(colours, Some(0)));
    assert!((0..2).all(|block| found[block].abs_diff(seen[block]) <= 2), "{found:?}, not {seen:?}");
    assert_eq!(blocks(&jpeg([[200, 128, 128], [30, 128, 128]], Some(1))), [200, 30]);
    // An ordinary one, for the colours themselves.
    let two = RgbImage::from_fn(16, 8, |x, _| Rgb(colours[usize::from(x > 7)]));
    let found = blocks(&encoded(two, ImageFormat::Jpeg));
    assert!((0..2).all(|block| found[block].abs_diff(seen[block]) <= 2), "{found:?}, not {seen:?}");
}

#[test]
fn a_tiff_of_inks_is_read_and_one_of_planes_refused_as_such() {
    for inks in PICTURES {
        for layout in [Layout::Pixels { bytes: 1 }, Layout::Pixels { bytes: 2 }, Layout::Jpeg] {
            assert_is_seen(blocks(&tiff(inks, &layout)), inks);
        }
        let refused = decode(&tiff(inks, &Layout::Planes)).expect_err("planes of inks");
        assert!(matches!(refused, PictureErrorKind::UnsupportedKind(_)), "{refused:?}");
        assert!(refused.to_string().contains("CMYK"), "{refused}");
    }
}
