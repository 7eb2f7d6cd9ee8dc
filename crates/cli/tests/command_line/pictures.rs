//! What is said of pictures, and written of them.
use std::path::Path;

use image::{GrayImage, ImageFormat, Luma};

use crate::support::{file, json, run, sequence, stderr, stdout, succeed};

/// A pear that has turned and drifted for so many frames, light on dark, with grey edges.
fn pear(frame: u32) -> GrayImage {
    let angle = 0.05 * f64::from(frame);
    GrayImage::from_fn(160, 120, |column, row| {
        let (x, y) = (f64::from(column) - 70.0 - f64::from(frame), f64::from(row) - 60.0);
        let (x, y) = (x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin());
        let depth = 1.0 - (x / 38.0).powi(2) - (y / (20.0 + 0.25 * x)).powi(2);
        Luma([(30.0 + 180.0 * (12.0 * depth + 0.5).clamp(0.0, 1.0)) as u8])
    })
}

fn encoded(picture: &GrayImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).expect("a picture");
    bytes.into_inner()
}

/// Pears of these frames in a folder of a folder, whose paths are given.
fn pears(base: &Path, name: &str, count: u32) -> (String, String) {
    let frames = base.join(name);
    std::fs::create_dir(&frames).expect("a folder");
    (0..count).for_each(|frame| pear(frame).save(frames.join(format!("{frame}.png"))).expect("a picture"));
    (frames.to_str().expect("UTF-8").to_owned(), base.to_str().expect("UTF-8").to_owned())
}

/// The names in a folder, in order.
fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into()).collect();
    names.sort();
    names
}

#[test]
fn a_jpeg_that_ends_early_is_left_out_and_named_and_the_others_count() {
    let folder = tempfile::tempdir().expect("a folder");
    for frame in 0..5 {
        let mut jpeg = encoded(&pear(frame), ImageFormat::Jpeg);
        if frame == 2 {
            jpeg.truncate(jpeg.len() / 2);
        }
        file(folder.path(), &format!("{frame}.jpg"), jpeg);
    }
    let frames = folder.path().to_str().expect("UTF-8");
    let output = run(&format!("outline {frames} --light --fps 30"), "");
    let named = format!("freeform: warning: {frames}/2.jpg: the picture is damaged: the file ends within it\n");
    assert_eq!((output.status.code(), stderr(&output)), (Some(0), named));
    let csv = stdout(&output);
    assert!(!csv.contains("\n2,") && ["\n0,", "\n1,", "\n3,", "\n4,"].iter().all(|frame| csv.contains(frame)));
    assert_eq!(run(&format!("outline {frames}/2.jpg"), "").status.code(), Some(2));
}

#[test]
fn options_for_pictures_are_refused_where_the_input_is_none() {
    for command in ["identify", "track", "fit"] {
        let output = run(&format!("{command} - --fps 25 --pixel-size 0.5 --ring dark"), &sequence(""));
        assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{command}");
        let expected = "--fps, --ring, --pixel-size: only for pictures, but <stdin> was read as CSV";
        assert!(stderr(&output).contains(expected), "{command}: {}", stderr(&output));
        // Of an input of nothing it is better said that it is empty.
        assert!(stderr(&run(&format!("{command} - --background median"), "")).contains("empty"));
    }
}

