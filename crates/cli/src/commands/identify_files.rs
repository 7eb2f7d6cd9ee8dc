//! The files of `identify`.
use std::path::Path;

use freeform_drawing::{Histories, MeaningOfB, Purpose, parameter_figure};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::{AdaptiveColumns, ObjectResult, Observation, TraceWriter, Trajectory, write_trajectory};
use freeform_motion::{Tracker, Truth};

use crate::args::{IdentifyArgs, IdentifyMethod};
use crate::failure::{Failure, file_failure, warn};
use crate::output::WholeFile;
use crate::overlay::curves;

/// Objects that are named where their poses are not smoothed.
const NOT_SMOOTHED_TOLD: usize = 5;

/// What is written frame by frame, or kept for figures. Files are begun before the work, which is not to be lost where there
/// is no place for them.
pub(super) struct Files<'a> {
    args: &'a IdentifyArgs,
    trace: Option<(&'a Path, TraceWriter<WholeFile>)>,
    trajectory: Option<(&'a Path, WholeFile, Trajectory)>,
    svg: Option<WholeFile>,
    pub(super) report: Option<WholeFile>,
    pub(super) histories: Histories,
    /// Whether a pose of any object was known in any frame.
    pub(super) has_poses: bool,
}

impl<'a> Files<'a> {
    /// Begins the files that are asked for.
    pub(super) fn create(args: &'a IdentifyArgs, truth: Option<&Truth>) -> Result<Self, Failure> {
        let (model, scale) = (args.options.motion.model(), args.options.scale);
        let study = (args.options.method == IdentifyMethod::Adaptive)
            .then(|| AdaptiveColumns { truth: truth.and_then(|truth| truth.constant_in_image(model, scale)) });
        let trace = args.trace.as_deref().map(|path| {
            let writer = TraceWriter::new(WholeFile::create(path)?, args.options.motion.family(), study);
            writer.map(|writer| (path, writer)).map_err(|error| file_failure(path, &error))
        });
        let trajectory = args.trajectory.as_deref();
        let trajectory = trajectory.map(|path| Ok((path, WholeFile::create(path)?, Trajectory::default())));
        let svg = args.svg.as_deref().map(WholeFile::create).transpose()?;
        let (trace, trajectory) = (trace.transpose()?, trajectory.transpose()?);
        let purpose = match args.report {
            Some(_) => Purpose::Report(args.options.rectification()),
            None => Purpose::Figures,
        };
        let histories = Histories::new(purpose, curves(&args.options)?);
        let report = args.report.as_deref().map(WholeFile::create).transpose()?;
        Ok(Self { args, trace, trajectory, svg, report, histories, has_poses: false })
    }

    /// Takes what a frame of an object gave.
    pub(super) fn take(&mut self, observation: &Observation, frame: Option<&OutlineFrame>) -> Result<(), Failure> {
        if let Some((path, trace)) = &mut self.trace {
            trace.write(observation).map_err(|error| file_failure(path, &error))?;
        }
        self.has_poses |= observation.state.is_some();
        if let Some((_, _, trajectory)) = &mut self.trajectory {
            trajectory.take(observation);
        }
        if self.args.svg.is_some() || self.args.report.is_some() {
            self.histories.take(observation, frame);
        }
        Ok(())
    }

    /// Moves the files to their destinations. A file without content is not written.
    pub(super) fn finish(
        self,
        tracker: &Tracker,
        truth: Option<&Truth>,
        results: &[ObjectResult],
        b: &MeaningOfB,
    ) -> Result<(), Failure> {
        let Self { args, trace, trajectory, svg, histories, .. } = self;
        let model = args.options.motion.model();
        let not_written = |options: &[(&str, bool)], reason: &str| {
            let names: Vec<&str> = options.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
            if !names.is_empty() && !args.quiet {
                warn(&format!("{}: not written, {reason}", names.join(", ")));
            }
        };
        if results.iter().all(|result| result.frames == result.frames_rejected) {
            let options =
                [("--trace", trace.is_some()), ("--trajectory", trajectory.is_some()), ("--svg", svg.is_some())];
            not_written(&options, "no outline could be used");
            return Ok(());
        }
        if let Some((path, trace)) = trace {
            trace.into_inner().map_err(|error| file_failure(path, &error))?.finish()?;
        }
        if let Some((path, mut file, mut trajectory)) = trajectory {
            if args.smooth {
                let not_smoothed = trajectory.smooth(tracker);
                let told = not_smoothed.len().min(NOT_SMOOTHED_TOLD);
                not_smoothed[..told].iter().for_each(|object| warn(&format!("--smooth: {object}")));
                if told < not_smoothed.len() {
                    warn(&format!("--smooth: nor are those of {} more object(s)", not_smoothed.len() - told));
                }
            }
            let written = write_trajectory(&mut file, &trajectory, model, args.options.scale);
            written.map_err(|error| file_failure(path, &error))?;
            file.finish()?;
        }
        if results.iter().all(|result| result.parameters().is_none()) {
            not_written(&[("--svg", svg.is_some())], "there is no motion to draw");
        } else if let Some(file) = svg {
            file.finish_with(parameter_figure(&histories, args.options.motion.family(), truth, b).as_bytes())?;
        }
        Ok(())
    }
}
