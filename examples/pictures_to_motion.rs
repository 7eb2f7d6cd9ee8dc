//! From pictures to motion in a loop of one's own, with the default settings of everything but rate and aspect:
//! `cargo run --release --example pictures_to_motion -- [--fps RATE] [--pixel-aspect WIDTH_OVER_HEIGHT] frames/`.
use std::path::PathBuf;

use freeform_motion::estimate::MotionEstimate;
use freeform_motion::outline_io::{
    Clipping, OutlineFrame, PictureOutlines, PictureSequence, PictureSettings, Selection, SequenceSettings,
    TraceSettings,
};
use freeform_motion::{Tracker, TrackerSettings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Arguments { frames_per_second, pixel_aspect, paths } = arguments()?;
    let pictures =
        PictureSequence::open(&paths, SequenceSettings { frames_per_second, ..SequenceSettings::default() })?;
    // A video may say its own aspect.
    let pixel_aspect = pixel_aspect.or(pictures.pixel_aspect()).unwrap_or(1.0);
    let trace = TraceSettings { clipping: Clipping::Open, minimum_area: 100, pixel_aspect, ..TraceSettings::default() };
    let settings = PictureSettings { trace, selection: Selection::All, ..PictureSettings::default() };
    let mut tracker = Tracker::new(TrackerSettings::default())?;
    for traced in PictureOutlines::new(pictures, settings)? {
        // What is wrong with one picture does not end the sequence.
        let traced = match traced {
            Ok(traced) => traced,
            Err(error) => {
                eprintln!("{error}");
                continue;
            }
        };
        let (frame, time) = (traced.frame.frame, traced.frame.time);
        match traced.objects {
            Err(error) => eprintln!("{}: {error}", traced.frame.file),
            Ok(objects) => {
                for (name, object) in objects {
                    let outline = OutlineFrame { frame, time, object: name.to_string(), outline: object.outline };
                    let observation = tracker.push(&outline);
                    let used = if observation.is_accepted() { "used" } else { "rejected" };
                    println!("{time:.3} s, object {name}, {used}: {}", in_words(observation.estimate));
                }
            }
        }
    }
    for result in tracker.results() {
        result.warnings.iter().for_each(|warning| eprintln!("object {}: {warning}", result.object));
    }
    Ok(())
}

/// The parameters by name, each with its standard deviation.
fn in_words(estimate: Option<MotionEstimate>) -> String {
    let Some(estimate) = estimate else { return "no motion known yet".to_owned() };
    let parameters = estimate.parameters().map(|p| match (p.value, p.standard_deviation) {
        (Some(value), Some(deviation)) => format!("{} = {value:.4} +- {deviation:.4} {}", p.name, p.unit),
        _ => format!("{} not observable", p.name),
    });
    parameters.collect::<Vec<_>>().join(", ")
}

struct Arguments {
    /// `None` for what a video or animation says, else 30.
    frames_per_second: Option<f64>,
    /// Width of a pixel over its height; `None` for what a video says, else 1.
    pixel_aspect: Option<f64>,
    paths: Vec<PathBuf>,
}

fn arguments() -> Result<Arguments, Box<dyn std::error::Error>> {
    let mut found = Arguments { frames_per_second: None, pixel_aspect: None, paths: Vec::new() };
    let mut rest = std::env::args_os().skip(1);
    while let Some(argument) = rest.next() {
        let value = match argument.to_str() {
            Some("--fps") => &mut found.frames_per_second,
            Some("--pixel-aspect") => &mut found.pixel_aspect,
            _ => {
                found.paths.push(PathBuf::from(argument));
                continue;
            }
        };
        let text = rest.next().ok_or_else(|| format!("{} needs a number", argument.display()))?;
        *value =
            Some(text.to_string_lossy().parse::<f64>().map_err(|error| format!("{}: {error}", argument.display()))?);
    }
    if found.paths.is_empty() {
        return Err("usage: pictures_to_motion [--fps RATE] [--pixel-aspect RATIO] PICTURES...".into());
    }
    Ok(found)
}
