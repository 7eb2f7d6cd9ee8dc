//! What was found of every object over time.
use freeform_motion::curve_fit::Outline;
use freeform_motion::estimate::MotionEstimate;
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::Observation;

use crate::fitted_outline::FittedOutline;
use crate::overlay::CurveFitter;

/// What was found of one object over time, kept for figures.
#[derive(Debug)]
pub(crate) struct History {
    pub(crate) object: String,
    /// Time of the first frame in seconds.
    pub(crate) start: Option<f64>,
    /// Time in seconds and what was known then, if anything was.
    pub(crate) estimates: Vec<(f64, Option<MotionEstimate>)>,
    /// Time in seconds and root mean square residual, of frames that were used.
    pub(crate) residuals: Vec<[f64; 2]>,
    /// Time in seconds and squared innovation, of frames that were used.
    pub(crate) innovations: Vec<[f64; 2]>,
    /// Number and time in seconds of every frame that was rejected, as far as its time is known.
    pub(crate) rejected: Vec<(u64, Option<f64>)>,
    /// The latest outline that was not rejected, with its curve; `None` where the method fits none.
    pub(crate) latest: Option<(FittedOutline, Outline)>,
}

impl History {
    /// An empty history.
    pub(crate) fn of(object: String) -> Self {
        let (estimates, residuals, innovations, rejected) = Default::default();
        Self { object, start: None, estimates, residuals, innovations, rejected, latest: None }
    }

    /// Adds a frame to the history of its object.
    pub(crate) fn take(
        histories: &mut Vec<Self>,
        observation: &Observation,
        frame: Option<&OutlineFrame>,
        curves: &mut CurveFitter,
    ) {
        let position = histories.iter().position(|history| history.object == observation.object);
        let position = position.unwrap_or_else(|| {
            histories.push(Self::of(observation.object.clone()));
            histories.len() - 1
        });
        let history = &mut histories[position];
        history.start = history.start.or(observation.time);
        history.estimates.extend(observation.time.map(|time| (time, observation.estimate)));
        if !observation.is_accepted() {
            history.rejected.push((observation.frame, observation.time));
            return;
        }
        if let Some(time) = observation.time {
            history.residuals.extend(observation.residual.map(|residual| [time, residual]));
            history.innovations.extend(observation.innovation.map(|innovation| [time, innovation]));
        }
        if let Some((frame, fit)) = frame.and_then(|frame| Some((frame, curves.of(observation, frame)?))) {
            history.latest = Some((FittedOutline::new(frame, fit), frame.outline.clone()));
        }
    }
}
