use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use freeform_drawing::{
    Findings, Histories, MeaningOfB, OBJECTS_PLAYED, Purpose, Report, fit_figure, parameter_figure, write_report,
};
use freeform_motion::curve_fit::Outline;
use freeform_motion::outline_io::{OutlineFrame, TableFormat};
use freeform_motion::riccati::CameraScale;
use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
use freeform_motion::tracker::{Method, ObjectResult, Observation, TraceWriter};
use freeform_motion::{FittedOutline, PipelineSettings, SimulatedMotion, Tracker, Truth};

use super::listed_settings::{fit_settings, settings, version};
use super::simulate::write_sequence;
use crate::args::{DemoArgs, DynamicsChoice, IdentifyMethod, MotionChoice, PerspectiveArgs, TrackOptions};
use crate::command_line::command_line;
use crate::failure::{Failure, file_failure, plain, warn_of};
use crate::output::{Sink, WholeFile, write_identify_table};
use crate::overlay::curves;

/// Length of the sequence in seconds: the time that the paper's figures show.
const SECONDS: f64 = 30.0;

const OUTLINES: &str = "outlines.csv";
const TRACE: &str = "trace.csv";
const TRACE_ADAPTIVE: &str = "trace-adaptive.csv";
const PARAMETERS: &str = "parameters.svg";
const PARAMETERS_ADAPTIVE: &str = "parameters-adaptive.svg";
const CURVE: &str = "curve.svg";
const REPORT: &str = "report.html";

/// Simulates the paper's flight bird, identifies its motion by both methods and leaves a report.
pub(crate) fn run(args: &DemoArgs) -> Result<(), Failure> {
    let folder = &args.out;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::unusable(format_args!("{}: {}", folder.display(), plain(&error))))?;
    let simulator = flight_bird()?;
    let scale = simulator.scene().camera().scale();
    let truth = SimulatedMotion::of(&simulator).seen_at(Some(scale));
    let mut filter = Identification::new(options(IdentifyMethod::Filter, scale), &folder.join(TRACE))?;
    let mut adaptive = Identification::new(options(IdentifyMethod::Adaptive, scale), &folder.join(TRACE_ADAPTIVE))?;
    let first = identify(&simulator, &folder.join(OUTLINES), &mut filter, &mut adaptive)?;
    let filter = filter.finish(&folder.join(PARAMETERS), &truth)?;
    let adaptive = adaptive.finish(&folder.join(PARAMETERS_ADAPTIVE), &truth)?;
    WholeFile::write(&folder.join(CURVE), &fit_figure(first.as_slice()))?;
    let b = MeaningOfB::in_coordinates(Some(scale));
    report(&folder.join(REPORT), &simulator, [&filter, &adaptive], &truth, &b)?;
    let mut sink = Sink::stdout();
    let printed = print(&mut sink, [&filter, &adaptive], &truth, &b, folder);
    printed.map_err(|error| sink.failure(&error))?;
    sink.finish()
}

/// The simulation of the paper's first experiment.
fn flight_bird() -> Result<Simulator, Failure> {
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).map_err(Failure::unusable)?;
    let length = SequenceLength::Seconds(SECONDS);
    let camera = Settings { fps: 30.0, length, noise: PaperExperiment::NOISE, ..Settings::default() };
    Simulator::new(scene, camera).map_err(Failure::unusable)
}

/// Options to identify a rigid motion by a method.
fn options(method: IdentifyMethod, scale: CameraScale) -> TrackOptions {
    TrackOptions {
        motion: MotionChoice::Rigid,
        perspective: PerspectiveArgs::default(),
        method,
        degree: None,
        scale: Some(scale),
        rectify: None,
        dynamics: DynamicsChoice::Auto,
        edge_uncertainty: None,
        mask_pixel: None,
    }
}

/// Writes the outlines and has both methods take them. Returns the first outline with the curve that the adaptive law fits to it.
fn identify(
    simulator: &Simulator,
    path: &Path,
    filter: &mut Identification,
    adaptive: &mut Identification,
) -> Result<Option<(FittedOutline, Outline)>, Failure> {
    let mut outlines = WholeFile::create(path)?;
    let mut first = None;
    let written = write_sequence(&mut outlines, TableFormat::Csv, simulator, |frame| {
        filter.take(frame)?;
        let observation = adaptive.take(frame)?;
        if let (None, Some(fit)) = (&first, observation.fit) {
            first = Some((FittedOutline::new(frame, fit), frame.outline.clone()));
        }
        Ok(())
    });
    written.map_err(|error| error.into_failure(|error| outlines.failure(error)))?;
    outlines.finish()?;
    Ok(first)
}

