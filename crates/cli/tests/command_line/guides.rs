//! The commands in the guides do what the guides say: every `sh` block is run, with pictures where a guide needs them.
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::pears::pear;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// The commands of all `sh` blocks of a guide.
fn commands(guide: &str) -> String {
    let text = std::fs::read_to_string(docs().join(guide)).expect("the guide");
    let mut commands = String::new();
    let mut within = false;
    for line in text.lines() {
        match line {
            "```sh" => within = true,
            "```" => within = false,
            line if within => commands = commands + line + "\n",
            _ => {}
        }
    }
    commands
}

/// A pear that turns and drifts, light on dark.
fn write_frames(folder: &Path) {
    std::fs::create_dir(folder).expect("a folder");
    for frame in 0..12 {
        pear(frame).save(folder.join(format!("frame-{frame}.png"))).expect("a picture");
    }
}

/// Runs the commands of a guide and gives what they print.
#[track_caller]
fn run_guide(guide: &str) -> String {
    let script = commands(guide);
    assert!(script.contains("freeform "), "{guide} has no commands");
    let folder = tempfile::tempdir().expect("a folder");
    write_frames(&folder.path().join("frames"));
    let binary = assert_cmd::cargo::cargo_bin("freeform");
    let mut path = binary.parent().expect("a folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let output = Command::new("sh")
        .args(["-euc", &script])
        .current_dir(folder.path())
        .env("PATH", path)
        .output()
        .expect("a shell");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{guide}: {errors}\n{}", String::from_utf8_lossy(&output.stdout));
    assert!(!errors.contains("panicked"), "{guide}: {errors}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn get_started_runs() {
    let printed = run_guide("get-started.md");
    assert!(printed.contains("truth") && printed.contains("freeform.identify/2"), "{printed}");
}

#[test]
fn video_to_motion_runs() {
    let printed = run_guide("video-to-motion.md");
    let aspect = printed.lines().find_map(|line| line.strip_prefix("aspect ")).expect("the aspect");
    assert!((aspect.parse::<f64>().expect("a number") - 1.0).abs() < 0.02, "{aspect}");
    assert!(printed.contains("b: velocity at the lower left corner, in lengths/s, a pixel 0.5 high"), "{printed}");
}

#[test]
fn choosing_method_and_degree_runs() {
    run_guide("choosing-method-and-degree.md");
}

#[test]
fn reading_uncertainties_runs() {
    run_guide("reading-uncertainties.md");
}

#[cfg(feature = "parquet")]
#[test]
fn tables_runs() {
    let printed = run_guide("tables.md");
    let (from_parquet, from_csv) = printed.split_at(printed.len() / 2);
    assert!(from_parquet.contains("omega"), "{printed}");
    assert_eq!(from_parquet, from_csv);
}

#[test]
fn each_crate_runs() {
    run_guide("each-crate.md");
}

#[test]
fn honesty_runs_and_explains_every_kind_of_the_suite() {
    assert!(run_guide("honesty.md").contains("disc rolling"));
    let output = Command::new(assert_cmd::cargo::cargo_bin("freeform"))
        .args(["evaluate", "--suite", "stress", "--list", "--format", "markdown"])
        .output()
        .expect("the binary runs");
    let listed = String::from_utf8(output.stdout).expect("UTF-8");
    let document = std::fs::read_to_string(docs().join("honesty.md")).expect("the document");
    for line in listed.lines() {
        assert!(document.contains(line), "docs/honesty.md lacks: {line}");
    }
}
