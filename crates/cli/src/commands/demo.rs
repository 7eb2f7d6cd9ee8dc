use std::fs;
use std::io::Write as _;

use freeform_motion::outline_io::WriteError;
use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};

use super::identify::settings;
use super::simulate::{SequenceError, write_sequence};
use super::{FittedOutline, History, command_line};
use crate::args::{DemoArgs, IdentifyMethod, MotionChoice, TrackOptions};
use crate::failure::{Failure, plain, warn};
use crate::output::{
    Report, Sink, TraceWriter, WholeFile, fit_figure, parameter_figure, write_identify_table, write_report,
};
use crate::tracking::Tracking;
use crate::truth::SimulatedMotion;

/// Length of the sequence in seconds: the time that the paper's figures show.
const SECONDS: f64 = 30.0;

const OUTLINES: &str = "outlines.csv";
const TRACE: &str = "trace.csv";
const PARAMETERS: &str = "parameters.svg";
const CURVE: &str = "curve.svg";
const REPORT: &str = "report.html";

/// Simulates the paper's flight bird, identifies its motion and leaves a report.
pub(crate) fn run(args: &DemoArgs) -> Result<(), Failure> {
    let folder = &args.out;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::unusable(format_args!("{}: {}", folder.display(), plain(&error))))?;
    let scale = PaperExperiment::SCALE;
    let scene = PaperExperiment::FLIGHT_BIRD.scene(scale).map_err(Failure::unusable)?;
    let length = SequenceLength::Seconds(SECONDS);
    let camera = Settings { fps: 30.0, length, noise: PaperExperiment::NOISE, ..Settings::default() };
    let simulator = Simulator::new(scene, camera).map_err(Failure::unusable)?;
    let options = TrackOptions {
        motion: MotionChoice::Rigid,
        method: IdentifyMethod::Adaptive,
        degree: None,
        scale: Some(scale),
    };
    let model = options.motion.model();
    let truth = SimulatedMotion { motion: simulator.scene().motion().at(0.0), scale }.seen_at(options.scale);

    let mut tracking = Tracking::new(&options)?;
    let mut outlines = WholeFile::create(&folder.join(OUTLINES))?;
    let trace_path = folder.join(TRACE);
    let trace_failure =
        |error: std::io::Error| Failure::unusable(format_args!("{}: {}", trace_path.display(), plain(&error)));
    let mut trace = TraceWriter::new(WholeFile::create(&trace_path)?, model).map_err(trace_failure)?;
    let mut histories = Vec::new();
    let mut first = None;
    let written = write_sequence(&mut outlines, &simulator, |frame| {
        let observation = tracking.push(frame)?;
        trace.write(&observation).map_err(trace_failure)?;
        if let (None, Ok(accepted)) = (&first, &observation.outcome) {
            first = Some((FittedOutline::new(frame, accepted.result.fit), frame.outline.clone()));
        }
        History::take(&mut histories, &observation, Some(frame));
        Ok(())
    });
    written.map_err(|error| match error {
        SequenceError::Write(WriteError::Io(error)) => outlines.failure(&error),
        SequenceError::Write(error) => Failure::unusable(error),
        SequenceError::Other(failure) => failure,
    })?;
    outlines.finish()?;
    trace.into_inner().map_err(trace_failure)?.finish()?;

    let results = tracking.results();
    for warning in results.iter().flat_map(|result| &result.warnings) {
        warn(warning);
    }
    WholeFile::write(&folder.join(PARAMETERS), &parameter_figure(&histories, model, Some(&truth)))?;
    WholeFile::write(&folder.join(CURVE), &fit_figure(first.as_slice()))?;
    let mut listed = settings(&options, "simulated: the flight bird of the paper");
    listed.extend([
        ("Frames per second", simulator.settings().fps.to_string()),
        ("Points on the outline", simulator.settings().points.to_string()),
        ("Noise on each coordinate", simulator.settings().noise.to_string()),
        ("Seed", simulator.settings().seed.to_string()),
    ]);
    let report = Report {
        title: "The flight bird: motion from nothing but its outlines".to_owned(),
        command: command_line(),
        settings: listed,
        results: &results,
        histories: &histories,
        truth: Some(&truth),
        read_error: None,
    };
    WholeFile::write(&folder.join(REPORT), &write_report(&report))?;

    let mut sink = Sink::stdout();
    let printed = write_identify_table(&mut sink, &results, Some(&truth)).and_then(|()| {
        let folder = folder.display();
        writeln!(sink, "\nWritten to {folder}: {REPORT}, {OUTLINES}, {TRACE}, {PARAMETERS}, {CURVE}")
    });
    printed.map_err(|error| sink.failure(&error))?;
    sink.finish()
}
