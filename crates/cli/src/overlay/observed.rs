use std::path::{Path, PathBuf};

use freeform_motion::Rectification;
use freeform_motion::curve_fit::{Fit, FitSettings, Fitter};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::Observation;

use super::drawing::{Drawn, Overlay};
use crate::args::TrackOptions;
use crate::failure::Failure;
use crate::fitted_outline::FittedOutline;
use crate::input::Input;
use crate::reader::Event;
use crate::seen::Missing;

/// Draws what was identified of objects on the pictures that they were seen in.
pub(crate) struct ObservedOverlay {
    overlay: Overlay,
    curves: CurveFitter,
    scale: Option<CameraScale>,
    plane: Option<Rectification>,
    /// Whether the objects are named.
    names: bool,
}

impl ObservedOverlay {
    /// Drawings for a folder, a GIF or a video, if they are asked for. Refused where there is nothing to draw on.
    pub(crate) fn open(
        path: Option<&Path>,
        inputs: &[PathBuf],
        input: &Input,
        options: &TrackOptions,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = path else { return Ok(None) };
        if !input.has_pictures() {
            return Err(Failure::unusable(format_args!("{}: --overlay draws on pictures, this is CSV", input.name)));
        }
        let names = input.pictures().is_some_and(|pictures| pictures.options().follows_all());
        let (overlay, curves) = (Overlay::open(path, inputs)?, CurveFitter::new(options)?);
        Ok(Some(Self { overlay, curves, scale: options.scale, plane: options.rectification(), names }))
    }

    /// Draws one object, or a picture without any.
    pub(crate) fn take(&mut self, event: &Event) -> Result<(), Failure> {
        let (observation, frame, seen_in) = match event {
            Event::Object(observation, Some((frame, Some(seen_in)))) => (observation, frame, seen_in),
            Event::Gap(Missing { seen_in: Some(seen_in), .. }) => return self.overlay.draw_nothing(seen_in),
            _ => return Ok(()),
        };
        let fitted = self.curves.of(observation, frame).map(|fit| FittedOutline::new(frame, fit));
        let drawn = Drawn {
            outline: &frame.outline,
            name: self.names.then_some(frame.object.as_str()),
            accepted: observation.is_accepted(),
            fit: fitted.as_ref().map(|fitted| (&fitted.fit, fitted.parts.as_ref().ok())),
            generator: observation.estimate.and_then(|estimate| {
                let generator = estimate.known_generator()?;
                Some(match &self.plane {
                    Some(plane) => plane.generator_in_picture(&generator),
                    None => self.scale.unwrap_or_default().generator_in_image(&generator),
                })
            }),
        };
        self.overlay.draw(seen_in, &drawn)
    }

    /// Writes what has not been written.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.overlay.finish()
    }
}

/// The curve to draw of an outline: that of the method, or one fitted for the drawing where the method fits none.
pub(crate) struct CurveFitter {
    fitter: Fitter,
    /// Whether the curves of the method are elsewhere than the outlines of the pictures.
    is_rectified: bool,
}

impl CurveFitter {
    pub(crate) fn new(options: &TrackOptions) -> Result<Self, Failure> {
        let settings = FitSettings { degree: options.degree_drawn(), ..FitSettings::default() };
        let fitter = Fitter::new(settings).map_err(Failure::unusable)?;
        Ok(Self { fitter, is_rectified: options.rectify.is_some() })
    }

    pub(crate) fn of(&mut self, observation: &Observation, frame: &OutlineFrame) -> Option<Fit> {
        observation.fit.filter(|_| !self.is_rectified).or_else(|| self.fitter.fit(&frame.outline).ok())
    }
}
