//! What is said of pictures that cannot be read, and of options that do not fit them.
use image::{GrayImage, ImageFormat, Luma};

use crate::pears::{encoded, pear, pears};
use crate::support::{file, run, sequence, stderr, stdout};

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
fn files_named_in_another_order_than_their_numbers_are_warned_of_and_a_quoted_pattern_is_sorted_by_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let (frames, _) = pears(folder.path(), "frames", 12);
    // As a shell orders them.
    let mut named: Vec<String> = (0..12).map(|frame| format!("{frames}/{frame}.png")).collect();
    let in_order = named.join(" ");
    named.sort();
    let told = format!(
        "freeform: warning[files_out_of_order]: {frames}/11.png is taken before {frames}/2.png, in the order in which the files are named"
    );
    for command in ["identify", "track", "outline"] {
        let errors =
            |files: &str, options: &str| stderr(&run(&format!("{command} {files} --light --fps 30 {options}"), ""));
        assert!(errors(&named.join(" "), "").contains(&told), "{command}: {}", errors(&named.join(" "), ""));
        for files in [&in_order, &format!("{frames}/*.png"), &frames] {
            assert!(!errors(files, "").contains("is taken before"), "{command} {files}");
        }
        assert!(!errors(&named.join(" "), "--quiet").contains("is taken before"), "{command}");
    }
    let sorted = run(&format!("outline {frames}/*.png --light --fps 30"), "");
    assert_eq!(stdout(&sorted), stdout(&run(&format!("outline {in_order} --light --fps 30"), "")));
}
