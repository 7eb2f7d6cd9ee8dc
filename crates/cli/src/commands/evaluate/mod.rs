//! Monte Carlo of the identification.
mod acquisition;
mod estimator;
mod monte_carlo;
mod setting;
mod statistics;
mod suite;

use std::io::{self, Write};
use std::path::Path;

use freeform_motion::sim_camera::{BuiltInShape, Shape};

pub(crate) use acquisition::{Acquisition, Found};
pub(crate) use monte_carlo::{Evaluation, MethodResult};
pub(crate) use setting::Setting;
pub(crate) use statistics::Statistics;

use self::acquisition::AcquisitionSetting;
use self::monte_carlo::Effort;
use super::simulate::shape;
use crate::args::{EvaluateArgs, EvaluateFormat};
use crate::failure::Failure;
use crate::output::{
    Sink, write_evaluation_csv, write_evaluation_json, write_evaluation_markdown, write_evaluation_table,
};
use crate::progress::Progress;

/// Runs of the acquisition for one of the motion, in the suite: shares near 1 need many.
const ACQUISITION_RUNS: usize = 10;

/// What was found by all runs.
#[derive(Debug)]
pub(crate) struct Report {
    /// Names of the shapes.
    pub(crate) shapes: Vec<String>,
    pub(crate) runs: usize,
    pub(crate) seed: u64,
    pub(crate) evaluations: Vec<Evaluation>,
    pub(crate) acquisitions: Vec<Acquisition>,
    /// Whether times are told.
    pub(crate) timing: bool,
}

/// What is to be run.
struct Plan {
    shapes: Vec<Shape>,
    settings: Vec<Setting>,
    acquisitions: Vec<AcquisitionSetting>,
    acquisition_runs: usize,
}

/// Simulates, identifies and prints.
pub(crate) fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    let plan = plan(args)?;
    for shape in &plan.shapes {
        plan.settings.iter().try_for_each(|setting| setting.simulator(shape, 0).map(drop))?;
        plan.acquisitions.iter().try_for_each(|setting| setting.check(shape))?;
    }
    // The output is refused before the work, not after it.
    let sink = Sink::open(&args.output)?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool.build().map_err(Failure::unusable)?;
    let report = pool.install(|| carry_out(args, &plan))?;
    write(args, &report, sink)
}

fn plan(args: &EvaluateArgs) -> Result<Plan, Failure> {
    let mut shapes: Vec<Shape> = match (&args.suite, args.shape.is_empty()) {
        (Some(_), _) => suite::SHAPES.iter().map(|shape| shape.shape()).collect(),
        (None, true) => vec![BuiltInShape::Bird.shape()],
        (None, false) => Vec::new(),
    };
    for name in &args.shape {
        let shape = named_by_file(shape(name)?, name, &shapes);
        if shapes.iter().any(|other| other.name() == shape.name()) {
            return Err(Failure::unusable(format_args!("--shape: {} is given twice", shape.name())));
        }
        shapes.push(shape);
    }
    let (settings, acquisitions, acquisition_runs) = match &args.suite {
        Some(text) => {
            let (settings, acquisitions) = suite::containing(text)?;
            (settings, acquisitions, ACQUISITION_RUNS.saturating_mul(args.runs))
        }
        None if args.acquisition => (Vec::new(), vec![AcquisitionSetting::from_args(args)], args.runs),
        None => (Setting::all_from_args(args)?, Vec::new(), args.runs),
    };
    Ok(Plan { shapes, settings, acquisitions, acquisition_runs })
}

/// The shape under the name of its file without the folder, unless another one has that name.
fn named_by_file(shape: Shape, path: &str, others: &[Shape]) -> Shape {
    let file_name = Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
    match file_name.filter(|name| others.iter().all(|other| other.name() != name)) {
        Some(name) => shape.with_name(name),
        None => shape.with_name(path),
    }
}

fn carry_out(args: &EvaluateArgs, plan: &Plan) -> Result<Report, Failure> {
    let Plan { shapes, settings, acquisitions, acquisition_runs } = plan;
    let total = shapes.len() * (settings.len() * args.runs + acquisitions.len() * acquisition_runs);
    let progress = Progress::of_runs(total as u64);
    let effort = |runs| Effort { shapes, methods: &args.method, runs, seed: args.seed, progress: &progress };
    let evaluations: Vec<Evaluation> =
        settings.iter().map(|setting| monte_carlo::evaluate(setting, &effort(args.runs))).collect::<Result<_, _>>()?;
    let acquisitions: Vec<Acquisition> = acquisitions
        .iter()
        .map(|setting| acquisition::evaluate(setting, &effort(*acquisition_runs)))
        .collect::<Result<_, _>>()?;
    let all_lost = |evaluation: &Evaluation| evaluation.methods.iter().all(|m| m.pooled.lost == m.pooled.runs);
    if !evaluations.is_empty() && acquisitions.is_empty() && evaluations.iter().all(all_lost) {
        return Err(Failure::no_result("every run of every method was lost"));
    }
    let shapes = shapes.iter().map(|shape| shape.name().to_owned()).collect();
    let timing = !args.no_timing;
    Ok(Report { shapes, runs: args.runs, seed: args.seed, evaluations, acquisitions, timing })
}

fn write(args: &EvaluateArgs, report: &Report, mut sink: Sink) -> Result<(), Failure> {
    let default = if args.suite.is_some() { EvaluateFormat::Markdown } else { EvaluateFormat::Table };
    let written: io::Result<()> = match args.format.unwrap_or(default) {
        EvaluateFormat::Table => write_evaluation_table(&mut sink, report),
        EvaluateFormat::Markdown => write_evaluation_markdown(&mut sink, report),
        EvaluateFormat::Json => write_evaluation_json(&mut sink, report),
        EvaluateFormat::Csv => write_evaluation_csv(&mut sink, report),
    };
    match written.and_then(|()| sink.flush()) {
        Ok(()) => sink.finish(),
        Err(error) => Err(sink.failure(&error)),
    }
}
