//! Label masks: every value is an object, by its number; flat pictures of one body are none.
use std::path::Path;

use image::{DynamicImage, GrayImage, ImageBuffer, Luma, Rgb, RgbImage};
use serde_json::Value;

use crate::support::{json, run, stderr, stdout, succeed};

const FRAMES: u32 = 20;
pub(crate) const SIZE: [u32; 2] = [240, 160];

/// Angular velocities of the bodies, in rad/s and positive clockwise as one looks at the picture, and where they begin and how they move, in pixels.
const BODIES: [(f64, [f64; 2], [f64; 2]); 3] =
    [(1.2, [50.0, 50.0], [30.0, 10.0]), (-0.8, [140.0, 70.0], [10.0, 40.0]), (0.6, [195.0, 50.0], [-5.0, 20.0])];

/// The body that a pixel belongs to in a frame: letters L of 44 by 36 pixels.
pub(crate) fn body(x: u32, y: u32, frame: u32) -> Option<usize> {
    let time = f64::from(frame) / 25.0;
    BODIES.iter().position(|(omega, place, velocity)| {
        let (x, y) = (f64::from(x) - place[0] - velocity[0] * time, f64::from(y) - place[1] - velocity[1] * time);
        let (sin, cos) = (omega * time).sin_cos();
        let (u, v) = (cos * x + sin * y, cos * y - sin * x);
        (-22.0..22.0).contains(&u) && (-18.0..18.0).contains(&v) && (u < -4.0 || v > 4.0)
    })
}

pub(crate) fn write(folder: &Path, picture: impl Fn(u32) -> DynamicImage) {
    for frame in 0..FRAMES {
        picture(frame).save(folder.join(format!("m{frame}.png"))).expect("a picture");
    }
}

/// Masks of so many bits whose bodies have these values.
pub(crate) fn write_masks(folder: &Path, bits: u32, labels: &[u16]) {
    let value = |x, y, frame| body(x, y, frame).and_then(|body| labels.get(body)).copied().unwrap_or(0);
    write(folder, |frame| match bits {
        8 => GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame) as u8])).into(),
        _ => ImageBuffer::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into(),
    });
}

pub(crate) fn identified(folder: &Path, options: &str) -> Value {
    json(&succeed(&format!("identify {} --fps 25 --json --quiet {options}", folder.display()), ""))
}

/// Names of the objects with their angular velocities.
pub(crate) fn omegas(document: &Value) -> Vec<(String, f64)> {
    let objects = document["objects"].as_array().expect("objects");
    let omega = |object: &Value| object["parameters"]["omega"]["value"].as_f64().unwrap_or(f64::NAN);
    objects.iter().map(|object| (object["object"].as_str().expect("a name").to_owned(), omega(object))).collect()
}

#[test]
fn every_label_of_masks_of_8_and_16_bits_is_an_object_by_its_number() {
    const ASKED: &str = "--objects labels";
    for (bits, labels, options) in [
        (8, &[1, 2][..], ""),
        (8, &[1, 20], ""),
        (8, &[3, 2, 1], ""),
        (8, &[85, 170, 255], ASKED),
        (16, &[1, 2], ""),
        (16, &[1, 20, 3], ""),
        (16, &[300, 7, 1000], ASKED),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        write_masks(folder.path(), bits, labels);
        let found = omegas(&identified(folder.path(), options));
        assert_eq!(found.len(), labels.len(), "{bits} bits, {labels:?}: {found:?}");
        for (label, (truth, ..)) in labels.iter().zip(BODIES) {
            let (_, omega) = found.iter().find(|(name, _)| *name == label.to_string()).expect("the label");
            assert!((omega - truth).abs() < 0.05, "{bits} bits, {labels:?}: {found:?}");
        }
    }
}

#[test]
fn the_colours_of_the_palette_of_label_masks_are_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let colours = [[128, 0, 0], [0, 128, 0], [192, 128, 128]];
    let colour = |x, y, frame| Rgb(body(x, y, frame).map_or([0; 3], |body| colours[body]));
    write(folder.path(), |frame| RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| colour(x, y, frame)).into());
    let mut names: Vec<String> = omegas(&identified(folder.path(), "")).into_iter().map(|(name, _)| name).collect();
    names.sort();
    assert_eq!(names, ["1", "15", "2"]);
}

