use freeform_motion::curve_fit::{Outline, PixelGrid};
use freeform_motion::sim_camera::{BuiltInShape, Mask};
use nalgebra::{Matrix2, Point2, Vector2};

use crate::support::{file, json, run, stderr, stdout, succeed};

/// One outline of a shape, as a file.
fn known(folder: &tempfile::TempDir, shape: &str) -> String {
    let csv = succeed(&format!("simulate --shape {shape} --noise 0 --seconds 0.03 --points 300"), "");
    file(folder.path(), &format!("{shape}.csv"), csv)
}

#[test]
fn an_object_under_an_affine_motion_has_the_name_of_its_file_and_the_map_that_leads_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["plane", "hat", "phone"].map(|shape| known(&folder, shape));
    let seen = succeed("simulate --shape hat --affine 0.4,1.5,-0.8,0.2,1,2 --scale 1 --seconds 0.5 --noise 0.002", "");
    let document = json(&succeed(&format!("recognise - --format json --known {}", files.join(" ")), &seen));
    assert_eq!(document["schema"], "freeform.recognise/1");
    let object = &document["objects"][0];
    assert_eq!(object["name"], files[1].as_str());
    assert!(object["probability"].as_f64().expect("a number") > 0.99);
    // The map of the last frame, at 14/30 s: the exponential of the generator.
    let generator = nalgebra::Matrix3::new(0.4, 1.5, 1.0, -0.8, 0.2, 2.0, 0.0, 0.0, 0.0);
    let expected = (generator * (14.0 / 30.0)).exp();
    for row in 0..3 {
        for column in 0..3 {
            let found = object["map"][row][column].as_f64().expect("a number");
            assert!((found - expected[(row, column)]).abs() < 0.02, "{found} {expected}");
        }
    }
    let table = succeed(&format!("recognise - --known {}", files.join(" ")), &seen);
    assert!(table.contains("hat.csv") && !table.contains("plane.csv"), "{table}");
}

#[test]
fn what_is_none_of_the_known_outlines_has_no_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["plane", "hat"].map(|shape| known(&folder, shape));
    let seen = succeed("simulate --shape shoe --seconds 0.1 --noise 0.002", "");
    let document = json(&succeed(&format!("recognise - --format json --known {}", files.join(" ")), &seen));
    let object = &document["objects"][0];
    assert!(object["name"].is_null() && object["map"].is_null());
    assert!(object["probability"].as_f64().expect("a number") > 0.99);
    assert!(succeed(&format!("recognise - --known {}", files[0]), &seen).contains("none of them"));
}

#[test]
fn hidden_arcs_are_left_out_and_nothing_else_is_no_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let hat = known(&folder, "hat");
    let seen = succeed("simulate --shape hat --seconds 0.1 --occlusion 0.2", "");
    let output = run(&format!("recognise - --known {hat}"), &seen);
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(1), ""));
    assert!(stderr(&output).contains("a part of the outline is hidden"), "{}", stderr(&output));
}

#[test]
fn a_known_outline_that_is_missing_or_open_is_unusable() {
    let folder = tempfile::tempdir().expect("a folder");
    let seen = succeed("simulate --shape hat --seconds 0.1", "");
    let output = run("recognise - --known nowhere.csv", &seen);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("nowhere.csv"));
    let open = file(folder.path(), "open.csv", succeed("simulate --seconds 0.1 --occlusion 0.2", ""));
    let output = run(&format!("recognise - --known {open}"), &seen);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("open.csv"), "{}", stderr(&output));
}

/// A shape as a mask, moved by a matrix on its unit-size points (y up), 200 pixels to the unit.
fn mask(folder: &tempfile::TempDir, name: &str, shape: BuiltInShape, linear: Matrix2<f64>) -> String {
    let points = shape.shape().sample(800, 0.0);
    let outline =
        Outline::closed(points.iter().map(|p| Point2::from(linear * p.coords)).collect()).expect("an outline");
    let grid = PixelGrid::new([150.0, 150.0], Point2::origin(), Vector2::new(0.005, -0.005));
    let mask = Mask::of_outline(&outline, [300, 300], &grid).expect("a mask");
    let path = folder.path().join(name);
    image::GrayImage::from_raw(300, 300, mask.grey).expect("300 x 300").save(&path).expect("a picture");
    path.display().to_string()
}

#[test]
fn masks_serve_as_known_outlines_and_pictures_as_those_that_are_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let shapes = [BuiltInShape::Plane, BuiltInShape::Hat, BuiltInShape::Phone];
    let known = shapes.map(|shape| mask(&folder, &format!("{shape}.png"), shape, Matrix2::identity()));
    let sheared = Matrix2::new(0.8, 0.5, -0.6, 0.7);
    let seen = mask(&folder, "seen.png", BuiltInShape::Phone, sheared);
    let document = json(&succeed(&format!("recognise {seen} --format json --known {}", known.join(" ")), ""));
    let object = &document["objects"][0];
    assert_eq!(object["name"], known[2].as_str(), "{object}");
    assert!(object["probability"].as_f64().expect("a number") > 0.9, "{object}");
    for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let found = object["map"][row][column].as_f64().expect("a number");
        assert!((found - sheared[(row, column)]).abs() < 0.02, "{object}");
    }
}
