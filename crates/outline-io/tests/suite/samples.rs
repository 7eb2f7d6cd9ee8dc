//! Samples of files, of which each is decoded once for all channels, are those of files that are read for each channel.
use std::path::PathBuf;

use freeform_outline_io::{Channel, PicturePreview, PictureSample, PictureSequence, SequenceSettings};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage};

/// How a picture is stored.
#[derive(Clone, Copy)]
enum Stored {
    Colour,
    Grey,
    Grey16,
    /// Grey, with some pixels that are transparent.
    Transparent,
}

/// How the picture of this number is stored.
type StoredIn = fn(u32) -> Stored;

/// A picture of some greys, with a square that is red where colours are stored.
fn picture(frame: u32, stored: Stored, [width, height]: [u32; 2]) -> DynamicImage {
    let grey = move |x: u32, y: u32| 40 + ((x * 31 + y * 17 + frame * 7) % 97) as u8;
    let is_thing = move |x: u32, y: u32| x.abs_diff(20 + 2 * frame) < height / 5 && y.abs_diff(height / 2) < height / 5;
    match stored {
        Stored::Colour => RgbImage::from_fn(width, height, |x, y| match is_thing(x, y) {
            true => Rgb([200, grey(x, y), 30]),
            false => Rgb([grey(x, y); 3]),
        })
        .into(),
        Stored::Grey => GrayImage::from_fn(width, height, |x, y| Luma([grey(x, y)])).into(),
        Stored::Grey16 => {
            ImageBuffer::from_fn(width, height, |x, y| Luma([253 * u16::from(grey(x, y)) + (x % 256) as u16])).into()
        }
        Stored::Transparent => ImageBuffer::from_fn(width, height, |x, y| {
            LumaA([grey(x, y), if is_thing(x, y) { 255 } else { (y % 200) as u8 }])
        })
        .into(),
    }
}

#[test]
fn samples_of_files_are_the_same_decoded_once_and_keep_all_channels_where_any_picture_has_colour() {
    let all = [Channel::Luminance, Channel::Red, Channel::Green, Channel::Blue, Channel::Saturation];
    let kinds: [(&str, StoredIn, bool); 6] = [
        ("colour", |_| Stored::Colour, true),
        ("grey", |_| Stored::Grey, false),
        ("16 bits", |_| Stored::Grey16, false),
        ("transparent", |_| Stored::Transparent, false),
        ("one is grey", |frame| if frame == 3 { Stored::Grey } else { Stored::Colour }, true),
        ("mixed", |frame| [Stored::Transparent, Stored::Grey16, Stored::Colour][frame as usize % 3], true),
    ];
    // As they are, and made smaller.
    for size in [[80, 50], [720, 600]] {
        for (name, stored, is_coloured) in kinds {
            let folder = tempfile::tempdir().expect("a folder");
            let paths: Vec<PathBuf> = (0..7).map(|frame| folder.path().join(format!("{frame}.png"))).collect();
            for (frame, path) in (0..).zip(&paths) {
                picture(frame, stored(frame), size).save(path).expect("a picture");
            }
            let sequence = PictureSequence::open(&paths, SequenceSettings::default()).expect("a sequence");
            let preview = PicturePreview::of_paths(&paths, &sequence);
            assert!(matches!(preview, PicturePreview::Pictures(_)));
            for channels in [&all[..], &all[..1], &all[..2], &[Channel::Saturation, Channel::Blue], &[Channel::Red]] {
                let sample = preview.sample(channels);
                assert_eq!(sample.len(), 7, "{name}");
                let is_same = sample == PictureSample::read(channels, |channel| preview.pictures(channel));
                assert!(is_same, "{name}, {size:?}, {channels:?}");
                let kept: Vec<Channel> = sample.channels().collect();
                assert_eq!(kept, if is_coloured { channels } else { &channels[..1] }, "{name}");
            }
        }
    }
}
