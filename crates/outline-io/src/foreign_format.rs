//! Files of other kinds that are given for outlines or pictures, and what to do with them.

const CONVERT: &str = "convert pictures to PNG, such as with ImageMagick: mogrify -format png FILES";
const ARRAY: &str =
    "save masks as PNG or TIFF, one picture a file, or give the array to freeform_motion.identify in Python";

/// Beginnings of files, of ten bytes at most, the names of their formats, and advice.
const KNOWN: [(&[u8], &str, &str); 10] = [
    (b"\x93NUMPY", "a NumPy array", ARRAY),
    (b"\x89HDF\r\n", "HDF5", ARRAY),
    // With the version, since a column may be called so.
    (b"MATLAB 5.0", "a MATLAB file", ARRAY),
    (b"MATLAB 7.3", "a MATLAB file", ARRAY),
    (b"\x80\x02", "a Python pickle", ARRAY),
    (b"\x80\x03", "a Python pickle", ARRAY),
    (b"\x80\x04", "a Python pickle", ARRAY),
    (b"\x80\x05", "a Python pickle", ARRAY),
    (b"8BPS", "a Photoshop document", CONVERT),
    (b"%PDF-", "a PDF", CONVERT),
];

/// Zip archives of other programs, by their names.
const ARCHIVES: [(&str, &str, &str); 3] = [
    (".npz", "NumPy arrays", ARRAY),
    (".xlsx", "a spreadsheet", "save it as CSV"),
    (".ods", "a spreadsheet", "save it as CSV"),
];

/// Name of the format of a file of this name that begins so, if it is one that is neither outlines nor pictures to be read here, and what to do.
pub(crate) fn foreign_format(start: &[u8], name: &str) -> Option<(&'static str, &'static str)> {
    if start.starts_with(b"\xff\x0a") || start.starts_with(b"\x00\x00\x00\x0cJX") {
        return Some(("a JPEG XL picture", CONVERT));
    }
    if start.starts_with(b"PK\x03\x04") {
        let archive = ARCHIVES.iter().find(|(extension, ..)| name.to_ascii_lowercase().ends_with(extension))?;
        return Some((archive.1, archive.2));
    }
    let known = KNOWN.iter().find(|(mark, ..)| start.starts_with(mark));
    known.map(|&(_, format, advice)| (format, advice))
}

/// Whether a file begins as a picture of HEIC, which comes in boxes as video does.
pub(crate) fn is_heic(start: &[u8]) -> bool {
    let brand = start.get(8..12);
    let is_box = start.get(4..8) == Some(b"ftyp");
    is_box && [b"heic", b"heix", b"heim", b"heis", b"mif1", b"msf1"].iter().any(|known| brand == Some(&known[..]))
}
