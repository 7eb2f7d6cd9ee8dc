use std::path::PathBuf;

use clap::Args;
use freeform_motion::sim_camera::{BuiltInShape, PictureScene};

use super::dynamics::DynamicsArgs;
use super::identify::MotionChoice;
use super::simulated::{DisturbanceArgs, TrueMotionArgs};
use super::values::{not_negative, positive};

const EXAMPLES: &str = "\
Examples:
  freeform simulate > outlines.csv
  freeform simulate --shape glider --omega -1.0472 --b 0,4 --seconds 20 --output glider.csv
  freeform simulate --shape mask.png --affine 0.1,1,-1,-0.1,0.2,0 --scale 1 --noise 0.002
  freeform simulate --motion projective --projective 0,1.6,-1.6,0,-3,4,-0.015,0.02
  freeform simulate --motion plane --focal 900 --principal 320,240 --plane 0.1,0,0.5,0.1,0,0.1 --normal 0.6,0
  freeform simulate --shape circle --dynamics velocity --omega 2 --velocity 10,0
  freeform simulate --dynamics accelerating --velocity 3,8 --acceleration 0,0,-9.81
  freeform simulate --dynamics oscillating --omega 1 --velocity 2,0 --period 3 --amplitude 0.5
  freeform simulate --occlusion 0.2 --outliers 0.05 --seed 7 | freeform identify -
  freeform simulate --pictures frames --scene belt-shadow --seed 3";

const OUTPUT: &str = "\
The first lines of the output are comments with the command and the true motion: omega and b, and the velocity v of the \
middle of the object in the last frame. Where the motion changes with time, all of it is that in the last frame, whose \
time is told. 'freeform identify' prints this truth next to its result.";

const PICTURES: &str = "\
The folder gets 000000.png, 000001.png, ... and truth.csv, a row for each body in each picture: its middle in pixels (y upwards \
from the lower left corner), its angle and omega (rad, positive clockwise), its velocity, whether it is whole and seen, and the \
first picture that shows it whole with where its middle was there: first_frame, first_x and first_y, empty before. Bodies are \
numbered as in the scene, objects of 'freeform identify' as they are found: they relate a body to the object that lies there in \
that picture.";

/// What stands behind the options: examples, shapes, the output, scenes.
fn after_help() -> String {
    let shapes = BuiltInShape::ALL.map(BuiltInShape::name).join(", ");
    let scenes = PictureScene::ALL.map(PictureScene::name).join(", ");
    format!("{EXAMPLES}\n\nShapes: {shapes}.\n\n{OUTPUT}\n\nScenes of --pictures: {scenes}. {PICTURES}")
}

/// Make outlines of a moving object as CSV, or test pictures of moving objects.
///
/// The object has unit size in the image (the largest distance between two of its points is 1) and starts at the origin.
/// Each frame has new random points of the outline. The motion is given in space: the image moves with b times f/Z0. It is
/// that at time 0 where --dynamics lets it change.
#[derive(Debug, Args)]
#[command(after_help = after_help())]
pub(crate) struct SimulateArgs {
    /// A built-in shape, or a file: a CSV polygon with columns x and y, or a mask picture (PNG)
    ///
    /// An outline from a file is centred and scaled to unit size.
    #[arg(long, value_name = "NAME|FILE", default_value = "bird")]
    pub(crate) shape: String,

    #[command(flatten)]
    pub(crate) motion_in_space: TrueMotionArgs,

    /// Family of motions that must hold the motion [default: any]
    #[arg(long, value_enum)]
    pub(crate) motion: Option<MotionChoice>,

    #[command(flatten)]
    pub(crate) dynamics: DynamicsArgs,

    /// Frames per second
    #[arg(long, value_parser = positive, default_value_t = 30.0)]
    pub(crate) fps: f64,

    /// Length of the sequence in seconds [default: 10, of pictures 2]
    #[arg(long, value_parser = positive)]
    pub(crate) seconds: Option<f64>,

    /// Points on the whole outline
    #[arg(long, value_name = "COUNT", default_value_t = 400)]
    pub(crate) points: usize,

    #[command(flatten)]
    pub(crate) disturbance: DisturbanceArgs,

    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,

    /// Make pictures of 640 x 480 pixels instead, in a new or an empty folder, with the truth beside them
    #[arg(long, value_name = "DIR", conflicts_with_all = ["shape", "omega", "b", "affine", "projective", "scale", "motion", "dynamics",
          "velocity", "acceleration", "period", "amplitude", "points", "noise", "occlusion", "outliers", "output"])]
    pub(crate) pictures: Option<PathBuf>,

    /// What the pictures show; sizes, motions, contrast, blur, shading and noise follow from the seed
    #[arg(long, value_name = "NAME", requires = "pictures", default_value = "gear")]
    pub(crate) scene: PictureScene,

    /// Write JPEG of this quality, 1 to 100, instead of PNG
    #[arg(long, value_name = "QUALITY", requires = "pictures", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub(crate) jpeg: Option<u8>,

    /// How long the shutter is open, in seconds, at most the time between two pictures: what moves is blurred
    #[arg(long, value_name = "SECONDS", requires = "pictures", value_parser = not_negative, default_value_t = 0.0)]
    pub(crate) exposure: f64,

    /// Grey values are those of the light to the power of 1 / GAMMA, 0.1 to 10: 1 in proportion to it, 2.2 as those of most cameras
    #[arg(long, requires = "pictures", value_parser = positive, default_value_t = 1.0)]
    pub(crate) gamma: f64,

    /// Where to write the outlines, as Parquet if the name ends so; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,
}
