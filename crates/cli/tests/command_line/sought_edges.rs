//! Objects that cannot be traced as a whole are found by their edges, where they are expected.
use std::path::Path;

use image::{GrayImage, Luma};

use crate::pears::depth_in_pear;
use crate::support::{json, run, stderr, stdout, succeed};

const FRAMES: u32 = 40;

/// A pear that turns and drifts, with grey edges and some noise.
fn pear(frame: u32) -> GrayImage {
    GrayImage::from_fn(240, 200, |column, row| {
        let depth = depth_in_pear(frame, [column, row], [110.0, 110.0], [48.0, 26.0, 0.3]);
        let noise = f64::from((column * 7919 + row * 104_729 + frame * 15_485_863) % 11) - 5.0;
        Luma([(40.0 + 150.0 * (14.0 * depth + 0.5).clamp(0.0, 1.0) + 0.6 * noise) as u8])
    })
}

/// A sequence in which something happens to the pictures 15 to 24.
fn sequence(folder: &Path, happens: impl Fn(&mut GrayImage)) -> String {
    for frame in 0..FRAMES {
        let mut picture = pear(frame);
        if (15..25).contains(&frame) {
            happens(&mut picture);
        }
        picture.save(folder.join(format!("{frame:03}.png"))).expect("a picture");
    }
    folder.to_str().expect("UTF-8").to_owned()
}

/// Fills a rectangle with a grey value.
fn fill(picture: &mut GrayImage, [left, top, right, lower]: [u32; 4], grey: u8) {
    (top..lower).for_each(|row| (left..right).for_each(|column| picture.put_pixel(column, row, Luma([grey]))));
}

#[test]
fn a_larger_object_beside_does_not_hide_the_one_that_is_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = sequence(folder.path(), |picture| fill(picture, [0, 0, 240, 52], 190));
    let output = run(&format!("identify {frames} --light --fps 30 --json"), "");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found = json(&stdout(&output));
    let object = &found["objects"][0];
    assert_eq!((&object["frames"], &object["frames_rejected"]), (&FRAMES.into(), &0.into()));
    // The picture's rows run downwards, so that the turn is positive there.
    let omega = &object["parameters"]["omega"];
    let [value, std] = ["value", "std"].map(|field| omega[field].as_f64().expect("a number"));
    assert!((value - 1.5).abs() < 4.0 * std && std < 0.05, "{value} {std}");
    let told = stderr(&output);
    assert!(
        told.contains("object 0: it was not found as a whole, and parts of it were found by their edges"),
        "{told}"
    );
    assert!(told.contains("in frame(s) 15-24\n"), "{told}");
    // The same frame by frame.
    let lines = succeed(&format!("track {frames} --light --fps 30 --quiet"), "");
    assert_eq!(lines.lines().filter(|line| line.contains("\"accepted\":true")).count(), FRAMES as usize);
}

#[test]
fn an_object_that_is_gone_is_not_found_among_what_is_in_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = sequence(folder.path(), |picture| {
        fill(picture, [0, 0, 240, 200], 40);
        // Stripes, and a larger object elsewhere.
        (60..190).step_by(9).for_each(|column| fill(picture, [column, 60, column + 4, 200], 190));
        fill(picture, [0, 0, 240, 52], 190);
    });
    let output = run(&format!("identify {frames} --light --fps 30 --json"), "");
    let found = json(&stdout(&output));
    let object = &found["objects"][0];
    let [frames, rejected] = ["frames", "frames_rejected"].map(|field| object[field].as_u64().expect("a number"));
    assert_eq!(frames - rejected, u64::from(FRAMES) - 10, "{object}");
    assert!(!stderr(&output).contains("by their edges"), "{}", stderr(&output));
}
