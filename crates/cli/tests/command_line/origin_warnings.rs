//! What is wrong with how outlines were found goes with them in their table.
use std::path::Path;

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
        let copy = format!("{table}-copy.csv");
        run(&format!("outline {table} --output {copy} --quiet"), "");
        for command in ["identify", "track", "fit", "outline"] {
            let told = stderr(&run(&format!("{command} {copy}"), ""));
            let message = "no way of tracing tells an object from the ground beyond doubt";
            assert_eq!(told.matches(message).count(), 1, "{command} {name}: {told}");
        }
        let report = format!("{table}.html");
        succeed(&format!("identify {table} --report {report} --quiet"), "");
        assert!(std::fs::read_to_string(report).expect("a report").contains("column warning: tracing_doubtful"));
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
