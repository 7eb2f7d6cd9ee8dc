//! The command line as it was typed, for reports and advice.
use std::path::{Path, PathBuf};

use freeform_motion::outline_io::readable;

use crate::args::takes_next;

/// The command line as it could be typed again.
pub(crate) fn command_line() -> String {
    typed(&arguments())
}

/// The command line as it could be typed again to read standard input in place of its inputs.
pub(crate) fn command_line_of_stdin(inputs: &[PathBuf]) -> String {
    typed(&with_stdin_for(inputs, &arguments()))
}

fn arguments() -> Vec<String> {
    std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// The arguments with `-` in the place of the first of these inputs, and without the others.
fn with_stdin_for(inputs: &[PathBuf], arguments: &[String]) -> Vec<String> {
    let is_value = |index: usize| index > 0 && takes_next(&arguments[index - 1]);
    let is_input = |index: usize| !is_value(index) && inputs.iter().any(|input| input == Path::new(&arguments[index]));
    let first = (0..arguments.len()).find(|&index| is_input(index));
    let kept = (0..arguments.len()).filter(|&index| first == Some(index) || !is_input(index));
    kept.map(|index| if first == Some(index) { "-".to_owned() } else { arguments[index].clone() }).collect()
}

fn typed(arguments: &[String]) -> String {
    let arguments = arguments.iter().map(|argument| quoted(argument));
    std::iter::once("freeform".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// An argument as it could be typed.
pub(crate) fn quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+@%".contains(c);
    if readable(argument).to_string() != argument {
        // The shell writes what it cannot show in the same way, but for the braces.
        let escaped = readable(&argument.replace('\\', r"\\").replace('\'', r"\'")).to_string().replace("\\u{", r"\U{");
        return format!("$'{}'", without_braces(&escaped));
    }
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.to_owned()
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}

/// `\\U{202e}` as `\\U0000202e`.
fn without_braces(text: &str) -> String {
    let mut parts = text.split("\\U{");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |whole, part| match part.split_once('}') {
        Some((digits, rest)) => whole + "\\U" + &"0".repeat(8_usize.saturating_sub(digits.len())) + digits + rest,
        None => whole + part,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_argument_with_characters_that_cannot_be_seen_stays_on_its_line() {
        assert_eq!(quoted("a\nb'\u{202e}"), r"$'a\nb\'\U0000202e'");
    }

    #[test]
    fn standard_input_takes_the_place_of_the_inputs_and_of_nothing_else() {
        let piped = |inputs: &[&str], line: &str| {
            let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
            let arguments: Vec<String> = line.split(' ').map(str::to_owned).collect();
            with_stdin_for(&inputs, &arguments).join(" ")
        };
        assert_eq!(piped(&["a.mp4"], "identify --quiet a.mp4 --fps 25"), "identify --quiet - --fps 25");
        assert_eq!(piped(&["a.mp4", "b.mp4"], "outline a.mp4 b.mp4 -o a.mp4"), "outline - -o a.mp4");
        assert_eq!(piped(&["1.png"], "track --background 1.png 1.png"), "track --background 1.png -");
        assert_eq!(piped(&["<stdin>"], "track --dark"), "track --dark");
    }
}
