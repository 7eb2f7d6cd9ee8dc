//! Outputs that would destroy each other or an input.
use std::fs;
use std::path::{Path, PathBuf};

use freeform_motion::outline_io::{has_picture_extension, picture_files};

use super::destination::{folder_of, is_same_file};
use crate::failure::Failure;

/// Standard output as a file.
const STDOUT: &str = "/dev/stdout";

/// Refuses a folder for drawings that is the input, or holds it.
pub(crate) fn refuse_drawing_beside(inputs: &[PathBuf], folder: &Path) -> Result<(), Failure> {
    let Some(place) = fs::canonicalize(folder).ok().filter(|place| place.is_dir()) else { return Ok(()) };
    for input in inputs.iter().filter(|input| input.as_os_str() != "-") {
        // A pattern is no file, but its folder is one.
        let named_in = fs::canonicalize(folder_of(input)).ok();
        let input = fs::canonicalize(input).ok();
        let lies_in = input.as_deref().and_then(Path::parent);
        if [named_in.as_deref(), input.as_deref(), lies_in].contains(&Some(&place)) {
            let reason = format_args!("{}: the pictures of the input are here, draw elsewhere", place.display());
            return Err(Failure::unusable(reason));
        }
    }
    Ok(())
}

/// Refuses output files that are read or of a folder that is, or one another, by whatever names; standard output too, which would be read as it
/// grows. A PNG within another is one of its drawings.
pub(crate) fn refuse_overwriting(read: &[PathBuf], outputs: &[&Path]) -> Result<(), Failure> {
    let all = [outputs, &[Path::new(STDOUT)]].concat();
    read.iter().try_for_each(|input| refuse_files_of(input, &all))?;
    for folder in outputs.iter().filter(|output| output.is_dir()) {
        let is_picture = |output: &&&Path| output.extension().is_some_and(|extension| extension == "png");
        let is_within = |output: &&&Path| !output.is_dir() && is_same_file(folder_of(output), folder);
        if let Some(output) = outputs.iter().filter(is_picture).find(is_within) {
            let reason = format_args!("{}: the drawings go into this folder, write elsewhere", output.display());
            return Err(Failure::unusable(reason));
        }
    }
    for (index, output) in outputs.iter().enumerate() {
        let is_device = output.exists() && !output.is_file() && !output.is_dir();
        if !is_device && outputs[..index].iter().any(|other| is_same_file(other, output)) {
            return Err(Failure::unusable(format_args!("{}: given for two outputs", output.display())));
        }
    }
    Ok(())
}

/// Formats of figures that are asked for by a name, but not written.
const OTHER_FIGURES: [&str; 6] = ["pdf", "eps", "ps", "webp", "html", "htm"];

/// Refuses a name of a figure that says another format than SVG.
pub(crate) fn refuse_other_format(svg: Option<&Path>) -> Result<(), Failure> {
    let is_other = |path: &&Path| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let is_among = |extension: &str| OTHER_FIGURES.iter().any(|other| other.eq_ignore_ascii_case(extension));
        has_picture_extension(path) || extension.is_some_and(is_among)
    };
    match svg.filter(is_other) {
        Some(path) => {
            Err(Failure::unusable(format_args!("{}: --svg writes SVG, give a name that ends in .svg", path.display())))
        }
        None => Ok(()),
    }
}

/// Refuses outputs that are standard output by another name, where the result goes.
pub(crate) fn refuse_standard_output(outputs: &[&Path]) -> Result<(), Failure> {
    let (stdout, nowhere) = (Path::new(STDOUT), Path::new("/dev/null"));
    let is_stdout = |output: &&&Path| fs::metadata(output).is_ok() && is_same_file(output, stdout);
    match outputs.iter().find(is_stdout) {
        Some(output) if !is_same_file(output, nowhere) => {
            Err(Failure::unusable(format_args!("{}: this is standard output, where the result goes", output.display())))
        }
        _ => Ok(()),
    }
}

fn refuse_files_of(input: &Path, outputs: &[&Path]) -> Result<(), Failure> {
    // What cannot be listed cannot be read either, which is told in its place.
    let stdin = Path::new("/dev/stdin");
    let input = if input.as_os_str() == "-" { stdin } else { input };
    let files = picture_files(input).unwrap_or_default();
    for output in outputs {
        if let Some(place) = fs::canonicalize(output).ok().filter(|place| place.is_file())
            && files.iter().any(|file| fs::canonicalize(file).is_ok_and(|file| file == place))
        {
            let what = if files == [input] { "the input" } else { "a file of the input" };
            return Err(Failure::unusable(format_args!("{}: this is {what}", output.display())));
        }
    }
    Ok(())
}
