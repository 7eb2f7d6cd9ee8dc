use clap::Args;
use nalgebra::Point2;

use super::values::point_pair;

const EXAMPLES: &str = "\
Examples:
  freeform rectify 102,391=0,0 418,402=21,0 371,120=21,29.7 160,117=0,29.7 > plane.txt
  freeform identify frames/ --rectify plane.txt

The output is a comment and the three rows of the map, for --rectify. With more than four points their errors are averaged, \
and the comment says how far the points are off in the plane (root mean square).";

/// Find the map from a picture to the plane that objects move in, from points whose places in both are known.
///
/// For a camera that looks at a plane from aside. The points are, for example, the corners of a sheet of paper that lies in
/// the plane. Their coordinates in the picture are those of the outlines: from pictures y runs upwards, unless --y-down is
/// given.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RectifyArgs {
    /// A point in the picture and the same point in the plane; at least four, no three of them on a line
    #[arg(required = true, value_name = "X,Y=U,V", value_parser = point_pair, allow_hyphen_values = true)]
    pub(crate) points: Vec<(Point2<f64>, Point2<f64>)>,
}
