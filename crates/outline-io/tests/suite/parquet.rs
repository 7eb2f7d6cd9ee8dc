//! Parquet as others write it and as we do, and files that are damaged or lie.
use std::path::PathBuf;

use freeform_curve_fit::Outline;
use freeform_outline_io::{
    OutlineFrame, OutlineReader, OutlineWriter, ParquetReader, ParquetWriter, ReadError, ReadErrorKind, Span,
    WriterOptions, read_shape,
};
use nalgebra::Point2;
use proptest::prelude::*;

use crate::csv_round_trip::sequence;

/// A file of tests/data/parquet; make.py there tells what made it.
pub(crate) fn sample(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/parquet").join(name)
}

pub(crate) fn parquet_of(frames: &[OutlineFrame], options: WriterOptions) -> Vec<u8> {
    let mut writer = ParquetWriter::new(Vec::new(), options, &[]).expect("memory");
    frames.iter().for_each(|frame| writer.write(frame).expect("the columns are there"));
    writer.finish().expect("memory")
}

pub(crate) fn read(bytes: &[u8]) -> Result<Vec<OutlineFrame>, ReadError> {
    ParquetReader::from_bytes(bytes.to_vec(), "test")?.collect()
}

/// The outlines of the samples that are read.
pub(crate) fn expected() -> Vec<OutlineFrame> {
    let outline = |points: &[(f64, f64)]| {
        Outline::closed(points.iter().map(|(x, y)| Point2::new(*x, *y)).collect()).expect("an outline")
    };
    let frame = |frame, time, outline| OutlineFrame { frame, time, object: "left".to_owned(), outline };
    vec![
        frame(3, 0.0, outline(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)])),
        frame(4, 0.1, outline(&[(0.5, 0.0), (2.5, 0.0), (0.5, 1.0)])),
        frame(6, 0.3, outline(&[(1.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0)])),
    ]
}

