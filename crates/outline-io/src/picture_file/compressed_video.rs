//! Video that has to be decoded first, known by how it begins.
use crate::foreign_format::is_heic;

/// Name of the kind of compressed video that a file begins like, if it does.
pub(crate) fn compressed_video(start: &[u8]) -> Option<&'static str> {
    let at = |offset: usize, mark: &[u8]| start.get(offset..).is_some_and(|rest| rest.starts_with(mark));
    // A box begins with its size, in which a text would be larger than any file.
    let is_box = |name: &[u8]| start.first().is_some_and(|high| *high < b' ') && at(4, name);
    // Pictures come in boxes too.
    if image::guess_format(start).is_ok() || is_heic(start) {
        None
    } else if is_box(b"ftypqt") || [b"moov", b"mdat", b"wide", b"free", b"skip"].into_iter().any(|name| is_box(name)) {
        Some("QuickTime")
    } else if is_box(b"ftyp") {
        Some("MP4")
    } else if at(0, b"\x1a\x45\xdf\xa3") {
        Some("Matroska or WebM")
    } else if at(0, b"RIFF") && at(8, b"AVI ") {
        Some("AVI")
    } else if at(0, b"OggS") {
        Some("Ogg")
    } else if at(0, b"FLV\x01") {
        Some("Flash")
    } else if at(0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11") {
        Some("Windows Media")
    } else if at(0, b"\x00\x00\x01\xba") || at(0, b"\x00\x00\x01\xb3") {
        Some("MPEG")
    } else {
        None
    }
}
