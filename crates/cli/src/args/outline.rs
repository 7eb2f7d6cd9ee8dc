use std::path::PathBuf;

use clap::Args;

use super::values::positive;

const EXAMPLES: &str = "\
Examples:
  freeform outline mask-0001.png > outline.csv
  freeform outline mask-*.png --fps 25 --output outlines.csv
  freeform outline frame-*.png --dark | freeform identify -";

/// Trace outlines in masks and pictures (PNG), as CSV.
///
/// Each picture is one frame, in the order given. The outline of its largest object is traced to a fraction of a pixel; y
/// runs upwards from the lower edge. A picture without an object leaves a gap and a warning.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct OutlineArgs {
    /// The pictures, in the order of time
    #[arg(required = true, value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,

    /// Frames per second
    #[arg(long, value_parser = positive, default_value_t = 30.0)]
    pub(crate) fps: f64,

    /// The object is darker than the ground
    #[arg(long)]
    pub(crate) dark: bool,

    /// Where to write the outlines; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,
}