#[test]
fn compressed_video_is_told_to_come_through_ffmpeg_to_the_command_as_it_was_typed() {
    let folder = tempfile::tempdir().expect("a folder");
    let mp4 = b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2avc1mp41";
    let video = file(folder.path(), "a clip.mp4", mp4);
    let unnamed = file(folder.path(), "clip", b"\x1a\x45\xdf\xa3\x01\0\0\0\0\0\0\x1f");
    let place = folder.path().to_str().expect("UTF-8");
    for command in ["outline", "identify", "track", "fit"] {
        let pipe = |video: &str, rest: &str| {
            format!("pipe it: ffmpeg -loglevel error -i {video} -f yuv4mpegpipe -pix_fmt yuv420p - | freeform {rest}\n")
        };
        // By its name, and as all that a folder holds.
        for input in [&video, place] {
            let output = assert_cmd::Command::cargo_bin("freeform")
                .expect("the binary is built")
                .args([command, "--background", "median", input, "--fps", "25"])
                .output()
                .expect("the binary runs");
            let errors = stderr(&output);
            assert_eq!((output.status.code(), errors.lines().count()), (Some(2), 1), "{command}");
            let expected = pipe(&format!("'{video}'"), &format!("{command} --background median - --fps 25"));
            assert!(errors.contains("MP4 video is not decoded here") && errors.ends_with(&expected), "{errors}");
        }
        let output = run(&format!("{command} {unnamed} {unnamed}"), "");
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert!(stderr(&output).contains("Matroska or WebM video is not decoded here"), "{}", stderr(&output));
        assert!(stderr(&output).ends_with(&pipe(&unnamed, &format!("{command} -"))), "{}", stderr(&output));
        let piped = std::str::from_utf8(mp4).expect("ASCII");
        assert!(stderr(&run(&format!("{command} -"), piped)).ends_with(&pipe("video.mp4", &format!("{command} -"))));
    }
}

#[test]
fn an_empty_video_is_not_taken_for_an_empty_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let video = file(folder.path(), "clip.mp4", "");
    for command in ["outline", "identify", "track", "fit"] {
        let output = run(&format!("{command} {video} --background median"), "");
        let expected = format!("freeform: {video}: empty, neither outlines (CSV) nor pictures\n");
        assert_eq!((output.status.code(), stderr(&output)), (Some(2), expected), "{command}");
    }
}

#[test]
fn what_is_wrong_with_a_background_is_told_with_its_option() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 2);
    file(folder.path(), "clip.mp4", b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2avc1mp41");
    for channel in ["luminance", "red"] {
        for (background, reason) in [
            ("nosuch.png", "No such file or directory\n"),
            ("frames", "Is a directory\n"),
            ("clip.mp4", "MP4 video is not decoded here, only uncompressed video (y4m) is\n"),
        ] {
            let output = run(&format!("outline {frames} --channel {channel} --background {base}/{background}"), "");
            let expected = format!("freeform: --background {base}/{background}: {reason}");
            assert_eq!((output.status.code(), stderr(&output)), (Some(2), expected), "{channel}");
        }
    }
}

#[test]
fn a_csv_among_several_inputs_is_told_to_be_read_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = file(folder.path(), "outlines.csv", sequence(""));
    for command in ["outline", "identify", "track", "fit"] {
        let output = run(&format!("{command} {csv} {csv}"), "");
        let expected = format!("freeform: {csv}: outlines are read from one CSV file, several inputs are pictures\n");
        assert_eq!((output.status.code(), stderr(&output)), (Some(2), expected), "{command}");
    }
}

#[test]
fn a_file_that_has_no_place_is_told_before_the_work_and_not_after_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 8);
    // A picture that would be warned of.
    GrayImage::new(160, 120).save(format!("{frames}/3.png")).expect("a picture");
    for arguments in [
        "identify --trace",
        "identify --trajectory",
        "identify --svg",
        "identify --report",
        "identify --overlay",
        "fit --svg",
        "outline --output",
    ] {
        let output = run(&format!("{arguments} {base}/no/file.gif {frames}"), "");
        assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{arguments}");
        assert_eq!(
            stderr(&output),
            format!("freeform: {base}/no/file.gif: No such file or directory\n"),
            "{arguments}"
        );
    }
    assert_eq!(names(&base), ["frames"]);
}

