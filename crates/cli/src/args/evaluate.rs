use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use freeform_experiments::monte_carlo::Method;
use freeform_motion::sim_camera::Sampling;

use super::identify::MotionChoice;
use super::simulated::{DisturbanceArgs, TrueMotionArgs};
use super::values::{at_least_one, fraction, frame_count, positive, thread_count};

const EXAMPLES: &str = "\
Examples:
  freeform evaluate
  freeform evaluate --shape bird glider masks/*.png --occlusion 0.2 --outliers 0.05 --frames 30,120
  freeform evaluate --affine 0.05,1.2,-1.7,-0.08,-0.3,0.4 --scale 1 --frames 60 --method filter
  freeform evaluate --seconds 30 --runs 10 --method filter,adaptive
  freeform evaluate --acquisition --shape bird van --runs 200 --format json
  freeform evaluate --suite --shape masks/*.png --output accuracy.md
  freeform evaluate --suite arc --runs 5 --method filter
  freeform evaluate --suite stress --kinds round/ --runs 10

Output, for each shape, and pooled over shapes and parameters:
  RMSE      root mean square error of a parameter, in the image
  bound     the Cramer-Rao bound: the smallest standard deviation of any unbiased estimator, if
            the shape is known and the initial pose is not; counts only points that are visible,
            not outliers, and on the right object
  ratio     RMSE over bound; pooled: root mean square of error over bound
  bias      mean error, and its standard error
  coverage  share of 95 % intervals (1.96 standard deviations each side) that contain the truth
  lost      runs without an estimate, or with one that moves the outline from its true place in
            the first frame to more than a quarter of its root mean square radius from its true
            place in the last frame (root mean square); they count in no other column
  rejected  share of the frames that were not used
  us/frame  mean time per frame on one core, including search for the object and final fit";

/// Measure the accuracy by Monte Carlo simulation: errors relative to the Cramer-Rao bound, with two baselines.
///
/// Simulates many sequences of each shape, identifies the motion in each with every method, and prints statistics of the
/// errors. The baselines are area moments, and iterated closest points to the first frame. The same seed gives the same
/// numbers for any number of threads, except for the times.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct EvaluateArgs {
    /// Built-in shapes, CSV polygons or mask pictures (PNG), as for 'simulate' [default: bird; with --suite: added to its
    /// six shapes]
    #[arg(long, value_name = "NAME|FILE", num_args = 1..)]
    pub(crate) shape: Vec<String>,

    #[command(flatten)]
    pub(crate) motion_in_space: TrueMotionArgs,

    /// Family of motions to identify; it must contain the true motion [default: rigid, affine with --affine,
    /// projective with --projective]
    ///
    /// With --suite stress rigid, similarity or affine: the picture grows or shrinks as well, what is at rest included, and for affine
    /// motion a camera looks at the plane from aside.
    #[arg(long, value_enum)]
    pub(crate) motion: Option<MotionChoice>,

    /// Lengths of the sequences in frames, at least 2 [default: 3,8,30,120; --suite stress: whole sequences]
    ///
    /// With --suite stress one number: what is stated after so many frames is judged.
    #[arg(long, value_name = "N,...", value_parser = frame_count, value_delimiter = ',')]
    pub(crate) frames: Vec<usize>,

    /// Lengths of the sequences in seconds
    #[arg(long, value_name = "S,...", value_parser = positive, value_delimiter = ',')]
    pub(crate) seconds: Vec<f64>,

    /// Frames per second
    #[arg(long, value_parser = positive, default_value_t = 30.0)]
    pub(crate) fps: f64,

    /// Points on the whole outline
    #[arg(long, value_name = "COUNT", default_value_t = 400)]
    pub(crate) points: usize,

    /// How the points are spread along the outline
    #[arg(long, value_enum, default_value_t = SamplingChoice::Independent)]
    pub(crate) sampling: SamplingChoice,

    #[command(flatten)]
    pub(crate) disturbance: DisturbanceArgs,

    /// Share of the frames that show another object
    #[arg(long, value_name = "FRACTION", value_parser = fraction, default_value_t = 0.0)]
    pub(crate) wrong_frames: f64,

    /// Sequences of each shape and length, or of each kind [default: 50; --suite stress: 20]
    #[arg(long, value_name = "COUNT", value_parser = at_least_one)]
    pub(crate) runs: Option<usize>,

    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,

    /// Methods to evaluate [default: filter,moments,icp; for projective motion, which moments do not have, filter,icp; for a plane in space filter]
    #[arg(long, value_parser = methods(), value_delimiter = ',')]
    pub(crate) method: Vec<Method>,

    /// Evaluate the start instead of the motion: how often the pose in the second of two frames is found
    ///
    /// Between the two frames the turn is uniform within 60 degrees and the shift uniform up to half the size of the
    /// object. The pose is found if the turn is right to 6 degrees and the centre to a tenth of the size.
    #[arg(long, conflicts_with_all = ["omega", "b", "affine", "projective", "scale", "frames", "seconds", "fps", "wrong_frames"])]
    pub(crate) acquisition: bool,

    /// Evaluate the settings of docs/accuracy.md, or those whose name contains TEXT, and print Markdown
    ///
    /// Shapes: bird, glider, phone, van, shoe and hat, and those of --shape. Acquisition has ten times as many runs as --runs.
    ///
    /// 'stress' is another suite, that of docs/honesty.md: more than a hundred kinds of sequences that are not what an estimator
    /// expects, in the classes plain, noise, family, dynamics, round and symmetry. A table tells how often a stated value was more
    /// than four standard deviations off without a word, how often nothing was stated, and how often the 95 % intervals held.
    #[arg(long, value_name = "TEXT", num_args = 0..=1, default_missing_value = "",
          conflicts_with_all = ["omega", "b", "affine", "projective", "scale", "seconds", "fps", "points", "sampling",
                                "noise", "occlusion", "outliers", "wrong_frames", "acquisition"])]
    pub(crate) suite: Option<String>,

    /// With --suite stress: only kinds whose class and name, as in 'noise/camera shake', contain TEXT
    #[arg(long, value_name = "TEXT")]
    pub(crate) kinds: Option<String>,

    /// With --suite stress: list the kinds and what they are
    #[arg(long)]
    pub(crate) list: bool,

    /// Number of threads, at most 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = thread_count)]
    pub(crate) threads: Option<usize>,

    /// Do not print times, so that the same seed gives the same output
    #[arg(long)]
    pub(crate) no_timing: bool,

    /// Format of the result [default: table; --suite: markdown; --suite stress: table]
    #[arg(long, value_enum)]
    pub(crate) format: Option<EvaluateFormat>,

    /// Where to write the result; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SamplingChoice {
    /// Every point anywhere on the outline, as the bound assumes
    Independent,
    /// One point on each of equally long pieces; can be slightly better than the bound
    Stratified,
}

impl SamplingChoice {
    /// The setting of the simulator.
    pub(crate) fn sampling(self) -> Sampling {
        match self {
            Self::Independent => Sampling::Independent,
            Self::Stratified => Sampling::default(),
        }
    }
}

/// Methods by their names.
fn methods() -> impl TypedValueParser<Value = Method> {
    let names = Method::ALL.map(|method| PossibleValue::new(method.name()).help(method.description()));
    PossibleValuesParser::new(names)
        .try_map(|name| Method::ALL.into_iter().find(|method| method.name() == name).ok_or("there is no such method"))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EvaluateFormat {
    /// For reading
    Table,
    /// A summary for a document
    Markdown,
    /// One JSON object, schema freeform.evaluate/1
    Json,
    /// One row per setting, method, shape and parameter
    Csv,
}
