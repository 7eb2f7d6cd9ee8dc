use freeform_motion::curve_fit::{Degree, Fit, FitSettings, Fitter, SettingsError};
use freeform_motion::outline_io::OutlineFrame;
use freeform_motion::tracker::Observation;

/// The curve to draw of an outline: that of the method, or one fitted for the drawing where the method fits none.
#[derive(Debug)]
pub struct CurveFitter {
    fitter: Fitter,
    /// Whether the curves of the method are elsewhere than the outlines of the pictures.
    is_rectified: bool,
}

impl CurveFitter {
    /// Curves of a degree. `is_rectified`: whether the tracker maps the outlines to a plane, so that curves of its method are not drawn on the
    /// pictures.
    ///
    /// # Errors
    ///
    /// Those of [`Fitter::new`].
    pub fn new(degree: Degree, is_rectified: bool) -> Result<Self, SettingsError> {
        let fitter = Fitter::new(FitSettings { degree, ..FitSettings::default() })?;
        Ok(Self { fitter, is_rectified })
    }

    pub(crate) fn of(&mut self, observation: &Observation, frame: &OutlineFrame) -> Option<Fit> {
        observation.fit.filter(|_| !self.is_rectified).or_else(|| self.fitter.fit(&frame.outline).ok())
    }
}
