//! Outputs under other names, and outputs that fail at any place.
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use crate::support::{file, json, run, sequence, small_pictures, stderr, succeed};

fn refused(arguments: &str, reason: &str) {
    let output = run(arguments, &sequence(""));
    assert_eq!(output.status.code(), Some(2), "{arguments}: {}", stderr(&output));
    assert!(
        stderr(&output).contains(reason) && stderr(&output).lines().count() == 1,
        "{arguments}: {}",
        stderr(&output)
    );
}

#[test]
fn two_outputs_on_one_file_are_refused_under_whatever_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    symlink("t.csv", path("link.csv")).expect("a link");
    fs::create_dir(path("within")).expect("a folder");
    // First while there is no such file, then with one, which may have two names.
    for _ in 0..2 {
        for other in ["./t.csv", "within/../t.csv", "link.csv"] {
            refused(&format!("identify - --trace {} --report {}", path("t.csv"), path(other)), "given for two outputs");
        }
        if !Path::new(&path("t.csv")).exists() {
            fs::write(path("t.csv"), "old").expect("a file");
        }
    }
    fs::hard_link(path("t.csv"), path("hard.csv")).expect("a link");
    refused(&format!("identify - --trace {} --svg {}", path("t.csv"), path("hard.csv")), "given for two outputs");
    assert_eq!(fs::read_to_string(path("t.csv")).expect("the file"), "old");
}

#[test]
fn what_a_command_reads_is_not_written_to() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = small_pictures(folder.path(), 6);
    let path = |name: &str| folder.path().join(name).display().to_string();
    let ground = file(folder.path(), "ground.png", fs::read(format!("{pictures}/0.png")).expect("a picture"));
    let plane = file(folder.path(), "plane.txt", "1 0 0 0 1 0 0 0 1");
    let outlines = file(folder.path(), "outlines.csv", sequence(""));
    let reason = "this is the input";
    refused(&format!("outline {pictures} --background {ground} --output {ground}"), reason);
    refused(&format!("identify - --rectify {plane} --trace {plane}"), reason);
    refused(&format!("track - --rectify {plane} --overlay {plane}"), reason);
    refused(&format!("simulate --shape {outlines} --output {}", path("./outlines.csv")), reason);
    refused(&format!("recognise {pictures} --known {outlines} --candidates {outlines}"), reason);
    refused(&format!("evaluate --shape {outlines} --output {outlines}"), reason);
    // As `<` gives it.
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("freeform"));
    let input = fs::File::open(&outlines).expect("the file");
    let output = command.args(["identify", "-", "--trace", &outlines]).stdin(input).output().expect("the binary runs");
    assert!(output.status.code() == Some(2) && stderr(&output).contains(reason), "{}", stderr(&output));
    let drawn = path("drawn");
    succeed(&format!("identify {pictures} --fps 10 --quiet --overlay {drawn}"), "");
    let within = format!("{drawn}/000001.png");
    refused(&format!("identify {pictures} --overlay {drawn} --trace {within}"), "the drawings go into this folder");
    // Other files may lie there.
    succeed(&format!("identify {pictures} --fps 10 --quiet --overlay {drawn} --trace {drawn}/trace.csv"), "");
    assert_eq!(fs::read_to_string(&plane).expect("the file"), "1 0 0 0 1 0 0 0 1");
}

#[test]
fn a_result_is_not_appended_to_what_it_is_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = sequence("--seconds 0.5");
    let input = file(folder.path(), "outlines.csv", &csv);
    for command in ["identify", "track", "fit", "outline", "recognise"] {
        let appended = fs::OpenOptions::new().append(true).open(&input).expect("the file");
        let mut arguments = vec![command, &input];
        arguments.extend((command == "recognise").then_some(["--known", &input]).into_iter().flatten());
        let mut program = Command::new(assert_cmd::cargo::cargo_bin("freeform"));
        let output = program.args(&arguments).stdout(appended).output().expect("the binary runs");
        assert!(output.status.code() == Some(2), "{command}: {}", stderr(&output));
        assert!(stderr(&output).contains("/dev/stdout: this is the input"), "{command}: {}", stderr(&output));
        assert_eq!(fs::read_to_string(&input).expect("the file"), csv, "{command}");
    }
}

#[test]
fn standard_output_is_for_the_result_alone() {
    for output in ["/dev/stdout", "/dev/fd/1"].into_iter().filter(|path| Path::new(path).exists()) {
        refused(&format!("identify - --json --trace {output}"), "this is standard output, where the result goes");
        refused(&format!("fit - --svg {output}"), "this is standard output, where the result goes");
    }
    for option in ["--trace", "--trajectory", "--svg", "--report"] {
        refused(&format!("identify - {option} -"), "for a file of this name write ./-");
    }
    // Where nothing else goes there it is welcome.
    let csv = succeed("simulate --seconds 0.1", "");
    let rows = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(&succeed("simulate --seconds 0.1 --output -", "")), rows(&csv));
    if Path::new("/dev/stdout").exists() {
        assert_eq!(rows(&succeed("simulate --seconds 0.1 --output /dev/stdout", "")), rows(&csv));
    }
}

