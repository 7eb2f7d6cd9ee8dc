//! Polygons as COCO, labelme and TrackMate write them.
use std::path::PathBuf;

use freeform_curve_fit::Outline;
use freeform_outline_io::{OutlineFile, OutlineFrame, PolygonSettings, ReadError, VerticalAxis};
use nalgebra::Point2;

/// A file of tests/data/polygons.
fn sample(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/polygons").join(name)
}

fn read(names: &[&str], settings: &PolygonSettings) -> Result<Vec<OutlineFrame>, ReadError> {
    let paths: Vec<PathBuf> = names.iter().map(|name| sample(name)).collect();
    OutlineFile::open_polygons(&paths, settings)?.collect()
}

fn read_text(text: &str) -> Result<Vec<OutlineFrame>, ReadError> {
    OutlineFile::polygons_from(text.as_bytes(), "test", &PolygonSettings::default())?.collect()
}

fn points(pairs: &[(f64, f64)]) -> Vec<Point2<f64>> {
    pairs.iter().map(|(x, y)| Point2::new(*x, *y)).collect()
}

fn contours(frame: &OutlineFrame) -> Vec<Vec<Point2<f64>>> {
    frame.outline.pieces().map(|piece| piece.points.to_vec()).collect()
}

/// The samples of COCO and labelme show the same: a nut with a mark that is its second contour, then moved, and a gear.
fn assert_nut_and_gear(frames: &[OutlineFrame], nut: &str) {
    let named: Vec<_> = frames.iter().map(|frame| (frame.frame, frame.time, frame.object.as_str())).collect();
    let mut expected = vec![(0, 0.0, nut), (1, 0.1, nut), (1, 0.1, "gear")];
    expected[1..].sort_by_key(|(.., name)| named[1].2 != *name);
    assert_eq!(named, expected);
    // y upwards from the lower edge of a picture of 30 rows.
    assert_eq!(
        contours(&frames[0]),
        [
            points(&[(10.0, 25.0), (20.0, 25.0), (20.0, 15.0), (10.0, 15.0)]),
            points(&[(12.0, 23.0), (14.0, 23.0), (14.0, 21.0)])
        ]
    );
    let moved = frames[1..].iter().find(|frame| frame.object == nut).expect("the nut");
    assert_eq!(contours(moved), [points(&[(11.5, 25.0), (21.5, 25.0), (21.5, 15.0), (11.5, 15.0)])]);
}

#[test]
fn annotations_of_coco_are_outlines_named_by_track_or_category() {
    let settings = PolygonSettings { frames_per_second: Some(10.0), ..PolygonSettings::default() };
    assert_nut_and_gear(&read(&["coco.json"], &settings).expect("outlines"), "3");
}

#[test]
fn files_of_labelme_are_frames_in_the_natural_order_of_their_pictures() {
    let settings = PolygonSettings { frames_per_second: Some(10.0), ..PolygonSettings::default() };
    let frames = read(&["labelme-10.json", "labelme-9.json"], &settings).expect("outlines");
    assert_nut_and_gear(&frames, "nut-1");
}

#[test]
fn spots_of_trackmate_are_outlines_named_by_branches_of_shown_tracks_at_their_times() {
    let frames = read(&["trackmate.xml"], &PolygonSettings::default()).expect("outlines");
    let named: Vec<_> = frames.iter().map(|frame| (frame.object.as_str(), frame.frame, frame.time)).collect();
    // Half a minute between frames; the track divides after frame 1.
    let expected = [("Track_0", 0, 0.0), ("Track_0", 1, 30.0), ("Track_0.2", 3, 90.0), ("Track_0.3", 3, 90.0)];
    assert_eq!(named, expected);
    // The picture has 20 rows of half a micron.
    assert_eq!(contours(&frames[0]), [points(&[(4.0, 7.0), (6.0, 7.0), (6.0, 5.0), (4.0, 5.0)])]);
    let given = PolygonSettings { frames_per_second: Some(4.0), ..PolygonSettings::default() };
    assert_eq!(read(&["trackmate.xml"], &given).expect("outlines")[3].time, 0.75);
}

#[test]
fn y_downwards_and_the_size_of_a_pixel_are_as_asked() {
    let settings = PolygonSettings { vertical: VerticalAxis::Down, pixel_size: 2.0, ..PolygonSettings::default() };
    let frames = read(&["coco.json"], &settings).expect("outlines");
    assert_eq!(contours(&frames[0])[0], points(&[(20.0, 10.0), (40.0, 10.0), (40.0, 30.0), (20.0, 30.0)]));
    assert!(matches!(frames[0].outline, Outline::Closed(_)));
}

#[test]
fn the_rate_is_assumed_only_where_neither_file_nor_settings_tell() {
    let is_assumed = |name: &str, settings: &PolygonSettings| {
        OutlineFile::open_polygons(&[sample(name)], settings).expect("outlines").is_rate_assumed()
    };
    let given = PolygonSettings { frames_per_second: Some(4.0), ..PolygonSettings::default() };
    assert!(is_assumed("coco.json", &PolygonSettings::default()) && !is_assumed("coco.json", &given));
    assert!(!is_assumed("trackmate.xml", &PolygonSettings::default()));
}

#[test]
fn a_polygon_that_is_no_outline_is_one_item_and_the_rest_is_read() {
    let text = r#"{"images": [{"id": 1, "file_name": "a"}], "annotations": [
        {"id": 1, "image_id": 1, "category_id": 1, "segmentation": [[0, 0, 1, 1]]},
        {"id": 2, "image_id": 1, "category_id": 2, "segmentation": [[0, 0, 1, 0, 0, 1]]}]}"#;
    let file = OutlineFile::polygons_from(text.as_bytes(), "test", &PolygonSettings::default()).expect("polygons");
    let items: Vec<_> = file.collect();
    assert!(items[0].as_ref().is_err_and(ReadError::is_recoverable) && items[1].is_ok());
}

