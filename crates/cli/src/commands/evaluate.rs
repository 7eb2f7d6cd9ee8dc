//! Monte Carlo of the identification.
use std::io::{self, Write};
use std::path::Path;

use freeform_experiments::monte_carlo::{
    AcquisitionSetting, Method, PlaneScene, Setting, Study, suite, write_report_csv,
};
use freeform_motion::named_shape;
use freeform_motion::riccati::MotionModel;
use freeform_motion::sim_camera::{BuiltInShape, SequenceLength, Settings, Shape};

use super::simulate::shape_files;
use crate::args::{DisturbanceArgs, EvaluateArgs, EvaluateFormat, MotionChoice, PlaneBefore};
use crate::failure::Failure;
use crate::output::{
    Evaluated, Sink, refuse_overwriting, write_evaluation_json, write_evaluation_markdown, write_evaluation_table,
};
use crate::progress::Progress;

/// Sequences of each shape and length where none are asked for.
const RUNS: usize = 50;

/// Simulates, identifies and prints.
pub(crate) fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    refuse_overwriting(&shape_files(&args.shape), &[&args.output])?;
    if args.suite.as_deref() == Some(super::stress::NAME) {
        return super::stress::run(args);
    }
    if args.suite.is_some() && !args.frames.is_empty() {
        return Err(Failure::unusable(
            "--frames is for --suite stress: the settings of docs/accuracy.md have their own lengths",
        ));
    }
    if args.suite.is_some() && args.motion.is_some() {
        return Err(Failure::unusable(
            "--motion is for --suite stress: the settings of docs/accuracy.md have their own motions",
        ));
    }
    let misplaced = [("--kinds", args.kinds.is_some()), ("--list", args.list)];
    if let Some((option, _)) = misplaced.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::unusable(format_args!("{option} is for --suite stress")));
    }
    let study = study(args)?;
    study.check().map_err(Failure::of_experiment)?;
    // The output is refused before the work, not after it.
    let sink = Sink::open(&args.output)?;
    let pool = thread_pool(args)?;
    let progress = Progress::of_runs(study.run_count() as u64);
    let report = pool.install(|| study.run(&|| progress.advance())).map_err(Failure::of_experiment)?;
    drop(progress);
    if report.is_all_lost() {
        return Err(Failure::no_result("every run of every method was lost"));
    }
    write(args, &Evaluated { report, timing: !args.no_timing }, sink)
}

/// As many threads as asked for.
pub(super) fn thread_pool(args: &EvaluateArgs) -> Result<rayon::ThreadPool, Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = args.threads {
        pool = pool.num_threads(threads);
    }
    pool.build().map_err(Failure::unusable)
}

fn study(args: &EvaluateArgs) -> Result<Study, Failure> {
    let mut shapes: Vec<Shape> = match (&args.suite, args.shape.is_empty()) {
        (Some(_), _) => suite::SHAPES.iter().map(|shape| shape.shape()).collect(),
        (None, true) => vec![BuiltInShape::Bird.shape()],
        (None, false) => Vec::new(),
    };
    for name in &args.shape {
        let shape = named_by_file(named_shape(name).map_err(Failure::unusable)?, name, &shapes);
        if shapes.iter().any(|other| other.name() == shape.name()) {
            return Err(Failure::unusable(format_args!("--shape: {} is given twice", shape.name())));
        }
        shapes.push(shape);
    }
    let runs = args.runs.unwrap_or(RUNS);
    let (settings, acquisitions, acquisition_runs) = match &args.suite {
        Some(text) => {
            let (settings, acquisitions) = suite::containing(text).map_err(Failure::of_experiment)?;
            (settings, acquisitions, suite::ACQUISITION_RUNS.saturating_mul(runs))
        }
        None if args.acquisition && args.motion == Some(MotionChoice::Plane) => {
            return Err(Failure::unusable("--acquisition is of a pose in the picture: use --motion projective"));
        }
        None if args.acquisition => (Vec::new(), vec![acquisition(args)], runs),
        None => (settings(args)?, Vec::new(), runs),
    };
    let is_projective = settings.iter().any(|setting| setting.model == MotionModel::Projective);
    let is_plane = settings.iter().any(|setting| setting.plane.is_some());
    let methods = match (args.method.is_empty(), is_projective) {
        (false, _) => args.method.clone(),
        (true, _) if is_plane => vec![Method::Filter],
        (true, false) => vec![Method::Filter, Method::Moments, Method::Icp],
        (true, true) => vec![Method::Filter, Method::Icp],
    };
    let seed = args.seed;
    Ok(Study { shapes, settings, acquisitions, methods, runs, acquisition_runs, seed })
}

