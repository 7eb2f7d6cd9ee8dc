//! Places in the palette of a PNG (PNG, third edition, sections 5.3 and 11.2.2).
use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use png::{ColorType, Decoder, Transformations};

/// The places in its palette that the pixels of a PNG are, row by row; nothing of other files. Several places may have one colour.
pub(crate) fn places_of_png(path: &Path) -> Option<Vec<i64>> {
    places_of(BufReader::new(File::open(path).ok()?))
}

fn places_of(source: impl BufRead + Seek) -> Option<Vec<i64>> {
    let mut decoder = Decoder::new(source);
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().ok()?;
    if reader.info().color_type != ColorType::Indexed {
        return None;
    }
    let mut packed = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut packed).ok()?;
    let (width, bits) = (frame.width as usize, frame.bit_depth as usize);
    // Of less than eight bits several are in a byte, the first one highest.
    let place = |line: &[u8], column: usize| {
        let from = 8 - bits - column * bits % 8;
        i64::from(line[column * bits / 8] >> from) & ((1 << bits) - 1)
    };
    let lines = packed.chunks_exact(frame.line_size).take(frame.height as usize);
    Some(lines.flat_map(|line| (0..width).map(move |column| place(line, column))).collect())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use png::{BitDepth, Encoder};

    use super::*;

    fn file(colour: ColorType, depth: BitDepth, [width, height]: [u32; 2], bytes: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, width, height);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == ColorType::Indexed {
            // The last two places have one colour.
            encoder.set_palette(vec![0, 0, 0, 230, 25, 75, 9, 9, 9, 9, 9, 9]);
        }
        encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes)).expect("a picture");
        file
    }

    #[test]
    fn pixels_are_places_of_any_depth_and_two_places_of_one_colour_are_two() {
        let two_bits = file(ColorType::Indexed, BitDepth::Two, [5, 2], &[0b0001_1011, 0b1100_0000, 0b1000_0000, 0]);
        assert_eq!(places_of(Cursor::new(&two_bits)), Some(vec![0, 1, 2, 3, 3, 2, 0, 0, 0, 0]));
        let eight = file(ColorType::Indexed, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]);
        assert_eq!(places_of(Cursor::new(&eight)), Some(vec![3, 2, 1, 0]));
    }

    #[test]
    fn pictures_without_a_palette_and_files_that_end_early_have_no_places() {
        assert_eq!(places_of(Cursor::new(file(ColorType::Grayscale, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]))), None);
        let whole = file(ColorType::Indexed, BitDepth::Eight, [2, 2], &[3, 2, 1, 0]);
        // The last chunk, of 12 bytes, ends the file.
        (0..whole.len() - 24).for_each(|length| assert_eq!(places_of(Cursor::new(&whole[..length])), None, "{length}"));
    }
}
