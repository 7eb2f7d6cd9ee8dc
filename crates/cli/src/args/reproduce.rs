use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::run_length;

const EXAMPLES: &str = "\
Examples:
  freeform reproduce
  freeform reproduce --only 3 4 --out bird
  freeform reproduce --only open --starts 200
  freeform reproduce --seconds 5 --starts 5 --repeats 1

The folder then holds index.html, which shows everything with captions and settings, and beside it every figure as SVG, \
and the numbers behind every figure and table as CSV.";

/// Make the figures and experiments of the paper, and measure what it leaves open.
///
/// Fig. 1 shows the ten objects with their closed quartics, Fig. 2 the boomerang with its line factors, Figs. 3, 5 and 7
/// the objects along their motion, Figs. 4, 6 and 8 the estimated parameters against time, each beside a comparison of
/// the laws and the motion filter. 'open' are tables of what the paper leaves open (noise, frame rate, camera scale,
/// line pair, gains, curve fit, initial values); 'affine' and 'changing' extend the experiments to affine motion and to
/// motion that changes slowly.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReproduceArgs {
    /// Folder for the files; it is made where it does not exist
    #[arg(long, value_name = "DIR", default_value = "freeform-paper")]
    pub(crate) out: PathBuf,

    /// Only these figures or tables
    #[arg(long, value_name = "FIGURE", value_enum, num_args = 1.., value_delimiter = ',')]
    pub(crate) only: Vec<Part>,

    /// Length of each experiment in seconds, at least 1
    #[arg(long, value_name = "S", value_parser = run_length, default_value_t = 30.0)]
    pub(crate) seconds: f64,

    /// Random initial values tried for each experiment and law
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000), default_value_t = 50)]
    pub(crate) starts: u32,

    /// Noise sequences that each row of a table is the median of
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), default_value_t = 3)]
    pub(crate) repeats: u32,

    /// All random numbers follow from it
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// A figure of the paper, or what goes beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum Part {
    /// The ten objects and their quartics
    #[value(name = "1", alias = "fig1")]
    Objects,
    /// The boomerang and its line factors
    #[value(name = "2", alias = "fig2")]
    Factors,
    /// The flight bird along its motion
    #[value(name = "3", alias = "fig3")]
    BirdPoses,
    /// The flight bird's estimated parameters
    #[value(name = "4", alias = "fig4")]
    BirdParameters,
    /// The glider along its motion, by text and by caption
    #[value(name = "5", alias = "fig5")]
    GliderPoses,
    /// The glider's estimated parameters, by text and by caption
    #[value(name = "6", alias = "fig6")]
    GliderParameters,
    /// The cellular phone along its motion
    #[value(name = "7", alias = "fig7")]
    PhonePoses,
    /// The cellular phone's estimated parameters
    #[value(name = "8", alias = "fig8")]
    PhoneParameters,
    /// Tables of what the paper leaves open
    #[value(name = "open")]
    OpenQuestions,
    /// Affine motion, six parameters
    #[value(name = "affine")]
    Affine,
    /// A motion that changes slowly
    #[value(name = "changing")]
    Changing,
}