#[test]
fn a_file_may_have_the_longest_name_that_there_is() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["x".repeat(255), "\u{e4}".repeat(127)] {
        let path = folder.path().join(&name);
        succeed(&format!("simulate --seconds 0.1 --output {}", path.display()), "");
        assert!(path.is_file());
    }
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 2);
    let longer = folder.path().join("x".repeat(256));
    refused(&format!("simulate --seconds 0.1 --output {}", longer.display()), "name too long");
}

#[test]
fn a_link_that_leads_to_no_file_yet_is_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("data")).expect("a folder");
    symlink("data/new.csv", path("first")).expect("a link");
    symlink("first", path("second")).expect("a link");
    succeed(&format!("simulate --seconds 0.1 --output {}", path("second").display()), "");
    assert!(path("data/new.csv").is_file() && path("second").is_symlink());
    symlink("round", path("round")).expect("a link");
    refused(&format!("simulate --output {}", path("round").display()), "too many links");
    symlink("no/where", path("astray")).expect("a link");
    refused(&format!("simulate --output {}", path("astray").display()), "No such file");
    assert!(path("astray").is_symlink());
}

#[test]
fn wherever_writing_fails_old_files_stay_and_nothing_half_done_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = tempfile::tempdir().expect("a folder");
    let csv = file(input.path(), "o.csv", sequence(""));
    let pictures = small_pictures(input.path(), 3);
    // Of an overlay the name says the format; a figure takes none that says another.
    let of = |name: &str| folder.path().join(name).display().to_string();
    let (target, figure) = (of("target.gif"), of("target.svg"));
    let commands = [
        format!("simulate --seconds 0.2 --output {target}"),
        format!("identify {csv} --trace {target}"),
        format!("identify {csv} --trajectory {target}"),
        format!("identify {csv} --svg {figure}"),
        format!("identify {csv} --report {target}"),
        format!("fit {csv} --svg {figure}"),
        format!("outline {pictures} --output {target}"),
        format!("outline {pictures} --overlay {target}"),
        format!("track {pictures} --overlay {target}"),
        format!("identify {pictures} --overlay {target}"),
    ];
    let failing_after = |blocks: u64, command: &str| {
        let mut shell = Command::new("sh");
        let script = format!(r#"ulimit -f {blocks}; exec "$0" "$@" > /dev/null"#);
        shell.args(["-c", &script]).arg(assert_cmd::cargo::cargo_bin("freeform"));
        shell.args(command.split_whitespace()).output().expect("a shell")
    };
    for command in commands {
        let target = if command.ends_with(&figure) { &figure } else { &target };
        fs::write(target, "old").expect("a file");
        succeed(&command, "");
        let blocks = fs::metadata(target).expect("the file").len().div_ceil(512);
        // A shell may count in blocks of twice the size, so that some of the last places are beyond the end.
        let step = (blocks / 12).max(1);
        let mut failures = 0;
        for limit in (0..blocks).step_by(step as usize) {
            fs::write(target, "old").expect("a file");
            let output = failing_after(limit, &command);
            let content = fs::read(target).expect("the file");
            match output.status.code() {
                Some(2) => {
                    failures += 1;
                    assert!(content == b"old", "{command}, {limit} blocks: the old file is gone");
                    let message = stderr(&output);
                    assert!(
                        message.contains(&format!("{target}: File too large")),
                        "{command}, {limit} blocks: {message}"
                    );
                }
                code => assert!(code == Some(0) && content.len() as u64 > 512 * limit, "{command}, {limit}: {code:?}"),
            }
            let entries = fs::read_dir(folder.path()).expect("the folder").count();
            assert_eq!(entries, 1, "{command}, {limit} blocks: something is left");
        }
        assert!(failures * 2 >= blocks.div_ceil(step), "{command}: {failures} failures of {blocks} blocks");
        fs::remove_file(target).expect("the file");
    }
    // A folder of drawings keeps those that are whole.
    let drawn = folder.path().join("drawn").display().to_string();
    assert_eq!(failing_after(1, &format!("outline {pictures} --overlay {drawn}")).status.code(), Some(2));
    assert_eq!(fs::read_dir(&drawn).expect("the folder").count(), 0);
    assert!(json(&succeed(&format!("identify {csv} --json"), "")).is_object());
}
