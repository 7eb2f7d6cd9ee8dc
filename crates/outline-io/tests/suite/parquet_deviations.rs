//! Standard deviations of points in Parquet: those of CSV, by the rules of CSV.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_outline_io::{
    Column, OutlineFile, OutlineFrame, OutlineReader, ParquetReader, ReadError, Span, TableFormat, TableWriter,
    WriterOptions,
};
use nalgebra::Point2;

use crate::parquet::{expected, parquet_of, read, sample};

fn read_sample(name: &str) -> Result<Vec<OutlineFrame>, ReadError> {
    ParquetReader::open(sample(&format!("{name}.parquet")))?.collect()
}

/// The outlines of the samples, the second of which states nothing.
fn stating() -> Vec<OutlineFrame> {
    let mut frames = expected();
    for (index, scale) in [(0, 1.0), (2, 0.5)] {
        let stated = [0.125, 0.25, 0.5, 1.0].map(|deviation| scale * deviation).to_vec();
        let outline = frames[index].outline.clone();
        frames[index].outline = outline.with_deviations(stated).expect("positive numbers");
    }
    frames
}

/// Two arcs, the second of which runs on where the first ends.
fn two_arcs() -> OutlineFrame {
    let arc = |points: [(f64, f64); 2], stated: [f64; 2]| {
        let arc = OpenArc::new(points.map(|(x, y)| Point2::new(x, y)).to_vec()).expect("two points");
        arc.with_deviations(stated.to_vec()).expect("positive numbers")
    };
    let arcs = vec![arc([(0.0, 0.0), (1.0, 0.0)], [0.1, 0.2]), arc([(5.0, 1.0), (5.0, 2.0)], [0.3, 0.4])];
    let outline = Outline::Open(OpenOutline::new(arcs).expect("two arcs"));
    OutlineFrame { frame: 0, time: 0.0, object: "0".to_owned(), outline }
}

#[test]
fn deviations_of_pyarrow_pandas_and_polars_are_read_in_either_layout_and_any_order() {
    for name in ["arrow", "types", "shuffled", "empty-list", "pandas", "polars", "points", "points-polars"] {
        assert_eq!(read_sample(&format!("deviations-{name}")).expect("outlines"), stating(), "{name}");
    }
}

#[test]
fn a_column_of_nothing_but_nulls_or_empty_lists_states_no_deviations() {
    for name in ["null", "null-lists", "empty-lists", "null-points"] {
        assert_eq!(read_sample(&format!("no-deviations-{name}")).expect("outlines"), expected(), "{name}");
    }
}

#[test]
fn deviations_of_arcs_are_read_from_lists_and_from_rows() {
    for name in ["deviations-arcs-lists", "deviations-arcs-rows"] {
        assert_eq!(read_sample(name).expect("an outline"), [two_arcs()], "{name}");
    }
}

#[test]
fn deviations_that_are_none_are_refused_with_row_and_column() {
    let none = "is not a standard deviation (a number above 0, or nothing)";
    for (name, expected) in [
        ("zero", format!("row 2: column deviation: 0 {none}")),
        ("negative", format!("row 2: column deviation: -0.5 {none}")),
        ("nan", "row 2: column deviation: \"NaN\" is not a finite number: leave out the point".to_owned()),
        ("infinite", "row 2: column deviation: \"inf\" is not a finite number: leave out the point".to_owned()),
        ("huge", "row 2: column deviation: 1e101 is beyond 1e100".to_owned()),
        (
            "null-value",
            "row 2: column deviation: the field is empty, expected a number: fill it in, or leave out the point"
                .to_owned(),
        ),
        ("short", "row 2: column deviation: 3 value(s), column x has 4 in this row".to_owned()),
        ("long", "row 2: column deviation: 5 value(s), column x has 4 in this row".to_owned()),
        ("points-zero", format!("row 5: column deviation: 0 {none}")),
        ("points-nan", "row 5: column deviation: \"NaN\" is not a finite number: leave out the point".to_owned()),
    ] {
        let reader = ParquetReader::open(sample(&format!("bad-deviations-{name}.parquet"))).expect("a table");
        let items: Vec<_> = reader.collect();
        let message = items.last().expect("items").as_ref().expect_err(name).to_string();
        assert!(message.ends_with(&expected), "{name}: {message}");
        // Rows before it are whole outlines, unless a row is a point.
        let whole = if name.starts_with("points") { 1 } else { 2 };
        assert_eq!(items.iter().filter(|item| item.is_ok()).count(), whole, "{name}");
    }
}

