//! Every kind of bad CSV is refused with a one-line message that names file, line and column, and what came before it
//! is still delivered.
use crate::support::csv::{TWO_FRAMES, read_all, refused};

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
    let mixed = "column arc: some rows of frame 0 of object \"0\" have an arc and some do not: an outline is made of open arcs, each with its name, \
                 or of closed contours without one";
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
