use std::path::Path;
use std::rc::Rc;

use freeform_motion::curve_fit::{Fit, FitSettings, Fitter};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::CameraScale;

use super::drawing::{Drawn, Overlay};
use crate::args::TrackOptions;
use crate::commands::FittedOutline;
use crate::failure::Failure;
use crate::input::SeenIn;
use crate::tracking::Observation;

/// Draws what was identified of objects on the pictures that they were seen in.
pub(crate) struct ObservedOverlay {
    overlay: Overlay,
    curves: CurveFitter,
    scale: Option<CameraScale>,
}

impl ObservedOverlay {
    /// Drawings for a folder or a GIF.
    pub(crate) fn open(path: &Path, options: &TrackOptions) -> Result<Self, Failure> {
        Ok(Self { overlay: Overlay::open(path)?, curves: CurveFitter::new(options)?, scale: options.scale })
    }

    /// Draws one object.
    pub(crate) fn take(
        &mut self,
        observation: &Observation,
        frame: Option<&OutlineFrame>,
        seen_in: Option<&Rc<SeenIn>>,
    ) -> Result<(), Failure> {
        let (Some(frame), Some(seen_in)) = (frame, seen_in) else { return Ok(()) };
        let fitted = self.curves.of(observation, frame).map(|fit| FittedOutline::new(frame, fit));
        let drawn = Drawn {
            outline: &frame.outline,
            accepted: observation.is_accepted(),
            fit: fitted.as_ref().map(|fitted| (&fitted.fit, fitted.parts.as_ref().ok())),
            generator: observation.estimate.and_then(|estimate| estimate.generator_in_image(self.scale)),
        };
        self.overlay.draw(seen_in, &drawn)
    }

    /// Writes what has not been written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.overlay.finish()
    }
}

/// The curve to draw of an outline: that of the method, or one fitted for the drawing where the method fits none.
pub(crate) struct CurveFitter(Fitter);

impl CurveFitter {
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        let defaults = FitSettings::default();
        let settings = FitSettings { degree: options.degree.unwrap_or(defaults.degree), ..defaults };
        Fitter::new(settings).map(Self).map_err(Failure::unusable)
    }

    pub(crate) fn of(&mut self, observation: &Observation, frame: &OutlineFrame) -> Option<Fit> {
        observation.fit.or_else(|| self.0.fit(&frame.outline).ok())
    }
}