#[test]
fn drawings_go_into_a_folder_or_a_gif_and_nothing_is_left_where_there_are_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 3);
    for command in ["outline", "identify", "track"] {
        for name in ["x.png", "x.mp4", "frames/0.png/x"] {
            let output = run(&format!("{command} {frames} --overlay {base}/{name}"), "");
            assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{command} {name}");
        }
        let output = run(&format!("{command} {frames} --overlay {base}/x.png"), "");
        assert!(
            stderr(&output).contains("x.png: drawings go into a folder, or into one animation FILE.gif or FILE.y4m"),
            "{}",
            stderr(&output)
        );
        for drawn in ["drawn", "drawn.gif"] {
            let report = if command == "identify" { format!("--report {base}/report.html") } else { String::new() };
            let output = run(&format!("{command} {base}/missing.png --overlay {base}/{drawn} {report}"), "");
            assert_eq!(output.status.code(), Some(2), "{command}");
        }
        assert_eq!(names(&base), ["frames"], "{command}");
    }
}

#[test]
fn drawings_of_an_earlier_run_are_removed_and_other_pictures_are_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let (many, base) = pears(folder.path(), "many", 5);
    let (few, _) = pears(folder.path(), "few", 2);
    let drawn = format!("{base}/drawn");
    succeed(&format!("outline {many} --overlay {drawn} --output {base}/many.csv"), "");
    assert_eq!(names(&drawn).len(), 5);
    file(folder.path(), "drawn/notes.png", "not a drawing");
    succeed(&format!("track {few} --overlay {drawn}"), "");
    assert_eq!(names(&drawn), ["000000.png", "000001.png", "notes.png"]);

    let other = file(folder.path(), "drawn/000007.png", encoded(&pear(0), ImageFormat::Png));
    let output = run(&format!("track {few} --overlay {drawn}"), "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""));
    assert!(stderr(&output).contains(&format!("{other}: this picture is none that freeform has drawn")));
    assert_eq!(names(&drawn).len(), 4);
}

#[test]
fn drawings_do_not_go_among_the_pictures_of_the_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 3);
    for input in [frames.clone(), format!("{frames}/*.png"), format!("{frames}/0.png {frames}/1.png")] {
        for command in ["outline", "track"] {
            let output = run(&format!("{command} {input} --overlay {base}/frames"), "");
            assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""), "{command} {input}");
            assert!(
                stderr(&output).contains("the pictures of the input are here, draw elsewhere"),
                "{}",
                stderr(&output)
            );
        }
    }
    assert_eq!(names(&frames).len(), 3);
}

#[test]
fn a_report_has_the_settings_that_were_used_and_marks_rejected_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 12);
    // Something else in the place of one.
    let other =
        GrayImage::from_fn(160, 120, |x, y| Luma([if (10..150).contains(&x) && y / 8 == 7 { 210 } else { 30 }]));
    other.save(format!("{frames}/8.png")).expect("a picture");
    let report = |options: &str| {
        succeed(&format!("identify {frames} {options} --quiet --report {base}/report.html"), "");
        std::fs::read_to_string(format!("{base}/report.html")).expect("a report")
    };
    let row = |name: &str, value: &str| format!("<tr><th>{name}</th><td>{value}</td></tr>");
    let html = report("--fps 12.5");
    for (name, value) in [
        ("Motion model", "rigid"),
        ("Method", "filter"),
        ("Frames per second", "12.5"),
        ("Smoothing", "1 pixel in masks, 0.5 pixels in others"),
        ("Thresholds by Otsu", "120 (grey values)"),
        ("Pixel width over height", "1"),
    ] {
        assert!(html.contains(&row(name, value)), "{name}: {html}");
    }
    let rejected = html.lines().find(|line| line.contains("Rejected frames"));
    assert!(html.contains("<p>Rejected frames: 8</p>"), "{rejected:?}");
    // One line in each of the two panels and one in each of their legends, and no cross on the lower edge.
    assert_eq!((html.matches("class=\"s s1\"").count(), html.matches("rejected frames</text>").count()), (4, 2));
    let html = report("--light --method adaptive --degree 4 --pixel-aspect 1.1");
    for (name, value) in [
        ("Degree of the curve", "4"),
        ("Frames per second", "30, assumed, as none is given"),
        ("Pixel width over height", "1.1"),
    ] {
        assert!(html.contains(&row(name, value)), "{name}: {html}");
    }
}

