//! The stress suite.
use std::io;

use freeform_experiments::monte_carlo::Method;
use freeform_experiments::stress::{StressStudy, kinds_containing};
use freeform_motion::riccati::MotionModel;

use crate::args::{EvaluateArgs, EvaluateFormat, MotionChoice};
use crate::failure::Failure;
use crate::output::{
    Sink, write_kinds, write_kinds_json, write_kinds_markdown, write_stress_json, write_stress_markdown,
    write_stress_table,
};
use crate::progress::Progress;

/// Runs of each kind where none are asked for.
const RUNS: usize = 20;

/// What `--suite` calls it.
pub(super) const NAME: &str = "stress";

/// Makes the runs, or lists the kinds, and prints.
pub(super) fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    if !args.shape.is_empty() {
        return Err(Failure::unusable("--suite stress has its own shapes: --shape has no meaning there"));
    }
    if !matches!(args.method[..], [] | [Method::Filter]) {
        return Err(Failure::unusable("--suite stress judges the motion filter alone: --method has no meaning there"));
    }
    let frames = match args.frames[..] {
        [] => None,
        [frames] => Some(frames),
        _ => return Err(Failure::unusable("--suite stress takes one number of frames")),
    };
    let format = args.format.unwrap_or(EvaluateFormat::Table);
    if format == EvaluateFormat::Csv {
        return Err(Failure::unusable("--suite stress has the formats table, markdown and json"));
    }
    let kinds = kinds_containing(args.kinds.as_deref().unwrap_or_default()).map_err(Failure::of_experiment)?;
    if args.list {
        return write(Sink::open(&args.output)?, |sink| match format {
            EvaluateFormat::Markdown => write_kinds_markdown(sink, &kinds),
            EvaluateFormat::Json => write_kinds_json(sink, &kinds),
            EvaluateFormat::Table | EvaluateFormat::Csv => write_kinds(sink, &kinds),
        });
    }
    let model = args.motion.unwrap_or(MotionChoice::Rigid).model();
    if args.motion == Some(MotionChoice::Plane) || model == MotionModel::Projective {
        return Err(Failure::unusable("--suite stress has rigid, similarity and affine motion"));
    }
    let study = StressStudy { kinds, model, runs: args.runs.unwrap_or(RUNS), frames, seed: args.seed };
    // The output is refused before the work, not after it.
    let sink = Sink::open(&args.output)?;
    let pool = super::evaluate::thread_pool(args)?;
    let progress = Progress::of_runs(study.run_count() as u64);
    let report = pool.install(|| study.run(&|| progress.advance())).map_err(Failure::of_experiment)?;
    drop(progress);
    write(sink, |sink| match format {
        EvaluateFormat::Markdown => write_stress_markdown(sink, &report),
        EvaluateFormat::Json => write_stress_json(sink, &report),
        EvaluateFormat::Table | EvaluateFormat::Csv => write_stress_table(sink, &report),
    })
}

fn write(mut sink: Sink, print: impl FnOnce(&mut Sink) -> io::Result<()>) -> Result<(), Failure> {
    match print(&mut sink).and_then(|()| io::Write::flush(&mut sink)) {
        Ok(()) => sink.finish(),
        Err(error) => Err(sink.failure(&error)),
    }
}
