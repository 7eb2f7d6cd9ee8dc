use std::io;

use freeform_drawing::fit_figure;
use freeform_motion::FittedOutline;
use freeform_motion::curve_fit::{Fitter, Outline};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::FrameRanges;
use rayon::prelude::*;

use super::side_by_side::SideBySide;
use crate::args::{FitArgs, FitFormat};
use crate::awaited::Waiting;
use crate::failure::{Failure, warn};
use crate::input::Input;
use crate::left_out::MissingWarnings;
use crate::output::{
    FitsJson, Sink, WholeFile, refuse_other_format, refuse_overwriting, refuse_standard_output, write_fit_table,
};
use crate::progress::{Progress, Verbosity};
use crate::seen::{Item, Missing};

/// Fits a curve to every outline.
pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let fitter = Fitter::new(args.options.settings()?).map_err(Failure::unusable)?;
    let outputs: Vec<_> = args.svg.iter().chain(&args.pictures.candidates).map(AsRef::as_ref).collect();
    refuse_overwriting(&args.pictures.files_read(&args.inputs), &outputs)?;
    refuse_standard_output(&outputs)?;
    refuse_other_format(args.svg.as_deref())?;
    let input = Input::open(&args.inputs, &args.pictures, Waiting::Allowed, Verbosity::Usual)?;
    let name = input.name.clone();
    let svg = args.svg.as_deref().map(WholeFile::create).transpose()?;
    input.tell_tracing();
    let mut sink = Sink::stdout();
    let Fitted { collected, first_missing, warnings, frames, failure } = fit_all(args, input, fitter, &mut sink)?;
    if collected.count == 0 {
        let nothing = nothing_fitted(args, &name, &collected, first_missing, &frames);
        return Err(failure.unwrap_or(nothing));
    }
    collected.reasons.iter().for_each(|reason| warn(reason));
    warnings.finish().for_each(|reason| warn(&reason));
    let Collected { count, with_stray_parts, json, drawn, .. } = collected;
    if with_stray_parts > 0 {
        warn(&format!(
            "{with_stray_parts} of {count} curve(s) have a stray part away from the outline, where the polynomial is zero too"
        ));
    }
    if args.format == FitFormat::Json {
        json.finish(&mut sink).map_err(|error| sink.failure(&error))?;
    }
    let printed = sink.finish();
    if let Some(file) = svg {
        file.finish_with(fit_figure(&drawn).as_bytes())?;
    }
    failure.map_or(printed, Err)
}

/// What has come of an input.
#[derive(Default)]
struct Fitted {
    collected: Collected,
    first_missing: Option<Missing>,
    warnings: MissingWarnings,
    /// All frames with an outline.
    frames: FrameRanges,
    /// What ended the reading before its time.
    failure: Option<Failure>,
}

/// Fits the outlines of an input, as many side by side as need not be waited for, and prints the fits.
fn fit_all(args: &FitArgs, mut input: Input, fitter: Fitter, sink: &mut Sink) -> Result<Fitted, Failure> {
    let progress = Progress::of_frames(input.frame_count(), sink.is_disturbed_by_progress());
    let is_wanted = |frame: u64| args.frame.is_none_or(|wanted| wanted == frame);
    let mut waiting = Batch { input: input.name.clone(), fitter, items: SideBySide::of(&input) };
    let mut fitted = Fitted::default();
    while let Some(item) = input.next() {
        progress.warn_of(&input.news());
        progress.advance();
        match item {
            Ok(Item::Outline(frame, _)) => {
                fitted.frames.add(frame.frame);
                if is_wanted(frame.frame) {
                    waiting.add(Ok(frame));
                }
            }
            Ok(Item::NoOutline { reason, frame, .. }) if is_wanted(frame) => waiting.add(Err(reason)),
            Ok(Item::Gap(missing)) if is_wanted(missing.frame) => {
                fitted.warnings.take(&missing).into_iter().for_each(|reason| waiting.add(Err(reason)));
                fitted.first_missing.get_or_insert(missing);
            }
            Ok(_) => {}
            Err(error) => {
                fitted.failure = Some(error);
                break;
            }
        }
        if waiting.items.are_enough() {
            fitted.collected.take_all(args, sink, waiting.fit()).map_err(|error| sink.failure(&error))?;
        }
    }
    fitted.collected.take_all(args, sink, waiting.fit()).map_err(|error| sink.failure(&error))?;
    Ok(fitted)
}