#[test]
fn json_says_what_b_is_and_which_pictures_were_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 8);
    GrayImage::new(160, 120).save(format!("{frames}/3.png")).expect("a picture");
    let document = json(&succeed(&format!("identify {frames} --json --quiet --pixel-aspect 1.2 --scale 2"), ""));
    let b = serde_json::json!({"point": "the lower left corner", "unit": "pixel heights/s", "scale": 2.0});
    assert_eq!(document["b"], b);
    assert_eq!(document["left_out"]["count"], 1);
    let picture = &document["left_out"]["pictures"][0];
    assert_eq!(picture["frame"], 3);
    assert!(picture["reason"].as_str().expect("text").contains("every pixel has the grey value 0"), "{picture}");

    let document = json(&succeed("identify - --json --quiet", &sequence("")));
    let b = serde_json::json!({"point": "the origin of the coordinates", "unit": "lengths/s", "scale": null});
    assert_eq!((&document["b"], &document["left_out"]["count"]), (&b, &0.into()));
}

#[test]
fn without_a_motion_files_hold_what_is_known_or_are_said_not_to_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = pears(folder.path(), "frames", 1);
    let outputs = format!("--trace {base}/trace.csv --trajectory {base}/poses.csv --svg {base}/figure.svg");
    let output = run(&format!("identify {frames} {outputs}"), "");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--svg: not written, there is no motion to draw"), "{}", stderr(&output));
    assert_eq!(names(&base), ["frames", "poses.csv", "trace.csv"]);
    let trace = std::fs::read_to_string(format!("{base}/trace.csv")).expect("a trace");
    assert_eq!(trace.lines().nth(1), Some("0,0,0,acquiring,true,,,,,,"));

    let bare = tempfile::tempdir().expect("a folder");
    let outputs = outputs.replace(&base, bare.path().to_str().expect("UTF-8"));
    GrayImage::new(160, 120).save(format!("{frames}/0.png")).expect("a picture");
    let output = run(&format!("identify {frames} {outputs}"), "");
    assert_eq!(output.status.code(), Some(1));
    let expected = "--trace, --trajectory, --svg: not written, no outline could be used";
    assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    assert_eq!(names(bare.path().to_str().expect("UTF-8")), [""; 0]);
}

/// Twelve pictures of two grey values.
fn masks_of_pears(folder: &Path) -> (String, String) {
    let (frames, base) = pears(folder, "frames", 12);
    for frame in 0..12 {
        let mask =
            GrayImage::from_fn(160, 120, |x, y| Luma([if pear(frame).get_pixel(x, y).0[0] > 120 { 255 } else { 0 }]));
        mask.save(format!("{frames}/{frame}.png")).expect("a picture");
    }
    (frames, base)
}

#[test]
fn the_rounding_of_masks_to_pixels_is_part_of_the_deviations_unless_an_edge_uncertainty_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = masks_of_pears(folder.path());
    let outlines = format!("{base}/outlines.csv");
    succeed(&format!("outline {frames} --fps 30 --output {outlines}"), "");
    let omega = |input: &str| {
        let document = json(&succeed(&format!("identify {input} --json --quiet"), ""));
        ["value", "std"].map(|field| {
            document["objects"][0]["parameters"]["omega"][field].as_f64().unwrap_or_else(|| panic!("{document}"))
        })
    };
    let of_masks = omega(&format!("{frames} --fps 30"));
    assert_eq!(omega(&format!("{outlines} --mask-pixel 1")), of_masks);
    // Nothing is known of outlines from elsewhere, and what is given is obeyed.
    let of_outlines = omega(&outlines);
    assert!(of_outlines[1] < of_masks[1], "{of_outlines:?} {of_masks:?}");
    assert_eq!(omega(&format!("{frames} --fps 30 --edge-uncertainty 0")), of_outlines);
}

