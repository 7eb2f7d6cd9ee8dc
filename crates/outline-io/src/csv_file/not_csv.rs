//! What is taken for CSV and is none.
use crate::error::ReadErrorKind;
use crate::foreign_format::foreign_format;

/// Bytes at the beginning of a file that tell.
pub(crate) const HEAD_LENGTH: u64 = 10;

/// Bytes of three characters of UTF-16.
const THREE_CHARACTERS: usize = 6;

/// Beginnings of compressed files, their names and what unpacks them.
const COMPRESSED: [(&[u8], &str, &str); 5] = [
    (b"\x1f\x8b", "gzip", "gzip -dc"),
    (b"\x28\xb5\x2f\xfd", "zstd", "zstd -dc"),
    (b"\xfd7zXZ\x00", "xz", "xz -dc"),
    (b"BZh", "bzip2", "bzip2 -dc"),
    (b"PK\x03\x04", "zip", "unzip -p"),
];

/// Why a file of this name that begins so is no CSV, if that is seen at once.
pub(crate) fn not_csv(start: &[u8], name: &str) -> Option<ReadErrorKind> {
    if start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff") {
        return Some(ReadErrorKind::Utf16);
    }
    if start.starts_with(b"PAR1") {
        return Some(ReadErrorKind::ParquetStream);
    }
    // Without a mark: a header of plain letters with a zero beside each.
    let zeros: Vec<bool> = start.iter().take(THREE_CHARACTERS).map(|byte| *byte == 0).collect();
    if zeros.len() == THREE_CHARACTERS && zeros[0] != zeros[1] && zeros.iter().skip(2).eq(zeros.iter().take(4)) {
        return Some(ReadErrorKind::Utf16);
    }
    if let Some((format, advice)) = foreign_format(start, name) {
        return Some(ReadErrorKind::ForeignFormat { format, advice });
    }
    let known = COMPRESSED.iter().find(|(mark, ..)| start.starts_with(mark));
    known.map(|&(_, format, unpack)| ReadErrorKind::Compressed { format, unpack })
}
