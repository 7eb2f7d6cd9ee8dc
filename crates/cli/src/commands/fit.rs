use std::io;

use freeform_motion::curve_fit::{Fitter, Outline};
use freeform_motion::tracker::FrameRanges;

use crate::args::{FitArgs, FitFormat};
use crate::failure::{Failure, warn};
use crate::fitted_outline::FittedOutline;
use crate::input::{Input, Waiting};
use crate::left_out::MissingWarnings;
use crate::output::{
    Sink, WholeFile, fit_figure, refuse_overwriting, refuse_standard_output, write_fit_table, write_fits_json,
};
use crate::progress::Progress;
use crate::seen::{Item, Missing};

/// Fits a curve to every outline.
pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let mut fitter = Fitter::new(args.options.settings()?).map_err(Failure::unusable)?;
    let outputs: Vec<_> = args.svg.iter().chain(&args.pictures.candidates).map(AsRef::as_ref).collect();
    refuse_overwriting(&args.inputs, &outputs)?;
    refuse_standard_output(&outputs)?;
    let input = Input::open(&args.inputs, &args.pictures, Waiting::Allowed)?;
    let name = input.name.clone();
    let svg = args.svg.as_deref().map(WholeFile::create).transpose()?;
    input.tell_tracing();
    let mut sink = Sink::stdout();
    let mut collected = Collected::default();
    let (mut reasons, mut first_missing, mut warnings) = (Vec::new(), None::<Missing>, MissingWarnings::default());
    let mut failure = None;
    let mut frames = FrameRanges::default();
    let progress = Progress::of_frames(input.frame_count(), sink.is_disturbed_by_progress());
    let is_wanted = |frame: u64| args.frame.is_none_or(|wanted| wanted == frame);
    for item in input {
        progress.advance();
        let frame = match item {
            Ok(Item::Outline(frame, _)) => frame,
            Ok(Item::NoOutline { reason, frame, .. }) => {
                reasons.extend(Some(reason).filter(|_| is_wanted(frame)));
                continue;
            }
            Ok(Item::Gap(missing)) => {
                if is_wanted(missing.frame) {
                    reasons.extend(warnings.take(&missing));
                    first_missing.get_or_insert(missing);
                }
                continue;
            }
            Err(error) => {
                failure = Some(error);
                break;
            }
        };
        frames.add(frame.frame);
        if !is_wanted(frame.frame) {
            continue;
        }
        match fitter.fit_with_covariance(&frame.outline) {
            Ok((fit, _)) if !fit.polynomial().coefficients().iter().all(|a| a.is_finite()) => {
                let place = format!("{name}: frame {} of object {:?}", frame.frame, frame.object);
                reasons.push(format!("{place}: a coefficient overflows, the outline is too small or too far away"));
            }
            Ok((fit, covariance)) => {
                let stray_parts = fit.stray_places(&frame.outline);
                let fitted = FittedOutline::new(&frame, fit).with_deviations(&covariance);
                let fitted = FittedOutline { stray_parts, ..fitted };
                collected.take(args, &mut sink, fitted, frame.outline).map_err(|error| sink.failure(&error))?;
            }
            Err(error) => {
                reasons.push(format!("{name}: frame {} of object {:?}: {error}", frame.frame, frame.object));
            }
        }
    }
    drop(progress);
    if collected.count == 0 {
        let nothing = match (reasons.into_iter().next(), first_missing, args.frame) {
            (_, Some(missing), _) => missing.into_failure(),
            (Some(reason), None, _) => Failure::no_result(reason),
            (None, None, Some(frame)) if !frames.is_empty() => {
                Failure::no_result(format_args!("{name}: no frame {frame}, there are frames {frames}"))
            }
            (None, None, _) => Failure::no_result(format_args!("{name}: no outline in the file")),
        };
        return Err(failure.unwrap_or(nothing));
    }
    reasons.extend(warnings.finish());
    reasons.iter().for_each(|reason| warn(reason));
    if let Collected { with_stray_parts: with @ 1.., count, .. } = collected {
        warn(&format!(
            "{with} of {count} curve(s) have a stray part away from the outline, where the polynomial is zero too"
        ));
    }
    if args.format == FitFormat::Json {
        write_fits_json(&mut sink, &collected.fits).map_err(|error| sink.failure(&error))?;
    }
    let printed = sink.finish();
    if let Some(file) = svg {
        file.finish_with(fit_figure(&collected.drawn).as_bytes())?;
    }
    failure.map_or(printed, Err)
}

/// What is kept of the outlines while they are read.
#[derive(Default)]
struct Collected {
    count: usize,
    with_stray_parts: usize,
    /// All fits, where they are printed together in the end.
    fits: Vec<FittedOutline>,
    /// Those of the first frame, where they are drawn.
    drawn: Vec<(FittedOutline, Outline)>,
}

impl Collected {
    fn take(&mut self, args: &FitArgs, sink: &mut Sink, fitted: FittedOutline, outline: Outline) -> io::Result<()> {
        if args.format == FitFormat::Table {
            write_fit_table(sink, &fitted, self.count > 0)?;
        }
        self.count += 1;
        self.with_stray_parts += usize::from(!fitted.stray_parts.is_empty());
        let is_of_first_frame = self.drawn.first().is_none_or(|(first, _)| first.frame == fitted.frame);
        if args.svg.is_some() && is_of_first_frame {
            self.drawn.push((fitted.clone(), outline));
        }
        if args.format == FitFormat::Json {
            self.fits.push(fitted);
        }
        Ok(())
    }
}
