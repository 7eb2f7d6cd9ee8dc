//! What a reader makes of a text, and of whatever else it is given.
use std::io::Read;

use freeform_outline_io::{OutlineReader, ReadError};

/// One triangle per frame, lines 2 to 4 and 5 to 7.
pub(crate) const TWO_FRAMES: &str =
    "frame,time,x,y\n0,0.0,0,0\n0,0.0,1,0\n0,0.0,0,1\n1,0.1,0,0\n1,0.1,1,0\n1,0.1,0,1\n";

/// Frames read until the reader ends, and all errors as (message, recoverable).
pub(crate) fn read_all(text: impl AsRef<[u8]>) -> (Vec<u64>, Vec<(String, bool)>) {
    read_from(text.as_ref())
}

pub(crate) fn read_from(source: impl Read) -> (Vec<u64>, Vec<(String, bool)>) {
    let told = |error: &ReadError| (error.to_string(), error.is_recoverable());
    let reader = match OutlineReader::new(source, "in.csv") {
        Ok(reader) => reader,
        Err(error) => return (vec![], vec![told(&error)]),
    };
    let (mut frames, mut errors) = (vec![], vec![]);
    for item in reader {
        match item {
            Ok(frame) => frames.push(frame.frame),
            Err(error) => errors.push(told(&error)),
        }
    }
    (frames, errors)
}

/// Asserts that the text is refused with one fatal error after the given frames.
#[track_caller]
pub(crate) fn refused(text: impl AsRef<[u8]>, frames: &[u64], message: &str) {
    assert_eq!(read_all(text), (frames.to_vec(), vec![(message.to_owned(), false)]));
}
