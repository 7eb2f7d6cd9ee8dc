//! What is written is read back to the last bit, whatever the layout of the file and however it arrives.
use std::io::{self, Read};

use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_io::{OutlineFrame, OutlineReader, OutlineWriter, WriteError, WriterOptions};
use nalgebra::Point2;
use proptest::prelude::*;

/// Returns one byte per call.
struct OneByte<R>(R);

impl<R: Read> Read for OneByte<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = buffer.len().min(1);
        self.0.read(&mut buffer[..length])
    }
}

fn read(source: impl Read) -> Vec<OutlineFrame> {
    let reader = OutlineReader::new(source, "test").expect("a header");
    reader.collect::<Result<_, _>>().expect("only good outlines")
}

fn written(frames: &[OutlineFrame], options: WriterOptions) -> Vec<u8> {
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory never fails");
    for frame in frames {
        writer.write(frame).expect("the columns are there");
    }
    writer.finish().expect("memory never fails")
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![-1000.0..1000.0, Just(0.0), Just(-0.0), -1e99..1e99, (-1.0..1.0).prop_map(|x: f64| x * 1e-300)]
}

fn points(at_least: usize) -> impl Strategy<Value = Vec<Point2<f64>>> {
    prop::collection::vec((coordinate(), coordinate()).prop_map(|(x, y)| Point2::new(x, y)), at_least..30)
}

fn outline() -> impl Strategy<Value = Outline> {
    let closed = points(3)
        .prop_filter("the reader drops a closing point that repeats the first", |points| {
            points.first() != points.last()
        })
        .prop_filter_map("points on one line", |points| Outline::closed(points).ok());
    let arc = points(2).prop_filter_map("equal points", |points| OpenArc::new(points).ok());
    let open = prop::collection::vec(arc, 1..4)
        .prop_filter_map("points on one line", |arcs| OpenOutline::new(arcs).ok().map(Outline::Open));
    let deviation = prop_oneof![1e-3..10.0, 1e-300..1e-299, 1e99..1e100];
    let stated = prop::option::of(prop::collection::vec(deviation, 90));
    (prop_oneof![closed, open], stated).prop_map(|(outline, stated)| match stated {
        Some(stated) => {
            let of_points = stated[..outline.point_count()].to_vec();
            outline.with_deviations(of_points).expect("positive numbers")
        }
        None => outline,
    })
}

/// Frames with gaps in number and time, each showing some of the objects.
pub(crate) fn sequence() -> impl Strategy<Value = Vec<OutlineFrame>> {
    let names = prop::collection::btree_set("[a-z0-9 ,\"#\u{e4}]{0,6}".prop_map(|name| name.trim().to_owned()), 1..4);
    let step = (1..5_u64, 1e-9..1e3_f64);
    let frames = prop::collection::vec((step, prop::collection::vec(prop::option::of(outline()), 3)), 0..6);
    (names, frames).prop_map(|(names, frames)| {
        let (mut frame, mut time, mut sequence) = (0, -10.0, Vec::new());
        for ((frame_step, time_step), outlines) in frames {
            frame += frame_step;
            time += time_step;
            for (object, outline) in names.iter().zip(outlines) {
                let Some(outline) = outline else { continue };
                sequence.push(OutlineFrame { frame, time, object: object.clone(), outline });
            }
        }
        sequence
    })
}

/// Compares bit by bit, so that -0 and 0 differ.
fn assert_same(found: &[OutlineFrame], expected: &[OutlineFrame]) {
    assert_eq!(found, expected);
    let bits = |frames: &[OutlineFrame]| -> Vec<u64> {
        let numbers = |frame: &OutlineFrame| -> Vec<f64> {
            frame.outline.points().flat_map(|p| [p.x, p.y]).chain([frame.time]).collect()
        };
        frames.iter().flat_map(numbers).map(f64::to_bits).collect()
    };
    assert_eq!(bits(found), bits(expected));
}

