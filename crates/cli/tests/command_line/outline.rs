use image::{GrayImage, Luma};

use crate::support::{file, freeform, json, run, stderr, stdout, succeed};

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
fn pictures_without_an_object_and_damaged_ones_leave_gaps() {
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

    let output = run(&format!("outline {damaged} {good}"), "");
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("\n1,") && stderr(&output).contains("damaged.png"));
    let output = run(&format!("outline {damaged}"), "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""));
    assert_eq!(stderr(&output).lines().count(), 1);
}

/// The names of the files in a folder, and the size of one of them as a picture.
fn drawn(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn pictures_are_identified_directly_and_drawn_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..12_u32 {
        let centre = 24.0 + frame as f32;
        file(&frames, &format!("f{frame}.png"), disc(centre));
    }
    let (frames, base) = (frames.to_str().expect("UTF-8"), folder.path().to_str().expect("UTF-8"));
    let text = succeed(&format!("identify {frames} --fps 10 --json --quiet --overlay {base}/drawn"), "");
    // A disc does not show its turn, nor then the velocity at the corner of the picture: that of its middle is stated.
    let object = &json(&text)["objects"][0];
    assert!(object["parameters"]["omega"]["value"].is_null() && object["parameters"]["b1"]["value"].is_null());
    let v1 = object["velocity"]["value"][0].as_f64().expect("a velocity");
    assert!((v1 - 10.0).abs() < 0.3, "{v1}");
    let names = drawn(&folder.path().join("drawn"));
    assert_eq!((names.len(), names[11].as_str()), (12, "000011.png"));
    let picture = image::open(folder.path().join("drawn/000011.png")).expect("a picture").into_rgb8();
    assert!(picture.pixels().any(|pixel| pixel.0[0] > pixel.0[2].saturating_add(60)), "a yellow outline");
    let is_green = |pixel: &image::Rgb<u8>| pixel.0[1] > pixel.0[0].saturating_add(60);
    assert!(!picture.pixels().any(is_green), "no arrows and no curve: neither motion nor a curve is known");

    let lines = succeed(&format!("track {frames}/*.png --fps 10 --overlay {base}/drawn.gif"), "");
    assert_eq!(lines.lines().count(), 12);
    let again = succeed(&format!("outline {base}/drawn.gif --output {base}/again.csv"), "");
    assert_eq!(again, "");

    let csv = succeed(&format!("outline {frames} --fps 10"), "");
    let from_csv = succeed("identify - --json --quiet", &csv);
    let mut of_csv = json(&from_csv)["objects"][0]["parameters"].clone();
    for name in ["b1", "b2"] {
        // In a file lengths have no name, in pictures they are pixels, as the table says.
        assert_eq!(of_csv[name]["unit"], "1/s");
        of_csv[name]["unit"] = "px/s".into();
    }
    assert_eq!(of_csv, json(&text)["objects"][0]["parameters"]);
    let refused = run(&format!("identify - --overlay {base}/none"), &csv);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("--overlay draws on pictures"), "{}", stderr(&refused));
}

#[test]
fn video_comes_through_a_pipe() {
    let mut video = b"YUV4MPEG2 W64 H64 F10:1 Cmono\n".to_vec();
    for frame in 0..6 {
        let picture = image::load_from_memory(&disc(26.0 + 2.0 * frame as f32)).expect("a picture").into_luma8();
        video.extend(b"FRAME\n");
        video.extend(picture.as_raw());
    }
    let output = freeform("identify - --json --quiet").write_stdin(video.clone()).output().expect("the binary runs");
    let v1 = json(&stdout(&output))["objects"][0]["velocity"]["value"][0].as_f64().expect("a velocity");
    assert!((v1 - 20.0).abs() < 0.6, "{v1}");
    video.truncate(video.len() - 100);
    let output = freeform("track -").write_stdin(video).output().expect("the binary runs");
    assert_eq!((output.status.code(), stdout(&output).lines().count()), (Some(0), 5));
    assert!(stderr(&output).contains("<stdin>: frame 5: the video ends within a frame"), "{}", stderr(&output));
}

/// A PNG that says it is 20000 x 20000 pixels large, as far as its header.
fn huge_png() -> Vec<u8> {
    let mut chunk = Vec::from(b"IHDR");
    chunk.extend(20_000_u32.to_be_bytes());
    chunk.extend(20_000_u32.to_be_bytes());
    chunk.extend([8, 0, 0, 0, 0]);
    let crc = !chunk.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    });
    let mut png = Vec::from(b"\x89PNG\r\n\x1a\n");
    png.extend(13_u32.to_be_bytes());
    png.extend(&chunk);
    png.extend(crc.to_be_bytes());
    png.extend([0, 0, 1, 0]);
    png.extend(b"IDAT");
    png
}

