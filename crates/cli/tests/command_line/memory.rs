//! Memory of the whole program on inputs that are small and unpack to much.
#![cfg(target_os = "linux")]
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, GrayImage, ImageEncoder as _, Luma};

use crate::support::file;

/// What the program may take for any picture, in kilobytes.
const LIMIT: u64 = 3 << 19;

/// Side of the largest picture that is read, in pixels.
const LARGEST: u32 = 8192;

/// Side of a picture of a quarter of the pixels, which may take a quarter of the memory.
const LARGE: u32 = LARGEST / 2;

/// Longest that a run may take with a build that is not optimised, on a machine that does other things too.
const PATIENCE: Duration = Duration::from_secs(120);

fn entry(child: &Child, name: &str) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Exit status and largest memory of a run in kilobytes.
fn peak(arguments: &[&str]) -> (Option<i32>, u64) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("freeform"));
    let mut child =
        command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the binary runs");
    let (begin, mut peak) = (Instant::now(), 0);
    loop {
        peak = peak.max(entry(&child, "VmHWM:").unwrap_or(0));
        if let Some(status) = child.try_wait().expect("our child") {
            return (status.code(), peak);
        }
        if begin.elapsed() > PATIENCE || peak > 2 * LIMIT {
            child.kill().expect("our child");
            child.wait().expect("our child");
            panic!("{arguments:?}: {peak} kB after {:?}", begin.elapsed());
        }
        thread::sleep(Duration::from_millis(2));
    }
}

/// A square picture. It is made row by row, since tests are not optimised.
fn picture(folder: &Path, (name, side): (&str, u32), row: impl Fn(u32) -> Vec<u8>) -> String {
    let path = folder.join(name);
    let mut pixels = Vec::new();
    (0..side).for_each(|y| pixels.extend(row(y)));
    GrayImage::from_raw(side, side, pixels).expect("all pixels").save(&path).expect("a picture");
    path.to_str().expect("UTF-8").to_owned()
}

/// A row that is light from end to end, or in every other pixel.
fn teeth(side: u32, is_light: bool) -> Vec<u8> {
    [255, if is_light { 255 } else { 0 }].repeat(side as usize / 2)
}

#[test]
fn the_largest_picture_of_the_most_runs_and_points_stays_within_the_memory_that_is_promised() {
    let folder = tempfile::tempdir().expect("a folder");
    let comb = picture(folder.path(), ("comb.png", LARGEST), |y| teeth(LARGEST, y == 0));
    for arguments in [&["outline", &comb][..], &["track", &comb, "--objects", "all", "--light"]] {
        let (status, peak) = peak(arguments);
        assert_eq!(status, Some(1), "{arguments:?}");
        assert!((1 << 17..LIMIT).contains(&peak), "{arguments:?}: {peak} kB");
    }
}

/// An animation of the largest size whose frames are of one pixel.
fn animation(frames: usize) -> Vec<u8> {
    let mut gif = b"GIF89a\x00\x20\xff\x1f\xf0\0\0\0\0\0\xff\xff\xff".to_vec();
    for _ in 0..frames {
        gif.extend(b"\x21\xf9\x04\x04\x0a\0\0\0\x2c\0\0\0\0\x01\0\x01\0\0\x02\x02\x44\x01\0");
    }
    gif.push(b';');
    gif
}

#[test]
fn frames_that_show_nothing_new_cost_next_to_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let gif = file(folder.path(), "small.gif", animation(5000));
    for arguments in [&["outline", &gif][..], &["track", &gif, "--light"], &["outline", &gif, "--background", "median"]]
    {
        let (status, peak) = peak(arguments);
        assert_eq!(status, Some(1), "{arguments:?}");
        assert!(peak < LIMIT, "{arguments:?}: {peak} kB");
    }
}

#[test]
fn objects_within_each_other_take_no_more_than_the_picture_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let nested = picture(folder.path(), ("nested.png", LARGE), |y| {
        let depth = |x: u32| x.min(y).min(LARGE - 1 - x).min(LARGE - 1 - y);
        (0..LARGE).map(|x| if depth(x) / 64 % 2 == 1 { 255 } else { 0 }).collect()
    });
    let (status, peak) = peak(&["track", &nested, "--objects", "all"]);
    assert_eq!(status, Some(0));
    assert!(peak < LIMIT / 4, "{peak} kB");
}

#[test]
fn holes_without_number_take_no_more_than_the_picture_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let sieve = picture(folder.path(), ("sieve.png", LARGE), |y| teeth(LARGE, y % 2 == 0));
    let (status, peak) = peak(&["outline", &sieve, "--contours", "all", "--light", "--smoothing", "0"]);
    assert_eq!(status, Some(0));
    // Half of a quarter, and what the program takes for itself.
    assert!(peak < LIMIT / 8 + (50 << 10), "{peak} kB");
}

#[test]
fn a_colour_profile_that_unpacks_to_much_takes_no_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut png = Vec::new();
    let mut encoder = PngEncoder::new(&mut png);
    encoder.set_icc_profile(vec![0; 1 << 27]).expect("PNG has profiles");
    encoder.write_image(&[0; 100], 10, 10, ExtendedColorType::L8).expect("memory");
    let path = file(folder.path(), "profile.png", png);
    let (status, peak) = peak(&["outline", &path]);
    assert_eq!(status, Some(1));
    assert!(peak < 110 * 1024, "{peak} kB");
}