/// The same table with its columns in another order, one unknown column more, comments, blank lines, white space and
/// other line ends.
fn rearranged(csv: &[u8], order: &[usize], line_end: &str, noise: &[bool], closed_last: bool) -> Vec<u8> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(csv);
    let mut out = String::from("\u{feff}# made for a test, with \"quotes\n");
    for (index, record) in reader.records().enumerate() {
        let record = record.expect("what the writer writes is CSV");
        let fields: Vec<String> = record.iter().chain(["extra"]).map(str::to_owned).collect();
        let order: Vec<usize> = order.iter().copied().filter(|column| *column < fields.len()).collect();
        let quoted = |field: &String| format!("\"{}\"", field.replace('"', "\"\""));
        let noisy = noise[index % noise.len()];
        let row: Vec<String> = order
            .iter()
            .map(|&column| match fields[column].parse::<f64>() {
                Ok(_) if noisy && column < 4 => format!("  {} ", fields[column]),
                _ => quoted(&fields[column]),
            })
            .collect();
        out += &row.join(",");
        out += line_end;
        if noisy {
            out += &format!("# comment, 1,2,3{line_end}{line_end}  {line_end}");
        }
    }
    if !closed_last {
        out.truncate(out.trim_end().len());
    }
    out.into_bytes()
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(frames in sequence()) {
        let all =
            WriterOptions { object_column: true, arc_column: true, deviation_column: true, ..WriterOptions::default() };
        assert_same(&read(written(&frames, all).as_slice()), &frames);
        let needed = WriterOptions::needed_for(&frames);
        assert_same(&read(written(&frames, needed).as_slice()), &frames);
    }

    #[test]
    fn the_layout_of_the_file_does_not_matter(
        frames in sequence(),
        order in Just((0..8).collect::<Vec<usize>>()).prop_shuffle(),
        line_end in prop_oneof![Just("\n"), Just("\r\n")],
        noise in prop::collection::vec(any::<bool>(), 1..20),
        closed_last in any::<bool>(),
    ) {
        let options = WriterOptions::needed_for(&frames);
        let csv = rearranged(&written(&frames, options), &order, line_end, &noise, closed_last);
        assert_same(&read(csv.as_slice()), &frames);
        assert_same(&read(OneByte(csv.as_slice())), &frames);
    }

    #[test]
    fn arbitrary_bytes_never_panic_and_give_one_line_messages(
        header in prop_oneof![Just("frame,time,x,y\n"), Just("x,y,arc,object,time,frame\n"), Just("")],
        bytes in prop::collection::vec(prop_oneof![
            prop::sample::select(b"0123456789.,-e\n\r\"# ".as_slice()), any::<u8>()], 0..300),
    ) {
        let input = [header.as_bytes(), &bytes].concat();
        let outcome = |source: &mut dyn Read| -> Vec<String> {
            match OutlineReader::new(source, "test") {
                Err(error) => vec![error.to_string()],
                Ok(reader) => reader.map(|item| match item {
                    Ok(frame) => format!("{frame:?}"),
                    Err(error) => error.to_string(),
                }).collect(),
            }
        };
        let whole = outcome(&mut input.as_slice());
        prop_assert!(whole.iter().all(|text| text.lines().count() == 1), "{whole:?}");
        prop_assert_eq!(whole, outcome(&mut OneByte(input.as_slice())));
    }
}

#[test]
fn a_repeated_closing_point_is_dropped_and_other_repetitions_are_kept() {
    let frames = read("frame,time,x,y\n0,0,0,0\n0,0,1,0\n0,0,1,0\n0,0,0,1\n0,0,0.0,0e5\n".as_bytes());
    let points: Vec<_> = frames[0].outline.points().map(|p| (p.x, p.y)).collect();
    assert_eq!(points, [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)]);
    assert!(matches!(frames[0].outline, Outline::Closed(_)));
}

#[test]
fn arcs_keep_their_order_and_are_not_closed() {
    let text = "frame,time,x,y,arc\n0,0,0,0,9\n0,0,1,0,9\n0,0,0,0,9\n0,0,5,5,3\n0,0,5,6,3\n";
    let frames = read(text.as_bytes());
    let pieces: Vec<_> = frames[0].outline.pieces().map(|piece| (piece.points.len(), piece.closed)).collect();
    assert_eq!(pieces, [(3, false), (2, false)]);
}

#[test]
fn an_outline_is_returned_before_the_rest_of_the_stream_is_read() {
    struct NoMore;
    impl Read for NoMore {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            panic!("read on although the outline was complete")
        }
    }
    let text = "frame,time,x,y\n0,0,0,0\n0,0,1,0\n0,0,0,1\n1,1,0,0\n";
    let mut reader = OutlineReader::new(text.as_bytes().chain(NoMore), "test").expect("a header");
    assert_eq!(reader.next().expect("an outline").expect("a triangle").frame, 0);
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let outline = Outline::closed(vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.0, 1.0)]);
    let outline = outline.expect("a triangle");
    let arc = OpenArc::new(vec![Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(1.0, 1.0)]);
    let arc = arc.expect("three points");
    let open = Outline::Open(OpenOutline::new(vec![arc]).expect("one arc"));
    let frame = |object: &str, time, outline: &Outline| OutlineFrame {
        frame: 3,
        time,
        object: object.to_owned(),
        outline: outline.clone(),
    };
    let mut plain = OutlineWriter::new(Vec::new(), WriterOptions::default()).expect("memory never fails");
    let named = plain.write(&frame("wing", 0.0, &outline));
    assert!(matches!(named, Err(WriteError::NoObjectColumn { .. })));
    assert!(matches!(plain.write(&frame("0", 0.0, &open)), Err(WriteError::NoArcColumn { frame: 3, .. })));
    assert!(matches!(plain.write(&frame("0", f64::NAN, &outline)), Err(WriteError::Time { .. })));
    let options = WriterOptions { object_column: true, arc_column: true, ..WriterOptions::default() };
    let mut full = OutlineWriter::new(Vec::new(), options).expect("memory never fails");
    for name in [" a", "a ", "a\nb", "\u{7f}"] {
        assert!(matches!(full.write(&frame(name, 0.0, &outline)), Err(WriteError::ObjectName { .. })), "{name:?}");
    }
    assert_eq!(plain.finish().expect("memory"), b"frame,time,x,y\n");
    assert_eq!(full.finish().expect("memory"), b"frame,time,x,y,object,arc\n");
}

