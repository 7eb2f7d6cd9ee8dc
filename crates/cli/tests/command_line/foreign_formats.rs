//! Files that are neither outlines nor pictures that are read: what they are, and what to do, on one line.
use image::GrayImage;

use crate::support::{file, json, run, stderr, stdout, succeed};

#[test]
fn files_of_other_kinds_are_named_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let heic = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic";
    for (name, content, expected) in [
        ("masks.npy", &b"\x93NUMPY\x01\0v\0{'descr': '|u1'}"[..], "a NumPy array: save masks as PNG"),
        ("masks.npz", b"PK\x03\x04\0\0\0\0\0\0", "NumPy arrays: save masks as PNG"),
        ("table.xlsx", b"PK\x03\x04\0\0\0\0\0\0", "a spreadsheet: save it as CSV"),
        ("masks.h5", b"\x89HDF\r\n\x1a\n\0\0", "HDF5: save masks as PNG"),
        ("masks.mat", b"MATLAB 5.0 MAT-file", "a MATLAB file: save masks as PNG"),
        ("photo.heic", heic, "pictures of type image/heic are not supported: convert them to PNG"),
        ("photo.avif", b"\0\0\0\x18ftypavif\0\0\0\0mif1avif", "image/avif are not supported: convert them to PNG"),
        (
            "dates.csv",
            b"frame,time,x,y\n0,2024-05-01T10:00:00Z,1,2\n",
            "dates.csv:2: column time: \"2024-05-01T10:00:00Z\" is a date or a time of day",
        ),
        ("german.csv", b"frame,time,x,y\n0,5.1.2024 10:00,1,2\n", "is a date or a time of day: give seconds"),
        // A column of a table may be called as a format is.
        ("columns.csv", b"MATLAB_id,frame,time,x\n0,0,0,1\n", "columns.csv:1: missing column(s) y"),
        ("masks73.mat", b"MATLAB 7.3 MAT-file", "a MATLAB file: save masks as PNG"),
        ("clock.csv", b"frame,time,x,y\n0,10:00:01.5,1,2\n", "is a date or a time of day: give seconds"),
    ] {
        let path = file(folder.path(), name, content);
        let output = run(&format!("identify {path}"), "");
        let told = stderr(&output);
        assert!(told.contains(expected) && told.lines().count() == 1, "{name}: {told}");
        assert_eq!(output.status.code(), Some(2), "{name}");
    }
    let alone = folder.path().join("alone");
    std::fs::create_dir(&alone).expect("a folder");
    file(&alone, "photo.heic", heic);
    let told = stderr(&run(&format!("identify {}", alone.display()), ""));
    assert!(told.contains("photo.heic: pictures of type image/heic"), "{told}");
}

#[test]
fn pictures_of_pgm_and_ppm_are_read_as_png_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let outlines = |extension: &str| {
        let pictures = folder.path().join(extension);
        std::fs::create_dir(&pictures).expect("a folder");
        for frame in 0..4_u32 {
            let is_light =
                |x: u32, y: u32| (10 + 2 * frame..40 + 2 * frame).contains(&x) && (10..30 + x / 4).contains(&y);
            let picture = GrayImage::from_fn(80, 60, |x, y| image::Luma([if is_light(x, y) { 200 } else { 30 }]));
            let path = pictures.join(format!("{frame}.{extension}"));
            match extension {
                "ppm" => image::DynamicImage::from(picture).into_rgb8().save(path),
                _ => picture.save(path),
            }
            .expect("a picture");
        }
        stdout(&run(&format!("outline {} --fps 10", pictures.display()), ""))
    };
    let [png, pgm, ppm] = ["png", "pgm", "ppm"].map(outlines);
    assert!(png.lines().count() > 100, "{png}");
    assert_eq!((&pgm, &ppm), (&png, &png));
}

#[test]
fn polygons_by_their_corners_alone_are_told_why_nothing_is_stated() {
    let quadrilateral = vec![(0.0, 0.0), (3.0, 0.2), (2.5, 2.0), (0.4, 1.5)];
    let star: Vec<_> =
        (0..10_u8).map(|i| (f64::from(i) / 10.0 * std::f64::consts::TAU, 1.0 + 0.3 * f64::from(i % 2))).collect();
    let squashed = |by: f64| -> Vec<_> {
        star.iter().map(|(angle, radius)| (radius * angle.cos(), by * radius * angle.sin())).collect()
    };
    let (star, regular) = (squashed(0.7), squashed(1.0));
    let rows = |corners: &[(f64, f64)], per_side: u32| -> String {
        let row = |frame: u32, (x, y): (f64, f64)| {
            let (sin, cos) = (0.1 * f64::from(frame)).sin_cos();
            let time = f64::from(frame) / 10.0;
            format!("{frame},{time},{},{}\n", cos * x - sin * y + time, sin * x + cos * y)
        };
        let sides: Vec<_> = corners.iter().zip(corners.iter().cycle().skip(1)).collect();
        let along = |i: u32| f64::from(i) / f64::from(per_side);
        let points = || {
            sides.iter().flat_map(|(a, b)| {
                (0..per_side).map(move |i| (a.0 + along(i) * (b.0 - a.0), a.1 + along(i) * (b.1 - a.1)))
            })
        };
        let frames = (0..12).flat_map(|frame| points().map(move |point| row(frame, point)));
        "frame,time,x,y\n".to_owned() + &frames.collect::<String>()
    };
    let told = |corners: &[(f64, f64)], per_side: u32| stderr(&run("identify -", &rows(corners, per_side)));
    let of_four = told(&quadrilateral, 1);
    assert!(of_four.contains("along the sides of a polygon too") && of_four.lines().count() == 1, "{of_four}");
    // Which of its points of a star is where nobody knows: another turn explains the corners as well.
    let of_ten = told(&regular, 1);
    assert!(of_ten.contains("every outline has 10 points") && of_ten.contains("along the sides too"), "{of_ten}");
    // Of another with corners all its own the frames are aligned together.
    assert!(!told(&star, 1).contains("along the sides"));
    let found = json(&succeed("identify - --json", &rows(&star, 1)));
    let omega = &found["objects"][0]["parameters"]["omega"];
    let [value, std] = ["value", "std"].map(|field| omega[field].as_f64().expect("a number"));
    assert!((value + 1.0).abs() < 3.0 * std && std < 0.1, "{value} {std}");
    // Points along the sides of a circle would not show its turn either.
    let circle: Vec<_> = (0..20_u8).map(|i| (f64::from(i) / 20.0 * std::f64::consts::TAU).sin_cos()).collect();
    for along in [told(&quadrilateral, 20), told(&star, 10), told(&circle, 1)] {
        assert!(!along.contains("along the sides"), "{along}");
    }
}
