//! Full disks, runs that are killed, and Ctrl-C.
use std::fs::{self, File};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::{file, json, run, sequence, stderr, stdout, succeed};

fn command() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin("freeform"))
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success());
}

fn entries(folder: &Path) -> usize {
    fs::read_dir(folder).expect("the folder").count()
}

#[test]
fn a_full_disk_is_told_on_one_line() {
    if !Path::new("/dev/full").exists() {
        println!("skipped: no /dev/full here");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let input = file(folder.path(), "outlines.csv", sequence(""));
    for arguments in [
        vec!["simulate"],
        vec!["track", &input],
        vec!["identify", &input],
        vec!["fit", &input],
        vec!["completions", "bash"],
        vec!["--help"],
        vec!["track", "--help"],
    ] {
        let full = File::options().write(true).open("/dev/full").expect("the device");
        let output = command().args(&arguments).stdout(full).stderr(Stdio::piped()).output().expect("the binary runs");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_eq!(stderr(&output), "freeform: standard output: No space left on device\n", "{arguments:?}");
    }
    for option in ["--trace", "--svg", "--report"] {
        let output = run(&format!("identify {input} {option} /dev/full"), "");
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert!(stderr(&output).contains("/dev/full: No space left on device"), "{option}: {}", stderr(&output));
    }
}

#[test]
fn a_disk_that_is_full_before_the_end_ends_identify_while_rows_keep_coming() {
    if !Path::new("/dev/full").exists() {
        println!("skipped: no /dev/full here");
        return;
    }
    let csv = succeed("simulate --points 60 --seconds 0.01", "");
    let points: Vec<String> = csv.lines().filter_map(|row| Some(row.strip_prefix("0,0,")?.to_owned())).collect();
    assert_eq!(points.len(), 60);
    let frame = move |number: u64| -> String {
        let row = |object: u64, point: &String| format!("{number},{number},{point},{object}\n");
        (0..3).flat_map(|object| points.iter().map(move |point| row(object, point))).collect()
    };
    let mut child = command()
        .args(["identify", "-", "--quiet", "--trace", "/dev/full"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut input = child.stdin.take().expect("a pipe");
    // The input ends no earlier than the process.
    let rows = std::thread::spawn(move || {
        input.write_all(b"frame,time,x,y,object\n").expect("the binary reads");
        (0..).all(|number| input.write_all(frame(number).as_bytes()).is_ok())
    });
    let deadline = Instant::now() + Duration::from_secs(60);
    while child.try_wait().expect("our child").is_none() {
        if Instant::now() > deadline {
            child.kill().expect("our child");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(!rows.join().expect("nothing but the pipe breaks"));
    let output = child.wait_with_output().expect("our child");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(stderr(&output), "freeform: /dev/full: No space left on device\n");
}

#[test]
#[cfg(unix)]
fn a_file_that_does_not_fit_leaves_the_old_one_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let target = file(folder.path(), "outlines.csv", "old");
    // A limit of 8 blocks stands for the full disk: beyond it writing fails.
    let script = r#"trap "" XFSZ; ulimit -f 8; exec "$0" "$@""#;
    let output = Command::new("sh")
        .args(["-c", script])
        .arg(assert_cmd::cargo::cargo_bin("freeform"))
        .args(["simulate", "--output", &target])
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    assert!(stderr(&output).contains("outlines.csv: "), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&target).expect("the file"), "old");
    assert_eq!(entries(folder.path()), 1);
}

#[test]
#[cfg(unix)]
fn a_run_that_is_killed_leaves_the_old_file_and_the_next_one_is_not_in_its_way() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let target = file(folder.path(), "outlines.csv", "old");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).expect("our file");
    let mut child = command()
        .args(["simulate", "--seconds", "3000", "--output", &target])
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs");
    while entries(folder.path()) < 2 {
        assert!(child.try_wait().expect("our child").is_none(), "it ended before it began to write");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("our child");
    child.wait().expect("our child");
    assert_eq!(fs::read_to_string(&target).expect("the file"), "old");
    succeed(&format!("simulate --seconds 0.1 --output {target}"), "");
    assert!(fs::read_to_string(&target).expect("the file").contains("frame,time,x,y"));
    assert_eq!(fs::metadata(&target).expect("the file").permissions().mode() & 0o777, 0o640);
}

#[test]
#[cfg(unix)]
fn ctrl_c_while_a_file_is_written_leaves_the_old_one_and_nothing_beside_it() {
    for arguments in [
        &["simulate", "--seconds", "3000", "--output"][..],
        &["evaluate", "--runs", "1000", "--output"],
        &["fit", "-", "--svg"],
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let target = file(folder.path(), "target", "old");
        let mut child = command()
            .args(arguments)
            .arg(&target)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary runs");
        // Waiting for the child would close it, and so end the input.
        let input = child.stdin.take();
        let begins_at_once = arguments[0] != "fit";
        while begins_at_once && entries(folder.path()) < 2 {
            assert!(child.try_wait().expect("our child").is_none(), "{arguments:?} ended before it began to write");
            std::thread::sleep(Duration::from_millis(5));
        }
        // Time to be ready for a signal at all.
        std::thread::sleep(Duration::from_millis(200));
        signal(&child, "-INT");
        assert_eq!(child.wait().expect("our child").code(), Some(130), "{arguments:?}");
        drop(input);
        assert_eq!(fs::read_to_string(&target).expect("the file"), "old");
        assert_eq!(entries(folder.path()), 1, "{arguments:?}");
    }
}

/// Starts a command that reads from a pipe, and hands it more than any buffer on the way holds, so that it is at work.
#[cfg(unix)]
fn at_work(arguments: &[&str], csv: &str) -> (Child, std::process::ChildStdin) {
    let mut child = command()
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut input = child.stdin.take().expect("a pipe");
    input.write_all(csv.as_bytes()).expect("the binary reads");
    (child, input)
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_identify_with_what_is_known_so_far_though_the_input_stands_still() {
    let csv = sequence("--seconds 12");
    assert!(csv.len() > 1 << 20, "{}", csv.len());
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace.csv");
    let arguments = ["identify", "-", "--format", "json", "--trace", trace.to_str().expect("UTF-8")];
    let (child, input) = at_work(&arguments, &csv);
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("it ends");
    drop(input);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let result = json(&stdout(&output));
    let frames = result["objects"][0]["frames"].as_u64().expect("a number");
    assert!((2..360).contains(&frames), "{frames}");
    assert!(result["objects"][0]["parameters"]["omega"]["value"].is_f64());
    let rows = fs::read_to_string(&trace).expect("the trace").lines().count() as u64;
    assert_eq!(rows, 1 + frames);
    assert_eq!(entries(folder.path()), 1);
}

/// What a process writes that is interrupted after its first line, its input still open, and ends well.
#[cfg(unix)]
fn output_until_interrupted(mut child: Child) -> String {
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut output = String::new();
    lines.read_line(&mut output).expect("a line");
    signal(&child, "-INT");
    lines.read_to_string(&mut output).expect("UTF-8");
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    output
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_track_after_a_whole_line() {
    let csv = sequence("--seconds 12");
    let (child, input) = at_work(&["track"], &csv[..csv.len() / 20]);
    let output = output_until_interrupted(child);
    drop(input);
    let frames: Vec<_> = output.lines().map(|line| json(line)["frame"].clone()).collect();
    assert!(frames.iter().enumerate().all(|(index, frame)| *frame == index), "{frames:?}");
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_track_of_a_video_with_whole_lines_and_a_whole_drawing() {
    let mut video = b"YUV4MPEG2 W80 H60 F10:1 Cmono\n".to_vec();
    for frame in 0..8_usize {
        video.extend(b"FRAME\n");
        let inside = |x: usize, y: usize| (20 + frame..45 + frame).contains(&x) && (20..35 + x / 8).contains(&y);
        video.extend((0..60 * 80).map(|index| if inside(index % 80, index / 80) { 220 } else { 20 }));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let drawn = folder.path().join("drawn.gif");
    let mut child = command()
        .args(["track", "-", "--overlay", drawn.to_str().expect("UTF-8")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut input = child.stdin.take().expect("a pipe");
    input.write_all(&video).expect("the binary reads");
    let output = output_until_interrupted(child);
    drop(input);
    let count = output.lines().map(json).count();
    let gif = BufReader::new(File::open(&drawn).expect("the drawing"));
    let decoder = image::codecs::gif::GifDecoder::new(gif).expect("a GIF");
    assert_eq!(image::AnimationDecoder::into_frames(decoder).collect_frames().expect("whole").len(), count);
    assert_eq!(entries(folder.path()), 1);
}
