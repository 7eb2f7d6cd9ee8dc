//! Named pipes, signals, and streams whose objects come and go.
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{file, json, run, sequence, stderr, stdout, succeed};

/// Longest that a run may take on a machine that does other things too.
const PATIENCE: Duration = Duration::from_secs(60);

fn pipe(folder: &Path, name: &str) -> String {
    let path = folder.join(name).to_str().expect("UTF-8").to_owned();
    assert!(Command::new("mkfifo").arg(&path).status().is_ok_and(|status| status.success()), "mkfifo is there");
    path
}

fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("freeform"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the binary runs")
}

/// What a process has written when it has ended, which it must before long.
fn ended(mut child: Child) -> Output {
    let begin = Instant::now();
    // Its output is short enough for a pipe to hold.
    while child.try_wait().expect("our child").is_none() {
        if begin.elapsed() > PATIENCE {
            child.kill().expect("our child");
            panic!("it hangs: {}", stderr(&child.wait_with_output().expect("it ends")));
        }
        thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().expect("it has ended")
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().is_ok_and(|status| status.success()));
}

/// Whether processes that are begun here hear of SIGHUP: where the tests themselves are to outlive their terminal they do not.
fn hangups_are_heard() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let are_heard = ignored.is_none_or(|signals| signals & 1 == 0);
    if !are_heard {
        eprintln!("not tried with SIGHUP, which is ignored here");
    }
    are_heard
}

/// A video of a box that moves by a pixel from frame to frame.
fn video(parameters: &str) -> Vec<u8> {
    let mut video = format!("YUV4MPEG2 W80 H60 F10:1 {parameters}Cmono\n").into_bytes();
    for frame in 0..6_usize {
        video.extend(b"FRAME\n");
        let inside = |x: usize, y: usize| (20 + frame..45 + frame).contains(&x) && (20..35 + x / 8).contains(&y);
        video.extend((0..60 * 80).map(|index| if inside(index % 80, index / 80) { 220 } else { 20 }));
    }
    video
}

#[test]
fn a_pipe_is_opened_once_and_read_whatever_its_name_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut gif = Vec::new();
    let mut encoder = image::codecs::gif::GifEncoder::new(&mut gif);
    for frame in 0..4 {
        let inside = |x: u32, y: u32| (9 + frame..40 + frame).contains(&x) && (12..40 + x / 8).contains(&y);
        let shade = |x, y| image::Rgba(if inside(x, y) { [230, 230, 230, 255] } else { [9, 9, 9, 255] });
        let picture = image::RgbaImage::from_fn(64, 64, shade);
        encoder.encode_frame(image::Frame::new(picture)).expect("memory");
    }
    drop(encoder);
    for (name, content) in [("v.y4m", video("")), ("v.gif", gif), ("v.png", video("")), ("o.csv", sequence("").into())]
    {
        let plain = file(folder.path(), "plain", &content);
        let expected = run(&format!("track {plain}"), "");
        assert!(expected.status.success(), "{name}: {}", stderr(&expected));
        let path = pipe(folder.path(), name);
        let (place, bytes) = (path.clone(), content.clone());
        let writer =
            thread::spawn(move || File::options().write(true).open(place).and_then(|mut to| to.write_all(&bytes)));
        let found = ended(start(&["track", &path]));
        assert!(found.status.success(), "{name}: {}", stderr(&found));
        assert_eq!(stdout(&found), stdout(&expected), "{name}");
        writer.join().expect("it ends").expect("the reader stays to the end");
    }
}

#[test]
fn the_first_ctrl_c_counts_while_a_pipe_stands_still() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = pipe(folder.path(), "o.csv");
    // Nobody writes: nothing is known.
    let child = start(&["track", &path]);
    thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    assert_eq!(ended(child).status.code(), Some(130));
    // Somebody has written, and goes on some other day.
    let names = ["-INT", "-TERM", "-HUP"];
    for name in names.into_iter().filter(|name| *name != "-HUP" || hangups_are_heard()) {
        let child = start(&["track", &path]);
        let mut writer = File::options().write(true).open(&path).expect("the other end");
        let csv = sequence("");
        writer.write_all(&csv.as_bytes()[..csv.len() / 2]).expect("the reader is there");
        thread::sleep(Duration::from_millis(500));
        signal(&child, name);
        let output = ended(child);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        let frames = stdout(&output).lines().map(json).count();
        assert!((3..9).contains(&frames), "{name}: {frames}");
    }
}