#[test]
fn tables_of_pyarrow_pandas_and_polars_are_read_whatever_their_types_encodings_and_order() {
    let mut count = 0;
    for file in std::fs::read_dir(sample("")).expect("the samples") {
        let path = file.expect("a file").path();
        if path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("good-")) {
            let frames: Result<Vec<_>, _> = ParquetReader::open(&path).expect("a table").collect();
            assert_eq!(frames.expect("outlines"), expected(), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 10, "{count}");
}

#[test]
fn arcs_in_lists_and_in_rows_of_any_order_are_the_same_outline() {
    let [lists, rows] = ["arcs-lists.parquet", "arcs-rows.parquet"].map(|name| {
        let frames: Result<Vec<_>, _> = ParquetReader::open(sample(name)).expect("a table").collect();
        frames.expect("outlines")
    });
    assert_eq!(lists, rows);
    assert!(matches!(&lists[0].outline, Outline::Open(open) if open.arcs().len() == 2));
}

#[test]
fn a_file_that_cannot_be_used_is_refused_with_row_and_column() {
    for (name, expected) in [
        ("bad-null-list", "row 1: column x: the field is empty, expected a number: fill it in, or leave out the point"),
        (
            "bad-null-value",
            "row 1: column y: the field is empty, expected a number: fill it in, or leave out the point",
        ),
        ("bad-nan", "row 2: column x: \"NaN\" is not a finite number: leave out the point"),
        ("bad-length", "row 1: column y: 2 value(s), column x has 3 in this row"),
        ("bad-text", "column x: the type is lists of BYTE_ARRAY (String), expected lists of numbers, or numbers"),
        ("bad-struct", "column x: the type is struct, expected lists of numbers, or numbers"),
        ("bad-nested", "column x: the type is lists of lists of DOUBLE, expected lists of numbers, or numbers"),
        ("bad-time", "column time: the type is INT64 (Timestamp"),
        ("bad-frame", "row 1: column frame: \"-4\" is not a frame number (a whole number, 0 or more)"),
        ("bad-frame-fraction", "row 1: column frame: \"4.5\" is not a frame number (a whole number, 0 or more)"),
        (
            "bad-null-frame",
            "row 1: column frame: the field is empty, expected a number: fill it in, or leave out the point",
        ),
        ("bad-name", "row 1: column object: the name is missing"),
        ("bad-codec", "compressed with Brotli"),
        ("bad-encoding", "column frame: the Parquet file cannot be read: values encoded as DELTA_BINARY_PACKED"),
        ("bad-columns", "missing column(s) time, x, the header is \"y,note,frame,object\""),
        ("bad-twice", "column x: the header names this column twice"),
        ("bad-second", "row 2: column frame: second outline of object \"left\" in frame 4"),
        ("bad-arc-length", "row 1: column arc: 2 value(s), column x has 3 in this row"),
        ("bad-arc", "row 0: column arc: \"0.5\" is not a whole number"),
        ("bad-time-order", "row 2: column time: time 0.1 of frame 6 of object \"left\" is not after 0.3"),
        ("bad-mixed-lists", "column y: the type is DOUBLE, expected lists, as column x has"),
    ] {
        let path = sample(&format!("{name}.parquet"));
        let error = ParquetReader::open(&path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let message = error.expect_err(name).to_string();
        assert!(message.contains(expected), "{name}: {message}");
        assert!(message.starts_with(&path.display().to_string()) && message.lines().count() == 1, "{message}");
    }
}

#[test]
fn outlines_before_a_bad_row_are_returned_before_the_error() {
    for (name, whole) in [("bad-nan", 2), ("bad-length", 1), ("bad-frame", 1), ("bad-second", 1), ("bad-arc", 0)] {
        let reader = ParquetReader::open(sample(&format!("{name}.parquet"))).expect("a table");
        let items: Vec<_> = reader.collect();
        assert_eq!(
            items.iter().map(Result::is_ok).collect::<Vec<_>>(),
            [vec![true; whole], vec![false]].concat(),
            "{name}"
        );
    }
}

#[test]
fn a_row_without_points_is_no_outline_and_the_reading_goes_on() {
    let items: Vec<_> = ParquetReader::open(sample("degenerate.parquet")).expect("a table").collect();
    let error = items[1].as_ref().expect_err("no points");
    assert!(error.is_recoverable() && error.place.span == Some(Span::Rows(1, 1)), "{error}");
    assert!(items.len() == 3 && items[0].is_ok() && items[2].is_ok());
}

#[test]
fn the_first_outline_of_a_table_serves_as_a_shape() {
    let shape = read_shape(sample("good-arrow.parquet")).expect("a shape");
    assert_eq!(shape, expected()[0].outline);
    assert!(read_shape(sample("arcs-lists.parquet")).is_err());
}

#[test]
fn parquet_in_a_stream_and_what_is_no_parquet_are_told() {
    let bytes = parquet_of(&expected(), WriterOptions::default());
    let error = OutlineReader::new(&bytes[..], "<stdin>").expect_err("no text");
    assert!(matches!(error.kind, ReadErrorKind::ParquetStream), "{error}");
    for bytes in [&b""[..], b"PAR1", b"frame,time,x,y\n0,0,0,0\n0,0,1,1\n"] {
        assert!(matches!(read(bytes).expect_err("no table").kind, ReadErrorKind::NotParquet));
    }
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused() {
    let bytes = parquet_of(&expected(), WriterOptions { arc_column: true, ..WriterOptions::default() });
    for length in 0..bytes.len() {
        assert!(read(&bytes[..length]).is_err(), "{length} bytes of {}", bytes.len());
    }
}

#[test]
fn no_changed_byte_brings_the_reader_down() {
    let mut files = vec![parquet_of(
        &expected(),
        WriterOptions { arc_column: true, contour_column: true, ..WriterOptions::default() },
    )];
    for name in
        ["good-arrow", "good-gzip", "good-zstd", "good-encodings", "good-polars", "good-points", "deviations-arrow"]
    {
        files.push(std::fs::read(sample(&format!("{name}.parquet"))).expect("a sample"));
    }
    for bytes in files {
        for at in 0..bytes.len() {
            for value in [0, 0x7f, 0xff, bytes[at] ^ 1, bytes[at].wrapping_add(0x10)] {
                let mut changed = bytes.clone();
                changed[at] = value;
                if let Err(error) = read(&changed) {
                    let message = error.to_string();
                    assert!(message.starts_with("test") && !message.contains('\n'), "{message:?}");
                }
            }
        }
    }
}

#[test]
fn a_short_file_with_very_many_copies_of_an_outline_ends_with_a_word() {
    let triangle = Outline::closed([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec());
    let triangle = triangle.expect("an outline");
    let at_rest =
        |frame: u64| OutlineFrame { frame, time: frame as f64, object: "0".into(), outline: triangle.clone() };
    let frames: Vec<_> = (0..120_000).map(at_rest).collect();
    let bytes = parquet_of(&frames, WriterOptions::default());
    let mut reader = ParquetReader::from_bytes(bytes.clone(), "test").expect("a table");
    let limit = (1 << 14) + bytes.len() / 32;
    assert!(limit < frames.len(), "{limit}");
    let read: Vec<_> = reader.by_ref().take_while(Result::is_ok).collect();
    assert_eq!(read.len(), limit);
    let error = ParquetReader::from_bytes(bytes, "test").expect("a table").find_map(Result::err).expect("an error");
    assert!(
        matches!(error.kind, ReadErrorKind::UnpacksToTooMuch { outlines, .. } if outlines as usize == limit),
        "{error}"
    );
}

#[test]
fn a_schema_without_end_is_refused() {
    // FileMetaData with a version and a schema of so many groups of one child within each other.
    let depth = 100_000_u32;
    let mut footer = vec![0x15, 0x02, 0x19, 0xfc];
    let mut count = depth;
    while count >= 0x80 {
        footer.push((count & 0x7f) as u8 | 0x80);
        count >>= 7;
    }
    footer.push(count as u8);
    for _ in 0..depth {
        // Required, named "a", one child.
        footer.extend([0x35, 0x00, 0x18, 0x01, b'a', 0x15, 0x02, 0x00]);
    }
    let mut file = b"PAR1".to_vec();
    file.extend(&footer);
    file.extend((footer.len() as u32).to_le_bytes());
    file.extend(b"PAR1");
    let message = read(&file).expect_err("too deep").to_string();
    assert!(message.contains("too deep"), "{message}");
}

#[test]
fn row_groups_are_written_before_the_end_and_their_order_does_not_matter() {
    let frames: Vec<OutlineFrame> = (0..300)
        .map(|frame| {
            let angle = |i: i32| f64::from(i) * 1e-3;
            let points = (0..6283).map(|i| Point2::new(angle(i).cos() + frame as f64, angle(i).sin())).collect();
            let outline = Outline::closed(points).expect("a circle");
            OutlineFrame { frame, time: frame as f64, object: "0".to_owned(), outline }
        })
        .collect();
    let bytes = parquet_of(&frames, WriterOptions::default());
    assert_eq!(read(&bytes).expect("outlines"), frames);
    let mut backwards = frames.clone();
    backwards.reverse();
    assert_eq!(read(&parquet_of(&backwards, WriterOptions::default())).expect("outlines"), frames);
}

#[test]
fn comments_and_rounding_are_those_of_csv() {
    let options = WriterOptions { resolution: Some(1e-3), object_column: true, ..WriterOptions::default() };
    let comments = ["one".to_owned(), "truth omega=1".to_owned()];
    let mut frames = expected();
    frames[1].time = 0.123_456_789_123;
    frames.iter_mut().for_each(|frame| {
        let points = frame.outline.points().map(|point| point * std::f64::consts::PI).collect();
        frame.outline = Outline::closed(points).expect("an outline");
    });
    let mut writer = ParquetWriter::new(Vec::new(), options, &comments).expect("memory");
    let mut csv = OutlineWriter::new(Vec::new(), options).expect("memory");
    for frame in &frames {
        writer.write(frame).expect("memory");
        csv.write(frame).expect("memory");
    }
    let (parquet, csv) = (writer.finish().expect("memory"), csv.finish().expect("memory"));
    let reader = ParquetReader::from_bytes(parquet, "test").expect("a table");
    assert_eq!(reader.comments(), "one\ntruth omega=1");
    let from_csv: Result<Vec<_>, _> = OutlineReader::new(&csv[..], "test").expect("a header").collect();
    let from_parquet: Vec<_> = reader.collect::<Result<_, _>>().expect("outlines");
    assert_eq!(from_parquet, from_csv.expect("outlines"));
    assert_ne!(from_parquet, frames);
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_to_the_last_bit_in_any_order(frames in sequence(), turn in 0..100_usize) {
        let options = WriterOptions::needed_for(&frames);
        let bits = |frames: &[OutlineFrame]| -> Vec<_> {
            let points = |frame: &OutlineFrame| {
                let coordinates = frame.outline.points().flat_map(|point| [point.x, point.y]);
                let numbers = coordinates.chain(frame.outline.deviations().into_iter().flatten());
                numbers.map(f64::to_bits).collect::<Vec<_>>()
            };
            frames.iter().map(|frame| (frame.object.clone(), frame.frame, frame.time.to_bits(), points(frame))).collect()
        };
        let again = read(&parquet_of(&frames, options)).expect("outlines");
        prop_assert_eq!(bits(&again), bits(&frames));
        prop_assert_eq!(&again, &frames);
        // Turned round, the rows are no longer in order, unless they are few.
        let mut turned = frames.clone();
        turned.rotate_left(turn % frames.len().max(1));
        let mut again = read(&parquet_of(&turned, options)).expect("outlines");
        let mut sorted = frames.clone();
        for list in [&mut again, &mut sorted] {
            list.sort_by(|a, b| (a.frame, &a.object).cmp(&(b.frame, &b.object)));
        }
        prop_assert_eq!(again, sorted);
    }
}
