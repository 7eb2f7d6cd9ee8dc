use std::io;

use freeform_motion::curve_fit::{Fit, FitCovariance, Fitter, Outline};
use freeform_motion::decompose::{
    AffineInvariants, CurveUncertainty, Decomposition, DecompositionError, RelatedPoints,
};
use freeform_motion::outline_io::OutlineFrame;
use nalgebra::Point2;

use crate::args::{FitArgs, FitFormat};
use crate::failure::{Failure, warn};
use crate::frame_ranges::FrameRanges;
use crate::input::{Input, Item};
use crate::left_out::{Missing, MissingWarnings};
use crate::level_set::stray_parts;
use crate::output::{Sink, WholeFile, fit_figure, refuse_overwriting, write_fit_table, write_fits_json};
use crate::progress::Progress;

/// A curve fitted to one outline, and what it is made of.
#[derive(Debug, Clone)]
pub(crate) struct FittedOutline {
    pub(crate) object: String,
    pub(crate) frame: u64,
    pub(crate) time: f64,
    pub(crate) fit: Fit,
    /// In image coordinates.
    pub(crate) parts: Result<Parts, DecompositionError>,
    /// Where it has been asked for.
    pub(crate) deviations: Option<Deviations>,
    /// Middles of the parts of the curve that lie beside the outline, where they have been looked for.
    pub(crate) stray_parts: Vec<Point2<f64>>,
}

/// Standard deviations of what a decomposition gives, by the noise of the points.
#[derive(Debug, Clone)]
pub(crate) struct Deviations {
    /// Of x and y of the related points, in image coordinates.
    pub(crate) related_points: Vec<[f64; 2]>,
    /// Of the invariants; empty where there are none.
    pub(crate) invariants: Vec<f64>,
}

/// What a decomposition gives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parts {
    pub(crate) decomposition: Decomposition,
    /// With the values of the monic polynomial in image coordinates.
    pub(crate) related_points: RelatedPoints,
    pub(crate) invariants: Option<AffineInvariants>,
}

impl FittedOutline {
    /// The curve of one frame of one object.
    pub(crate) fn new(frame: &OutlineFrame, fit: Fit) -> Self {
        // In working coordinates, where nothing is lost to rounding, and then moved.
        let parts = Decomposition::of(fit.working()).and_then(|working| {
            let image_from_working = fit.normalisation().image_from_working();
            let decomposition = working.moved(&image_from_working)?;
            let n = working.degree().value();
            let factor = working.coefficient(n) / decomposition.coefficient(n);
            let related_points = RelatedPoints::of(&working).moved(&image_from_working).scaled(factor);
            Ok(Parts { decomposition, related_points, invariants: AffineInvariants::of(&working) })
        });
        Self {
            object: frame.object.clone(),
            frame: frame.frame,
            time: frame.time,
            fit,
            parts,
            deviations: None,
            stray_parts: Vec::new(),
        }
    }

    /// The same with the standard deviations that a covariance of the coefficients gives its parts.
    fn with_deviations(mut self, covariance: &FitCovariance) -> Self {
        let carried = CurveUncertainty::carried(self.fit.working(), &covariance.coefficients());
        let map = self.fit.normalisation().image_from_working();
        let linear = map.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        self.deviations = carried.ok().map(|carried| Deviations {
            related_points: carried
                .points()
                .iter()
                .map(|c| (linear * c * linear.transpose()).diagonal().map(f64::sqrt).into())
                .collect(),
            invariants: carried.invariants().map_or_else(Vec::new, |c| c.diagonal().iter().map(|v| v.sqrt()).collect()),
        });
        self
    }
}

/// Fits a curve to every outline.
pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let mut fitter = Fitter::new(args.options.settings()?).map_err(Failure::unusable)?;
    if let Some(svg) = &args.svg {
        refuse_overwriting(&args.inputs, &[svg])?;
    }
    let input = Input::open(&args.inputs, &args.pictures)?;
    let name = input.name.clone();
    let svg = args.svg.as_deref().map(WholeFile::create).transpose()?;
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
            Ok(Item::Rejected { reason, frame, .. }) => {
                reasons.extend(Some(reason).filter(|_| is_wanted(frame)));
                continue;
            }
            Ok(Item::Missing(missing)) => {
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
                let stray_parts = stray_parts(&fit, &frame.outline);
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
        warn(&format!("{with} of {count} curve(s) have a part beside the outline, where the polynomial is zero too"));
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
