//! The bytes of a Parquet file, with a bound on what a page may claim.
use std::fs::File;
use std::io::{BufReader, Chain, Cursor, Read, Seek, SeekFrom};

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, Length};

/// Largest page in memory, in bytes; writers make pages of about a megabyte.
pub(crate) const PAGE_LIMIT: u64 = 1 << 28;

/// Bytes at the beginning of a page's header that hold its sizes.
const SIZES_LENGTH: usize = 24;

/// Bytes of a header that are read at once.
const HEADER_BUFFER: usize = 256;

/// What pages are read from: their sizes are looked at before memory is taken for them.
#[derive(Debug)]
pub(crate) enum Source {
    File { file: File, length: u64 },
    Memory(Bytes),
}

impl Source {
    pub(crate) fn of_file(file: File) -> std::io::Result<Self> {
        let length = file.metadata()?.len();
        Ok(Self::File { file, length })
    }
}

impl Length for Source {
    fn len(&self) -> u64 {
        match self {
            Self::File { length, .. } => *length,
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }
}

impl ChunkReader for Source {
    type T = Chain<Cursor<Vec<u8>>, Box<dyn Read>>;

    /// Of a column this is asked for at the header of a page.
    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let mut rest: Box<dyn Read> = match self {
            Self::File { file, .. } => {
                let mut file = file.try_clone()?;
                file.seek(SeekFrom::Start(start))?;
                Box::new(BufReader::with_capacity(HEADER_BUFFER, file))
            }
            Self::Memory(bytes) => Box::new(bytes.get_read(start)?),
        };
        let mut head = Vec::with_capacity(SIZES_LENGTH);
        rest.by_ref().take(SIZES_LENGTH as u64).read_to_end(&mut head)?;
        match unpacked_size(&head) {
            Some(size) if size <= PAGE_LIMIT => Ok(Cursor::new(head).chain(rest)),
            Some(size) => Err(damaged(format!("a page of {size} bytes, the largest read has {PAGE_LIMIT}"))),
            None => Err(damaged("no header of a page where one should be")),
        }
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        if start.checked_add(length as u64).is_none_or(|end| end > self.len()) {
            return Err(damaged(format!("{length} bytes from byte {start} on, the file has {}", self.len())));
        }
        match self {
            Self::File { file, .. } => file.get_bytes(start, length),
            Self::Memory(bytes) => bytes.get_bytes(start, length),
        }
    }
}

/// Something that a sound file does not hold.
pub(crate) fn damaged(reason: impl Into<String>) -> ParquetError {
    ParquetError::General(reason.into())
}

/// Size of a page without compression: the second field of its header, which as every writer makes it begins with two 32-bit numbers
/// (Thrift compact protocol).
fn unpacked_size(head: &[u8]) -> Option<u64> {
    /// A field whose number is one more than that of the field before, of type i32.
    const NEXT_I32: u8 = 0x15;
    let rest = head.strip_prefix(&[NEXT_I32])?;
    let (_, rest) = varint(rest)?;
    let (size, _) = varint(rest.strip_prefix(&[NEXT_I32])?)?;
    // Zigzag: odd numbers are negative, which the reader of headers refuses.
    Some(size >> 1)
}

/// A number in groups of seven bits, the lowest first, and what follows it.
fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let length = bytes.iter().take(10).position(|byte| byte & 0x80 == 0)? + 1;
    let (number, rest) = bytes.split_at(length);
    let value = number.iter().rev().fold(0_u64, |value, byte| value.wrapping_shl(7) | u64::from(byte & 0x7f));
    Some((value, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_page_is_found_in_its_header() {
        // A data page of 300 bytes (zigzag 600), 200 when compressed.
        assert_eq!(unpacked_size(&[0x15, 0x00, 0x15, 0xd8, 0x04, 0x15, 0x90, 0x03]), Some(300));
        for head in [&[][..], &[0x15], &[0x15, 0x80], &[0x15, 0x00, 0x25, 0x02], &[0x15, 0x00, 0x15, 0xff]] {
            assert_eq!(unpacked_size(head), None, "{head:?}");
        }
    }
}
