//! The palette of a PNG (PNG, third edition, sections 5.3 and 11.2.2).
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

const SIGNATURE: &[u8; 8] = b"\x89PNG\r\n\x1a\n";

/// Colour type of pictures whose pixels are places in a palette, and where it stands in the header.
const INDEXED: u8 = 3;
const COLOUR_TYPE: usize = 9;

/// Chunks looked at before the palette.
const MOST_CHUNKS: usize = 64;

/// The colours of the palette of a PNG whose pixels are places in it, in their order; nothing of other files.
pub(crate) fn palette_of_png(path: &Path) -> Option<Vec<[u8; 3]>> {
    palette_of(&mut BufReader::new(File::open(path).ok()?))
}

fn palette_of(source: &mut (impl Read + Seek)) -> Option<Vec<[u8; 3]>> {
    let mut signature = [0; 8];
    source.read_exact(&mut signature).ok()?;
    if signature != *SIGNATURE {
        return None;
    }
    for _ in 0..MOST_CHUNKS {
        let mut head = [0; 8];
        source.read_exact(&mut head).ok()?;
        let [a, b, c, d, name @ ..] = head;
        let length = u32::from_be_bytes([a, b, c, d]);
        match &name {
            b"IHDR" => {
                let mut header = [0; 13];
                source.read_exact(&mut header).ok()?;
                if length as usize != header.len() || header[COLOUR_TYPE] != INDEXED {
                    return None;
                }
                source.seek_relative(4).ok()?;
            }
            b"PLTE" => {
                let mut colours = vec![0; length.min(3 * 256) as usize];
                source.read_exact(&mut colours).ok()?;
                let (colours, _) = colours.as_chunks::<3>();
                return Some(colours.to_vec());
            }
            b"IDAT" | b"IEND" => return None,
            // With its checksum.
            _ => source.seek_relative(i64::from(length) + 4).ok()?,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
        [&(data.len() as u32).to_be_bytes()[..], name, data, &[0; 4]].concat()
    }

    #[test]
    fn the_palette_is_found_behind_other_chunks_and_only_where_pixels_are_places_in_it() {
        let file = |colour_type: u8| {
            let header = [0, 0, 0, 1, 0, 0, 0, 1, 8, colour_type, 0, 0, 0];
            let colours = chunk(b"PLTE", &[0, 0, 0, 230, 25, 75]);
            [&SIGNATURE[..], &chunk(b"IHDR", &header), &chunk(b"gAMA", &[1, 2, 3, 4]), &colours].concat()
        };
        assert_eq!(palette_of(&mut Cursor::new(file(3))), Some(vec![[0; 3], [230, 25, 75]]));
        assert_eq!(palette_of(&mut Cursor::new(file(2))), None);
        let whole = file(3);
        (0..whole.len() - 4).for_each(|length| assert_eq!(palette_of(&mut Cursor::new(&whole[..length])), None));
    }
}