#[test]
fn a_pipe_that_is_named_among_pictures_is_read_and_ctrl_c_ends_the_waiting_for_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = file(folder.path(), "0.y4m", video(""));
    let path = pipe(folder.path(), "1.y4m");
    for command in ["outline", "track", "identify"] {
        let arguments = [command, &first, &path, "--light", "--fps", "10"];
        let child = start(&arguments);
        File::options().write(true).open(&path).expect("the other end").write_all(&video("")).expect("the reader");
        let whole = ended(child);
        assert!(whole.status.success(), "{command}: {}", stderr(&whole));
        // Nobody writes: what came before is known.
        let child = start(&arguments);
        thread::sleep(Duration::from_millis(500));
        signal(&child, "-INT");
        let half = ended(child);
        assert_eq!(half.status.code(), Some(0), "{command}: {}", stderr(&half));
        assert_ne!(stdout(&half), stdout(&whole), "{command}");
    }
}

#[test]
fn the_first_ctrl_c_counts_while_nobody_reads_a_pipe_or_a_picture_stands_still_half_way() {
    let folder = tempfile::tempdir().expect("a folder");
    let outlines = file(folder.path(), "o.csv", sequence(""));
    let child = start(&["outline", &outlines, "--output", &pipe(folder.path(), "out.csv")]);
    thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    assert_eq!(ended(child).status.code(), Some(130));
    let mut png = std::io::Cursor::new(Vec::new());
    let picture = image::GrayImage::from_fn(200, 200, |x, y| image::Luma([(x * y % 251) as u8]));
    picture.write_to(&mut png, image::ImageFormat::Png).expect("memory");
    let path = pipe(folder.path(), "p.png");
    for command in ["outline", "track", "identify"] {
        let child = start(&[command, &path]);
        let mut writer = File::options().write(true).open(&path).expect("the other end");
        writer.write_all(&png.get_ref()[..5000]).expect("the reader is there");
        thread::sleep(Duration::from_millis(300));
        signal(&child, "-INT");
        let output = ended(child);
        assert!(!output.status.success() && stdout(&output).is_empty(), "{command}: {}", stderr(&output));
    }
}

