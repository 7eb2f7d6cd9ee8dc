use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use freeform_motion::outline_io::{OutlineFrame, TableFormat, WriteError};
use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
use freeform_motion::tracker::{Method, ObjectResult, Observation};
use freeform_motion::{PipelineSettings, Tracker};

use super::identify::{file_failure, fit_settings, settings};
use super::simulate::{SequenceError, write_sequence};
use crate::args::{DemoArgs, DynamicsChoice, IdentifyMethod, MotionChoice, PerspectiveArgs, TrackOptions};
use crate::command_line::command_line;
use crate::failure::{Failure, plain, warn};
use crate::fitted_outline::FittedOutline;
use crate::history::{Histories, OBJECTS_PLAYED, Purpose};
use crate::left_out::LeftOut;
use crate::meaning_of_b::MeaningOfB;
use crate::output::{
    Findings, Report, Sink, TraceWriter, WholeFile, fit_figure, parameter_figure, write_identify_table, write_report,
};
use crate::overlay::CurveFitter;
use crate::truth::{SimulatedMotion, Truth};

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
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).map_err(Failure::unusable)?;
    let scale = scene.camera().scale();
    let length = SequenceLength::Seconds(SECONDS);
    let camera = Settings { fps: 30.0, length, noise: PaperExperiment::NOISE, ..Settings::default() };
    let simulator = Simulator::new(scene, camera).map_err(Failure::unusable)?;
    let truth = SimulatedMotion::of(&simulator).seen_at(Some(scale));
    let by_filter = TrackOptions {
        motion: MotionChoice::Rigid,
        perspective: PerspectiveArgs::default(),
        method: IdentifyMethod::Filter,
        degree: None,
        scale: Some(scale),
        rectify: None,
        dynamics: DynamicsChoice::Auto,
        edge_uncertainty: None,
        mask_pixel: None,
    };
    let by_adaptive_law = TrackOptions { method: IdentifyMethod::Adaptive, ..by_filter.clone() };

    let mut filter = Identification::new(by_filter.clone(), &folder.join(TRACE))?;
    let mut adaptive = Identification::new(by_adaptive_law.clone(), &folder.join(TRACE_ADAPTIVE))?;
    let mut outlines = WholeFile::create(&folder.join(OUTLINES))?;
    let mut first = None;
    let written = write_sequence(&mut outlines, TableFormat::Csv, &simulator, |frame| {
        filter.take(frame)?;
        let observation = adaptive.take(frame)?;
        if let (None, Some(fit)) = (&first, observation.fit) {
            first = Some((FittedOutline::new(frame, fit), frame.outline.clone()));
        }
        Ok(())
    });
    written.map_err(|error| match error {
        SequenceError::Write(WriteError::Io(error)) => outlines.failure(&error),
        SequenceError::Write(error) => Failure::unusable(error),
        SequenceError::Other(failure) => failure,
    })?;
    outlines.finish()?;
    let filter = filter.finish(&folder.join(PARAMETERS), &truth)?;
    let adaptive = adaptive.finish(&folder.join(PARAMETERS_ADAPTIVE), &truth)?;
    WholeFile::write(&folder.join(CURVE), &fit_figure(first.as_slice()))?;

    let mut listed = settings(&by_filter, "simulated: the flight bird of the paper");
    listed.push(("For comparison", Method::from(by_adaptive_law.method).to_string()));
    listed.extend(fit_settings(&PipelineSettings::default().fit));
    listed.extend([
        ("Frames per second", simulator.settings().fps.to_string()),
        ("Points on the outline", simulator.settings().points.to_string()),
        ("Noise on each coordinate", simulator.settings().noise.to_string()),
        ("Seed", simulator.settings().seed.to_string()),
    ]);
    let b = MeaningOfB::in_coordinates(Some(scale));
    let report = Report {
        title: "The flight bird: motion from nothing but its outlines".to_owned(),
        command: command_line(),
        settings: listed,
        meaning_of_b: b.clone(),
        findings: [&filter, &adaptive].map(Found::findings).into(),
        truth: Some(&truth),
        no_motion: None,
        read_error: None,
        left_out: &LeftOut::default(),
    };
    WholeFile::create(&folder.join(REPORT))?.finish_by(|file| write_report(file, &report))?;

    let mut sink = Sink::stdout();
    let printed = print(&mut sink, [&filter, &adaptive], &truth, &b, folder);
    printed.map_err(|error| sink.failure(&error))?;
    sink.finish()
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
    curves: CurveFitter,
    histories: Histories,
}

/// What one method found.
struct Found {
    results: Vec<ObjectResult>,
    histories: Histories,
}

impl Identification {
    fn new(options: TrackOptions, trace_path: &Path) -> Result<Self, Failure> {
        let tracker = Tracker::new(options.tracker_settings()).map_err(Failure::unusable)?;
        let tracker = tracker.with_known_outlines(OBJECTS_PLAYED);
        let trace = TraceWriter::new(WholeFile::create(trace_path)?, options.motion.family(), None)
            .map_err(|error| file_failure(trace_path, &error))?;
        let curves = CurveFitter::new(&options)?;
        let histories = Histories::new(Purpose::Report(None));
        Ok(Self { options, tracker, trace, trace_path: trace_path.to_owned(), curves, histories })
    }

    fn take(&mut self, frame: &OutlineFrame) -> Result<Observation, Failure> {
        let observation = self.tracker.push(frame);
        self.trace.write(&observation).map_err(|error| file_failure(&self.trace_path, &error))?;
        self.histories.take(&observation, Some(frame), &mut self.curves);
        Ok(observation)
    }

    /// Writes the trace and the figure, and prints the warnings.
    fn finish(self, figure: &Path, truth: &Truth) -> Result<Found, Failure> {
        let Self { options, tracker, trace, trace_path, mut histories, .. } = self;
        histories.close();
        trace.into_inner().map_err(|error| file_failure(&trace_path, &error))?.finish()?;
        WholeFile::write(figure, &parameter_figure(&histories.list, options.motion.family(), Some(truth)))?;
        let results = tracker.results();
        for warning in results.iter().flat_map(|result| &result.warnings) {
            warn(&format!("{} method: {warning}", tracker.settings().method()));
        }
        Ok(Found { results, histories })
    }
}

impl Found {
    fn findings(&self) -> Findings<'_> {
        Findings { results: &self.results, histories: &self.histories }
    }
}
