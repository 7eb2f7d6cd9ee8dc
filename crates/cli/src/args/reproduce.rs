use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use freeform_experiments::paper::Part;

use super::values::run_length;

const EXAMPLES: &str = "\
Examples:
  freeform reproduce
  freeform reproduce --only 3 4 --out bird
  freeform reproduce --only open --starts 200
  freeform reproduce --seconds 5 --starts 5 --repeats 1

The folder then contains index.html, which shows everything with captions and settings, every figure as SVG, and the \
numbers behind every figure and table as CSV.";

/// Make the figures and experiments of the paper, and measure what it leaves open.
///
/// Fig. 1 shows the ten objects with their closed quartics. Fig. 2 shows the boomerang with its line factors. Figs. 3, 5
/// and 7 show the objects along their motion. Figs. 4, 6 and 8 show the estimated parameters against time, each with a
/// comparison of the laws and the motion filter. 'lyapunov' shows e(t), the Lyapunov function and the 36 numbers over lines that
/// move exactly. 'open' gives tables of what the paper leaves open: noise, frame rate, camera scale, line pair, law, size in the
/// identifier, gains, curve fit, initial values. 'affine' and 'changing' extend the experiments to affine
/// motion and to motion that changes slowly.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ReproduceArgs {
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "freeform-paper")]
    pub(crate) out: PathBuf,

    /// Only these figures or tables
    #[arg(long, value_name = "FIGURE", value_parser = parts(), num_args = 1.., value_delimiter = ',')]
    pub(crate) only: Vec<Part>,

    /// Length of each experiment in seconds, at least 1
    #[arg(long, value_name = "S", value_parser = run_length, default_value_t = 30.0)]
    pub(crate) seconds: f64,

    /// Random initial values tried for each experiment and law
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000), default_value_t = 50)]
    pub(crate) starts: u32,

    /// Noise sequences per row of a table; the row is their median
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), default_value_t = 3)]
    pub(crate) repeats: u32,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// Alternative names of the figures of the paper.
const FIGURES: [&str; 8] = ["fig1", "fig2", "fig3", "fig4", "fig5", "fig6", "fig7", "fig8"];

/// Figures and tables by their names.
fn parts() -> impl TypedValueParser<Value = Part> {
    let names = Part::ALL.map(|part| {
        let aliases = FIGURES.into_iter().filter(|alias| alias.strip_prefix("fig") == Some(part.name()));
        PossibleValue::new(part.name()).help(part.description()).aliases(aliases)
    });
    PossibleValuesParser::new(names).try_map(|name| {
        let name = name.trim_start_matches("fig");
        Part::ALL.into_iter().find(|part| part.name() == name).ok_or("there is no such figure")
    })
}