#[test]
fn other_signals_that_ask_for_the_end_leave_nothing_unfinished() {
    let ends = [("-TERM", 143), ("-HUP", 129)];
    for (name, status) in ends.into_iter().filter(|(name, _)| *name != "-HUP" || hangups_are_heard()) {
        let folder = tempfile::tempdir().expect("a folder");
        let target = file(folder.path(), "target", "old");
        let child = start(&["simulate", "--seconds", "3000", "--output", &target]);
        let entries = || fs::read_dir(folder.path()).expect("the folder").count();
        while entries() < 2 {
            thread::sleep(Duration::from_millis(5));
        }
        signal(&child, name);
        assert_eq!(ended(child).status.code(), Some(status));
        assert_eq!((fs::read_to_string(&target).expect("the file").as_str(), entries()), ("old", 1));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_run_that_is_to_outlive_its_terminal_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("o.csv");
    let mut shell = Command::new("sh");
    shell.args(["-c", r#"trap "" HUP; exec "$0" "$@""#]).arg(assert_cmd::cargo::cargo_bin("freeform"));
    let child = shell.args(["simulate", "--seconds", "20", "--output"]).arg(&target).spawn().expect("a shell");
    thread::sleep(Duration::from_millis(100));
    signal(&child, "-HUP");
    assert_eq!(ended(child).status.code(), Some(0));
    assert!(fs::read_to_string(target).expect("the file").contains("\n599,"));
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error_on_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = file(folder.path(), "outlines.csv", "old");
    let mut shell = Command::new("sh");
    shell.args(["-c", r#"ulimit -f 8; exec "$0" "$@""#]).arg(assert_cmd::cargo::cargo_bin("freeform"));
    let output = shell.args(["simulate", "--output", &target]).output().expect("a shell");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let message = stderr(&output);
    assert!(message.lines().count() == 1 && message.contains("outlines.csv: File too large"), "{message}");
    assert_eq!(fs::read_to_string(&target).expect("the file"), "old");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
}

#[test]
fn an_interlaced_video_is_announced() {
    let folder = tempfile::tempdir().expect("a folder");
    for (parameters, is_told) in [("It ", true), ("Ib ", true), ("Im ", true), ("Ip ", false), ("", false)] {
        let path = file(folder.path(), "v.y4m", video(parameters));
        for command in ["outline", "track", "identify"] {
            let output = run(&format!("{command} {path}"), "");
            assert!(output.status.success(), "{}", stderr(&output));
            assert_eq!(stderr(&output).contains("the video is interlaced"), is_told, "{parameters}{command}");
            assert_eq!(stderr(&run(&format!("{command} --quiet {path}"), "")), "");
        }
    }
}

#[test]
fn an_object_that_has_left_a_stream_has_a_last_line_and_begins_anew_when_it_comes_back() {
    let triangle = |frame: u64, object: &str| {
        let t = frame as f64 / 30.0;
        let (sin, cos) = (0.3 * t).sin_cos();
        let points = [
            (0.0, 0.0),
            (1.0, -0.1),
            (2.0, 0.2),
            (2.1, 0.6),
            (1.9, 1.0),
            (1.1, 1.3),
            (0.3, 1.4),
            (0.1, 1.0),
            (0.1, 0.6),
        ];
        let row = |(x, y): &(f64, f64)| format!("{frame},{t},{},{},{object}\n", cos * x - sin * y, sin * x + cos * y);
        points.iter().map(row).collect::<String>()
    };
    let mut csv = "frame,time,x,y,object\n".to_owned();
    for frame in 0..1105 {
        csv += &triangle(frame, "stays");
        if !(3..=1100).contains(&frame) {
            csv += &triangle(frame, "leaves");
        }
    }
    let lines: Vec<_> = succeed("track", &csv).lines().map(json).collect();
    let of = |name: &str| lines.iter().filter(|line| line["object"] == name).collect::<Vec<_>>();
    assert_eq!(of("stays").len(), 1105);
    let leaves: Vec<_> = of("leaves").iter().map(|line| (line["frame"].as_u64(), line["phase"].as_str())).collect();
    assert_eq!(leaves[2..5], [(Some(2), Some("tracking")), (Some(2), Some("closed")), (Some(1101), Some("acquiring"))]);
    let closed = of("leaves")[3];
    assert_eq!((&closed["accepted"], &closed["parameters"]), (&false.into(), &of("leaves")[2]["parameters"]));
    assert!(closed["reason"].as_str().is_some_and(|reason| reason.starts_with("not seen")));
}

#[test]
fn a_pipe_among_pictures_whose_tracing_is_chosen_is_named_and_not_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = folder.path().join("simulated");
    let name = pictures.to_str().expect("UTF-8");
    succeed(&format!("simulate --pictures {name} --scene gear --seconds 0.2"), "");
    let mut frames: Vec<_> =
        fs::read_dir(&pictures).expect("pictures").map(|entry| entry.expect("one").path()).collect();
    frames.retain(|path| path.extension().is_some_and(|extension| extension == "png"));
    frames.sort();
    fs::remove_file(&frames[2]).expect("a picture");
    let lost = frames[2].file_name().and_then(|name| name.to_str()).expect("UTF-8");
    pipe(&pictures, lost);
    let written = folder.path().join("outlines.csv").to_str().expect("UTF-8").to_owned();
    for command in [vec!["identify"], vec!["track"], vec!["outline", "--output", &written]] {
        let output = ended(start(&[&command[..], &[name, "--fps", "30"]].concat()));
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stderr(&output).contains(&format!("{lost}: not a file")), "{}", stderr(&output));
    }
}