/// Writes the report of both methods, the filter first.
fn report(
    path: &Path,
    simulator: &Simulator,
    found: [&Found; 2],
    truth: &Truth,
    b: &MeaningOfB,
) -> Result<(), Failure> {
    let [filter, adaptive] = found.map(|found| &found.options);
    let mut listed = settings(filter, "simulated: the flight bird of the paper");
    listed.push(("For comparison", Method::from(adaptive.method).to_string()));
    listed.extend(fit_settings(&PipelineSettings::default().fit));
    listed.extend([
        ("Frames per second", simulator.settings().fps.to_string()),
        ("Points on the outline", simulator.settings().points.to_string()),
        ("Noise on each coordinate", simulator.settings().noise.to_string()),
        ("Seed", simulator.settings().seed.to_string()),
        version(),
    ]);
    let report = Report {
        title: "The flight bird: motion from nothing but its outlines".to_owned(),
        command: command_line(),
        settings: listed,
        meaning_of_b: b.clone(),
        findings: found.map(|found| Findings { results: &found.results, histories: &found.histories }).into(),
        truth: Some(truth),
        ..Report::default()
    };
    WholeFile::create(path)?.finish_by(|file| write_report(file, &report))
}

fn print(
    sink: &mut Sink,
    [filter, adaptive]: [&Found; 2],
    truth: &Truth,
    b: &MeaningOfB,
    folder: &Path,
) -> io::Result<()> {
    write_identify_table(sink, &filter.results, Some(truth), b)?;
    writeln!(sink, "\nFor comparison, by the adaptive law of the paper:")?;
    write_identify_table(sink, &adaptive.results, Some(truth), b)?;
    writeln!(sink, "\nWritten to {}:", folder.display())?;
    writeln!(sink, "  {REPORT}, {OUTLINES}, {CURVE}")?;
    writeln!(sink, "  {TRACE}, {PARAMETERS} (filter)")?;
    writeln!(sink, "  {TRACE_ADAPTIVE}, {PARAMETERS_ADAPTIVE} (adaptive)")
}

/// One method at work on the sequence.
struct Identification {
    options: TrackOptions,
    tracker: Tracker,
    trace: TraceWriter<WholeFile>,
    trace_path: PathBuf,
    histories: Histories,
}

/// What one method found.
struct Found {
    options: TrackOptions,
    results: Vec<ObjectResult>,
    histories: Histories,
}

impl Identification {
    fn new(options: TrackOptions, trace_path: &Path) -> Result<Self, Failure> {
        let tracker = Tracker::new(options.tracker_settings()).map_err(Failure::unusable)?;
        let tracker = tracker.with_known_outlines(OBJECTS_PLAYED);
        let trace = TraceWriter::new(WholeFile::create(trace_path)?, options.motion.family(), None)
            .map_err(|error| file_failure(trace_path, &error))?;
        let histories = Histories::new(Purpose::Report(None), curves(&options)?);
        Ok(Self { options, tracker, trace, trace_path: trace_path.to_owned(), histories })
    }

    fn take(&mut self, frame: &OutlineFrame) -> Result<Observation, Failure> {
        let observation = self.tracker.push(frame);
        self.trace.write(&observation).map_err(|error| file_failure(&self.trace_path, &error))?;
        self.histories.take(&observation, Some(frame));
        Ok(observation)
    }

    /// Writes the trace and the figure, and prints the warnings.
    fn finish(self, figure: &Path, truth: &Truth) -> Result<Found, Failure> {
        let Self { options, tracker, trace, trace_path, mut histories } = self;
        histories.close();
        trace.into_inner().map_err(|error| file_failure(&trace_path, &error))?.finish()?;
        let b = MeaningOfB::in_coordinates(options.scale);
        WholeFile::write(figure, &parameter_figure(&histories, options.motion.family(), Some(truth), &b))?;
        let results = tracker.results();
        for warning in results.iter().flat_map(|result| &result.warnings) {
            warn_of(warning.code(), &format!("{} method: {warning}", tracker.settings().method()));
        }
        Ok(Found { options, results, histories })
    }
}