#[test]
fn that_labels_are_objects_is_said_with_the_option_that_says_it_and_the_one_that_says_otherwise() {
    let folder = tempfile::tempdir().expect("a folder");
    write_masks(folder.path(), 8, &[1, 2, 3]);
    let input = folder.path().display();
    let chosen = run(&format!("outline {input} --fps 25"), "");
    assert!(
        stderr(&chosen).contains("every value but 0 is an object, by its number (3 in the pictures looked at"),
        "{}",
        stderr(&chosen)
    );
    let asked = run(&format!("outline {input} --fps 25 --objects labels"), "");
    assert_eq!((stdout(&asked), stderr(&asked)), (stdout(&chosen), String::new()));
    let lighter = omegas(&identified(folder.path(), "--light --threshold 2.5"));
    assert_eq!(lighter.len(), 1, "{lighter:?}");
    let refused = run(&format!("identify {input} --objects labels --dark"), "");
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("--objects labels: not with --dark"), "{}", stderr(&refused));
}

#[test]
fn a_label_that_is_missing_for_some_frames_keeps_its_name_and_is_not_looked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    write_masks(folder.path(), 8, &[4, 9]);
    let without = |x, y, frame| body(x, y, frame).filter(|body| *body == 0).map_or(0, |_| 4);
    for frame in 8..11 {
        let picture = GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([without(x, y, frame)]));
        picture.save(folder.path().join(format!("m{frame}.png"))).expect("a picture");
    }
    let document = identified(folder.path(), "");
    let frames = |name: &str| {
        let objects = document["objects"].as_array().expect("objects");
        objects.iter().find(|object| object["object"] == name).and_then(|object| object["frames"].as_u64())
    };
    assert_eq!((frames("4"), frames("9")), (Some(20), Some(17)));
}

#[test]
fn a_body_whose_value_changes_from_picture_to_picture_is_one_object() {
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x, y, frame: u32| u8::from(body(x, y, frame) == Some(0)) * (170 + 4 * frame as u8);
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let found = omegas(&identified(folder.path(), ""));
    assert!(matches!(found[..], [(_, omega)] if (omega - 1.2).abs() < 0.05), "{found:?}");
}

#[test]
fn a_mark_on_a_body_in_colours_of_the_palette_of_label_masks_is_no_label() {
    let folder = tempfile::tempdir().expect("a folder");
    let is_mark = |x: u32, y: u32, frame: u32| {
        let [across, up] = [(8, 0), (0, 8)].map(|(dx, dy)| [x + dx, x - dx, y + dy, y - dy]);
        body(across[0], y, frame).is_some()
            && body(across[1], y, frame).is_some()
            && body(x, up[2], frame).is_some()
            && body(x, up[3], frame).is_some()
    };
    let colour = |x: u32, y: u32, frame: u32| match body(x, y, frame) {
        Some(0) if is_mark(x, y, frame) => Rgb([128, 0, 0]),
        Some(0) => Rgb([128, 128, 0]),
        _ => Rgb([0; 3]),
    };
    write(folder.path(), |frame| RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| colour(x, y, frame)).into());
    let output = run(&format!("identify {} --fps 25 --json", folder.path().display()), "");
    assert!(!stderr(&output).contains("label masks"), "{}", stderr(&output));
}

#[test]
fn a_label_too_small_for_an_outline_is_told_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x: u32, y: u32, frame| match body(x, y, frame) {
        Some(0) => 1,
        Some(1) => 2,
        // Six pixels wide and high.
        _ => 3 * u8::from((120..126).contains(&x) && (150..156).contains(&y)),
    };
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let told = stderr(&run(&format!("outline {} --fps 25", folder.path().display()), ""));
    assert!(told.contains("frame 0, label 3: no outline, while others have one"), "{told}");
}

