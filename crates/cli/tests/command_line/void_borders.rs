//! Label masks that mark the borders of objects as void.
use std::path::Path;

use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};

use crate::label_masks::{SIZE, body, identified, omegas, write, write_masks};
use crate::support::{json, run, stderr, stdout, succeed};

#[test]
fn borders_that_are_marked_as_void_belong_to_their_objects_up_to_the_middle_and_are_told_of() {
    let void = |x: u32, y: u32, frame: u32| {
        let own = body(x, y, frame);
        let near = (-2..=2_i32).flat_map(|dx| (-2..=2_i32).map(move |dy| (dx, dy)));
        let differs =
            |(dx, dy): (i32, i32)| body(x.saturating_add_signed(dx), y.saturating_add_signed(dy), frame) != own;
        near.filter(|(dx, dy)| dx * dx + dy * dy <= 5).any(differs)
    };
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x: u32, y: u32, frame: u32| {
        if void(x, y, frame) { 255 } else { body(x, y, frame).map_or(0, |body| [1, 2, 3][body]) }
    };
    write(folder.path(), |frame| GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y, frame)])).into());
    let plain = tempfile::tempdir().expect("a folder");
    write_masks(plain.path(), 8, &[1, 2, 3]);
    let area = |folder: &Path| {
        let table = succeed(&format!("outline {} --fps 25", folder.display()), "");
        let points =
            table.lines().filter(|line| line.starts_with("0,")).map(|line| line.split(',').collect::<Vec<_>>());
        let points: Vec<(f64, f64)> = points
            .filter(|cells| cells[4] == "1")
            .map(|cells| (cells[2].parse().expect("x"), cells[3].parse().expect("y")))
            .collect();
        let pairs = points.iter().zip(points.iter().cycle().skip(1));
        0.5 * pairs.map(|((x, y), (u, v))| x * v - u * y).sum::<f64>().abs()
    };
    let [with_void, without] = [area(folder.path()), area(plain.path())];
    assert!((with_void / without - 1.0).abs() < 0.03, "{with_void} {without}");
    let document = identified(folder.path(), "");
    let found = omegas(&document);
    assert_eq!(found.len(), 3, "{found:?}");
    assert_eq!(document["warnings"][0]["code"], "void_borders");
    let told = stderr(&run(&format!("outline {} --fps 25 --objects labels", folder.path().display()), ""));
    assert!(told.contains("marked as void (255)"), "{told}");
}

/// The value of a mask of the first body with a border of void around it.
fn with_void(own: u8, x: u32, y: u32, frame: u32) -> u8 {
    let has = |dx: i32, dy: i32| body(x.saturating_add_signed(dx), y.saturating_add_signed(dy), frame) == Some(0);
    match (has(0, 0), [(2, 0), (-2, 0), (0, 2), (0, -2)].into_iter().all(|(dx, dy)| has(dx, dy) == has(0, 0))) {
        (_, false) => 255,
        (true, true) => own,
        (false, true) => 0,
    }
}

#[test]
fn a_mask_of_one_object_with_a_void_border_is_a_label_mask_and_drawings_and_smoothed_masks_are_none() {
    let voc = |value: u8| match value {
        0 => Rgb([0; 3]),
        255 => Rgb([224, 224, 192]),
        _ => Rgb([192, 128, 128]),
    };
    let told = |picture: &dyn Fn(u32) -> DynamicImage| {
        let folder = tempfile::tempdir().expect("a folder");
        write(folder.path(), picture);
        let output = run(&format!("identify {} --fps 25 --json", folder.path().display()), "");
        let codes: Vec<String> = json(&stdout(&output))["warnings"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(|told| told["code"].as_str().map(str::to_owned))
            .collect();
        (stderr(&output), codes, omegas(&json(&stdout(&output))))
    };
    let grey = |value: &dyn Fn(u32, u32) -> u8| -> DynamicImage {
        GrayImage::from_fn(SIZE[0], SIZE[1], |x, y| Luma([value(x, y)])).into()
    };
    let of_voc = |frame| RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| voc(with_void(15, x, y, frame))).into();
    for (name, (_, codes, found)) in
        [("1", told(&|frame| grey(&|x, y| with_void(1, x, y, frame)))), ("15", told(&of_voc))]
    {
        assert_eq!(codes, ["void_borders"]);
        assert!(matches!(&found[..], [(label, omega)] if label == name && (omega - 1.2).abs() < 0.05), "{found:?}");
    }
    // A body with a light line around it may be drawn: the option is named.
    let (drawn, codes, _) = told(&|frame| grey(&|x, y| with_void(20, x, y, frame)));
    assert!(drawn.contains("--objects labels takes") && !codes.contains(&"void_borders".to_owned()), "{drawn}");
    // How sure a program is of each pixel, and a mask with a smoothed edge.
    let levels = |frame: u32, steps: u32| {
        move |x: u32, y: u32| {
            let near = (0..steps).flat_map(|dx| (0..steps).map(move |dy| (dx, dy)));
            let count = near.filter(|(dx, dy)| body(x + dx, y + dy, frame) == Some(0)).count() as u32;
            (255 * count / (steps * steps)) as u8
        }
    };
    for steps in [1, 2, 6] {
        let (told, codes, _) = told(&|frame| grey(&levels(frame, steps)));
        assert!(!told.contains("label") && !codes.contains(&"void_borders".to_owned()), "{steps}: {told}");
    }
}
