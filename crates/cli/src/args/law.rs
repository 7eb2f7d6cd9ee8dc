//! Options of the adaptive method, for those who study it.
use clap::{Args, ValueEnum};
use freeform_motion::PipelineSettings;
use freeform_motion::curve_fit::Method;
use freeform_motion::identify::{AdaptiveLaw, PairChoice};
use freeform_motion::riccati::{CameraScale, MotionModel};
use nalgebra::{Matrix4, Vector4};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::values::{finite, list, positive};
use crate::failure::Failure;

/// Options of the adaptive method.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Adaptive method, for study")]
pub(crate) struct LawOptions {
    /// How the parameters are adapted [default: structured; least-squares for affine and projective motion]
    #[arg(long, value_enum)]
    law: Option<LawChoice>,

    /// Which pairs of lines drive the law: the best, all, or one by its number, 0 to 3 [default: all]
    #[arg(long, value_name = "best|all|N", value_parser = pairs)]
    pairs: Option<PairChoice>,

    /// The stability matrix Am: its diagonal, or 16 numbers row by row [default: -0.5,-0.5,-1,-1]
    #[arg(long, value_name = "LIST", value_parser = matrix, allow_hyphen_values = true)]
    am: Option<Matrix4<f64>>,

    /// The matrix Q of the Lyapunov equation Am'P + P Am = -Q: its diagonal, or 16 numbers row by row [default: 0.5,1,2,3]
    #[arg(long, value_name = "LIST", value_parser = matrix, allow_hyphen_values = true)]
    q: Option<Matrix4<f64>>,

    /// Parameters to start from, in the units of the result, or random ones from -1 to 1; 'random:SEED' for others [default: all 0]
    #[arg(long, value_name = "LIST|random", value_parser = initial, allow_hyphen_values = true)]
    initial: Option<Initial>,

    /// How a curve is fitted to every outline [default: bounded]
    #[arg(long, value_enum)]
    fit: Option<FitChoice>,

    /// RMS radius of the object in the coordinates of the identifier: a larger one settles faster and follows the noise more
    /// [default: 0.6]
    #[arg(long, value_name = "RMS", value_parser = positive)]
    size: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LawChoice {
    /// Equation 21 as printed: 36 numbers, of which the motion is read off; at most affine motion
    Printed,
    /// Equation 21 over the motion parameters alone
    Structured,
    /// Filtered least squares with exponential forgetting
    LeastSquares,
    /// Dynamic regressor extension and mixing: a law for each parameter by itself
    Drem,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FitChoice {
    /// 3L
    #[value(name = "3l")]
    ThreeLevel,
    /// Globally stabilised 3L
    Gs3l,
    /// 3L, held bounded
    Bounded,
}

/// What the law starts from.
#[derive(Debug, Clone, PartialEq)]
enum Initial {
    Values(Vec<f64>),
    Random { seed: u64 },
}

fn pairs(text: &str) -> Result<PairChoice, String> {
    match text {
        "best" => Ok(PairChoice::Best),
        "all" => Ok(PairChoice::All),
        number => match number.parse() {
            Ok(index) if index < 4 => Ok(PairChoice::Given(index)),
            _ => Err(format!("{text:?} is neither 'best', 'all' nor a number from 0 to 3")),
        },
    }
}

fn matrix(text: &str) -> Result<Matrix4<f64>, String> {
    match list(text)?[..] {
        [a, b, c, d] => Ok(Matrix4::from_diagonal(&Vector4::new(a, b, c, d))),
        ref all if all.len() == 16 => Ok(Matrix4::from_row_slice(all)),
        ref other => Err(format!("expected 4 numbers or 16, found {}", other.len())),
    }
}

fn initial(text: &str) -> Result<Initial, String> {
    match text.split_once(':') {
        None if text == "random" => Ok(Initial::Random { seed: 0 }),
        Some(("random", seed)) => {
            let seed = seed.parse().map_err(|_| format!("{seed:?} is not a whole number from 0 on"))?;
            Ok(Initial::Random { seed })
        }
        _ => Ok(Initial::Values(text.split(',').map(finite).collect::<Result<_, _>>()?)),
    }
}

impl LawOptions {
    /// Those that are given.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let Self { law, pairs, am, q, initial, fit, size } = self;
        let all = [
            ("--law", law.is_some()),
            ("--pairs", pairs.is_some()),
            ("--am", am.is_some()),
            ("--q", q.is_some()),
            ("--initial", initial.is_some()),
            ("--fit", fit.is_some()),
            ("--size", size.is_some()),
        ];
        all.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }

    /// Puts them into settings.
    pub(crate) fn apply(&self, settings: &mut PipelineSettings, scale: Option<CameraScale>) -> Result<(), Failure> {
        let PipelineSettings { fit, identify, size } = settings;
        identify.law = self.law.map_or(identify.law, Into::into);
        identify.pairs = self.pairs.unwrap_or(identify.pairs);
        identify.stability = self.am.unwrap_or(identify.stability);
        identify.definite = self.q.unwrap_or(identify.definite);
        *size = self.size.unwrap_or(*size);
        let ridge_weight = match fit.method {
            Method::Bounded { ridge_weight, .. } | Method::GloballyStabilised { ridge_weight } => ridge_weight,
            Method::ThreeLevel => 0.0,
        };
        match self.fit {
            None | Some(FitChoice::Bounded) => {}
            Some(FitChoice::ThreeLevel) => fit.method = Method::ThreeLevel,
            Some(FitChoice::Gs3l) => fit.method = Method::GloballyStabilised { ridge_weight },
        }
        if let Some(initial) = &self.initial {
            identify.initial_values = in_image(identify.model, &initial.values(identify.model)?, scale);
        }
        Ok(())
    }
}

impl Initial {
    fn values(&self, model: MotionModel) -> Result<Vec<f64>, Failure> {
        let needed = model.parameter_count();
        match self {
            Self::Values(values) if values.len() == needed => Ok(values.clone()),
            Self::Values(values) => {
                let names = model.parameter_names().join(",");
                let found = values.len();
                Err(Failure::unusable(format_args!("--initial: expected {names}, found {found} number(s)")))
            }
            Self::Random { seed } => {
                let mut rng = ChaCha8Rng::seed_from_u64(*seed);
                Ok((0..needed).map(|_| rng.random_range(-1.0..1.0)).collect())
            }
        }
    }
}

/// Parameters in the units of the result as those of the image.
fn in_image(model: MotionModel, values: &[f64], scale: Option<CameraScale>) -> Vec<f64> {
    let generator = scale.unwrap_or_default().generator_in_image(&model.generator(values));
    model.parameters_of(&generator)[..values.len()].to_vec()
}

impl From<LawChoice> for AdaptiveLaw {
    fn from(choice: LawChoice) -> Self {
        match choice {
            LawChoice::Printed => Self::Printed,
            LawChoice::Structured => Self::Structured,
            LawChoice::LeastSquares => Self::FilteredLeastSquares,
            LawChoice::Drem => Self::RegressorMixing,
        }
    }
}
