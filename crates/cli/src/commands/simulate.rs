use std::io::{self, Write};
use std::path::PathBuf;

use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame, TableFormat, TableWriter, WriteError, WriterOptions};
use freeform_motion::sim_camera::{BuiltInShape, Frame, Occlusion, Scene, SequenceLength, Settings, Simulator};
use freeform_motion::{SimulatedMotion, named_shape};

use crate::args::{DisturbanceArgs, MotionChoice, PlaneBefore, SimulateArgs};
use crate::command_line::command_line;
use crate::failure::Failure;
use crate::output::{Sink, refuse_overwriting};
use crate::progress::Progress;

use super::simulate_pictures::write_pictures;

/// Simulates a sequence and writes its outlines.
pub(crate) fn run(args: &SimulateArgs) -> Result<(), Failure> {
    if let Some(folder) = &args.pictures {
        return write_pictures(args, folder);
    }
    let simulator = simulator(args)?;
    refuse_overwriting(&shape_files(std::slice::from_ref(&args.shape)), &[&args.output])?;
    let mut sink = Sink::open(&args.output)?;
    let written = write_sequence(&mut sink, TableFormat::of(&args.output), &simulator, |_| Ok(()));
    written.map_err(|error| error.into_failure(|error| sink.failure(error)))?;
    sink.finish()
}

/// Length of a sequence of outlines where none is given.
const SECONDS: f64 = 10.0;

/// Coordinates of outlines with noise are written to this share of the RMS radius.
const RESOLUTION: f64 = 1e-7;

/// Why a sequence could not be written.
pub(super) enum SequenceError {
    Write(WriteError),
    Other(Failure),
}

impl SequenceError {
    /// The failure; `of_sink` says where the sink failed.
    pub(super) fn into_failure(self, of_sink: impl FnOnce(&io::Error) -> Failure) -> Failure {
        match self {
            Self::Write(WriteError::Io(error)) => of_sink(&error),
            Self::Write(error) => Failure::unusable(error),
            Self::Other(failure) => failure,
        }
    }
}

impl From<WriteError> for SequenceError {
    fn from(error: WriteError) -> Self {
        Self::Write(error)
    }
}

impl From<Failure> for SequenceError {
    fn from(failure: Failure) -> Self {
        Self::Other(failure)
    }
}

/// Writes the head with the truth and all outlines; hands every outline on after it has been written.
pub(super) fn write_sequence(
    sink: &mut impl Write,
    format: TableFormat,
    simulator: &Simulator,
    mut observe: impl FnMut(&OutlineFrame) -> Result<(), Failure>,
) -> Result<(), SequenceError> {
    let head = [command_line(), SimulatedMotion::of(simulator).to_string()];
    let arc_column = simulator.settings().occlusion.fraction > 0.0;
    // Objects have about unit size in the image; far below the noise there is nothing to tell.
    let resolution = (simulator.settings().noise > 1e3 * RESOLUTION).then_some(RESOLUTION);
    let options = WriterOptions { arc_column, resolution, ..WriterOptions::default() };
    let mut writer = TableWriter::new(sink, format, options, &head)?;
    let progress = Progress::of_frames(Some(simulator.frame_count() as u64), false);
    for Frame { index, time, outline, .. } in simulator.frames() {
        let frame = OutlineFrame { frame: index as u64, time, object: DEFAULT_OBJECT.to_owned(), outline };
        writer.write(&frame)?;
        observe(&frame)?;
        progress.advance();
    }
    writer.finish()?;
    Ok(())
}

fn simulator(args: &SimulateArgs) -> Result<Simulator, Failure> {
    let is_plane = args.motion == Some(MotionChoice::Plane);
    let plane = args.motion_in_space.in_space.plane(is_plane)?;
    let camera = args.motion_in_space.camera().map_err(Failure::unusable)?;
    let given = args.motion_in_space.motion();
    if let Some(model) = args.motion.filter(|_| !is_plane).map(MotionChoice::model)
        && model.parameters_of_motion(&given).is_none()
    {
        let family = args.motion_in_space.family();
        return Err(Failure::unusable(format_args!("--motion {model} does not contain the motion of --{family}")));
    }
    let motion = args.dynamics.motion(&args.motion_in_space)?;
    let scene = match plane {
        Some(PlaneBefore { motion, camera, size }) => {
            Scene::in_space(named_shape(&args.shape).map_err(Failure::unusable)?, motion, camera, size)
        }
        None => Scene::new(named_shape(&args.shape).map_err(Failure::unusable)?, motion, camera),
    };
    let DisturbanceArgs { occlusion, outliers, .. } = args.disturbance;
    let noise = args.disturbance.noise(is_plane);
    let settings = Settings {
        fps: args.fps,
        length: SequenceLength::Seconds(args.seconds.unwrap_or(SECONDS)),
        points: args.points,
        noise,
        occlusion: Occlusion { fraction: occlusion, ..Occlusion::default() },
        outliers,
        seed: args.seed,
        ..Settings::default()
    };
    Simulator::new(scene, settings).map_err(Failure::unusable)
}

/// Those of these shapes that are files.
pub(super) fn shape_files(names_or_files: &[String]) -> Vec<PathBuf> {
    let is_file = |name: &&String| name.parse::<BuiltInShape>().is_err();
    names_or_files.iter().filter(is_file).map(PathBuf::from).collect()
}
