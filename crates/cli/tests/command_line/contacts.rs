//! Objects that touch in a table of outlines, and in pictures.
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use serde_json::Value;

use crate::support::{Pear, json, pictures, run, stderr, succeed};

/// Pictures of a pear that turns by 0.06 rad and travels by 6 pixels a frame along a bar, which it touches; the folder.
fn passing(base: &Path, name: &str, bar: Range<u32>) -> String {
    let pear = Pear { half: [16.0, 11.0], taper: 0.2, edge: 6.0 };
    pictures(&base.join(name), 40, [280, 110], |frame, column, row| {
        if bar.contains(&column) && (56..74).contains(&row) {
            return 210;
        }
        let time = f64::from(frame);
        pear.shade(0.06 * time, [f64::from(column) - 20.0 - 6.0 * time, f64::from(row) - 47.0])
    })
}

#[test]
fn an_object_that_gets_another_number_as_it_touched_another_for_long_is_told_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let outline = |pictures: &str| {
        let table = folder.path().join("o.csv");
        let output =
            run(&format!("outline {pictures} --light --objects all --fps 25 --output {}", table.display()), "");
        let text = std::fs::read_to_string(table).expect("a table");
        let rows = text.lines().filter(|row| row.starts_with(|first: char| first.is_ascii_digit()));
        let cells: Vec<Vec<&str>> = rows.map(|row| row.split(',').collect()).collect();
        let names: BTreeSet<&str> = cells.iter().map(|cells| cells[4]).collect();
        let marked: BTreeSet<u32> = cells
            .iter()
            .filter(|cells| cells.last() == Some(&"new_after_contact"))
            .map(|cells| cells[0].parse().expect("a frame"))
            .collect();
        (names.len(), marked, stderr(&output))
    };
    let (names, marked, told) = outline(&passing(folder.path(), "long", 70..210));
    assert_eq!(names, 4, "{told}");
    let pairs = "object 2, new in frame 22, may be object 0 or 1; object 3, new in frame 34, may be object 0 or 1: ";
    assert!(told.contains(&format!("freeform: warning[new_after_contact]: {pairs}")), "{told}");
    assert!(told.contains("'freeform identify'"), "{told}");
    // The table says so of all outlines since then, and is heard where it is read.
    assert_eq!(marked, (22..40).collect());
    let told = stderr(&run(&format!("identify {}", folder.path().join("o.csv").display()), ""));
    assert!(told.contains("freeform: warning[new_after_contact]: "), "{told}");
    // For a short while it keeps its number, and nothing is said.
    let (names, marked, told) = outline(&passing(folder.path(), "short", 120..150));
    assert!(names == 2 && marked.is_empty() && !told.contains("may be object"), "{names}: {told}");
}

#[test]
fn an_object_is_followed_through_a_long_contact_in_the_pictures_themselves() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = passing(folder.path(), "long", 70..210);
    let lines = succeed(&format!("track {pictures} --light --objects all --fps 25 --quiet"), "");
    // They touch in frames 6 to 33, and are apart then.
    let is_after = |line: &Value| line["frame"].as_u64().is_some_and(|frame| frame > 33);
    let of_pear: Vec<Value> = lines.lines().map(json).filter(|line| line["object"] == "1").collect();
    assert!(of_pear.iter().filter(|line| line["frame"].as_u64().is_some_and(|frame| frame < 6)).count() == 6);
    let after: Vec<&Value> = of_pear.iter().filter(|line| is_after(line)).collect();
    assert!(after.len() == 6 && after.iter().all(|line| line["accepted"] == true), "{after:?}");
    // Rows run downwards, so that its turn is positive.
    for line in after {
        let number = |of: &Value| ["value", "std"].map(|field| of[field].as_f64().expect("a number"));
        let [omega, of_omega] = number(&line["parameters"]["omega"]);
        assert!((omega - 1.5).abs() < 0.02 && of_omega < 0.3, "{omega} {of_omega}");
        let [angle, of_angle] = number(&line["pose"]["angle"]);
        let truth = 0.06 * line["frame"].as_f64().expect("a number");
        assert!((angle - truth).abs() < 4.0 * of_angle && of_angle < 0.05, "{angle} {of_angle} {truth}");
    }
}

#[test]
fn an_object_that_is_not_found_by_its_edges_while_it_touches_another_is_told_where_motions_are_stated() {
    let folder = tempfile::tempdir().expect("a folder");
    // It is seen by itself in two pictures before, which do not show its outline well enough.
    let pictures = passing(folder.path(), "early", 42..210);
    let pairs = "freeform: warning[new_after_contact]: object 2, new in frame 18, may be object 0 or 1; object 3, new in frame 34, \
                 may be object 0 or 1: ";
    let means = "; its edges were not found all the while, so that results of two objects may be those of one";
    for command in ["identify --json", "track"] {
        let output = run(&format!("{command} {pictures} --light --objects all --fps 25"), "");
        let told = stderr(&output);
        assert!(told.contains(pairs) && told.contains(means), "{command}: {told}");
        let is_in_json = String::from_utf8_lossy(&output.stdout).contains("\"new_after_contact\"");
        assert_eq!(is_in_json, command == "identify --json");
    }
    // Where they were found it keeps its number, and both together are told to be the bar, whose edges show too little.
    let pictures = passing(folder.path(), "long", 70..210);
    let told = stderr(&run(&format!("identify {pictures} --light --objects all --fps 25"), ""));
    let pair = "freeform: warning[new_after_contact]: object 2, new in frame 22, may be object 0: ";
    assert!(told.contains(pair), "{told}");
}

/// Pictures of a belt of parts 60 pixels apart, of which each is 24 wide, that moves by so many pixels a frame; the folder.
fn belt(base: &Path, step: u32) -> String {
    pictures(&base.join(format!("belt{step}")), 12, [280, 60], |frame, column, row| {
        let along = (column + 600 - step * frame) % 60;
        let inside = along < 24 && (20..36).contains(&row) && (along > 8 || row > 26);
        if inside { 210 } else { 30 }
    })
}

#[test]
fn parts_on_a_belt_that_may_have_gone_the_other_way_are_told_in_pictures_and_tables_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("o.csv");
    let told_of = |step: u32| {
        let options = "--light --objects all --fps 25 --pixel-size 0.01";
        let pictures = belt(folder.path(), step);
        let told = stderr(&run(&format!("outline {pictures} {options} --output {}", table.display()), ""));
        [told, stderr(&run(&format!("identify {}", table.display()), ""))]
    };
    let [of_pictures, of_table] = told_of(26);
    let message = "warning[among_alike]: objects that look alike were taken to move by (0.260, 0) from frame 0 to 1, but may have moved by (-0.340, 0), each";
    assert!(of_pictures.contains(message), "{of_pictures}");
    assert!(of_table.contains("warning[among_alike]: "), "{of_table}");
    let slow = told_of(12);
    assert!(!slow.iter().any(|told| told.contains("among_alike")), "{slow:?}");
}
