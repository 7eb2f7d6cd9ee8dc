//! Whether a TIFF file holds several pictures (TIFF 6.0, section 2; BigTIFF with numbers of eight bytes).
use std::io::{self, Read, Seek, SeekFrom};

/// Tag of what a picture is beside others.
const NEW_SUBFILE_TYPE: u64 = 254;

/// Bits of that: a smaller version of another picture, or a mask for it.
const IS_NO_PAGE: u64 = 0b101;

/// Directories that are looked at; files may have them in a circle.
const MOST_DIRECTORIES: usize = 64;

/// Entries of one of them that are looked at.
const MOST_ENTRIES: u64 = 4096;

/// Whether there is more than one page, thumbnails and masks not counted. Leaves the source at its beginning. A file that
/// contradicts itself has as many as are seen.
pub(crate) fn has_several_pages(source: &mut (impl Read + Seek)) -> io::Result<bool> {
    let pages = pages(source).unwrap_or(0);
    source.rewind()?;
    Ok(pages > 1)
}

fn pages(source: &mut (impl Read + Seek)) -> io::Result<usize> {
    source.rewind()?;
    let mut head = [0; 4];
    source.read_exact(&mut head)?;
    let mut file = Numbers { source, is_big_endian: head.starts_with(b"MM"), is_long: head[2] == 43 || head[3] == 43 };
    if file.is_long {
        file.source.seek(SeekFrom::Start(8))?;
    }
    let (mut pages, mut next) = (0, file.offset()?);
    for _ in 0..MOST_DIRECTORIES {
        if next == 0 || pages > 1 {
            break;
        }
        file.source.seek(SeekFrom::Start(next))?;
        let count = file.number(if file.is_long { 8 } else { 2 })?;
        if count > MOST_ENTRIES {
            break;
        }
        let mut is_page = true;
        for _ in 0..count {
            let tag = file.number(2)?;
            let kind = file.number(2)?;
            file.offset()?;
            // A value of four bytes stands at the beginning of its place.
            let value = file.number(if kind == 3 { 2 } else { 4 })?;
            file.source.seek_relative(if file.is_long { 8 } else { 4 } - if kind == 3 { 2 } else { 4 })?;
            is_page &= tag != NEW_SUBFILE_TYPE || value & IS_NO_PAGE == 0;
        }
        pages += usize::from(is_page);
        next = file.offset()?;
    }
    Ok(pages)
}

/// Numbers of a file, which says in which order their bytes are.
struct Numbers<'a, R> {
    source: &'a mut R,
    is_big_endian: bool,
    is_long: bool,
}

impl<R: Read> Numbers<'_, R> {
    fn number(&mut self, length: usize) -> io::Result<u64> {
        let mut bytes = [0; 8];
        self.source.read_exact(&mut bytes[..length])?;
        if self.is_big_endian {
            bytes[..length].reverse();
        }
        Ok(u64::from_le_bytes(bytes))
    }

    fn offset(&mut self) -> io::Result<u64> {
        self.number(if self.is_long { 8 } else { 4 })
    }
}