#[test]
fn a_mark_on_a_body_and_grey_edges_are_no_labels() {
    let value = |x: u32, y: u32, frame: u32| match body(x, y, frame) {
        // A mark of 8 pixels in the corner of the letter.
        Some(0)
            if [(0, 3), (3, 0), (0, -3_i32), (-3, 0)].iter().all(|(dx, dy)| {
                body(x.saturating_add_signed(3 * dx), y.saturating_add_signed(3 * dy), frame) == Some(0)
            }) =>
        {
            220
        }
        Some(0) => 110,
        _ => 0,
    };
    let marked = tempfile::tempdir().expect("a folder");
    write(marked.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let smooth = tempfile::tempdir().expect("a folder");
    let inside = |x: u32, y: u32, frame: u32| -> u32 {
        let near = [(0, 0), (1, 0), (0, 1), (1, 1)];
        near.iter().map(|(dx, dy)| u32::from(body(x + dx, y + dy, frame) == Some(1)) * 50).sum()
    };
    write(smooth.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([inside(x, y, frame) as u8])).into());
    for folder in [marked, smooth] {
        let output = run(&format!("identify {} --fps 25 --json", folder.path().display()), "");
        assert!(!stderr(&output).contains("label"), "{}", stderr(&output));
        assert_eq!(omegas(&json(&stdout(&output))).len(), 1);
    }
}

#[test]
fn flat_areas_that_touch_are_told_of_where_their_values_are_no_small_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x: u32, y: u32, frame: u32| {
        let x = x.wrapping_sub(60 + 2 * frame);
        if y.wrapping_sub(40) < 50 && x < 40 {
            120
        } else if y.wrapping_sub(40) < 30 && x < 70 {
            240
        } else {
            0
        }
    };
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let told = stderr(&run(&format!("outline {} --fps 25", folder.path().display()), ""));
    assert!(told.contains("flat areas of 2 values") && told.contains("--objects labels"), "{told}");
    let rows = succeed(&format!("outline {} --fps 25 --objects labels", folder.path().display()), "");
    assert!(["120", "240"].iter().all(|label| rows.contains(&format!(",{label},"))), "{rows:.200}");
}

#[test]
fn a_label_in_two_parts_is_told_of() {
    let folder = tempfile::tempdir().expect("a folder");
    // The third body has the label of the first.
    write_masks(folder.path(), 8, &[1, 2, 1]);
    let told = stderr(&run(&format!("outline {} --fps 25", folder.path().display()), ""));
    assert!(told.contains("frame 0, label 1: the largest part, of ") && told.contains("a label of its own"), "{told}");
}

/// Codes in the column `warning` of a table, of each frame.
fn codes_of_frames(table: &str) -> Vec<(u32, String)> {
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).expect("the column");
    let (frame, warning) = (column("frame"), column("warning"));
    let mut codes: Vec<(u32, String)> = lines
        .map(|line| line.split(',').collect::<Vec<_>>())
        .map(|cells| (cells[frame].parse().expect("a number"), cells[warning].to_owned()))
        .collect();
    codes.dedup();
    codes
}

#[test]
fn what_is_wrong_with_labels_stands_in_their_table_from_the_mask_on_that_shows_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // From the fifth mask on the third body has the label of the first; in the ninth a speck has one.
    let value = |x: u32, y: u32, frame: u32| match body(x, y, frame) {
        Some(2) if frame < 4 => 0,
        Some(body) => [1, 2, 1][body],
        None => 3 * u8::from(frame == 8 && (120..126).contains(&x) && (150..156).contains(&y)),
    };
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let input = folder.path().display();
    let table = succeed(&format!("outline {input} --fps 25"), "");
    let codes = codes_of_frames(&table);
    let expected = |frame: u32| match frame {
        0..4 => "",
        4..8 => "label_in_parts",
        _ => "label_in_parts label_left_out",
    };
    assert!(
        codes.iter().map(|(frame, code)| (*frame, code.as_str())).eq((0..FRAMES).map(|k| (k, expected(k)))),
        "{codes:?}"
    );
    // It is heard again where the table is read, and stands in the document of the masks themselves.
    for document in [json(&succeed("identify - --json --quiet", &table)), identified(folder.path(), "")] {
        let codes: Vec<&str> = document["warnings"]
            .as_array()
            .expect("warnings")
            .iter()
            .filter_map(|told| told["code"].as_str())
            .collect();
        assert_eq!(codes, ["label_in_parts", "label_left_out"]);
    }
}

