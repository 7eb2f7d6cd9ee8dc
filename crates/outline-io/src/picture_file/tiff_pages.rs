//! Whether a TIFF file holds several pictures, and of how many bits grey ones are (TIFF 6.0, sections 2 and 8; BigTIFF with numbers of eight bytes).
use std::io::{self, Read, Seek, SeekFrom};

/// Tag of what a picture is beside others.
const NEW_SUBFILE_TYPE: u64 = 254;

/// Tag of how many bits each sample of a pixel has.
const BITS_PER_SAMPLE: u64 = 258;

/// Bits of the first of these: a smaller version of another picture, or a mask for it.
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

/// How many bits a pixel of a picture of one sample has, such as grey ones; nothing of others, and of a file that contradicts itself.
pub(crate) fn bits_of_single_sample(source: &mut (impl Read + Seek)) -> Option<u64> {
    let mut file = Numbers::of(source).ok()?;
    let first = file.offset().ok()?;
    file.source.seek(SeekFrom::Start(first)).ok()?;
    let mut bits = None;
    file.read_entries(|entry| {
        if entry.tag == BITS_PER_SAMPLE && entry.count == 1 {
            bits = Some(entry.value);
        }
    })
    .ok()?;
    bits
}

fn pages(source: &mut (impl Read + Seek)) -> io::Result<usize> {
    let mut file = Numbers::of(source)?;
    let (mut pages, mut next) = (0, file.offset()?);
    for _ in 0..MOST_DIRECTORIES {
        if next == 0 || pages > 1 {
            break;
        }
        file.source.seek(SeekFrom::Start(next))?;
        let mut is_page = true;
        let is_read =
            file.read_entries(|entry| is_page &= entry.tag != NEW_SUBFILE_TYPE || entry.value & IS_NO_PAGE == 0)?;
        if !is_read {
            break;
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

/// What a directory says of a picture.
struct Entry {
    tag: u64,
    /// How many values there are.
    count: u64,
    /// The value, where it is one of two or four bytes.
    value: u64,
}

impl<'a, R: Read + Seek> Numbers<'a, R> {
    /// Those of a file, up to the place of its first directory.
    fn of(source: &'a mut R) -> io::Result<Self> {
        source.rewind()?;
        let mut head = [0; 4];
        source.read_exact(&mut head)?;
        let is_long = head[2] == 43 || head[3] == 43;
        if is_long {
            source.seek(SeekFrom::Start(8))?;
        }
        Ok(Self { source, is_big_endian: head.starts_with(b"MM"), is_long })
    }

    /// Looks at all entries of the directory that is next; false where it has too many.
    fn read_entries(&mut self, mut look: impl FnMut(Entry)) -> io::Result<bool> {
        let entries = self.number(if self.is_long { 8 } else { 2 })?;
        if entries > MOST_ENTRIES {
            return Ok(false);
        }
        for _ in 0..entries {
            let tag = self.number(2)?;
            let kind = self.number(2)?;
            let count = self.offset()?;
            // A value of four bytes stands at the beginning of its place.
            let value = self.number(if kind == 3 { 2 } else { 4 })?;
            self.source.seek_relative(if self.is_long { 8 } else { 4 } - if kind == 3 { 2 } else { 4 })?;
            look(Entry { tag, count, value });
        }
        Ok(true)
    }
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