#[test]
fn an_ordinary_picture_takes_no_more_than_60_bytes_a_pixel() {
    let folder = tempfile::tempdir().expect("a folder");
    let (width, height) = (2000, 1500);
    let inside = |x: u32, y: u32| (300..1500 + x / 9 % 5).contains(&y) && (400 + y / 7..1500).contains(&x);
    let shade = |x, y| (if inside(x, y) { 200 } else { 40 }) + (7 * x + 13 * y) as u8 % 16;
    let grey = image::DynamicImage::ImageLuma8(GrayImage::from_fn(width, height, |x, y| Luma([shade(x, y)])));
    let pictures = [
        ("grey.png", grey.clone()),
        ("colour.jpg", grey.to_rgb8().into()),
        ("deep.png", grey.to_rgba16().into()),
        ("deep.tif", grey.to_rgb16().into()),
        ("colour.webp", grey.to_rgb8().into()),
        ("colour.bmp", grey.to_rgb8().into()),
        ("palette.gif", grey.to_rgb8().into()),
    ];
    for (name, picture) in pictures {
        let path = folder.path().join(name).display().to_string();
        picture.save(&path).expect("a picture");
        let commands = [&["outline", &path][..], &["identify", &path], &["track", &path, "--objects", "all"]];
        // Once it is traced it does not matter which format a picture had.
        for arguments in &commands[..if matches!(name, "grey.png" | "colour.jpg") { commands.len() } else { 1 }] {
            let (status, peak) = peak(arguments);
            assert!(status.is_some_and(|status| status < 2), "{arguments:?}: {status:?}");
            let most = u64::from(width * height) * 60 / 1024 + 50 * 1024;
            assert!(peak < most, "{arguments:?}: {peak} kB of {most}");
        }
    }
}

/// Outlines of so many objects, each in two frames.
fn many_objects(count: usize, in_order_of: fn((usize, usize)) -> (usize, usize)) -> String {
    let mut seen: Vec<(usize, usize)> = (0..2 * count).map(|index| (index / count, index % count)).collect();
    seen.sort_by_key(|seen| in_order_of(*seen));
    let points = [(0, 0), (2, 0), (4, 1), (5, 3), (4, 5), (3, 6), (1, 5), (0, 4), (-1, 2)];
    let rows = seen.into_iter().flat_map(|(frame, object)| {
        points.map(|(x, y)| format!("{frame},{frame},{},{y},{object}\n", x + frame as i32))
    });
    std::iter::once("frame,time,x,y,object\n".to_owned()).chain(rows).collect()
}

#[test]
fn identify_keeps_little_of_each_of_very_many_objects() {
    const OBJECTS: usize = 7000;
    let folder = tempfile::tempdir().expect("a folder");
    let frame_by_frame = file(folder.path(), "frames.csv", many_objects(OBJECTS, |(frame, object)| (frame, object)));
    let one_by_one = file(folder.path(), "objects.csv", many_objects(OBJECTS, |(frame, object)| (object, frame)));
    let report = folder.path().join("report.html").display().to_string();
    for (input, more) in [(&frame_by_frame, vec![]), (&one_by_one, vec!["--report", &report])] {
        let arguments = [vec!["identify", input, "--json", "--quiet"], more].concat();
        let (status, peak) = peak(&arguments);
        assert_eq!(status, Some(0), "{arguments:?}");
        // They would be 400 megabytes and more if all were kept: 60 kilobytes each, as far as they are.
        assert!(peak < 170_000, "{arguments:?}: {peak} kB");
    }
    let page = fs::read_to_string(&report).expect("the report");
    assert!(page.contains(&format!("figures are drawn of the first 200 of {OBJECTS} objects")));
    assert_eq!(page.matches("<h2>Object ").count(), OBJECTS);
    assert!((200..2000).contains(&page.matches("<svg").count()), "{} figures", page.matches("<svg").count());
}

#[test]
fn memory_does_not_grow_with_the_number_of_objects_that_come_and_go() {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("freeform"));
    command.args(["track", "--quiet"]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().expect("the binary runs");
    let mut input = child.stdin.take().expect("a pipe");
    let writer = thread::spawn(move || {
        input.write_all(b"frame,time,x,y,object\n").expect("the binary reads");
        for frame in 0..9000 {
            let points = [(0, 0), (2, 0), (4, 1), (5, 3), (4, 5), (3, 6), (1, 5), (0, 4), (-1, 2)];
            let rows = points.map(|(x, y)| format!("{frame},{frame},{x},{y},{frame}\n"));
            input.write_all(rows.concat().as_bytes()).expect("the binary reads");
        }
    });
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    // From here on an object leaves for each that comes.
    assert_eq!(lines.by_ref().take(3000).count(), 3000);
    let early = entry(&child, "RssAnon:").expect("our child");
    assert_eq!(lines.by_ref().take(12_000).count(), 12_000);
    let late = entry(&child, "RssAnon:").expect("our child");
    lines.for_each(drop);
    writer.join().expect("the writer ends");
    assert!(child.wait().expect("it ends").success());
    // 6000 objects would be more than 60 megabytes; their names are kept by the reader, in tables that double: 3.5 of 48,000 objects.
    assert!(late < early + 6144, "{early} kB early, {late} kB late");
}
