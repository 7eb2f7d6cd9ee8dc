//! The column `warning` of tables.
use freeform_outline_io::{
    OriginWarning, OriginWarnings, OutlineReader, OutlineWriter, ParquetReader, ParquetWriter, WriterOptions,
};

use crate::parquet::{expected, parquet_of, read};

fn csv_of(options: WriterOptions) -> Vec<u8> {
    let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
    expected().iter().for_each(|frame| writer.write(frame).expect("the columns are there"));
    writer.finish().expect("memory")
}

#[test]
fn every_warning_comes_back_from_csv_and_parquet_and_the_outlines_are_the_same() {
    let all: Vec<OriginWarning> = OriginWarning::ALL.into();
    for told in all.iter().map(|warning| vec![*warning]).chain([all.clone()]) {
        let warnings: OriginWarnings = told.iter().copied().collect();
        let options = WriterOptions { object_column: true, warnings, ..WriterOptions::default() };
        let csv = csv_of(options);
        let mut reader = OutlineReader::new(&csv[..], "test").expect("a header");
        let frames: Result<Vec<_>, _> = reader.by_ref().collect();
        assert_eq!((frames.expect("outlines"), reader.warnings()), (expected(), warnings));
        let bytes = parquet_of(&expected(), options);
        assert_eq!(read(&bytes).expect("outlines"), expected());
        let mut reader = ParquetReader::from_bytes(bytes, "test").expect("a table");
        assert_eq!((reader.by_ref().count(), reader.warnings()), (expected().len(), warnings));
    }
}

#[test]
fn a_warning_in_one_row_is_heard_and_words_of_other_programs_say_nothing() {
    let rows = |last: &str| {
        let row = |frame: usize, x: f64, y: f64, told: &str| format!("{frame},{x},{y},{frame},{told}\n");
        let outline =
            |frame, told: &str| row(frame, 0.0, 0.0, "") + &row(frame, 1.0, 0.0, told) + &row(frame, 0.0, 1.0, "");
        format!("frame,x,y,time,warning\n{}{}{}", outline(0, ""), outline(1, "low battery"), outline(2, last))
    };
    let heard = |last: &str| {
        let csv = rows(last);
        let mut reader = OutlineReader::new(csv.as_bytes(), "test").expect("a header");
        assert_eq!(reader.by_ref().filter(Result::is_ok).count(), 3);
        reader.warnings()
    };
    assert!(heard("moves_beside").iter().eq([OriginWarning::MovesBeside]));
    assert!(heard("not tracing_doubtfully").is_empty() && heard("").is_empty());
    let twice = "frame,time,x,y,warning,warning\n0,0,0,0,a,b\n0,0,1,0,a,b\n0,0,0,1,a,b\n";
    assert_eq!(OutlineReader::new(twice.as_bytes(), "test").expect("a header").flatten().count(), 1);
}

#[test]
fn warnings_that_become_known_later_are_in_the_later_rows_where_the_column_is_there() {
    let doubtful: OriginWarnings = [OriginWarning::TracingDoubtful].into_iter().collect();
    let options = WriterOptions { object_column: true, warning_column: true, ..WriterOptions::default() };
    let csv = |options: WriterOptions| {
        let mut writer = OutlineWriter::new(Vec::new(), options).expect("memory");
        for frame in &expected() {
            writer.warn(if frame.frame == 6 { doubtful } else { OriginWarnings::NONE });
            writer.write(frame).expect("the columns are there");
        }
        String::from_utf8(writer.finish().expect("memory")).expect("text")
    };
    let rows = csv(options);
    let ends = |end: &str| rows.lines().filter(|row| row.ends_with(end)).count();
    assert_eq!([ends(",warning"), ends(","), ends(",tracing_doubtful")], [1, 7, 4], "{rows}");
    let without = csv(WriterOptions { warning_column: false, ..options });
    assert!(!without.contains("warning") && !without.contains("doubtful"), "{without}");
    assert!(OutlineReader::new(without.as_bytes(), "test").expect("a header").all(|frame| frame.is_ok()));
    for (warns, expected_warnings) in [(true, doubtful), (false, OriginWarnings::NONE)] {
        let mut writer = ParquetWriter::new(Vec::new(), options, &[]).expect("memory");
        for frame in &expected() {
            writer.warn(if warns && frame.frame == 6 { doubtful } else { OriginWarnings::NONE });
            writer.write(frame).expect("the columns are there");
        }
        let bytes = writer.finish().expect("memory");
        let mut reader = ParquetReader::from_bytes(bytes, "test").expect("a table");
        assert!(reader.has_warning_column());
        assert_eq!((reader.by_ref().count(), reader.warnings()), (expected().len(), expected_warnings));
    }
}

#[cfg(feature = "serde")]
#[test]
fn unknown_bits_of_saved_warnings_are_left_out() {
    let all: OriginWarnings = OriginWarning::ALL.into_iter().collect();
    let read = |text: &str| serde_json::from_str::<OriginWarnings>(text).expect("a set");
    assert_eq!((read("65535"), read("49152"), read("1")), (all, OriginWarnings::NONE, read("32769")));
    assert_eq!(read(&serde_json::to_string(&all).expect("a set")), all);
}
