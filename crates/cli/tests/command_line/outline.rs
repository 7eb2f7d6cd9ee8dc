use image::{GrayImage, Luma};

use crate::support::{file, run, stderr, stdout, succeed};

/// A mask of a disc.
fn disc(centre: f32) -> Vec<u8> {
    let inside = |x: u32, y: u32| (x as f32 + 0.5 - centre).hypot(y as f32 + 0.5 - 32.0) < 12.0;
    let picture = GrayImage::from_fn(64, 64, |x, y| Luma([if inside(x, y) { 255 } else { 0 }]));
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).expect("a picture");
    png.into_inner()
}

#[test]
fn every_picture_is_one_frame_at_its_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first, second) = (file(folder.path(), "a.png", disc(30.0)), file(folder.path(), "b.png", disc(33.0)));
    let csv = succeed(&format!("outline {first} {second} --fps 4"), "");
    assert!(csv.starts_with("frame,time,x,y"));
    let mean = |frame: &str| {
        let rows: Vec<f64> = csv
            .lines()
            .skip(1)
            .filter(|line| line.starts_with(frame))
            .map(|line| line.split(',').nth(2).expect("x").parse().expect("a number"))
            .collect();
        assert!(rows.len() > 50);
        rows.iter().sum::<f64>() / rows.len() as f64
    };
    assert!((mean("0,0,") - 30.0).abs() < 0.3 && (mean("1,0.25,") - 33.0).abs() < 0.3);
}

#[test]
fn a_picture_without_an_object_leaves_a_gap_and_a_damaged_one_ends_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = file(folder.path(), "good.png", disc(30.0));
    let mut empty = std::io::Cursor::new(Vec::new());
    GrayImage::new(64, 64).write_to(&mut empty, image::ImageFormat::Png).expect("a picture");
    let empty = file(folder.path(), "empty.png", empty.into_inner());
    let damaged = file(folder.path(), "damaged.png", &disc(30.0)[..60]);

    let output = run(&format!("outline {good} {empty} {good}"), "");
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("empty.png"));
    assert!(stdout(&output).contains("\n2,") && !stdout(&output).contains("\n1,"));

    let output = run(&format!("outline {empty}"), "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(1), ""));
    assert_eq!(stderr(&output).lines().count(), 1);

    let output = run(&format!("outline {good} {damaged}"), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(stdout(&output).contains("\n0,") && stderr(&output).contains("damaged.png"));
}
