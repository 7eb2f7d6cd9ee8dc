//! The beginning of a stream, read before anything is decided.
use std::io::{self, BufRead, Read as _};
use std::sync::Arc;

/// Most bytes of a stream that are read ahead.
const MOST_BYTES: u64 = 1 << 26;

/// Pictures of a video that are read ahead.
const PICTURES: u64 = 60;

/// Most bytes of the header of a video.
const LONGEST_HEADER: u64 = 1 << 12;

/// Bytes before each picture of a video.
const FRAME_HEADER: u64 = 6;

/// The beginning of a stream of pictures, to look at before the stream is read for good ([`PicturePreview::Beginning`](crate::PicturePreview)):
/// 60 pictures of an uncompressed video (y4m), 64 MiB of anything else. The stream goes on behind it.
///
/// # Errors
///
/// Those of the source.
pub fn read_ahead(source: &mut impl BufRead) -> io::Result<Arc<[u8]>> {
    let mut beginning = Vec::new();
    source.by_ref().take(LONGEST_HEADER).read_until(b'\n', &mut beginning)?;
    let length = video_length(&beginning, PICTURES).unwrap_or(MOST_BYTES).min(MOST_BYTES);
    source.by_ref().take(length).read_to_end(&mut beginning)?;
    Ok(beginning.into())
}

/// Bytes that so many pictures of an uncompressed video have at most, by its header; `None` where it is no such video.
fn video_length(header: &[u8], pictures: u64) -> Option<u64> {
    let header = std::str::from_utf8(header).ok()?.strip_prefix("YUV4MPEG2 ")?;
    let number =
        |name: char| header.split_ascii_whitespace().find_map(|word| word.strip_prefix(name)?.parse::<u64>().ok());
    let is_grey = header.contains(" Cmono");
    let pixels = number('W')?.checked_mul(number('H')?)?;
    // Colours of a quarter of the pixels, unless they say that they have more.
    let has_all = header.contains(" C444") || header.contains(" C422");
    let halves = if is_grey {
        2
    } else if has_all {
        6
    } else {
        3
    };
    let of_picture = pixels.checked_mul(halves)? / 2;
    of_picture.checked_add(FRAME_HEADER)?.checked_mul(pictures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixty_pictures_of_a_video_are_read_ahead_and_the_stream_goes_on_behind_them() {
        let mut video = b"YUV4MPEG2 W4 H2 F30:1 C444\n".to_vec();
        for frame in 0..70_u8 {
            video.extend(b"FRAME\n");
            video.extend([frame; 3 * 4 * 2]);
        }
        let mut source = &video[..];
        let beginning = read_ahead(&mut source).expect("memory");
        assert_eq!(beginning.len(), 27 + 60 * (6 + 24));
        let mut rest = Vec::new();
        source.read_to_end(&mut rest).expect("memory");
        assert_eq!([&beginning[..], &rest].concat(), video);
    }

    #[test]
    fn a_header_that_asks_for_more_than_there_can_be_is_no_length() {
        assert_eq!(video_length(b"YUV4MPEG2 W18446744073709551615 H2 F30:1\n", 60), None);
        assert_eq!(video_length(b"\x89PNG\r\n", 60), None);
        assert_eq!(video_length(b"YUV4MPEG2 W4 H2 Cmono\n", 1), Some(4 * 2 + 6));
    }
}
