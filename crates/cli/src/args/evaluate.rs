use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use freeform_experiments::monte_carlo::Method;
use freeform_motion::sim_camera::Sampling;

use super::identify::MotionChoice;
use super::simulated::{DisturbanceArgs, TrueMotionArgs};
use super::values::{at_least_one, fraction, frame_count, positive};

const EXAMPLES: &str = "\
Examples:
  freeform evaluate
  freeform evaluate --shape bird glider masks/*.png --occlusion 0.2 --outliers 0.05 --frames 30,120
  freeform evaluate --affine 0.05,1.2,-1.7,-0.08,-0.3,0.4 --scale 1 --frames 60 --method filter
  freeform evaluate --seconds 30 --runs 10 --method filter,adaptive
  freeform evaluate --acquisition --shape bird van --runs 200 --format json
  freeform evaluate --suite --shape masks/*.png --output accuracy.md
  freeform evaluate --suite arc --runs 5 --method filter

What is printed, for each shape and pooled over shapes and parameters:
  RMSE      root mean square error of a parameter, in the image
  bound     the Cramer-Rao bound: the smallest standard deviation of any unbiased estimator, the
            shape being known and the initial pose not; only points count that are visible, no
            outliers, of the right object
  ratio     RMSE over bound; pooled: root mean square of error over bound
  bias      mean error, and its standard error
  coverage  how often the 95 % interval (1.96 standard deviations either side) held the truth
  lost      runs without an estimate, or with one that leads the outline astray: moved from its
            true place in the first frame over the whole sequence, it ends more than a quarter of
            its root mean square radius off (root mean square); they count in no other column
  rejected  share of the frames that were not used
  us/frame  mean time of a frame on one core, search for the object and final fit included";

/// Monte Carlo of the identification: errors against the Cramer-Rao bound, beside two baselines.
///
/// Simulates many sequences of each shape, identifies the motion in each by every method, and prints how far off they are.
/// Baselines: area moments, and iterated closest points to the first frame. The same seed gives the same numbers whatever
/// the number of threads, times aside.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct EvaluateArgs {
    /// Built-in shapes, CSV polygons or pictures of masks (PNG), as 'simulate' takes them [default: bird; --suite: added
    /// to its six]
    #[arg(long, value_name = "NAME|FILE", num_args = 1..)]
    pub(crate) shape: Vec<String>,

    #[command(flatten)]
    pub(crate) motion_in_space: TrueMotionArgs,

    /// Family of motions that is identified; it must hold the true one [default: rigid, affine with --affine]
    #[arg(long, value_enum)]
    pub(crate) motion: Option<MotionChoice>,

    /// Lengths of the sequences in frames, at least 2 [default: 3,8,30,120]
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

    /// Sequences of each shape and length
    #[arg(long, value_name = "COUNT", value_parser = at_least_one, default_value_t = 50)]
    pub(crate) runs: usize,

    /// Everything random follows from it
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,

    /// The methods that are evaluated
    #[arg(long, value_parser = methods(), value_delimiter = ',', default_values = ["filter", "moments", "icp"])]
    pub(crate) method: Vec<Method>,

    /// Evaluate the start in place of the motion: two frames, a turn uniform within 60 degrees and a shift uniform up to
    /// half the object's size between them
    ///
    /// Prints the share of runs in which the second pose was found: the turn to 6 degrees, the centre to a tenth of the
    /// object's size.
    #[arg(long, conflicts_with_all = ["omega", "b", "affine", "scale", "frames", "seconds", "fps", "wrong_frames"])]
    pub(crate) acquisition: bool,

    /// Evaluate the settings of docs/accuracy.md, or those whose name contains TEXT, and print Markdown
    ///
    /// Shapes: bird, glider, phone, van, shoe and hat, and those of --shape. Acquisition takes ten times --runs.
    #[arg(long, value_name = "TEXT", num_args = 0..=1, default_missing_value = "",
          conflicts_with_all = ["omega", "b", "affine", "scale", "motion", "frames", "seconds", "fps", "points", "sampling",
                                "noise", "occlusion", "outliers", "wrong_frames", "acquisition"])]
    pub(crate) suite: Option<String>,

    /// Number of threads [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = at_least_one)]
    pub(crate) threads: Option<usize>,

    /// Leave out the times, so that the same seed gives the same output
    #[arg(long)]
    pub(crate) no_timing: bool,

    /// How the result is printed [default: table; --suite: markdown]
    #[arg(long, value_enum)]
    pub(crate) format: Option<EvaluateFormat>,

    /// Where to write the result; '-' is standard output
    #[arg(long, short, value_name = "FILE", default_value = "-")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SamplingChoice {
    /// Every point anywhere, as the bound assumes
    Independent,
    /// One point in each of equal stretches; can beat the bound slightly
    Stratified,
}

impl SamplingChoice {
    /// As the simulator knows it.
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