#[test]
fn the_deviations_of_the_last_pose_are_those_of_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, base) = masks_of_pears(folder.path());
    let document = json(&succeed(&format!("identify {frames} --json --quiet --trajectory {base}/poses.csv"), ""));
    let poses = std::fs::read_to_string(format!("{base}/poses.csv")).expect("poses");
    let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let (header, last) = (split(poses.lines().next().expect("a header")), split(poses.lines().last().expect("rows")));
    for name in ["omega", "b1", "b2"] {
        let column = header.iter().position(|head| *head == format!("{name}_std")).expect("a column");
        let (of_row, of_table) = (&last[column], &document["objects"][0]["parameters"][name]["std"]);
        let (of_row, of_table): (f64, f64) = (of_row.parse().expect("a number"), of_table.as_f64().expect("a number"));
        assert!((of_row - of_table).abs() < 1e-6 * of_table, "{name}: {of_row} {of_table}");
    }
}

#[test]
fn the_same_of_many_pictures_is_said_once_with_what_may_help() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 9);
    for frame in [1, 4, 5, 6] {
        // Uneven ground, and nothing on it.
        let noise = |x: u32, y: u32| ((x * 7919 + y * 104_729 + x * y * frame) % 61) as u8;
        GrayImage::from_fn(160, 120, |x, y| Luma([60 + noise(x, y)]))
            .save(format!("{frames}/{frame}.png"))
            .expect("a picture");
    }
    for command in ["outline", "track", "identify", "fit"] {
        let output = run(&format!("{command} {frames} --light --fps 30"), "");
        let errors = stderr(&output);
        let told: Vec<&str> =
            errors.lines().filter(|line| line.contains(".png") || line.contains("pictures")).collect();
        assert_eq!(told.len(), 2, "{command}: {errors}");
        assert!(
            told[0].contains("1.png") && told[0].contains("; try --threshold, --dark, --background median"),
            "{errors}"
        );
        assert!(told[1].ends_with("3 more pictures left out for the same reason: 4-6"), "{errors}");
    }
    let output = run(&format!("outline {frames}/4.png --dark"), "");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("; try --threshold, --light, --background median"), "{}", stderr(&output));
}

#[test]
fn values_out_of_range_are_refused_with_the_range() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 3);
    for (arguments, status, message) in [
        (format!("identify {frames} --pixel-size -1"), 2, "-1 is not above 0"),
        (format!("outline {frames} --smoothing -0.5"), 2, "-0.5 is below 0"),
        (format!("fit {frames} --light --frame 7"), 1, "no frame 7, there are frames 0-2"),
    ] {
        let output = run(&arguments, "");
        assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(status), 1), "{arguments}");
        assert!(stderr(&output).contains(message), "{arguments}: {}", stderr(&output));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn on_a_terminal_no_progress_bar_stands_in_the_lines_of_a_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 4);
    let binary = assert_cmd::cargo::cargo_bin("freeform");
    for (command, start) in [("track", "{\"schema\""), ("outline", "frame,time"), ("fit", "object 0, frame")] {
        let line = format!("'{}' {command} {frames}", binary.display());
        let Ok(output) = std::process::Command::new("script").args(["-qec", &line, "/dev/null"]).output() else {
            println!("skipped: there is no program script, which makes a terminal");
            return;
        };
        let printed = stdout(&output);
        let results: Vec<&str> = printed.lines().filter(|line| line.contains(start)).collect();
        assert!(!results.is_empty() && results.iter().all(|line| line.starts_with(start)), "{command}: {printed}");
    }
}

#[test]
fn without_options_the_way_of_tracing_is_found_printed_and_gives_the_same_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    for (scene, seed, expected) in
        [("accelerating-l", 0, "--dark"), ("gear", 1, "--light"), ("belt", 1, "--objects all")]
    {
        let frames = format!("{base}/{scene}");
        succeed(&format!("simulate --pictures {frames} --scene {scene} --seed {seed} --seconds 0.5"), "");
        let chosen = run(&format!("outline {frames} --fps 30"), "");
        let errors = stderr(&chosen);
        let note = errors.lines().find_map(|line| line.strip_prefix("freeform: note: traced with ")).expect("a note");
        let options = note.split(" (").next().expect("options");
        assert!(options.contains(expected), "{scene}: {note}");
        let again = run(&format!("outline {frames} --fps 30 {options}"), "");
        assert_eq!((stdout(&again), stderr(&again)), (stdout(&chosen), String::new()), "{scene}: {note}");
    }
}

