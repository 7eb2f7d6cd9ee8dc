//! What is printed and written of the motion in pictures.
use image::{GrayImage, Luma};

use crate::pears::{masks_of_pears, names, pears};
use crate::support::{json, run, sequence, stderr, stdout, succeed};

#[test]
fn a_report_has_the_settings_that_were_used_and_marks_rejected_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 12);
    // Something else in the place of one.
    let other =
        GrayImage::from_fn(160, 120, |x, y| Luma([if (10..150).contains(&x) && y / 8 == 7 { 210 } else { 30 }]));
    other.save(format!("{frames}/8.png")).expect("a picture");
    let report = |options: &str| {
        succeed(&format!("identify {frames} {options} --quiet --report {base}/report.html"), "");
        std::fs::read_to_string(format!("{base}/report.html")).expect("a report")
    };
    let row = |name: &str, value: &str| format!("<tr><th>{name}</th><td>{value}</td></tr>");
    let html = report("--fps 12.5");
    for (name, value) in [
        ("Motion model", "rigid"),
        ("Method", "filter"),
        ("Frames per second", "12.5"),
        ("Smoothing", "1 pixel in masks, 0.5 pixels in others"),
        ("Thresholds by Otsu", "120 (grey values)"),
        ("Pixel width over height", "1"),
    ] {
        assert!(html.contains(&row(name, value)), "{name}: {html}");
    }
    let rejected = html.lines().find(|line| line.contains("Rejected frames"));
    assert!(html.contains("<p>Rejected frames: 8</p>"), "{rejected:?}");
    // One line in each of the two panels and one in each of their legends, and no cross on the lower edge.
    assert_eq!((html.matches("class=\"s s1\"").count(), html.matches("rejected frames</text>").count()), (4, 2));
    let html = report("--light --method adaptive --degree 4 --pixel-aspect 1.1");
    for (name, value) in [
        ("Degree of the curve", "4"),
        ("Frames per second", "30, assumed, as none is given"),
        ("Pixel width over height", "1.1"),
    ] {
        assert!(html.contains(&row(name, value)), "{name}: {html}");
    }
}

#[test]
fn json_says_what_b_is_and_which_pictures_were_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 8);
    GrayImage::new(160, 120).save(format!("{frames}/3.png")).expect("a picture");
    let document = json(&succeed(&format!("identify {frames} --json --quiet --pixel-aspect 1.2 --scale 2"), ""));
    let b = serde_json::json!({"point": "the lower left corner", "unit": "pixel heights/s", "scale": 2.0});
    assert_eq!(document["b"], b);
    assert_eq!(document["left_out"]["count"], 1);
    let picture = &document["left_out"]["pictures"][0];
    assert_eq!(picture["frame"], 3);
    assert!(picture["reason"].as_str().expect("text").contains("every pixel has the grey value 0"), "{picture}");

    let document = json(&succeed("identify - --json --quiet", &sequence("")));
    let b = serde_json::json!({"point": "the origin of the coordinates", "unit": "lengths/s", "scale": null});
    assert_eq!((&document["b"], &document["left_out"]["count"]), (&b, &0.into()));
}

#[test]
fn without_a_motion_files_hold_what_is_known_or_are_said_not_to_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 1);
    let outputs = format!("--trace {base}/trace.csv --trajectory {base}/poses.csv --svg {base}/figure.svg");
    let output = run(&format!("identify {frames} {outputs}"), "");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--svg: not written, there is no motion to draw"), "{}", stderr(&output));
    assert_eq!(names(&base), ["frames", "poses.csv", "trace.csv"]);
    let trace = std::fs::read_to_string(format!("{base}/trace.csv")).expect("a trace");
    let all = "omega unknown; b1 unknown; b2 unknown; v1 unknown; v2 unknown";
    assert_eq!(trace.lines().nth(1), Some(format!("0,0,0,acquiring,true,,,,,,,,,,,,{all},,").as_str()));

    let bare = tempfile::tempdir().expect("a folder");
    let outputs = outputs.replace(&base, bare.path().to_str().expect("UTF-8"));
    GrayImage::new(160, 120).save(format!("{frames}/0.png")).expect("a picture");
    let output = run(&format!("identify {frames} {outputs}"), "");
    assert_eq!(output.status.code(), Some(1));
    let expected = "--trace, --trajectory, --svg: not written, no outline could be used";
    assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    assert_eq!(names(bare.path().to_str().expect("UTF-8")), [""; 0]);
}

#[test]
fn the_rounding_of_masks_to_pixels_is_part_of_the_deviations_and_is_found_in_tables_of_their_outlines() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = masks_of_pears(folder.path());
    let outlines = format!("{base}/outlines.csv");
    succeed(&format!("outline {frames} --fps 30 --output {outlines}"), "");
    let omega = |input: &str| {
        let document = json(&succeed(&format!("identify {input} --json --quiet"), ""));
        ["value", "std"].map(|field| {
            document["objects"][0]["parameters"]["omega"][field].as_f64().unwrap_or_else(|| panic!("{document}"))
        })
    };
    let of_masks = omega(&format!("{frames} --fps 30"));
    assert_eq!(omega(&format!("{outlines} --mask-pixel 1")), of_masks);
    // Sides that lie half way between two pixels tell of it, also where nothing else is said of the outlines.
    assert_eq!(omega(&outlines), of_masks);
    assert_eq!(omega(&format!("{frames} --fps 30 --edge-uncertainty 0")), of_masks);
    // What is given is obeyed.
    let finer = omega(&format!("{outlines} --mask-pixel 0.25"));
    assert!(finer[1] < of_masks[1], "{finer:?} {of_masks:?}");
}

#[test]
fn the_deviations_of_the_last_pose_are_those_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = masks_of_pears(folder.path());
    let document = json(&succeed(&format!("identify {frames} --json --quiet --trajectory {base}/poses.csv"), ""));
    let poses = std::fs::read_to_string(format!("{base}/poses.csv")).expect("poses");
    let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let (header, last) = (split(poses.lines().next().expect("a header")), split(poses.lines().last().expect("rows")));
    for name in ["omega", "b1", "b2"] {
        let column = header.iter().position(|head| *head == format!("{name}_std")).expect("a column");
        let (of_row, of_table) = (&last[column], &document["objects"][0]["parameters"][name]["std"]);
        let (of_row, of_table): (f64, f64) = (of_row.parse().expect("a number"), of_table.as_f64().expect("a number"));
        assert!((of_row - of_table).abs() < 1e-6 * of_table, "{name}: {of_row} {of_table}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn on_a_terminal_no_progress_bar_stands_in_the_lines_of_a_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 4);
    let binary = assert_cmd::cargo::cargo_bin("freeform");
    for (command, start) in [("track", "{\"schema\""), ("outline", "frame,time"), ("fit", "object 0, frame")] {
        let line = format!("'{}' {command} {frames}", binary.display());
        let Ok(output) = std::process::Command::new("script").args(["-qec", &line, "/dev/null"]).output() else {
            println!("skipped: there is no program script, which makes a terminal");
            return;
        };
        let printed = stdout(&output);
        let results: Vec<&str> = printed.lines().filter(|line| line.contains(start)).collect();
        assert!(!results.is_empty() && results.iter().all(|line| line.starts_with(start)), "{command}: {printed}");
    }
}
