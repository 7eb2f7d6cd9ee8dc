use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::support::{json, run, sequence, stdout, succeed};

#[test]
fn every_frame_is_one_line_and_the_last_agrees_with_identify() {
    let csv = sequence("");
    let lines = succeed("track", &csv);
    assert_eq!(lines.lines().count(), 15);
    let first = json(lines.lines().next().expect("a line"));
    assert_eq!((&first["frame"], &first["accepted"]), (&0.into(), &true.into()));
    let last = json(lines.lines().last().expect("a line"));
    let whole = json(&succeed("identify - --format json", &csv));
    assert_eq!(last["parameters"], whole["objects"][0]["parameters"]);
}

#[test]
fn lines_list_the_other_rates_of_a_symmetric_outline() {
    let csv = sequence("--shape ellipse");
    let last = json(succeed("track", &csv).lines().last().expect("a line"));
    let aliases = last["parameters"]["omega"]["aliases"].as_array().expect("a list");
    assert!(!aliases.is_empty(), "{last}");
    let whole = json(&succeed("identify - --format json", &csv));
    assert_eq!(last["parameters"], whole["objects"][0]["parameters"]);
}

#[test]
fn a_frame_that_is_no_outline_is_told_in_its_line() {
    let output = run("track", &(sequence("") + "20,5.0,1,1\n"));
    assert_eq!(output.status.code(), Some(0));
    let last = json(stdout(&output).lines().last().expect("a line"));
    assert_eq!((&last["frame"], &last["accepted"]), (&20.into(), &false.into()));
    assert!(last["reason"].as_str().is_some_and(|reason| reason.contains("frame 20")));
}

/// A stream at work, and its ends.
fn track_in_pipes() -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("freeform"))
        .arg("track")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let input = child.stdin.take().expect("a pipe");
    let output = BufReader::new(child.stdout.take().expect("a pipe"));
    (child, input, output)
}

#[test]
fn a_line_comes_as_soon_as_the_row_after_its_frame_has_been_read() {
    let csv = sequence("");
    let split = csv.match_indices("\n1,").next().expect("a second frame").0 + 1;
    let next_row = csv[split..].find('\n').expect("a row") + split + 1;
    let (mut child, mut input, mut output) = track_in_pipes();
    // One row beyond: the line end of a row may only be recognised with the next byte.
    let end = csv[next_row..].find('\n').expect("a row") + next_row + 1;
    input.write_all(&csv.as_bytes()[..end]).expect("the binary reads");
    input.flush().expect("the binary reads");
    let mut line = String::new();
    output.read_line(&mut line).expect("a line while the input is open");
    assert_eq!(json(&line)["frame"], 0);
    drop(input);
    assert!(child.wait().expect("it ends").success());
}

/// Resident memory of a process in kilobytes, its code left out, which is read from the disk as it is needed.
#[cfg(target_os = "linux")]
fn resident(child: &Child) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).expect("our child");
    let line = status.lines().find(|line| line.starts_with("RssAnon:")).expect("a line of its memory");
    line.split_whitespace().nth(1).expect("a number").parse().expect("a number")
}

#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_the_number_of_frames() {
    let csv = succeed("simulate --points 40 --seconds 150 --noise 0.005", "");
    let (mut child, mut input, output) = track_in_pipes();
    // The input stays open, so that the process stands still after the last frame that is complete.
    let writer = std::thread::spawn(move || {
        input.write_all(csv.as_bytes()).expect("the binary reads");
        input
    });
    let mut lines = output.lines();
    for _ in 0..500 {
        lines.next().expect("a frame").expect("UTF-8");
    }
    let early = resident(&child);
    for _ in 500..4499 {
        lines.next().expect("a frame").expect("UTF-8");
    }
    let late = resident(&child);
    drop(writer.join().expect("the writer ends"));
    assert!(child.wait().expect("it ends").success());
    // Chunks read ahead come and go; 4000 frames of 40 points would be 2.5 megabytes.
    assert!(late < early + 1024, "{early} kB after 500 frames, {late} kB after 4499");
}
