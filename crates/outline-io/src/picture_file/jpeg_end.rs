//! Whether a JPEG file goes on to its end.
use std::io::{self, BufRead};

/// What a marker begins with.
const PREFIX: u8 = 0xff;
const START_OF_IMAGE: u8 = 0xd8;
const END_OF_IMAGE: u8 = 0xd9;

/// Whether a JPEG file has the marker that ends the picture. Decoders do not tell: they fill with grey what is missing.
///
/// Goes from marker to marker (ISO/IEC 10918-1, annex B): a small picture within a segment has an end of its own, and so
/// have pictures that follow the first.
pub(crate) fn reaches_its_end(source: &mut impl BufRead) -> io::Result<bool> {
    loop {
        if !skip_past(source, PREFIX)? {
            return Ok(false);
        }
        let mut marker = byte(source)?;
        // Any number of them may stand before a marker.
        while marker == Some(PREFIX) {
            marker = byte(source)?;
        }
        match marker {
            None => return Ok(false),
            Some(END_OF_IMAGE) => return Ok(true),
            // A byte of the pixels, an interval within them, markers that stand alone.
            Some(0 | 1 | 0xd0..=0xd7 | START_OF_IMAGE) => {}
            Some(_) => {
                let (Some(high), Some(low)) = (byte(source)?, byte(source)?) else { return Ok(false) };
                let rest = u16::from_be_bytes([high, low]).saturating_sub(2);
                if !skip(source, usize::from(rest))? {
                    return Ok(false);
                }
            }
        }
    }
}

fn byte(source: &mut impl BufRead) -> io::Result<Option<u8>> {
    let next = source.fill_buf()?.first().copied();
    source.consume(usize::from(next.is_some()));
    Ok(next)
}

/// Goes on behind the next byte of this value; false where there is none.
fn skip_past(source: &mut impl BufRead, wanted: u8) -> io::Result<bool> {
    loop {
        let buffer = source.fill_buf()?;
        let (length, found) = (buffer.len(), buffer.iter().position(|byte| *byte == wanted));
        source.consume(found.map_or(length, |position| position + 1));
        if length == 0 || found.is_some() {
            return Ok(found.is_some());
        }
    }
}

/// Goes on by so many bytes; false where there are fewer.
fn skip(source: &mut impl BufRead, mut count: usize) -> io::Result<bool> {
    while count > 0 {
        let length = source.fill_buf()?.len().min(count);
        if length == 0 {
            return Ok(false);
        }
        source.consume(length);
        count -= length;
    }
    Ok(true)
}
