//! Pictures whose pixels are not as wide as they are high.
use std::path::Path;

use crate::support::{Pear, json, pictures, run, stderr, stdout};

/// Width of a pixel over its height.
const ASPECT: f64 = 1.25;

/// Pictures of a pear that turns by 0.05 rad a frame, with pixels that are wider than high; the folder.
fn wide_pixels(base: &Path) -> String {
    let pear = Pear { half: [48.0, 26.0], taper: 0.3, edge: 12.0 };
    pictures(&base.join("wide"), 40, [140, 150], |frame, column, row| {
        pear.shade(0.05 * f64::from(frame), [ASPECT * (f64::from(column) - 70.0), f64::from(row) - 75.0])
    })
}

#[test]
fn pixels_that_are_not_as_wide_as_high_are_told_with_the_aspect_and_with_that_the_turn_is_right() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = wide_pixels(folder.path());
    let report = folder.path().join("report.html");
    let identify = |options: &str| {
        let output = run(&format!("identify {pictures} --light --fps 20 --json {options}"), "");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (json(&stdout(&output)), stderr(&output))
    };
    let (found, told) = identify(&format!("--report {}", report.display()));
    let start = "freeform: warning[pixel_aspect]: the object keeps its shape as it turns only with pixels of another aspect: give \
                 --pixel-aspect ";
    let given = told.split(start).nth(1).and_then(|rest| rest.split(' ').next()).expect("an aspect");
    let aspect: f64 = given.parse().expect("a number");
    assert!((aspect - ASPECT).abs() < 0.03, "{aspect}");
    // In JSON and in the report too.
    let codes: Vec<_> = found["warnings"].as_array().expect("a list").iter().map(|warning| &warning["code"]).collect();
    assert_eq!(codes, ["pixel_aspect"]);
    let report = std::fs::read_to_string(report).expect("a report");
    assert!(report.contains(&format!("give --pixel-aspect {given} ")), "the report says it");

    let (found, told) = identify(&format!("--pixel-aspect {given}"));
    assert!(!told.contains("pixel_aspect") && found["warnings"].is_null(), "{told}");
    let omega = &found["objects"][0]["parameters"]["omega"];
    let [value, std] = ["value", "std"].map(|field| omega[field].as_f64().expect("a number"));
    // Rows run downwards, so that the turn is positive.
    assert!((value - 1.0).abs() < 4.0 * std && std < 0.05, "{value} {std}");
}

/// Obeying the warning would stretch the plane that the map has made right.
#[test]
fn nothing_is_said_of_the_pixels_where_a_map_to_the_plane_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = wide_pixels(folder.path());
    let output = run(&format!("identify {pictures} --light --fps 20 --json --rectify {ASPECT},0,0,0,1,0,0,0,1"), "");
    let (found, told) = (json(&stdout(&output)), stderr(&output));
    assert!(!told.contains("pixel_aspect") && found["warnings"].is_null(), "{told}");
    let omega = &found["objects"][0]["parameters"]["omega"];
    let [value, std] = ["value", "std"].map(|field| omega[field].as_f64().expect("a number"));
    assert!((value - 1.0).abs() < 4.0 * std && std < 0.05, "{value} {std}");
}
