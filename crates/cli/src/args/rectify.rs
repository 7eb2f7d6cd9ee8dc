use std::path::PathBuf;

use clap::Args;
use nalgebra::Point2;

use super::pictures::{PictureOptions, picture_inputs};
use super::values::point_pair;

const EXAMPLES: &str = "\
Examples:
  freeform rectify 102,391=0,0 418,402=21,0 371,120=21,29.7 160,117=0,29.7 > plane.txt
  freeform rectify --known badge.csv --seen rest.csv > plane.txt
  freeform identify frames/ --rectify plane.txt

The output is a comment and the three rows of the map, for --rectify. With more than four points their errors are averaged, \
and the comment says how far the points are off in the plane (root mean square); so it does of the points of an outline.";

/// Find the map from a picture to the plane that objects move in, from points whose places in both are known or from a known
/// outline.
///
/// For a camera that looks at a plane from aside. The points are, for example, the corners of a sheet of paper that lies in
/// the plane. Their coordinates in the picture are those of the outlines: from pictures y runs upwards, unless --y-down is
/// given.
///
/// In place of points, an object of known outline that lies at rest in the plane will do. Neither a round outline tells the map nor a
/// rectangle whose sides may be taken for each other.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("rectify --known badge.csv --seen")))]
pub(crate) struct RectifyArgs {
    /// A point in the picture and the same point in the plane; at least four, no three of them on a line
    #[arg(
        required_unless_present = "known",
        conflicts_with = "known",
        value_name = "X,Y=U,V",
        value_parser = point_pair,
        allow_hyphen_values = true
    )]
    pub(crate) points: Vec<(Point2<f64>, Point2<f64>)>,

    /// The outline of an object in the plane, in the lengths of the plane: CSV (its first outline) or a picture (its largest object)
    #[arg(long, value_name = "FILE", requires = "seen")]
    pub(crate) known: Option<PathBuf>,

    /// The same object at rest, as the camera sees it: outlines as CSV, Parquet or polygons, or pictures; errors of several are
    /// averaged
    #[arg(long, value_name = "INPUT", num_args = 1.., requires = "known")]
    pub(crate) seen: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}
