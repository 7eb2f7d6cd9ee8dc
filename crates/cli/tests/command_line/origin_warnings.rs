//! What is wrong with how outlines were found goes with them in their table.
use std::path::Path;

use freeform_motion::outline_io::{OriginWarning, OutlineReader, TableFormat, TableWriter, WriterOptions};
use image::{GrayImage, Luma};

use crate::support::{json, run, stderr, stdout, succeed};

/// Pictures in which something is seen in two of twelve, so that every way of tracing is in doubt.
fn doubtful_pictures(folder: &Path) -> String {
    let frames = folder.join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..12_u32 {
        let place = 60 + 3 * frame;
        let is_light = |x: u32, y: u32| {
            let (x, y) = (x.wrapping_sub(place), y.wrapping_sub(50));
            (5..7).contains(&frame) && x < 18 && y < 24 && (x < 7 || y < 6)
        };
        let noise = |x: u32, y: u32| ((x * 31 + y * 17 + frame * 7) % 5) as u8;
        let value = |x: u32, y: u32| noise(x, y) + if is_light(x, y) { 180 } else { 60 };
        let picture = GrayImage::from_fn(160, 120, |x, y| Luma([value(x, y)]));
        picture.save(frames.join(format!("{frame:02}.png"))).expect("a picture");
    }
    frames.display().to_string()
}

fn codes(of: &serde_json::Value) -> Vec<&str> {
    of["warnings"].as_array().into_iter().flatten().filter_map(|warning| warning["code"].as_str()).collect()
}

#[test]
fn a_table_of_outlines_says_what_is_wrong_with_their_pictures_to_everything_that_reads_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = doubtful_pictures(folder.path());
    let of_pictures = json(&succeed(&format!("identify {frames} --quiet --json"), ""));
    for name in ["outlines.csv", "outlines.parquet"] {
        let table = folder.path().join(name).display().to_string();
        run(&format!("outline {frames} --output {table} --quiet"), "");
        let output = run(&format!("identify {table} --json"), "");
        let document = json(&stdout(&output));
        assert_eq!(codes(&document), ["tracing_doubtful", "rate_assumed"], "{document}");
        assert_eq!(codes(&document), codes(&of_pictures));
        assert_eq!(codes(&document["objects"][0]), codes(&of_pictures["objects"][0]), "{document}");
        for copy in ["copy.csv", "copy.parquet"].map(|copy| format!("{table}-{copy}")) {
            run(&format!("outline {table} --output {copy} --quiet"), "");
            for command in ["identify", "track", "fit", "outline"] {
                let told = stderr(&run(&format!("{command} {copy}"), ""));
                let message = "no way of tracing tells an object from the ground beyond doubt";
                assert_eq!(told.matches(message).count(), 1, "{command} {copy}: {told}");
            }
        }
        let report = format!("{table}.html");
        succeed(&format!("identify {table} --report {report} --quiet"), "");
        assert!(std::fs::read_to_string(report).expect("a report").contains("column warning: tracing_doubtful"));
    }
}

/// Rows of a disc that moves, of which the table says something.
fn disc(object: &str, frames: impl Iterator<Item = u32>, told: &str) -> String {
    let point = |frame: u32, i: u32| {
        let (y, x) = (f64::from(i) / 40.0 * std::f64::consts::TAU).sin_cos();
        let time = f64::from(frame) / 10.0;
        format!("{object},{frame},{time},{},{y},{told}\n", 2.0 * x + time)
    };
    frames.flat_map(|frame| (0..40).map(move |i| point(frame, i))).collect()
}

#[test]
fn a_copy_of_joined_tables_says_what_only_the_later_rows_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    // More rows of Parquet than are read at once come before.
    let rows = disc("a", 0..80, "") + &disc("b", 0..80, "tracing_doubtful rate_assumed");
    std::fs::write(place("joined.csv"), format!("object,frame,time,x,y,warning\n{rows}")).expect("a table");
    for (of, copy) in [
        ("joined.csv", "copy.csv"),
        ("joined.csv", "copy.parquet"),
        ("copy.parquet", "again.csv"),
        ("copy.parquet", "again.parquet"),
    ] {
        succeed(&format!("outline {} --output {} --quiet", place(of), place(copy)), "");
        let document = json(&stdout(&run(&format!("identify {} --json", place(copy)), "")));
        assert_eq!(codes(&document), ["tracing_doubtful", "rate_assumed"], "{of} {copy}: {document}");
    }
    let copied = std::fs::read_to_string(place("copy.csv")).expect("a table");
    let count = |end: &str| copied.lines().filter(|row| row.ends_with(end)).count();
    assert!(count(",tracing_doubtful rate_assumed") >= 80 * 40 && count(",") >= 79 * 40, "{copied}");
}

#[test]
fn rows_of_parquet_that_have_to_be_ordered_are_told_of_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("table.parquet");
    let rows = "object,frame,time,x,y\n".to_owned() + &disc("a", 0..8, "").replace(",\n", "\n");
    let frames: Result<Vec<_>, _> = OutlineReader::new(rows.as_bytes(), "rows").expect("a header").collect();
    let warnings = [OriginWarning::TracingDoubtful].into_iter().collect();
    let options = WriterOptions { object_column: true, warnings, ..WriterOptions::default() };
    let file = std::fs::File::create(&table).expect("a file");
    let mut writer = TableWriter::new(file, TableFormat::Parquet, options, &[]).expect("a table");
    frames.expect("outlines").iter().rev().for_each(|frame| writer.write(frame).expect("the columns are there"));
    writer.finish().expect("a table");
    for command in ["identify", "track", "fit", "outline"] {
        let told = stderr(&run(&format!("{command} {}", table.display()), ""));
        assert_eq!(told.matches("column warning: tracing_doubtful").count(), 1, "{command}: {told}");
    }
}

#[test]
fn outlines_of_which_nothing_is_said_have_no_such_column_and_a_column_of_others_says_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    succeed(&format!("simulate --pictures {} --scene gear --seconds 0.3", frames.display()), "");
    let rows = succeed(&format!("outline {} --fps 30 --quiet", frames.display()), "");
    assert!(rows.starts_with("frame,time,x,y") && !rows.lines().next().expect("a header").contains("warning"));
    let rows: String = (0..8)
        .map(|frame| {
            let row = |x: f64, y: f64| format!("{frame},{},{x},{y},battery low\n", f64::from(frame) / 10.0);
            (0..40)
                .map(|i| (f64::from(i) / 40.0 * std::f64::consts::TAU).sin_cos())
                .map(|(x, y)| row(2.0 * x + 0.3 * y, y))
                .collect::<String>()
        })
        .collect();
    let output = run("identify - --json", &format!("frame,time,x,y,warning\n{rows}"));
    assert_eq!(json(&stdout(&output))["warnings"], serde_json::Value::Null);
    assert!(!stderr(&output).contains("column warning"), "{}", stderr(&output));
}
