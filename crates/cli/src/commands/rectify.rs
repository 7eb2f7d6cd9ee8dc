use std::io::Write as _;

use freeform_motion::riccati::homography;

use crate::args::RectifyArgs;
use crate::failure::Failure;
use crate::output::Sink;

/// Finds the map from a picture to a plane.
pub(crate) fn run(args: &RectifyArgs) -> Result<(), Failure> {
    let map = homography(&args.points).map_err(Failure::unusable)?;
    let squares = args.points.iter().map(|(picture, plane)| (map * picture - plane).norm_squared());
    let off = (squares.sum::<f64>() / args.points.len() as f64).sqrt();
    let mut sink = Sink::stdout();
    let mut text = "# map from the picture to the plane".to_owned();
    if args.points.len() > 4 {
        text.push_str(&format!("; {} points, off by {off:.3e} in the plane", args.points.len()));
    }
    for row in map.matrix().row_iter() {
        text.push_str(&format!("\n{} {} {}", row[0], row[1], row[2]));
    }
    writeln!(sink, "{text}").map_err(|error| sink.failure(&error))?;
    sink.finish()
}
