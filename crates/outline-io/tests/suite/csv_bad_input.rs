//! Every kind of bad CSV is refused with a one-line message that names file, line and column, and what came before it
//! is still delivered.
use std::error::Error as _;
use std::io::{self, Read};

use freeform_outline_io::{OutlineReader, ReadError, ReadErrorKind};

/// One triangle per frame, lines 2 to 4 and 5 to 7.
const TWO_FRAMES: &str = "frame,time,x,y\n0,0.0,0,0\n0,0.0,1,0\n0,0.0,0,1\n1,0.1,0,0\n1,0.1,1,0\n1,0.1,0,1\n";

/// Frames read until the reader ends, and all errors as (message, recoverable).
fn read_all(text: impl AsRef<[u8]>) -> (Vec<u64>, Vec<(String, bool)>) {
    read_from(text.as_ref())
}

fn read_from(source: impl Read) -> (Vec<u64>, Vec<(String, bool)>) {
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
fn refused(text: impl AsRef<[u8]>, frames: &[u64], message: &str) {
    assert_eq!(read_all(text), (frames.to_vec(), vec![(message.to_owned(), false)]));
}

/// The two frames with one more row.
fn with_row(row: &str) -> String {
    format!("{TWO_FRAMES}{row}")
}

#[test]
fn an_empty_file_is_refused() {
    let message = "in.csv: the file is empty, expected a header such as frame,time,x,y";
    refused("", &[], message);
    refused("\n \r\n\n", &[], message);
    refused("# nothing but a comment", &[], message);
}

#[test]
fn a_header_without_rows_holds_no_outline() {
    assert_eq!(read_all("frame,time,x,y\n"), (vec![], vec![]));
    assert_eq!(read_all("frame,time,x,y"), (vec![], vec![]));
}

#[test]
fn columns_that_are_separated_by_something_else_than_commas_are_told_so() {
    let missing = "in.csv:1: missing column(s) frame, time, x, y, the header is";
    let semicolons = format!("{missing} \"frame;time;x;y\": columns are separated by commas, not by semicolons");
    refused("frame;time;x;y\n0;0;1;2\n", &[], &semicolons);
    let tabs = format!("{missing} \"frame\\ttime\\tx\\ty\": columns are separated by commas, not by tabs");
    refused("frame\ttime\tx\ty\n0\t0\t1\t2\n", &[], &tabs);
    let spaces = format!("{missing} \"frame time x y\": columns are separated by commas, not by spaces");
    refused("frame time x y\n0 0 1 2\n", &[], &spaces);
    refused(
        "# frame time x y\n0.0 0 1 2\n",
        &[],
        &spaces.replace(":1:", ":2:").replace("\"frame time x y\"", "\"0.0 0 1 2\""),
    );
}

#[test]
fn missing_columns_are_named_with_the_header_found() {
    refused(
        "frame,x,y\n0,1,2\n",
        &[],
        "in.csv:1: missing column(s) time, the header is \"frame,x,y\"; give the time of each frame in seconds in a column named time",
    );
    refused("# a\n\nhello\n", &[], "in.csv:3: missing column(s) frame, time, x, y, the header is \"hello\"");
    refused(
        "Frame,time,x,y\n",
        &[],
        "in.csv:1: missing column(s) frame, the header is \"Frame,time,x,y\"; names of columns are in lower case",
    );
    let long = format!("{}\n", "abc,".repeat(100));
    let start = "abc,".repeat(10);
    refused(long, &[], &format!("in.csv:1: missing column(s) frame, time, x, y, the header is \"{start}...\""));
}

#[test]
fn a_file_without_a_header_is_told_to_get_one_where_the_comment_before_it_is_none() {
    let told =
        "that is a row of numbers: add a line before it that names the columns, without # (numpy.savetxt: comments='')";
    let missing = "missing column(s) frame, time, x, y, the header is \"0,0,1,2\"";
    for head in ["", "# frame,time,x,y,z\n", "# frame,t,x,y\n", "# frame,time,x,y\n# made by hand\n"] {
        let line = head.lines().count() + 1;
        refused(format!("{head}0,0,1,2\n"), &[], &format!("in.csv:{line}: {missing}; {told}"));
    }
}

#[test]
fn a_column_named_twice_is_refused() {
    refused("frame,time,x,y,x\n", &[], "in.csv:1: column x: the header names this column twice");
    refused("arc,frame,time,x,y,arc\n", &[], "in.csv:1: column arc: the header names this column twice");
}

#[test]
fn text_in_a_number_column_is_quoted() {
    refused(with_row("2,0.2,one,0\n"), &[0, 1], "in.csv:8: column x: \"one\" is not a number");
    refused(with_row("2,0.2,0,\"1;5\"\n"), &[0, 1], "in.csv:8: column y: \"1;5\" is not a number");
    refused(with_row("2,soon,0,0\n"), &[0, 1], "in.csv:8: column time: \"soon\" is not a number");
    refused(
        with_row("2,0.2,0,\n"),
        &[0, 1],
        "in.csv:8: column y: the field is empty, expected a number: fill it in, or leave out the point",
    );
    refused(
        with_row("2, ,0,0\n"),
        &[0, 1],
        "in.csv:8: column time: the field is empty, expected a number: fill it in, or leave out the point",
    );
    refused(with_row("2,0.2,\"a\nb\",0\n"), &[0, 1], "in.csv:8: column x: \"a\\nb\" is not a number");
    let start = "z".repeat(40);
    refused(
        with_row(&format!("2,0.2,{},0\n", "z".repeat(5000))),
        &[0, 1],
        &format!("in.csv:8: column x: \"{start}...\" is not a number"),
    );
}

#[test]
fn numbers_that_are_not_finite_or_too_large_are_refused() {
    for text in ["nan", "NaN", "inf", "-inf", "Infinity", "1e400"] {
        let message = format!("in.csv:8: column y: \"{text}\" is not a finite number: leave out the point");
        refused(with_row(&format!("2,0.2,0,{text}\n")), &[0, 1], &message);
    }
    refused(
        with_row("2,inf,0,0\n"),
        &[0, 1],
        "in.csv:8: column time: \"inf\" is not a finite number: leave out the point",
    );
    refused(with_row("2,0.2,-1e300,0\n"), &[0, 1], "in.csv:8: column x: -1e300 is beyond 1e100");
}

#[test]
fn a_frame_number_is_a_whole_number_from_0() {
    for text in ["-1", "1.5", "-2.0", "two", "1e300", "inf", "nan", "99999999999999999999"] {
        let message = format!("in.csv:8: column frame: \"{text}\" is not a frame number (a whole number, 0 or more)");
        refused(with_row(&format!("{text},0.2,0,0\n")), &[0], &message);
    }
    refused(
        with_row(",0.2,0,0\n"),
        &[0],
        "in.csv:8: column frame: the field is empty, expected a number: fill it in, or leave out the point",
    );
}

#[test]
fn an_outline_that_the_bad_row_may_belong_to_is_not_delivered() {
    // Frame 1 may be incomplete: the bad row is one of its own, or does not tell.
    refused(with_row("1,0.1,bad,0\n"), &[0], "in.csv:8: column x: \"bad\" is not a number");
    refused(
        with_row("?,0.1,0,0\n"),
        &[0],
        "in.csv:8: column frame: \"?\" is not a frame number (a whole number, 0 or more)",
    );
    // The frame number of this row is whole and another: frame 1 is complete.
    refused(with_row("2,0."), &[0, 1], "in.csv:8: the last line is cut short: 2 field(s), the header has 4");
    // This one may be cut from 12 or from 1.
    refused(with_row("1"), &[0], "in.csv:8: the last line is cut short: 1 field(s), the header has 4");
    refused(with_row("2"), &[0], "in.csv:8: the last line is cut short: 1 field(s), the header has 4");
}

#[test]
fn time_must_increase_for_every_object() {
    let message = |time| {
        format!(
            "in.csv:8: column time: time {time} of frame 2 of object \"0\" is not after 0.1, the time of its frame before"
        )
    };
    refused(with_row("2,0.05,0,0\n"), &[0, 1], &message("0.05"));
    refused(with_row("2,0.1,0,0\n"), &[0, 1], &message("0.1"));

    let two_objects = "object,frame,time,x,y\n\
        a,0,5,0,0\na,0,5,1,0\na,0,5,0,1\n\
        b,0,1,0,0\nb,0,1,1,0\nb,0,1,0,1\n\
        b,1,2,0,0\nb,1,2,1,0\nb,1,2,0,1\n";
    assert_eq!(read_all(two_objects), (vec![0, 0, 1], vec![]), "each object has its own time");
    refused(
        format!("{two_objects}a,1,4,0,0\n"),
        &[0, 0, 1],
        "in.csv:11: column time: time 4 of frame 1 of object \"a\" is not after 5, the time of its frame before",
    );
}

#[test]
fn frame_numbers_must_increase_for_every_object() {
    let three = with_row("5,0.5,0,0\n5,0.5,1,0\n5,0.5,0,1\n");
    let message = "in.csv:11: column frame: frame 3 of object \"0\" comes after its frame 5: order the rows by frame";
    refused(format!("{three}3,0.7,0,0\n"), &[0, 1, 5], message);
}

#[test]
fn one_object_has_one_outline_per_frame() {
    let interrupted = "frame,time,x,y,object\n\
        0,0,0,0,a\n0,0,1,0,a\n0,0,0,1,a\n\
        0,0,0,0,b\n0,0,1,0,b\n0,0,0,1,b\n\
        0,0,5,5,a\n";
    refused(
        interrupted,
        &[0, 0],
        "in.csv:8: column frame: second outline of object \"a\" in frame 0: the rows of one outline must follow each other",
    );
}

#[test]
fn time_is_the_same_throughout_an_outline() {
    refused(
        with_row("1,0.2,0,0\n"),
        &[0],
        "in.csv:8: column time: the time changes from 0.1 to 0.2 within frame 1 of object \"0\"",
    );
}

#[test]
fn rows_with_too_few_or_too_many_fields_are_refused() {
    refused(with_row("2,0.2,1\n"), &[0, 1], "in.csv:8: 3 field(s), the header has 4");
    refused(with_row("2,0.2,1,5,7\n3,0.3,0,0\n"), &[0, 1], "in.csv:8: 5 field(s), the header has 4");
    refused(with_row("2,0.2,1,5,7"), &[0, 1], "in.csv:8: 5 field(s), the header has 4");
}

#[test]
fn a_last_line_that_is_cut_short_is_refused() {
    let whole = TWO_FRAMES.trim_end();
    assert_eq!(read_all(whole), (vec![0, 1], vec![]), "only the line end is missing");
    refused(&whole[..whole.len() - 2], &[0], "in.csv:7: the last line is cut short: 3 field(s), the header has 4");
    refused(
        &whole[..whole.len() - 1],
        &[0],
        "in.csv:7: column y: the field is empty, expected a number: fill it in, or leave out the point",
    );
    refused(with_row("2,0.2,1,2e-"), &[0, 1], "in.csv:8: column y: \"2e-\" is not a number");
}

#[test]
fn a_degenerate_outline_is_recoverable_and_names_its_lines() {
    let text = "frame,time,x,y\n\
        0,0.0,0,0\n0,0.0,1,0\n0,0.0,0,1\n\
        # one point\n\
        1,0.1,7,7\n\
        2,0.2,3,3\n2,0.2,3,3\n2,0.2,3,3\n2,0.2,3,3\n\n\
        3,0.3,0,0\n3,0.3,1,1\n# between\n3,0.3,2,2\n\
        4,0.4,0,0\n4,0.4,1,0\n4,0.4,0,1\n\
        5,0.5,1,1\n5,0.5,2,2";
    let errors = [
        "in.csv:6-6: frame 1 of object \"0\": 1 point(s), at least 3 are needed",
        "in.csv:7-10: frame 2 of object \"0\": all 3 points are equal",
        "in.csv:12-15: frame 3 of object \"0\": all 3 points lie on one line",
        "in.csv:19-20: frame 5 of object \"0\": 2 point(s), at least 3 are needed",
    ];
    let errors = errors.map(|message| (message.replace("6-6", "6"), true));
    assert_eq!(read_all(text), (vec![0, 4], errors.to_vec()));
}

#[test]
fn a_degenerate_outline_before_a_bad_row_is_told_too() {
    let text = "frame,time,x,y\n0,0,0,0\n1,x,0,0\n";
    let told = vec![
        ("in.csv:2: frame 0 of object \"0\": 1 point(s), at least 3 are needed".to_owned(), true),
        ("in.csv:3: column time: \"x\" is not a number".to_owned(), false),
    ];
    assert_eq!(read_all(text), (vec![], told));
}

#[test]
fn arcs_without_two_points_are_dropped_unless_nothing_remains() {
    let header = "frame,time,x,y,arc\n";
    let good = "0,0,0,0,a\n0,0,1,0,a\n0,0,1,1,a\n";
    assert_eq!(read_all(format!("{header}{good}0,0,5,5,b\n0,0,6,6,c\n0,0,6,6,c\n")), (vec![0], vec![]));
    let message = "in.csv:2-4: frame 0 of object \"0\": 1 point(s), at least 2 are needed";
    let none = format!("{header}0,0,5,5,b\n0,0,6,6,c\n0,0,6,6,c\n");
    assert_eq!(read_all(none), (vec![], vec![(message.to_owned(), true)]));
}

#[test]
fn arcs_are_consecutive_and_not_mixed_with_closed_rows() {
    let text = "frame,time,x,y,arc\n0,0,0,0,a\n0,0,1,0,a\n0,0,1,1,b\n0,0,2,1,b\n";
    refused(
        format!("{text}0,0,3,3,a\n"),
        &[],
        "in.csv:6: column arc: arc \"a\" comes a second time in frame 0 of object \"0\": its rows must follow each other",
    );
    let mixed = "column arc: some rows of frame 0 of object \"0\" have an arc and some do not";
    refused(format!("{text}0,0,3,3,\n"), &[], &format!("in.csv:6: {mixed}"));
    refused("frame,time,x,y,arc\n0,0,0,0,\n0,0,1,0,1\n", &[], &format!("in.csv:3: {mixed}"));
}

#[test]
fn invalid_utf_8_is_refused_where_it_matters() {
    let bad = |row: &[u8]| [b"frame,time,x,y,object,note\n".as_slice(), row].concat();
    refused(bad(b"0,0,0,0,\xff\xfe,n\n"), &[], "in.csv:2: column object: \"\u{fffd}\u{fffd}\" is not valid UTF-8");
    refused(bad(b"0,0,\xff1,0,a,n\n"), &[], "in.csv:2: column x: \"\u{fffd}1\" is not valid UTF-8");
    let ignored = bad(b"0,0,0,0,a,\xff\n0,0,1,0,a,\xff\n0,0,0,1,a,\xff\n");
    assert_eq!(read_all(ignored), (vec![0], vec![]));
}

#[test]
fn a_file_without_line_ends_does_not_fill_the_memory() {
    let message = "in.csv:8: no complete row within 1048576 bytes";
    let endless = TWO_FRAMES.as_bytes().chain(io::repeat(b'1'));
    assert_eq!(read_from(endless), (vec![0], vec![(message.to_owned(), false)]));
    // A quote that is never closed swallows line after line.
    let rest = "2,0.2,0,0\n".repeat(200_000);
    let (frames, errors) = read_all(with_row(&format!("2,0.2,\"0,0\n{rest}")));
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

#[test]
fn deviations_that_are_none_are_refused_and_those_of_some_points_alone_leave_the_outline_out() {
    let with = |cells: [&str; 3]| {
        let points = ["0,0", "1,0", "0,1"];
        let rows = points.iter().zip(cells).map(|(point, cell)| format!("0,0.0,{point},{cell}\n"));
        format!("frame,time,x,y,deviation\n{}", rows.collect::<String>())
    };
    assert_eq!(read_all(with(["0.1", "2", "1e-3"])), (vec![0], vec![]));
    assert_eq!(read_all(with(["", " ", ""])), (vec![0], vec![]));
    let none = "is not a standard deviation (a number above 0, or nothing)";
    refused(with(["0.1", "0", "0.1"]), &[], &format!("in.csv:3: column deviation: 0 {none}"));
    refused(with(["-0.1", "0.1", "0.1"]), &[], &format!("in.csv:2: column deviation: -0.1 {none}"));
    refused(with(["0.1", "0.1", "wide"]), &[], "in.csv:4: column deviation: \"wide\" is not a number");
    let (frames, errors) = read_all(with(["0.1", "", "0.1"]));
    assert_eq!((frames, errors.len()), (vec![], 1));
    assert!(errors[0].1 && errors[0].0.contains("2 standard deviation(s) for 3 points"), "{errors:?}");
}
