use std::io::Read as _;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::Command;
use serde_json::Value;

/// The binary with arguments, in words.
pub(crate) fn freeform(arguments: &str) -> Command {
    let mut command = Command::cargo_bin("freeform").expect("the binary is built");
    command.args(arguments.split_whitespace()).env("COLUMNS", "100");
    command
}

/// What the binary does with arguments and an input.
pub(crate) fn run(arguments: &str, input: &str) -> Output {
    freeform(arguments).write_stdin(input).output().expect("the binary runs")
}

/// What the binary does when its standard output is closed after ten bytes.
pub(crate) fn closing_its_pipe(arguments: &[&str]) -> Output {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("freeform"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let mut start = [0; 10];
    child.stdout.take().expect("a pipe").read_exact(&mut start).expect("some output");
    child.wait_with_output().expect("it ends")
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// The output of a run that must succeed.
pub(crate) fn succeed(arguments: &str, input: &str) -> String {
    let output = run(arguments, input);
    assert!(output.status.success(), "{arguments}: {}", stderr(&output));
    stdout(&output)
}

pub(crate) fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// A short simulated sequence.
pub(crate) fn sequence(arguments: &str) -> String {
    succeed(&format!("simulate --points 120 --seconds 0.5 {arguments}"), "")
}

/// Writes a file into a folder and gives its path as text.
pub(crate) fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("a temporary file");
    path.to_str().expect("UTF-8").to_owned()
}

/// A new folder with so many pictures of a width and a height, by the shade of a frame, a column and a row; its path.
pub(crate) fn pictures(
    folder: &Path,
    count: u32,
    [width, height]: [u32; 2],
    shade: impl Fn(u32, u32, u32) -> u8,
) -> String {
    std::fs::create_dir(folder).expect("a folder");
    for frame in 0..count {
        let picture = image::GrayImage::from_fn(width, height, |column, row| image::Luma([shade(frame, column, row)]));
        picture.save(folder.join(format!("{frame}.png"))).expect("a picture");
    }
    folder.to_str().expect("UTF-8").to_owned()
}

/// A new folder with so many small pictures of a body that moves by a pixel from each to the next; its path.
pub(crate) fn small_pictures(base: &Path, count: u32) -> String {
    pictures(&base.join("p"), count, [64, 64], |frame, x, y| {
        let inside = (9 + frame..40 + frame).contains(&x) && (12..40 + x / 8).contains(&y);
        if inside { 230 } else { 9 }
    })
}

/// A pear of so many pixels in length, from its middle, and in height, how much wider it gets to its end, and how steep its edge is.
pub(crate) struct Pear {
    pub(crate) half: [f64; 2],
    pub(crate) taper: f64,
    pub(crate) edge: f64,
}

impl Pear {
    /// The shade at a place from its middle, of the pear turned by an angle.
    pub(crate) fn shade(&self, angle: f64, [x, y]: [f64; 2]) -> u8 {
        let (sin, cos) = angle.sin_cos();
        let (x, y) = (cos * x + sin * y, cos * y - sin * x);
        let depth = 1.0 - (x / self.half[0]).powi(2) - (y / (self.half[1] + self.taper * x)).powi(2);
        (30.0 + 180.0 * (self.edge * depth + 0.5).clamp(0.0, 1.0)) as u8
    }
}
