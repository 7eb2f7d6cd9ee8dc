use freeform_motion::outline_filter::{KnownOutline, KnownPiece};
use freeform_motion::outline_io::{OutlineFrame, SourcePicture};
use freeform_motion::riccati::{CameraScale, map_point};
use freeform_motion::tracker::{ObjectPhase, Observation};
use freeform_motion::{FittedOutline, Rectification};

use super::drawing::{Drawn, DrawnPicture, Overlay};
use crate::history::CurveFitter;

/// Draws what was identified of objects on the pictures that they were seen in: the outline, the motion, and what the method knows of the outline.
/// That is the known outline in the pose of the frame where the tracker gives it
/// ([`Tracker::with_known_outlines`](freeform_motion::Tracker::with_known_outlines)), and the curve with its related points where the method fits one.
#[derive(Debug)]
pub struct ObservedOverlay {
    overlay: Overlay,
    curves: CurveFitter,
    scale: Option<CameraScale>,
    plane: Option<Rectification>,
    names: bool,
}

impl ObservedOverlay {
    /// An overlay with curves from `curves`. `names`: whether the objects are named.
    #[must_use]
    pub fn new(curves: CurveFitter, names: bool) -> Self {
        Self { overlay: Overlay::default(), curves, scale: None, plane: None, names }
    }

    /// For motions whose velocities were divided by a camera scale.
    #[must_use]
    pub fn with_scale(self, scale: Option<CameraScale>) -> Self {
        Self { scale, ..self }
    }

    /// For motions in a plane that the pictures were mapped to.
    #[must_use]
    pub fn with_plane(self, plane: Option<Rectification>) -> Self {
        Self { plane, ..self }
    }

    /// Draws one object. Returns the picture before, if this one is another.
    #[must_use]
    pub fn draw(
        &mut self,
        observation: &Observation,
        frame: &OutlineFrame,
        source: &SourcePicture,
    ) -> Option<DrawnPicture> {
        // A curve of which the method knows nothing would say nothing of what it found.
        let fit = observation.fit.and_then(|_| self.curves.of(observation, frame));
        let fitted = fit.map(|fit| FittedOutline::new(frame, fit));
        let is_followed = observation.phase != Some(ObjectPhase::Lost);
        let known = observation.known_outline.as_deref().filter(|_| is_followed);
        let known = known.map_or_else(Vec::new, |known| self.in_picture(known));
        let drawn = Drawn {
            outline: &frame.outline,
            name: self.names.then_some(frame.object.as_str()),
            accepted: observation.is_accepted(),
            known: &known,
            fit: fitted.as_ref().map(|fitted| (&fitted.fit, fitted.parts.as_ref().ok())),
            generator: observation.estimate.and_then(|estimate| {
                let generator = estimate.known_generator()?;
                Some(match &self.plane {
                    Some(plane) => plane.generator_in_picture(&generator),
                    None => self.scale.unwrap_or_default().generator_in_image(&generator),
                })
            }),
        };
        self.overlay.draw(source, &drawn)
    }

    /// A known outline where it is in the frame, in the picture.
    fn in_picture(&self, known: &KnownOutline) -> Vec<KnownPiece> {
        let place = |point| {
            let here = map_point(known.pose.matrix(), point);
            self.plane.as_ref().map_or(here, |plane| plane.point_in_picture(&here))
        };
        let pieces = known.pieces.iter();
        pieces
            .map(|KnownPiece { points, closed }| KnownPiece {
                points: points.iter().map(place).collect(),
                closed: *closed,
            })
            .collect()
    }

    /// Says on a picture that it gave no outline. Returns the picture before, if this one is another.
    #[must_use]
    pub fn draw_nothing(&mut self, source: &SourcePicture) -> Option<DrawnPicture> {
        self.overlay.draw_nothing(source)
    }

    /// The last picture, if there was any.
    #[must_use]
    pub fn finish(self) -> Option<DrawnPicture> {
        self.overlay.finish()
    }
}
