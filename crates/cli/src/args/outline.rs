use std::path::PathBuf;

use clap::Args;

use super::pictures::{PictureOptions, picture_inputs};

const EXAMPLES: &str = "\
Examples:
  freeform outline 'mask-*.png' --fps 25 --output outlines.csv
  freeform outline frames/ --dark | freeform identify -
  freeform outline coco.json --fps 20 --output outlines.parquet
  freeform outline parts.gif --background median --objects all --overlay drawn.gif
  freeform outline 'frames/*.jpg' --ring dark --pixel-size 0.35 --pixel-aspect 1.14";

/// Trace outlines in pictures and video, or take those of a file; write them as CSV or Parquet.
///
/// Each picture is one frame. Polygons of COCO, labelme and TrackMate, CSV and Parquet are taken as they are. Of each picture the outer
/// outline of the largest object, or of all objects, is traced to a fraction of a pixel; holes are filled unless `--contours all` is given
/// or chosen. An object clipped by the edge of the picture gives open arcs. y runs upwards from the lower edge.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("outline")))]
pub(crate) struct OutlineArgs {
    /// Pictures in the order of time, or outlines: files, folders, quoted patterns; '-' is standard input
    #[arg(required = true, value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    /// Where to write the outlines, as Parquet if the name ends so; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,

    /// Write the standard deviations of the points too, as column `deviation`
    ///
    /// They are known where edges are fitted in grey pictures. Those of a table are written in any case. `identify` and `track`
    /// weigh the points by them.
    #[arg(long)]
    pub(crate) deviations: bool,

    /// Draw the outlines on every picture: a folder for PNG files, FILE.gif, or FILE.y4m (uncompressed video, which ffmpeg
    /// and others read)
    ///
    /// Drawings of an earlier run are removed from the folder. The folder is refused if it contains pictures with the names of
    /// drawings that freeform did not draw.
    #[arg(long, value_name = "DIR|FILE.gif|FILE.y4m")]
    pub(crate) overlay: Option<PathBuf>,

    /// Print only results and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}
