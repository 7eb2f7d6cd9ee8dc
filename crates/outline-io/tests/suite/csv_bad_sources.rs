//! Sources that never end, that fail, or that hold something else than CSV are refused with a one-line message, in constant memory.
use std::error::Error as _;
use std::io::{self, Read};

use freeform_outline_io::{OutlineReader, ReadErrorKind};

use crate::support::csv::{TWO_FRAMES, read_all, read_from, refused};

#[test]
fn a_file_without_line_ends_does_not_fill_the_memory() {
    let message = "in.csv:8: no complete row within 1048576 bytes";
    let endless = TWO_FRAMES.as_bytes().chain(io::repeat(b'1'));
    assert_eq!(read_from(endless), (vec![0], vec![(message.to_owned(), false)]));
    // A quote that is never closed swallows line after line.
    let rest = "2,0.2,0,0\n".repeat(200_000);
    let (frames, errors) = read_all(format!("{TWO_FRAMES}2,0.2,\"0,0\n{rest}"));
    assert_eq!(frames, [0]);
    assert!(errors[0].0.ends_with("no complete row within 1048576 bytes"), "{errors:?}");
    // Neither does an endless binary file without a header.
    let (_, errors) = read_from(io::repeat(0));
    assert_eq!(errors, [("in.csv:1: no complete row within 1048576 bytes".to_owned(), false)]);
}

#[test]
fn an_outline_of_absurd_length_is_refused() {
    let rows = io::repeat(b'0').take(0).chain(Endless { row: b"2,0.2,0,0\n", at: 0 });
    let (frames, errors) = read_from(TWO_FRAMES.as_bytes().chain(rows));
    assert_eq!(frames, [0, 1]);
    assert_eq!(errors.len(), 1);
    assert!(errors[0].0.ends_with(": more than 4194304 points in frame 2 of object \"0\""), "{errors:?}");
}

/// The same row for ever.
struct Endless {
    row: &'static [u8],
    at: usize,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        for byte in buffer.iter_mut() {
            *byte = self.row[self.at % self.row.len()];
            self.at += 1;
        }
        Ok(buffer.len())
    }
}

#[test]
fn a_source_that_fails_is_told_with_its_cause() {
    struct Failing;
    impl Read for Failing {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::new(io::ErrorKind::ConnectionReset, "the camera is gone"))
        }
    }
    let source = TWO_FRAMES.as_bytes().chain(Failing);
    let mut reader = OutlineReader::new(source, "<stdin>").expect("the header comes before the failure");
    assert_eq!(reader.next().expect("frame 0").expect("frame 0").frame, 0);
    let error = reader.next().expect("the failure").expect_err("the failure");
    assert_eq!(error.to_string(), "<stdin>:8: the camera is gone");
    assert!(matches!(&error.kind, ReadErrorKind::Io(cause) if cause.kind() == io::ErrorKind::ConnectionReset));
    assert!(error.source().is_some());
    assert!(reader.next().is_none());
}

#[test]
fn a_file_that_cannot_be_opened_is_named() {
    let error = OutlineReader::open("/nowhere/a\nb.csv").expect_err("no such file");
    assert_eq!(error.to_string(), "/nowhere/a\\nb.csv: No such file or directory (os error 2)");
    let folder = tempfile::tempdir().expect("a folder");
    let error = OutlineReader::open(folder.path()).expect_err("a folder is no file");
    assert!(matches!(error.kind, ReadErrorKind::Io(_)), "{error}");
}

#[test]
fn comments_and_empty_lines_may_have_any_length() {
    let comment = "# ".to_owned() + &"x".repeat(78) + "\n";
    let many = comment.repeat(40_000) + &"\n".repeat(2_000_000) + "#" + &"y".repeat(3_000_000) + "\n";
    let rest = many.clone() + &TWO_FRAMES[15..];
    assert_eq!(read_all(many + "frame,time,x,y\n" + &rest), (vec![0, 1], vec![]));
}

#[test]
fn a_quote_that_is_never_closed_is_told_though_comments_seem_to_follow() {
    let text = "frame,time,x,y\n0,0,\"1\n".to_owned() + &"# a comment within quotes\n".repeat(100_000);
    refused(text, &[], "in.csv:40332: no complete row within 1048576 bytes");
}

#[test]
fn what_is_no_csv_is_named_for_what_it_is() {
    let utf16 = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let message = "in.csv: the text is UTF-16, expected UTF-8: save it as such, or use iconv -f UTF-16 -t UTF-8";
    refused([b"\xff\xfe".to_vec(), utf16(TWO_FRAMES)].concat(), &[], message);
    refused(utf16(TWO_FRAMES), &[], message);
    let message = "in.csv: compressed with gzip: unpack it, such as by a pipe: gzip -dc FILE | ...";
    refused(b"\x1f\x8b\x08\0\0\0\0\0\0\x03".as_slice(), &[], message);
    let message = "in.csv: compressed with zstd: unpack it, such as by a pipe: zstd -dc FILE | ...";
    refused(b"\x28\xb5\x2f\xfd\x24\0".as_slice(), &[], message);
    let returns = TWO_FRAMES.replace('\n', "\r");
    let message = "the lines end with carriage returns alone, expected line feeds: use tr '\\r' '\\n'";
    refused(&returns, &[], &format!("in.csv: {message}"));
    refused(returns.repeat(20_000), &[], &format!("in.csv:1: {message}"));
    refused(format!("# a comment\r{returns}"), &[], &format!("in.csv: {message}"));
}
