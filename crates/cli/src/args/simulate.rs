use std::path::PathBuf;

use clap::Args;
use freeform_motion::riccati::AffineMotion;

use super::values::{affine, finite, fraction, not_negative, pair, positive};

const EXAMPLES: &str = "\
Examples:
  freeform simulate > outlines.csv
  freeform simulate --shape glider --omega -1.0472 --b 0,4 --seconds 20 --output glider.csv
  freeform simulate --shape mask.png --affine 0.1,1,-1,-0.1,0.2,0 --scale 1 --noise 0.002
  freeform simulate --occlusion 0.2 --outliers 0.05 --seed 7 | freeform identify -

Shapes: plane, van, glass_vase, cd_box, shoe, car, vase, glider, phone, hat, bird, boomerang, circle, ellipse, square.

The first lines of the output are comments that hold the command and the true motion; 'freeform identify' shows the \
truth beside what it finds.";

/// Make outlines of a moving object as CSV.
///
/// The object is of unit size in the image (the largest distance between two of its points is 1) and starts at the origin.
/// Its points are drawn anew in every frame. The motion is that in space: the image moves with b times f/Z0.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// A built-in shape, or a file: a CSV polygon with columns x and y, or a picture (PNG) of a mask
    ///
    /// An outline from a file is centred and scaled to unit size.
    #[arg(long, value_name = "NAME|FILE", default_value = "bird")]
    pub(crate) shape: String,

    /// Angular velocity in rad/s, positive clockwise (y up)
    #[arg(long, value_name = "W", value_parser = finite, allow_hyphen_values = true,
          default_value_t = std::f64::consts::FRAC_PI_2)]
    pub(crate) omega: f64,

    /// Velocity at the origin, in space lengths per second
    #[arg(long, value_name = "B1,B2", value_parser = pair, allow_hyphen_values = true, default_value = "-3,4")]
    pub(crate) b: [f64; 2],

    /// An affine motion in place of --omega and --b
    #[arg(long, value_name = "A1,A2,A3,A4,B1,B2", value_parser = affine, allow_hyphen_values = true,
          conflicts_with_all = ["omega", "b"])]
    pub(crate) affine: Option<AffineMotion>,

    /// Camera scale f/Z0: image lengths per space length
    #[arg(long, value_name = "F_OVER_Z0", value_parser = positive, default_value_t = 0.1)]
    pub(crate) scale: f64,

    /// Frames per second
    #[arg(long, value_parser = positive, default_value_t = 30.0)]
    pub(crate) fps: f64,

    /// Length of the sequence in seconds
    #[arg(long, value_parser = positive, default_value_t = 10.0)]
    pub(crate) seconds: f64,

    /// Points on the whole outline
    #[arg(long, value_name = "COUNT", default_value_t = 400)]
    pub(crate) points: usize,

    /// Standard deviation of the noise on each coordinate, in image lengths
    #[arg(long, value_name = "SIGMA", value_parser = not_negative, default_value_t = 0.005)]
    pub(crate) noise: f64,

    /// Share of the outline that is missing, at a random place in every frame
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.0)]
    pub(crate) occlusion: f64,

    /// Share of the points that are wrong
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.0)]
    pub(crate) outliers: f64,

    /// Everything random follows from it
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,

    /// Where to write the outlines; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,
}