#[test]
fn an_assumed_rate_and_a_choice_without_conviction_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 4);
    let told = stderr(&run(&format!("outline {frames} --light"), ""));
    assert!(told.contains("30 frames/s assumed") && told.contains("--fps"), "{told}");
    let noise = folder.path().join("noise");
    std::fs::create_dir(&noise).expect("a folder");
    for frame in 0..6_u32 {
        let value = |x: u32, y: u32| ((x * 7919 + y * 104_729 + (x * y + frame * 77) * (frame + 3)) % 61) as u8;
        GrayImage::from_fn(160, 120, |x, y| Luma([60 + value(x, y)]))
            .save(noise.join(format!("{frame}.png")))
            .expect("a picture");
    }
    let output = run(&format!("identify {} --fps 30", noise.display()), "");
    let told = stderr(&output);
    assert!(output.status.code() == Some(1) || told.contains("beyond doubt"), "{told}");
}

#[test]
fn discs_that_roll_tell_their_turn_by_their_holes_and_not_without_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().to_str().expect("UTF-8");
    for (scene, has_holes) in [("marked-discs", true), ("discs", false)] {
        let frames = format!("{base}/{scene}");
        succeed(&format!("simulate --pictures {frames} --scene {scene} --seed 1 --seconds 1"), "");
        let document = json(&succeed(&format!("identify {frames} --fps 30 --quiet --json"), ""));
        let truth = std::fs::read_to_string(format!("{frames}/truth.csv")).expect("the truth");
        let last: Vec<Vec<String>> =
            truth.lines().rev().take(2).map(|line| line.split(',').map(str::to_owned).collect()).collect();
        for (object, row) in document["objects"].as_array().expect("objects").iter().zip(last.iter().rev()) {
            let omega = &object["parameters"]["omega"]["value"];
            let truth: f64 = row[6].parse().expect("a number");
            match omega.as_f64() {
                Some(omega) => assert!(has_holes && (omega / truth - 1.0).abs() < 0.01, "{scene}: {omega} {truth}"),
                None => assert!(!has_holes, "{scene}: {object}"),
            }
        }
        assert_eq!(document["objects"].as_array().map(Vec::len), Some(2), "{scene}");
    }
}

#[test]
fn deviations_of_points_are_written_where_they_are_asked_for_and_weigh_the_points_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 6);
    let plain = succeed(&format!("outline {frames} --quiet"), "");
    let with_deviations = succeed(&format!("outline {frames} --quiet --deviations"), "");
    let rows =
        |text: &str| -> Vec<String> { text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect() };
    let (plain_rows, rows) = (rows(&plain), rows(&with_deviations));
    assert!(rows[0].ends_with(",deviation") && !plain_rows[0].contains("deviation"), "{}", rows[0]);
    assert_eq!(rows.len(), plain_rows.len());
    for (row, plain) in rows[1..].iter().zip(&plain_rows[1..]) {
        let (point, deviation) = row.rsplit_once(',').expect("columns");
        assert_eq!(point, plain);
        assert!(deviation.parse::<f64>().is_ok_and(|deviation| deviation > 0.0), "{row}");
    }
    let identified = |outlines: &str| json(&succeed("identify - --json --quiet", outlines))["objects"].clone();
    assert_ne!(identified(&with_deviations)[0]["parameters"]["omega"], identified(&plain)[0]["parameters"]["omega"]);
    // Parquet has the same, to the last bit.
    let parquet = folder.path().join("a.parquet").display().to_string();
    succeed(&format!("outline {frames} --quiet --deviations --output {parquet}"), "");
    let from_parquet = json(&succeed(&format!("identify {parquet} --json --quiet"), ""));
    assert_eq!(from_parquet["objects"], identified(&with_deviations));
}