#[test]
fn a_column_of_deviations_of_another_type_than_the_points_is_refused() {
    for (name, expected) in [
        ("text", "the type is lists of BYTE_ARRAY (String), expected lists of numbers, or numbers"),
        ("one", "the type is DOUBLE, expected lists, as column x has"),
        ("points-list", "the type is lists of DOUBLE, expected one value in a row, as column x has"),
        ("points-text", "the type is BYTE_ARRAY (String), expected lists of numbers, or numbers"),
        ("nested", "the type is lists of lists of DOUBLE, expected lists of numbers, or numbers"),
    ] {
        let error = ParquetReader::open(sample(&format!("bad-deviations-{name}.parquet"))).expect_err(name);
        assert_eq!((error.place.span, error.place.column), (None, Some(Column::Deviation)), "{name}");
        assert!(error.to_string().ends_with(expected), "{name}: {error}");
    }
}

#[test]
fn an_outline_with_deviations_of_some_points_is_left_out_and_the_reading_goes_on() {
    for (name, count, message, rows) in [
        ("some-points", 3, "frame 4 of object \"left\": 2 standard deviation(s) for 3 points", (4, 6)),
        ("some-arcs", 1, "frame 0 of object \"0\": 2 standard deviation(s) for 4 points", (0, 1)),
    ] {
        let reader = ParquetReader::open(sample(&format!("bad-deviations-{name}.parquet"))).expect("a table");
        let items: Vec<_> = reader.collect();
        assert_eq!(items.len(), count, "{name}");
        let errors: Vec<_> = items.into_iter().filter_map(Result::err).collect();
        assert!(errors[0].is_recoverable() && errors[0].to_string().ends_with(message), "{}", errors[0]);
        assert_eq!((errors.len(), errors[0].place.span), (1, Some(Span::Rows(rows.0, rows.1))), "{name}");
    }
}

#[test]
fn deviations_come_back_to_the_last_bit_from_parquet_as_from_csv() {
    let mut frames = stating();
    frames[0].outline =
        frames[0].outline.clone().with_deviations(vec![1e-300, 0.1, 1.0 / 3.0, 1e100]).expect("numbers");
    frames.insert(0, two_arcs());
    // Coordinates are rounded, standard deviations are not.
    for resolution in [None, Some(1e-2)] {
        let options = WriterOptions { resolution, ..WriterOptions::needed_for(&frames) };
        assert!(options.deviation_column);
        let [csv, parquet] = [TableFormat::Csv, TableFormat::Parquet].map(|format| {
            let mut writer = TableWriter::new(Vec::new(), format, options, &[]).expect("memory");
            frames.iter().for_each(|frame| writer.write(frame).expect("memory"));
            writer.finish().expect("memory")
        });
        let from_csv: Result<Vec<_>, _> = OutlineReader::new(&csv[..], "test").expect("a header").collect();
        let (from_csv, from_parquet) = (from_csv.expect("outlines"), read(&parquet).expect("outlines"));
        assert_eq!(from_csv, from_parquet);
        let bits = |frames: &[OutlineFrame]| -> Vec<u64> {
            frames.iter().flat_map(|frame| frame.outline.deviations().into_iter().flatten()).map(f64::to_bits).collect()
        };
        assert_eq!((bits(&from_csv), bits(&from_parquet)), (bits(&frames), bits(&frames)));
    }
}

#[test]
fn deviations_are_written_only_where_the_column_is_asked_for_and_readers_tell_whether_it_is_there() {
    let frames = stating();
    let asked = WriterOptions::needed_for(&frames);
    let with = parquet_of(&frames, asked);
    assert_eq!(read(&with).expect("outlines"), frames);
    let without = parquet_of(&frames, WriterOptions { deviation_column: false, ..asked });
    assert_eq!(read(&without).expect("outlines"), expected());
    let has_column =
        |bytes: &[u8]| ParquetReader::from_bytes(bytes.to_vec(), "test").expect("a table").has_deviation_column();
    assert_eq!((has_column(&with), has_column(&without)), (true, false));
    // No outline has them: the column is there, and null.
    let asked_in_vain = parquet_of(&expected(), asked);
    assert!(has_column(&asked_in_vain));
    assert_eq!(read(&asked_in_vain).expect("outlines"), expected());
    let csv = |header: &str| OutlineReader::new(header.as_bytes(), "test").expect("a header").has_deviation_column();
    assert_eq!((csv("frame,time,x,y,deviation\n"), csv("frame,time,x,y\n")), (true, false));
    let open = |name: &str| OutlineFile::open_parquet(&sample(name)).expect("a table").has_deviation_column();
    assert_eq!((open("deviations-arrow.parquet"), open("good-arrow.parquet")), (true, false));
}
