//! Objects that touch in a table of outlines, and in pictures.
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

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
        let rows = text.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
        let names: BTreeSet<String> = rows.filter_map(|row| row.split(',').nth(4).map(str::to_owned)).collect();
        (names.len(), stderr(&output))
    };
    let (names, told) = outline(&passing(folder.path(), "long", 70..210));
    assert!(names > 2, "{names}: {told}");
    assert!(told.contains("freeform: note: object 2, new in frame ") && told.contains("'freeform identify'"), "{told}");
    // For a short while it keeps its number, and nothing is said.
    let (names, told) = outline(&passing(folder.path(), "short", 120..150));
    assert!(names == 2 && !told.contains("may be object"), "{names}: {told}");
}

#[test]
fn an_object_is_followed_through_a_long_contact_in_the_pictures_themselves() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = passing(folder.path(), "long", 70..210);
    let found = json(&succeed(&format!("identify {pictures} --light --objects all --fps 25 --quiet --json"), ""));
    // In frames of before, of the contact and of after it; rows run downwards, so that its turn is positive.
    let is_whole = |object: &&serde_json::Value| object["frames"].as_u64().is_some_and(|frames| frames > 24);
    let object = found["objects"].as_array().expect("a list").iter().find(is_whole).expect("an object that is kept");
    let omega = &object["parameters"]["omega"];
    let [value, std] = ["value", "std"].map(|field| omega[field].as_f64().expect("a number"));
    assert!((value - 1.5).abs() < 4.0 * std && std < 0.4, "{value} {std}");
}