/// The shape under the name of its file without the folder, unless another one has that name.
fn named_by_file(shape: Shape, path: &str, others: &[Shape]) -> Shape {
    let file_name = Path::new(path).file_name().map(|name| name.to_string_lossy().into_owned());
    match file_name.filter(|name| others.iter().all(|other| other.name() != name)) {
        Some(name) => shape.with_name(name),
        None => shape.with_name(path),
    }
}

/// One setting for each length of sequence that was asked for.
fn settings(args: &EvaluateArgs) -> Result<Vec<Setting>, Failure> {
    let is_plane = args.motion == Some(MotionChoice::Plane);
    let plane = args.motion_in_space.in_space.plane(is_plane)?;
    let plane = plane.map(|PlaneBefore { motion, camera, size }| PlaneScene { motion, camera, size });
    let camera = args.motion_in_space.camera().map_err(Failure::unusable)?;
    let motion = camera.image_motion(&args.motion_in_space.motion());
    let family = args.motion_in_space.family();
    let model = args.motion.map_or(family, MotionChoice::model);
    if model.parameters_of_motion(&motion).is_none() {
        return Err(Failure::unusable(format_args!("--motion {model} does not contain the motion of --{family}")));
    }
    let of_seconds = |seconds: &f64| {
        let length = SequenceLength::Seconds(*seconds);
        Settings { fps: args.fps, length, ..Settings::default() }.frame_count().map_err(Failure::unusable)
    };
    let mut lengths = args.frames.clone();
    lengths.extend(args.seconds.iter().map(of_seconds).collect::<Result<Vec<_>, _>>()?);
    if lengths.is_empty() {
        lengths = vec![3, 8, 30, 120];
    }
    if let Some(short) = lengths.iter().find(|frames| **frames < 2) {
        return Err(Failure::unusable(format_args!("a sequence of {short} frame(s) shows no motion")));
    }
    let DisturbanceArgs { occlusion, outliers, .. } = args.disturbance;
    let noise = args.disturbance.noise(is_plane);
    let setting = |frames| Setting {
        plane,
        name: format!("{frames} frames"),
        model,
        motion,
        frames,
        fps: args.fps,
        points: args.points,
        noise,
        occlusion,
        outliers,
        wrong_frames: args.wrong_frames,
        sampling: args.sampling.sampling(),
    };
    Ok(lengths.into_iter().map(setting).collect())
}

fn acquisition(args: &EvaluateArgs) -> AcquisitionSetting {
    let DisturbanceArgs { occlusion, outliers, .. } = args.disturbance;
    let noise = args.disturbance.noise(false);
    AcquisitionSetting {
        name: "acquisition".to_owned(),
        model: args.motion.unwrap_or(MotionChoice::Rigid).model(),
        points: args.points,
        noise,
        occlusion,
        outliers,
        sampling: args.sampling.sampling(),
    }
}

fn write(args: &EvaluateArgs, evaluated: &Evaluated, mut sink: Sink) -> Result<(), Failure> {
    let default = if args.suite.is_some() { EvaluateFormat::Markdown } else { EvaluateFormat::Table };
    let written: io::Result<()> = match args.format.unwrap_or(default) {
        EvaluateFormat::Table => write_evaluation_table(&mut sink, evaluated),
        EvaluateFormat::Markdown => write_evaluation_markdown(&mut sink, evaluated),
        EvaluateFormat::Json => write_evaluation_json(&mut sink, evaluated),
        EvaluateFormat::Csv => write_report_csv(&mut sink, &evaluated.report, evaluated.timing),
    };
    match written.and_then(|()| sink.flush()) {
        Ok(()) => sink.finish(),
        Err(error) => Err(sink.failure(&error)),
    }
}