/// Why there is no fit at all.
fn nothing_fitted(
    args: &FitArgs,
    name: &str,
    collected: &Collected,
    first_missing: Option<Missing>,
    frames: &FrameRanges,
) -> Failure {
    match (collected.reasons.first(), first_missing, args.frame) {
        (_, Some(missing), _) => missing.into_failure(),
        (Some(reason), None, _) => Failure::no_result(reason),
        (None, None, Some(frame)) if !frames.is_empty() => {
            Failure::no_result(format_args!("{name}: no frame {frame}, there are frames {frames}"))
        }
        (None, None, _) => Failure::no_result(format_args!("{name}: no outline in the file")),
    }
}

/// Outlines that wait to be fitted, and why others are none, in their order.
struct Batch {
    /// Name of the input, for messages.
    input: String,
    fitter: Fitter,
    items: SideBySide<Result<OutlineFrame, String>>,
}

impl Batch {
    fn add(&mut self, item: Result<OutlineFrame, String>) {
        let points = item.as_ref().map_or(0, |frame| frame.outline.point_count());
        self.items.add(item, points);
    }

    /// The fits of all that wait, computed on all cores; none waits after that.
    fn fit(&mut self) -> Vec<Result<(FittedOutline, Outline), String>> {
        let fitted = self.items.take().into_par_iter().map_init(
            || self.fitter.clone(),
            |fitter, item| {
                let frame = item?;
                let told = |reason: String| {
                    Err(format!("{}: frame {} of object {:?}: {reason}", self.input, frame.frame, frame.object))
                };
                match fitter.fit_with_covariance(&frame.outline) {
                    Ok((fit, _)) if !fit.polynomial().coefficients().iter().all(|a| a.is_finite()) => {
                        told("a coefficient overflows, the outline is too small or too far away".to_owned())
                    }
                    Ok((fit, covariance)) => {
                        let stray_parts = fit.stray_places(&frame.outline);
                        let fitted = FittedOutline::new(&frame, fit).with_deviations(&covariance);
                        Ok((FittedOutline { stray_parts, ..fitted }, frame.outline))
                    }
                    Err(error) => told(error.to_string()),
                }
            },
        );
        fitted.collect()
    }
}

/// What has come of the outlines so far.
#[derive(Default)]
struct Collected {
    count: usize,
    with_stray_parts: usize,
    /// Why there is no fit of some.
    reasons: Vec<String>,
    json: FitsJson,
    /// Fits of the first frame, where they are drawn.
    drawn: Vec<(FittedOutline, Outline)>,
}

impl Collected {
    fn take_all(
        &mut self,
        args: &FitArgs,
        sink: &mut Sink,
        fitted: Vec<Result<(FittedOutline, Outline), String>>,
    ) -> io::Result<()> {
        for fitted in fitted {
            match fitted {
                Ok((fitted, outline)) => self.take(args, sink, fitted, outline)?,
                Err(reason) => self.reasons.push(reason),
            }
        }
        Ok(())
    }

    fn take(&mut self, args: &FitArgs, sink: &mut Sink, fitted: FittedOutline, outline: Outline) -> io::Result<()> {
        match args.format {
            FitFormat::Table => write_fit_table(sink, &fitted, self.count > 0)?,
            FitFormat::Json => self.json.write(sink, &fitted)?,
        }
        self.count += 1;
        self.with_stray_parts += usize::from(!fitted.stray_parts.is_empty());
        let is_of_first_frame = self.drawn.first().is_none_or(|(first, _)| first.frame == fitted.frame);
        if args.svg.is_some() && is_of_first_frame {
            self.drawn.push((fitted, outline));
        }
        Ok(())
    }
}
