use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::pictures::{PictureOptions, picture_inputs};

const EXAMPLES: &str = "\
Examples:
  freeform recognise outlines.csv --known plane.csv phone.png hat.png
  freeform recognise frames/ --objects all --known known/*.png --format json
  freeform simulate --shape hat --seconds 0.2 | freeform recognise - --known hat.csv van.csv";

/// Say which known outline each object has, under any affine map, or that it has none of them.
///
/// Compares the affine invariants of the curves by their Mahalanobis distance, brings the known outlines that are near onto the one
/// seen, by the related points and by turning one contour along the other, and checks how far the whole outlines lie from
/// each other against their noise. The frames of an object add up. Outlines of which a part is hidden are left out.
///
/// Outlines that an affine map takes to each other, as all ellipses, cannot be told apart and share the probability.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("recognise")))]
pub(crate) struct RecogniseArgs {
    /// Outlines as CSV, Parquet or polygons (COCO, labelme, TrackMate), or pictures: files, a folder, a quoted pattern; '-' is
    /// standard input
    #[arg(required = true, value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    /// The known outlines, one a file: CSV (its first outline) or a picture (its largest object)
    #[arg(long, required = true, value_name = "FILE", num_args = 1..)]
    pub(crate) known: Vec<PathBuf>,

    /// How the result is printed
    #[arg(long, value_enum, default_value_t = RecogniseFormat::Table)]
    pub(crate) format: RecogniseFormat,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecogniseFormat {
    /// For reading
    Table,
    /// One JSON object
    Json,
}
