//! The comment lines at the head of a file.
use std::io::{self, BufRead, Read as _};

/// Longest head of comment lines that is read, in bytes.
const LONGEST_HEAD: u64 = 1 << 16;

/// The comment lines that a file of outlines begins with: the lines that start with `#`, up to 64 KiB of them. Nothing beyond them is taken from the
/// source.
///
/// ```
/// use freeform_outline_io::read_comments;
///
/// let mut source = &b"# truth omega=1 b1=0 b2=0 scale=1\nframe,time,x,y\n"[..];
/// assert_eq!(read_comments(&mut source)?, b"# truth omega=1 b1=0 b2=0 scale=1\n");
/// assert_eq!(source, b"frame,time,x,y\n");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
///
/// Those of the source.
pub fn read_comments(source: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    loop {
        let buffer = match source.fill_buf() {
            Ok(buffer) => buffer,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let left = LONGEST_HEAD.saturating_sub(head.len() as u64);
        if buffer.first() != Some(&b'#') || left == 0 {
            return Ok(head);
        }
        source.by_ref().take(left).read_until(b'\n', &mut head)?;
    }
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    #[test]
    fn the_head_ends_where_the_comments_end_and_the_rest_stays_in_the_source() {
        let mut source = BufReader::with_capacity(4, &b"# one\n# two\nframe,time,x,y\n# later\n"[..]);
        assert_eq!(read_comments(&mut source).expect("memory"), b"# one\n# two\n");
        let mut rest = String::new();
        source.read_to_string(&mut rest).expect("memory");
        assert_eq!(rest, "frame,time,x,y\n# later\n");
    }

    #[test]
    fn an_endless_comment_is_not_read_to_its_end() {
        let mut source = BufReader::new(io::repeat(b'#'));
        assert_eq!(read_comments(&mut source).expect("no error").len() as u64, LONGEST_HEAD);
    }
}
