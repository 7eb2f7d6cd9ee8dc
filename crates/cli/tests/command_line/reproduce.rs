use std::collections::BTreeSet;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::support::{file, run, stderr, stdout, succeed};

/// A small version of everything.
const SMALL: &str = "--seconds 3 --starts 3 --repeats 1";

/// The root of the workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn names_in(folder: &Path, extension: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let wanted = entries.filter(|path| path.extension().is_some_and(|found| found == extension));
    wanted.map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned()).collect()
}

/// Titles, heads and what stands in the first column: all of the tables that a smaller version has too.
fn labels(tables: &str) -> Vec<String> {
    let label = |line: &str| match line.strip_prefix("  ") {
        // In a title, without the number of runs.
        None => line.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned(),
        Some(row) => row.split("  ").next().unwrap_or(row).to_owned(),
    };
    tables.lines().map(label).collect()
}

#[test]
fn a_small_version_of_everything_gives_the_tables_as_they_were() {
    let folder = tempfile::tempdir().expect("a folder");
    let printed = succeed(&format!("reproduce {SMALL} --out {}", folder.path().display()), "");
    let (tables, last_line) = printed.trim_end().rsplit_once('\n').expect("lines");
    assert!(last_line.starts_with("20 figure(s)") && last_line.ends_with("index.html"), "{last_line}");
    insta::assert_snapshot!("reproduce", tables);
    let kept = fs::read_to_string(root().join("docs/paper-tables.txt")).expect("the tables of the documents");
    let (kept, _) = kept.trim_end().rsplit_once('\n').expect("lines");
    assert_eq!(labels(kept), labels(tables), "make docs/paper-tables.txt anew as docs/paper.md says");

    let figures = names_in(folder.path(), "svg");
    let data = names_in(folder.path(), "csv");
    assert_eq!(figures.len(), 20);
    assert!(figures.is_subset(&data), "every figure has its numbers: {figures:?} {data:?}");
    let page = fs::read_to_string(folder.path().join("index.html")).expect("the page");
    for name in figures.iter().chain(&data) {
        assert!(page.contains(&format!("{name}.")), "{name}");
    }
    assert_eq!(page.matches("<figure").count(), 20);
    let svg = |name: &String| fs::read_to_string(folder.path().join(format!("{name}.svg"))).expect("a figure");
    for text in figures.iter().map(svg).chain([page]) {
        assert!(!text.contains("NaN") && !text.contains("inf\"") && !text.contains("inf "));
        let links = text.matches("http").count() - text.matches("http://www.w3.org/2000/svg").count();
        assert_eq!(links, 0, "no link to elsewhere");
    }
}

#[test]
fn only_what_is_asked_for_is_made_and_a_folder_that_exists_keeps_its_other_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let other = file(folder.path(), "fig1.svg", "mine");
    for _ in 0..2 {
        succeed(&format!("reproduce --only 2 7 --out {}", folder.path().display()), "");
    }
    assert_eq!(names_in(folder.path(), "svg").into_iter().collect::<Vec<_>>(), ["fig1", "fig2", "fig7"]);
    assert_eq!(fs::read_to_string(other).expect("the other file"), "mine");
    assert!(folder.path().join("index.html").exists() && folder.path().join("fig2-factors.csv").exists());
}

#[test]
fn names_and_numbers_that_mean_nothing_are_wrong_usage() {
    let folder = tempfile::tempdir().expect("a folder");
    let lengths = ["--seconds 0", "--seconds 0.001", "--seconds 0.99", "--seconds x"];
    let others = ["--only 9", "--only", "--only fig", "--starts 0", "--repeats -1"];
    for arguments in lengths.iter().chain(&others) {
        let output = run(&format!("reproduce --out {}/new {arguments}", folder.path().display()), "");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
        assert_eq!(stderr(&output).lines().count(), 1, "{arguments}: {}", stderr(&output));
        assert_eq!(stdout(&output), "", "{arguments}");
    }
    assert!(!folder.path().join("new").exists());
    let output = run(&format!("reproduce --only 9 --out {}", folder.path().display()), "");
    assert!(stderr(&output).contains("changing"), "the names that there are: {}", stderr(&output));
    let output = run(&format!("reproduce --only lyapunov --seconds 1e9 --out {}", folder.path().display()), "");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("at most 1000000"), "{}", stderr(&output));
    let occupied = file(folder.path(), "occupied", "");
    let output = run(&format!("reproduce --only 1 --out {occupied}"), "");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("occupied"), "{}", stderr(&output));
}

#[test]
fn a_closed_pipe_does_not_keep_the_figures_from_being_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("freeform"))
        .args(["reproduce", "--only", "1", "--out"])
        .arg(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    drop(child.stdout.take());
    let mut message = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut message).expect("text");
    assert_eq!(child.wait().expect("it ends").code(), Some(0), "{message}");
    assert_eq!(message, "");
    assert!(folder.path().join("fig1.svg").exists() && folder.path().join("index.html").exists());
}

/// Numbers and what stands between them.
fn numbers_and_text(svg: &str) -> (Vec<f64>, String) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let (mut numbers, mut text) = (Vec::new(), String::new());
    for run in svg.split_inclusive(|c| !is_number(c)) {
        let number = run.trim_end_matches(|c| !is_number(c));
        numbers.extend(number.parse::<f64>().ok());
        text.push_str(&run[number.len()..]);
    }
    (numbers, text)
}

/// Sums are rounded differently on different processors: what is written may differ by less than can be seen.
#[test]
fn the_pictures_of_the_documents_are_what_the_command_writes() {
    let folder = tempfile::tempdir().expect("a folder");
    succeed(&format!("reproduce --only 1 2 3 4 8 lyapunov --out {}", folder.path().display()), "");
    let (simulated, identified) = ("simulate --seconds 1", "identify - --scale 0.1 --svg");
    let told = fs::read_to_string(root().join("README.md")).expect("the README");
    assert!(told.contains(&format!("freeform {simulated} | freeform {identified} motion.svg")));
    let motion = folder.path().join("motion.svg");
    succeed(&format!("{identified} {}", motion.display()), &succeed(simulated, ""));
    let pictures = root().join("docs/pictures");
    let names = names_in(&pictures, "svg");
    assert!(!names.is_empty());
    for name in names {
        let read = |folder: &Path| fs::read_to_string(folder.join(format!("{name}.svg"))).expect("a picture");
        let (written, text) = numbers_and_text(&read(folder.path()));
        let (kept, kept_text) = numbers_and_text(&read(&pictures));
        let differs = || written.iter().zip(&kept).any(|(a, b)| (a - b).abs() > 1.0);
        assert!(text == kept_text && !differs(), "{name}: make it anew as docs/paper.md or README.md says");
    }
}