#[test]
fn files_that_cannot_be_used_are_refused_on_one_line() {
    let coco = |image: &str, annotations: &str| {
        format!(
            r#"{{"images": [{image}], "annotations": [{annotations}], "categories": [{{"id": 1, "name": "nut"}}]}}"#
        )
    };
    let image = r#"{"id": 1, "file_name": "a.png", "height": 10}"#;
    let nut = r#"{"id": 5, "image_id": 1, "category_id": 1, "segmentation": [[0, 0, 1, 0, 0, 1]]}"#;
    let videos = r#"{"id": 1, "video_id": 1}, {"id": 2, "video_id": 2}"#;
    let spot = r#"<Spot ID="1" POSITION_X="0" POSITION_Y="0" POSITION_T="0" FRAME="0">0 0 1 0 0 x</Spot>"#;
    for (text, expected) in [
        ("{".to_owned(), "EOF while parsing"),
        ("{}".to_owned(), "no polygons: expected COCO"),
        ("<a></b>".to_owned(), "byte 3: "),
        ("<a/>".to_owned(), "no polygons: expected COCO"),
        (coco(image, &format!("{nut}, {nut}")), "two outlines of \"nut\" in frame 0: give annotations a track_id"),
        (coco("", nut), "annotation 5 is of image 1, which is not among the images"),
        (coco(videos, nut), "images of the videos 1 and 2"),
        (coco(image, &nut.replace("[[0, 0, 1, 0, 0, 1]]", "[[0, 0, 1]]")), "annotation 5: 3 coordinates, expected pairs"),
        (coco(image, &nut.replace("[[0, 0, 1, 0, 0, 1]]", "[]")), "annotation 5 has no polygon"),
        (coco(image, &nut.replace("[[0, 0, 1, 0, 0, 1]]", r#"{"size": [2, 2], "counts": "04"}"#)), "annotation 5 is a run-length mask"),
        (coco(image, &nut.replace("\"image_id\": 1,", "")), "missing field `image_id`"),
        (r#"{"shapes": [{"label": "a", "points": [[0, 0]]}, {"label": "a", "points": [[0, 0]]}], "imagePath": "p.png"}"#.to_owned(),
            "two outlines of \"a\" in p.png: give bodies labels of their own"),
        ("<TrackMate></TrackMate>".to_owned(), "no tracks: link the spots in TrackMate"),
        (format!("<TrackMate>{spot}</TrackMate>"), "its outline of Spot: \"x\" is not a finite number"),
        ("<TrackMate><Spot ID=\"1\"/></TrackMate>".to_owned(), "Spot lacks FRAME"),
    ] {
        let message = read_text(&text).expect_err(&text).to_string();
        assert!(message.contains(expected) && message.starts_with("test: ") && message.lines().count() == 1, "{message}");
    }
    let several = read(&["coco.json", "labelme-9.json"], &PolygonSettings::default());
    assert!(several.expect_err("two kinds").to_string().contains("only those of labelme"));
}

#[test]
fn no_cut_or_changed_byte_brings_the_readers_down() {
    for name in ["coco.json", "labelme-9.json", "trackmate.xml"] {
        let bytes = std::fs::read(sample(name)).expect("a sample");
        let settings = PolygonSettings::default();
        let read = |bytes: &[u8]| OutlineFile::polygons_from(bytes, "test", &settings).map(Iterator::count);
        for at in (0..bytes.len()).step_by(3) {
            let _ = read(&bytes[..at]);
            for value in [0xff, b'"', b'9', b'<', b'-'] {
                let mut changed = bytes.clone();
                changed[at] = value;
                if let Err(error) = read(&changed) {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
    }
}

#[test]
fn a_name_that_every_outline_would_copy_may_not_be_long() {
    let coco = |name: &str| {
        let annotations: Vec<String> = (0..2)
            .map(|image| format!(r#"{{"image_id":{image},"category_id":1,"segmentation":[[0,0,4,0,4,3]]}}"#))
            .collect();
        format!(
            r#"{{"images":[{{"id":0}},{{"id":1}}],"categories":[{{"id":1,"name":"{name}"}}],"annotations":[{}]}}"#,
            annotations.join(",")
        )
    };
    let trackmate = |name: &str| {
        let spot = |id: u8| {
            format!(
                r#"<Spot ID="{id}" FRAME="{id}" POSITION_X="1" POSITION_Y="1" POSITION_T="{id}">0 0 4 0 4 3</Spot>"#
            )
        };
        let edge = r#"<Edge SPOT_SOURCE_ID="0" SPOT_TARGET_ID="1"/>"#;
        format!(r#"<TrackMate>{}{}<Track TRACK_ID="1" name="{name}">{edge}</Track></TrackMate>"#, spot(0), spot(1))
    };
    let (longest, longer) = ("n".repeat(4096), "n".repeat(4097));
    for (whole, refused) in [(coco(&longest), coco(&longer)), (trackmate(&longest), trackmate(&longer))] {
        let frames = read_text(&whole).expect("outlines");
        assert!(frames.len() == 2 && frames.iter().all(|frame| frame.object == longest));
        let message = read_text(&refused).expect_err("a long name").to_string();
        assert_eq!(message, "test: a name of 4097 bytes, up to 4096 are read");
    }
}