#[test]
fn a_closed_pipe_keeps_its_kind() {
    struct Closed;
    impl io::Write for Closed {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::BrokenPipe.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut writer = OutlineWriter::new(Closed, WriterOptions::default()).expect("the header is buffered");
    let error = writer.flush().expect_err("the pipe is closed");
    assert!(matches!(error, WriteError::Io(cause) if cause.kind() == io::ErrorKind::BrokenPipe));
}

#[test]
fn rounded_numbers_are_short_and_right_to_the_resolution_asked_for() {
    let angle = |k: i32| std::f64::consts::TAU * f64::from(k) / 97.0;
    for (size, decimals) in [(1.0, 7), (250.0, 5), (2e-3, 10)] {
        let points = (0..97).map(|k| Point2::new(size * (3.0 + angle(k).cos()), -size * angle(k).sin())).collect();
        let outline = Outline::closed(points).expect("a circle");
        let frame = OutlineFrame { frame: 7, time: 7.0 / 30.0, object: "0".to_owned(), outline };
        let options = WriterOptions { resolution: Some(1e-7), ..WriterOptions::default() };
        let text = written(std::slice::from_ref(&frame), options);
        let again = read(text.as_slice());
        assert!((again[0].time - frame.time).abs() < 1e-9);
        for (p, q) in again[0].outline.points().zip(frame.outline.points()) {
            assert!((p - q).amax() <= 0.6e-7 * size, "{p} and {q}");
        }
        for line in String::from_utf8(text).expect("UTF-8").lines().skip(1) {
            let longest = line.split(',').skip(2).filter_map(|number| Some(number.split_once('.')?.1.len())).max();
            assert!(longest <= Some(decimals), "{line}");
        }
    }
}

#[test]
fn a_file_of_numpy_with_its_header_in_a_comment_and_frames_as_floats_is_read_as_one_with_a_header() {
    let rows = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0], [7.0, 0.0, 0.0], [7.0, 1.0, 0.5], [7.0, 0.0, 1.0]];
    let plain: String = rows.iter().map(|[frame, x, y]| format!("{frame},{},{x},{y}\n", 0.5 * frame)).collect();
    let numpy: String =
        rows.iter().map(|[frame, x, y]| format!("{frame:.18e},{:.18e},{x:e},{y:.3}\n", 0.5 * frame)).collect();
    let expected = read(format!("frame,time,x,y\n{plain}").as_bytes());
    assert_eq!(expected.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [0, 7]);
    for head in [
        "# frame,time,x,y\n",
        "#frame,time,x,y\r\n",
        "# of numpy\n# frame, time, x, y\n\n",
        "\u{feff}# frame,time,x,y\n",
    ] {
        for body in [&plain, &numpy] {
            let text = format!("{head}{body}");
            assert_eq!(read(text.as_bytes()), expected, "{text}");
            assert_eq!(read(OneByte(text.as_bytes())), expected, "byte by byte: {text}");
        }
    }
}

#[test]
fn an_error_below_a_commented_header_names_its_line_in_the_file() {
    let text = "# of numpy\n# frame,time,x,y\n0,0,0,0\n0,0,1,0\n0,0,one,1\n";
    let error = OutlineReader::new(text.as_bytes(), "in.csv").expect("a header").find_map(Result::err);
    assert_eq!(error.expect("an error").to_string(), "in.csv:5: column x: \"one\" is not a number");
    let text = "# frame,time,x,y\nzero,0,0,0\n0,0,1,0\n";
    let error = OutlineReader::new(text.as_bytes(), "in.csv").expect("a header").find_map(Result::err);
    let told = "in.csv:2: column frame: \"zero\" is not a frame number (a whole number, 0 or more)";
    assert_eq!(error.expect("an error").to_string(), told);
}
