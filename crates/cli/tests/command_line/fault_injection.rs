//! Every output of every command, while each of its writes fails once: the old file stays or the new one is whole, and nothing else is left.
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::support::{file, sequence, small_pictures, stderr};

/// Calls that can fail while an output is written, and what they fail with.
const FAULTS: [(&str, &str); 5] = [
    ("write", "ENOSPC"),
    ("write", "EIO"),
    ("fsync", "EIO"),
    ("rename,renameat,renameat2", "EIO"),
    ("mkdir", "ENOSPC"),
];

/// Calls of a kind that fail, one in each run; of more, as many of them, evenly over the run.
const MOST_PLACES: usize = 60;

/// As that, of a command that takes a second and writes as others do: the first call, one half way, and the last.
const MOST_PLACES_OF_DEMO: usize = 2;

/// Files by their names within a folder.
type Files = BTreeMap<String, Vec<u8>>;

fn files(folder: &Path, within: &Path) -> Files {
    let mut found = Files::new();
    for entry in fs::read_dir(within).expect("the folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            found.extend(files(folder, &entry));
        } else {
            let name = entry.strip_prefix(folder).expect("a file within").display().to_string();
            found.insert(name, fs::read(&entry).expect("the file"));
        }
    }
    found
}

/// The program under a tracer, which has the calls fail that `inject` names.
fn traced(options: &[&str], log: &Path, folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new("strace");
    command.args(["-f", "-qq", "-o"]).arg(log).args(options).arg(assert_cmd::cargo::cargo_bin("freeform"));
    command.args(arguments.split_whitespace()).current_dir(folder);
    command.stdin(Stdio::null()).output().expect("the tracer runs")
}

fn fill(folder: &Path, old: &Files) {
    for entry in fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() { fs::remove_dir_all(entry) } else { fs::remove_file(entry) }.expect("our file");
    }
    old.iter().for_each(|(name, content)| fs::write(folder.join(name), content).expect("a file"));
}

/// Commands that write files, from a table of outlines and a folder of pictures.
fn writing_commands(csv: &str, pictures: &str) -> Vec<String> {
    let mut commands = vec![
        "simulate --points 200 --seconds 0.1 --output target".to_owned(),
        "simulate --pictures target-new --scene coin --seconds 0.05".to_owned(),
        format!("identify {csv} --trace target"),
        format!("identify {csv} --method adaptive --trace target"),
        format!("identify {csv} --trajectory target"),
        format!("identify {csv} --trajectory target --smooth"),
        format!("identify {csv} --svg target"),
        format!("identify {csv} --report target"),
        format!("identify {pictures} --overlay target.gif"),
        format!("identify {pictures} --overlay target-new"),
        format!("identify {csv} --trace target --trajectory target.gif --report target-new"),
        format!("fit {csv} --svg target"),
        format!("outline {pictures} --output target"),
        format!("outline {pictures} --overlay target.gif"),
        format!("outline {pictures} --overlay target-new"),
        format!("track {pictures} --overlay target.gif"),
        format!("track {pictures} --overlay target-new"),
        "evaluate --runs 1 --frames 3 --threads 1 --output target".to_owned(),
        "evaluate --runs 1 --frames 3 --threads 1 --format json --output target".to_owned(),
        "reproduce --only 2 --seconds 1 --starts 1 --repeats 1 --out target-new".to_owned(),
        "demo --out target-new".to_owned(),
    ];
    if cfg!(feature = "parquet") {
        commands.push("simulate --points 200 --seconds 0.1 --output target.parquet".to_owned());
        commands.push(format!("outline {csv} --output target.parquet"));
    }
    commands
}

#[test]
fn whichever_call_fails_every_output_is_the_old_or_the_new_one_and_nothing_else_is_left() {
    let is_there = Command::new("strace").args(["-qq", "-o", "/dev/null", "true"]).status();
    if !is_there.is_ok_and(|status| status.success()) {
        println!("skipped: no strace here, or it may not trace");
        return;
    }
    let input = tempfile::tempdir().expect("a folder");
    let csv = file(input.path(), "o.csv", sequence("--points 30 --seconds 0.2"));
    let pictures = small_pictures(input.path(), 2);
    let commands = writing_commands(&csv, &pictures);
    let (work, log) = (tempfile::tempdir().expect("a folder"), input.path().join("calls"));
    let folder = work.path();
    let old: Files = ["target", "target.gif", "target.parquet"].map(|name| (name.to_owned(), b"old".to_vec())).into();
    let mut runs = 0;
    for command in &commands {
        fill(folder, &old);
        let whole = traced(&["-e", "trace=write,fsync,rename,renameat,renameat2,mkdir"], &log, folder, command);
        assert!(whole.status.success(), "{command}: {}", stderr(&whole));
        let new = files(folder, folder);
        assert!(new != old, "{command}: nothing was written");
        let calls = fs::read_to_string(&log).expect("the log");
        let has_times = command.starts_with("evaluate");
        let lines = |content: &[u8]| content.iter().filter(|byte| **byte == b'\n').count();
        let mut failures = 0;
        for (names, error) in FAULTS {
            let is_one = |line: &str| names.split(',').any(|name| line.contains(&format!(" {name}(")));
            let count = calls.lines().filter(|line| is_one(line)).count();
            let most = if command.starts_with("demo") { MOST_PLACES_OF_DEMO } else { MOST_PLACES };
            let last = (count > most).then_some(count);
            for place in (1..=count).step_by(count.div_ceil(most).max(1)).chain(last) {
                fill(folder, &old);
                let (traced_calls, inject) =
                    (format!("trace={names}"), format!("inject={names}:error={error}:when={place}"));
                let output = traced(&["-e", &traced_calls, "-e", &inject], &log, folder, command);
                let what = format!("{command}: {names} {place} fails with {error}: {}", stderr(&output));
                let left = files(folder, folder);
                for (name, content) in &left {
                    // The time that a run took is another in every run.
                    let is_new = |new: &Vec<u8>| new == content || has_times && lines(new) == lines(content);
                    let is_whole = old.get(name) == Some(content) || new.get(name).is_some_and(is_new);
                    assert!(is_whole, "{what}: {name} is neither the old nor the new one");
                }
                assert!(old.keys().all(|name| left.contains_key(name)), "{what}: an old file is gone");
                match output.status.code() {
                    // What is told beside the result may be lost.
                    Some(0) => assert!(
                        left.keys().eq(new.keys()) && (has_times || left == new),
                        "{what}: a file is missing, and nothing was said"
                    ),
                    code => {
                        assert_eq!(code, Some(2), "{what}");
                        failures += 1;
                    }
                }
                runs += 1;
            }
        }
        assert!(failures >= 3, "{command}: {failures} failures");
    }
    println!("{runs} runs, each with one fault");
}
