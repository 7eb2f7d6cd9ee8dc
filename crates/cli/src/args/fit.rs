use std::path::PathBuf;

use clap::{Args, ValueEnum};
use freeform_motion::curve_fit::{Degree, FitSettings, Method, Normalise};

use super::pictures::{PictureOptions, picture_inputs};
use super::values::{degree, not_negative, positive};
use crate::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  freeform fit outlines.csv --frame 0
  freeform fit outlines.csv --frame 0 --degree 6 --svg curve.svg
  freeform fit outlines.csv --method gs3l --kappa 1e-5 --format json
  freeform fit mask.png --svg curve.svg";

/// Fit a curve to every outline and decompose it into lines.
///
/// Prints for each outline: the coefficients a_ij of x^i y^j, whether the curve is closed and bounded, the distances of the
/// points from it, the complex lines x + l y + k of every level, the related points that move with the curve, and its affine
/// invariants.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("fit")))]
pub(crate) struct FitArgs {
    /// Outlines as CSV, Parquet or polygons (COCO, labelme, TrackMate), or pictures: files, a folder, a quoted pattern; '-' is
    /// standard input
    #[arg(required = true, value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    /// Only the outlines of this frame
    #[arg(long, value_name = "N")]
    pub(crate) frame: Option<u64>,

    #[command(flatten)]
    pub(crate) options: FitOptions,

    /// Format of the result
    #[arg(long, value_enum, default_value_t = FitFormat::Table)]
    pub(crate) format: FitFormat,

    /// Draw the first frame (or the one of --frame): points, fitted curves and related points
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}

/// How curves are fitted.
#[derive(Debug, Clone, Args)]
pub(crate) struct FitOptions {
    /// Degree of the polynomial: 2, 4, 6 or 8
    #[arg(long, value_name = "N", value_parser = degree, default_value = "4")]
    pub(crate) degree: Degree,

    /// Method of the fit
    #[arg(long, value_enum, default_value_t = FitMethod::Bounded)]
    pub(crate) method: FitMethod,

    /// Weight of the ridge [default: 1e-5 for gs3l, 0 for bounded]
    #[arg(long, value_name = "WEIGHT", value_parser = not_negative)]
    pub(crate) kappa: Option<f64>,

    /// Smallest value of the leading form on the unit circle, in (0, 0.9]; for bounded [default: 0.02]
    #[arg(long, value_name = "FRACTION", value_parser = positive)]
    pub(crate) margin: Option<f64>,

    /// Distance of the outer level sets, in units of the root mean square radius [default: 0.1]
    #[arg(long, value_name = "DISTANCE", value_parser = positive)]
    pub(crate) offset: Option<f64>,

    /// In which coordinates each outline is fitted
    #[arg(long, value_enum, default_value_t = NormaliseChoice::Similarity)]
    pub(crate) normalise: NormaliseChoice,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum NormaliseChoice {
    /// Centred and scaled: the curve follows turns, shifts and changes of scale
    Similarity,
    /// Moved to a circle of inertia: the curve, its lines and its invariants follow every affine map (whole outlines only)
    Affine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FitMethod {
    /// Plain 3L: follows the points most closely; the curve may be unbounded
    #[value(name = "3l")]
    ThreeLevel,
    /// Globally stabilised 3L: the curve is likely to be bounded
    Gs3l,
    /// 3L with a constraint: the curve is closed and bounded by construction
    Bounded,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FitFormat {
    /// For reading
    Table,
    /// One JSON object
    Json,
}

const DEFAULT_KAPPA: f64 = 1e-5;
const DEFAULT_MARGIN: f64 = 0.02;

impl FitOptions {
    pub(crate) fn settings(&self) -> Result<FitSettings, Failure> {
        let method = match self.method {
            FitMethod::ThreeLevel => Method::ThreeLevel,
            FitMethod::Gs3l => Method::GloballyStabilised { ridge_weight: self.kappa.unwrap_or(DEFAULT_KAPPA) },
            FitMethod::Bounded => Method::Bounded {
                margin: self.margin.unwrap_or(DEFAULT_MARGIN),
                ridge_weight: self.kappa.unwrap_or(0.0),
            },
        };
        if self.kappa.is_some() && self.method == FitMethod::ThreeLevel {
            return Err(Failure::unusable("--kappa is for --method gs3l or bounded, not 3l"));
        }
        if self.margin.is_some() && self.method != FitMethod::Bounded {
            return Err(Failure::unusable("--margin is for --method bounded only"));
        }
        let default = FitSettings::default();
        let normalise = match self.normalise {
            NormaliseChoice::Similarity => Normalise::Similarity,
            NormaliseChoice::Affine => Normalise::Affine,
        };
        let offset = self.offset.unwrap_or(default.offset);
        Ok(FitSettings { degree: self.degree, method, offset, normalise, ..default })
    }
}