#[test]
fn bad_pictures_are_named_in_one_line_and_the_good_ones_still_count() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut black = std::io::Cursor::new(Vec::new());
    GrayImage::new(64, 64).write_to(&mut black, image::ImageFormat::Png).expect("a picture");
    let mut small = std::io::Cursor::new(Vec::new());
    GrayImage::new(20, 20).write_to(&mut small, image::ImageFormat::Png).expect("a picture");
    let bad = [
        ("1-empty.png", Vec::new(), 2, "the file is empty"),
        ("2-text.png", b"this is text".to_vec(), 2, "not a picture"),
        ("3-cut.png", disc(30.0)[..60].to_vec(), 2, "the picture is damaged"),
        ("4-huge.png", huge_png(), 2, "20000 x 20000 pixels, more than"),
        ("5-cut.gif", b"GIF89a\x10\x00".to_vec(), 2, "the picture is damaged"),
        ("6-black.png", black.into_inner(), 1, "no object: every pixel has the grey value 0"),
    ];
    for (name, content, status, message) in &bad {
        let name = file(path, name, content);
        for command in ["outline", "identify", "track", "fit"] {
            let output = run(&format!("{command} {name} --pixel-size 2"), "");
            let errors = stderr(&output);
            assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(*status), ""), "{command}: {errors}");
            let last = errors.lines().last().expect("a message");
            assert!(
                last.contains(&name) && last.contains(message) && errors.lines().count() == 1,
                "{command}: {errors}"
            );
        }
    }
    file(path, "7-small.png", small.into_inner());
    for (name, centre) in [("0.png", 26.0), ("8.png", 30.0), ("9.png", 32.0)] {
        file(path, name, disc(centre));
    }
    let output = run(&format!("outline {}", path.display()), "");
    assert_eq!((output.status.code(), stderr(&output).lines().count()), (Some(0), 7), "{}", stderr(&output));
    assert!(stderr(&output).contains("7-small.png: 20 x 20 pixels, the frames before it have 64 x 64"));
    for frame in ["\n0,", "\n8,", "\n9,"] {
        assert!(stdout(&output).contains(frame));
    }
}

#[test]
fn pictures_without_motion_give_a_report_and_drawings_that_say_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut black = std::io::Cursor::new(Vec::new());
    GrayImage::new(64, 64).write_to(&mut black, image::ImageFormat::Png).expect("a picture");
    let frames = path.join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..3 {
        file(&frames, &format!("{frame}.png"), black.get_ref());
    }
    let base = path.to_str().expect("UTF-8");
    let identify = format!("identify {base}/frames --report {base}/report.html --overlay {base}/drawn");
    let output = run(&identify, "");
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(1), ""));
    let report = std::fs::read_to_string(path.join("report.html")).expect("a report");
    assert!(report.contains("No motion was identified") && report.contains("every pixel has the grey value 0"));
    assert!(report.contains("Pictures without an outline: 3"), "{report}");
    assert_eq!(drawn(&path.join("drawn")), ["000000.png", "000001.png", "000002.png"]);

    // One frame is not enough either, and the report shows it.
    file(&frames, "1.png", disc(30.0));
    let output = run(&identify, "");
    assert_eq!(output.status.code(), Some(1));
    let report = std::fs::read_to_string(path.join("report.html")).expect("a report");
    assert!(report.contains("1 frame(s), at least 2 are needed") && report.contains("Pictures without an outline: 2"));
}

#[test]
fn drawings_keep_the_numbers_of_the_pictures_and_mark_what_was_not_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    for frame in 0..10_u32 {
        let picture = match frame {
            4 => GrayImage::new(64, 64),
            // Something else altogether.
            7 => GrayImage::from_fn(64, 64, |x, y| Luma([if x > 2 && y > 30 && y < 34 && x < 60 { 255 } else { 0 }])),
            _ => image::load_from_memory(&disc(24.0 + frame as f32)).expect("a picture").into_luma8(),
        };
        picture.save(frames.join(format!("{frame}.png"))).expect("a picture");
    }
    let base = folder.path().to_str().expect("UTF-8");
    let lines = succeed(&format!("track {base}/frames --quiet --overlay {base}/drawn"), "");
    assert_eq!(lines.lines().count(), 9);
    assert_eq!(drawn(&folder.path().join("drawn")).len(), 10);
    let reddest = |frame: u32| {
        let picture = image::open(folder.path().join(format!("drawn/{frame:06}.png"))).expect("a picture").into_rgb8();
        picture.pixels().filter(|pixel| pixel.0 == [255, 80, 80]).count()
    };
    assert!(reddest(4) > 50 && reddest(7) > 50 && reddest(2) == 0, "{} {} {}", reddest(4), reddest(7), reddest(2));
    succeed(&format!("identify {base}/frames --quiet --overlay {base}/drawn.gif"), "");
    let gif = std::fs::File::open(folder.path().join("drawn.gif")).expect("an animation");
    let decoder = image::codecs::gif::GifDecoder::new(std::io::BufReader::new(gif)).expect("a GIF");
    assert_eq!(image::AnimationDecoder::into_frames(decoder).count(), 10);
}

#[test]
fn the_table_says_where_b_is_and_in_which_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    for frame in 0..4_u32 {
        file(folder.path(), &format!("{frame}.png"), disc(26.0 + frame as f32));
    }
    let frames = folder.path().to_str().expect("UTF-8");
    for (options, note) in [
        ("", "b: velocity at the lower left corner, in pixels/s\n"),
        ("--pixel-size 0.5 --y-down", "upper left corner, in lengths/s, a pixel 0.5 high\n"),
        ("--pixel-aspect 1.14 --scale 2", "corner, in pixel heights/s, over f/Z0 = 2\n"),
    ] {
        let report = folder.path().join("report.html");
        let table = succeed(&format!("identify {frames} {options} --report {}", report.display()), "");
        assert!(std::fs::read_to_string(report).expect("a report").contains(note.trim_end()), "{note}");
        assert!(table.contains(note), "{table}");
        assert_eq!(table.contains("px/s"), options.is_empty(), "{table}");
        let rows = succeed(&format!("identify {frames} --fps 10 --format csv --quiet {options}"), "");
        let units = |name: &str| rows.lines().find(|row| row.contains(name)).and_then(|row| row.split(',').nth(8));
        let unit = if options.is_empty() { "px/s" } else { "1/s" };
        assert_eq!([",b1,", ",v2,"].map(units), [Some(unit); 2], "{rows}");
        assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    }
}
