//! Places in the palette of a PNG (PNG, third edition, sections 5.3 and 11.2.2).
use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use image::GrayImage;
use image::metadata::Orientation;
use png::{ColorType, Decoder, Transformations};

use crate::picture_file::picture::turned;

/// The places in its palette that the pixels of a PNG are, as it is to be seen; nothing of other files. Several places may have one colour.
pub(crate) fn places_of_png(path: &Path) -> Option<GrayImage> {
    places_of(BufReader::new(File::open(path).ok()?))
}

fn places_of(source: impl BufRead + Seek) -> Option<GrayImage> {
    let mut decoder = Decoder::new(source);
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().ok()?;
    if reader.info().color_type != ColorType::Indexed {
        return None;
    }
    let orientation = reader.info().exif_metadata.as_deref().and_then(Orientation::from_exif_chunk);
    let mut packed = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut packed).ok()?;
    let (width, bits) = (frame.width as usize, frame.bit_depth as usize);
    // Of less than eight bits several are in a byte, the first one highest.
    let place = |line: &[u8], column: usize| {
        let from = 8 - bits - column * bits % 8;
        (line[column * bits / 8] >> from) & (u8::MAX >> (8 - bits))
    };
    let lines = packed.chunks_exact(frame.line_size).take(frame.height as usize);
    let places = lines.flat_map(|line| (0..width).map(move |column| place(line, column))).collect();
    let places = GrayImage::from_raw(frame.width, frame.height, places)?;
    Some(turned(places, orientation.unwrap_or(Orientation::NoTransforms)))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use png::{BitDepth, Encoder, Info};

    use super::*;

    fn file(colour: ColorType, depth: BitDepth, size: [u32; 2], bytes: &[u8]) -> Vec<u8> {
        file_with(None, colour, depth, size, bytes)
    }

    fn file_with(exif: Option<&[u8]>, colour: ColorType, depth: BitDepth, size: [u32; 2], bytes: &[u8]) -> Vec<u8> {
        let [width, height] = size;
        let mut info = Info::with_size(width, height);
        (info.color_type, info.bit_depth) = (colour, depth);
        info.exif_metadata = exif.map(Into::into);
        if colour == ColorType::Indexed {
            // The last two places have one colour.
            info.palette = Some(vec![0, 0, 0, 230, 25, 75, 9, 9, 9, 9, 9, 9].into());
        }
        let mut file = Vec::new();
        let encoder = Encoder::with_info(&mut file, info).expect("a header");
        encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes)).expect("a picture");
        file
    }

    fn places(width: u32, height: u32, places: &[u8]) -> Option<GrayImage> {
        GrayImage::from_raw(width, height, places.to_vec())
    }

    #[test]
    fn pixels_are_places_of_any_depth_and_two_places_of_one_colour_are_two() {
        let two_bits = file(ColorType::Indexed, BitDepth::Two, [5, 2], &[0b0001_1011, 0b1100_0000, 0b1000_0000, 0]);
        assert_eq!(places_of(Cursor::new(&two_bits)), places(5, 2, &[0, 1, 2, 3, 3, 2, 0, 0, 0, 0]));
        let eight = file(ColorType::Indexed, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]);
        assert_eq!(places_of(Cursor::new(&eight)), places(2, 2, &[3, 2, 1, 0]));
    }

    #[test]
    fn places_are_turned_as_the_picture_is_to_be_seen() {
        // One entry: the orientation, a short number, a quarter of a turn clockwise.
        let exif = [0x49, 0x49, 42, 0, 8, 0, 0, 0, 1, 0, 0x12, 1, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0];
        let turned = file_with(Some(&exif), ColorType::Indexed, BitDepth::Eight, [3, 2], &[0, 1, 2, 3, 2, 1]);
        assert_eq!(places_of(Cursor::new(&turned)), places(2, 3, &[3, 0, 2, 1, 1, 2]));
    }

    #[test]
    fn pictures_without_a_palette_and_files_that_end_early_have_no_places() {
        assert_eq!(places_of(Cursor::new(file(ColorType::Grayscale, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]))), None);
        let whole = file(ColorType::Indexed, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]);
        // The last chunk, of 12 bytes, ends the file.
        (0..whole.len() - 24).for_each(|length| assert_eq!(places_of(Cursor::new(&whole[..length])), None, "{length}"));
    }
}
