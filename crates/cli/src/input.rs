//! Outlines from a file or standard input.
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;

use freeform_motion::outline_io::{OutlineReader, ReadError};

use crate::failure::{Failure, plain};
use crate::truth::SimulatedMotion;

/// Longest head of comment lines that is looked through for the truth, in bytes.
const HEAD_LIMIT: u64 = 1 << 16;

/// A sequence of outlines, open for reading.
pub(crate) struct Input {
    /// The file's name as it stands in messages.
    pub(crate) name: String,
    /// The motion that the head of the file says it was simulated with.
    pub(crate) truth: Option<SimulatedMotion>,
    /// The outlines.
    pub(crate) outlines: OutlineReader<Box<dyn Read>>,
}

impl Input {
    /// Opens a file, or standard input where the path is `-`, and reads its head.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            return Self::from_source(io::stdin().lock(), "<stdin>".to_owned());
        }
        let name = path.display().to_string();
        match File::open(path) {
            Ok(file) => Self::from_source(BufReader::new(file), name),
            Err(error) => Err(Failure::unusable(format_args!("{name}: {}", plain(&error)))),
        }
    }

    fn from_source(mut source: impl BufRead + 'static, name: String) -> Result<Self, Failure> {
        let head = comment_lines(&mut source).map_err(|error| Failure::unusable(format_args!("{name}: {error}")))?;
        let truth = String::from_utf8_lossy(&head)
            .lines()
            .find_map(|line| SimulatedMotion::parse(line.trim_start_matches('#')));
        // The head is read again with the rest, so that line numbers are right.
        let whole: Box<dyn Read> = Box::new(Cursor::new(head).chain(source));
        let outlines = OutlineReader::new(whole, name.clone()).map_err(|error| unreadable(&error))?;
        Ok(Self { name, truth, outlines })
    }
}

/// What is said of a file that cannot be read.
pub(crate) fn unreadable(error: &ReadError) -> Failure {
    Failure::unusable(error)
}

/// The lines at the beginning that start with `#`. Nothing beyond them is taken from the source.
fn comment_lines(source: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    loop {
        let buffer = match source.fill_buf() {
            Ok(buffer) => buffer,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let left = HEAD_LIMIT.saturating_sub(head.len() as u64);
        if buffer.first() != Some(&b'#') || left == 0 {
            return Ok(head);
        }
        source.by_ref().take(left).read_until(b'\n', &mut head)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_ends_where_the_comments_end_and_the_rest_stays_in_the_source() {
        let mut source = BufReader::with_capacity(4, &b"# one\n# two\nframe,time,x,y\n# later\n"[..]);
        assert_eq!(comment_lines(&mut source).expect("memory"), b"# one\n# two\n");
        let mut rest = String::new();
        source.read_to_string(&mut rest).expect("memory");
        assert_eq!(rest, "frame,time,x,y\n# later\n");
    }

    #[test]
    fn an_endless_comment_is_not_read_to_its_end() {
        let mut source = BufReader::new(io::repeat(b'#'));
        assert_eq!(comment_lines(&mut source).expect("no error").len() as u64, HEAD_LIMIT);
    }
}