/// Writes bytes of a PNG of places in a palette.
fn write_indexed(path: &Path, palette: &[[u8; 3]], index: impl Fn(u32, u32) -> u8) {
    let mut encoder = png::Encoder::new(std::fs::File::create(path).expect("a file"), SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.concat());
    let places: Vec<u8> =
        (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).map(|(x, y)| index(x, y)).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&places)).expect("a picture");
}

/// Writes masks whose bodies are these places in a palette, and follows each by that number.
fn assert_places_are_labels(folder: &Path, palette: &[[u8; 3]], places: [u8; 3]) {
    for frame in 0..FRAMES {
        let path = folder.join(format!("m{frame}.png"));
        write_indexed(&path, palette, |x, y| body(x, y, frame).map_or(0, |body| places[body]));
    }
    let found = omegas(&identified(folder, "--objects labels"));
    for (label, (truth, ..)) in places.iter().zip(BODIES) {
        let (_, omega) = found.iter().find(|(name, _)| *name == label.to_string()).expect("the label");
        assert!((omega - truth).abs() < 0.05, "{found:?}");
    }
}

#[test]
fn colours_of_another_palette_are_numbers_where_it_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let palette = [[0, 0, 0], [230, 25, 75], [60, 180, 75], [0, 130, 200]];
    assert_places_are_labels(folder.path(), &palette, [3, 1, 2]);
    // A drawing may have a palette too: it is told of, and traced as it is.
    let told = stderr(&run(&format!("outline {} --fps 25", folder.path().display()), ""));
    assert!(told.contains("flat areas of 3 values") && !told.contains("label masks: every value"), "{told}");
}

#[test]
fn two_places_of_one_colour_in_a_palette_are_two_labels() {
    let folder = tempfile::tempdir().expect("a folder");
    let palette = [[0, 0, 0], [200, 30, 30], [200, 30, 30], [20, 200, 20]];
    assert_places_are_labels(folder.path(), &palette, [1, 2, 3]);
}

#[test]
fn masks_whose_ground_is_another_number_than_0_are_told_what_to_give() {
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x: u32, y: u32, frame: u32| body(x, y, frame).map_or(255, |body| [0, 1, 2][body]);
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let told = stderr(&run(&format!("outline {} --fps 25 --objects labels", folder.path().display()), ""));
    assert!(told.contains("frame 0, label 255: ") && told.contains("give it the number 0"), "{told}");
}

#[test]
fn bodies_of_drawn_pictures_that_one_threshold_leaves_out_are_told_of_with_the_options_that_find_them() {
    for (ground, greys, are_missed) in [(0_u32, [60, 255], true), (120, [40, 250], true), (0, [200, 255], false)] {
        let folder = tempfile::tempdir().expect("a folder");
        // Edges are the mean of four pixels.
        let grey = |x: u32, y: u32, frame: u32| -> u8 {
            let near = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let value = |(dx, dy): (u32, u32)| {
                body(x + dx, y + dy, frame).and_then(|body| greys.get(body)).map_or(ground, |grey| *grey)
            };
            (near.into_iter().map(value).sum::<u32>() / 4) as u8
        };
        write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([grey(x, y, frame)])).into());
        let input = folder.path().display();
        let told = stderr(&run(&format!("identify {input} --fps 25"), ""));
        let note = told.lines().find_map(|line| line.split_once("are not followed: ").map(|(_, options)| options));
        assert_eq!(note.is_some(), are_missed, "{ground}, {greys:?}: {told}");
        let Some((options, _)) = note.and_then(|note| note.split_once(" finds")) else { continue };
        let mut found: Vec<f64> =
            omegas(&identified(folder.path(), options)).into_iter().map(|(_, omega)| omega).collect();
        found.sort_by(f64::total_cmp);
        assert!((found[0] + 0.8).abs() < 0.1 && (found[1] - 1.2).abs() < 0.1, "{options}: {found:?}");
    }
}
