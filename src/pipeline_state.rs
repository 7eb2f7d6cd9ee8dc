//! A pipeline as bytes and back.
use freeform_estimate::{StateError, StateFormat};
use freeform_identify::{AdaptiveIdentifier, AdaptiveSettings};
use nalgebra::{Affine2, Translation2};
use serde::{Deserialize, Serialize};

use crate::{
    Pipeline, PipelineSettings,
    followed_pose::FollowedPose,
    matched_frame::{MatchedFrame, Matches},
    pipeline::follow_by,
    regular_map::are_coordinates,
    settling::Settling,
};

/// The format of the bytes.
const FORMAT: StateFormat = StateFormat { version: 1, kind: *b"pipe", name: "pipeline" };

/// What is saved. The buffers of the fitter hold nothing from frame to frame.
#[derive(Serialize, Deserialize)]
struct SavedPipeline {
    settings: PipelineSettings,
    /// With a header of its own.
    identifier: Vec<u8>,
    image_from_identifier: Option<Affine2<f64>>,
    identifier_from_start: Translation2<f64>,
    last: Option<MatchedFrame>,
    pose: Option<FollowedPose>,
    frames: usize,
    frames_rejected: usize,
    without_separate_lines: usize,
    matches: Matches,
    settling: Settling,
}

impl Pipeline {
    /// Everything that the pipeline knows, as bytes: 1.5 to 15 kB. A pipeline [made from them](Self::from_bytes) goes on as this one would, to
    /// the last bit. The first four bytes are the version of the format, little-endian.
    ///
    /// # Errors
    /// None for a pipeline; the encoder reports errors of its sink, and memory has none.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StateError> {
        FORMAT.encoded(&SavedPipeline {
            settings: self.settings.clone(),
            identifier: self.identifier.to_bytes()?,
            image_from_identifier: self.image_from_identifier,
            identifier_from_start: self.identifier_from_start,
            last: self.last,
            pose: self.pose.clone(),
            frames: self.frames,
            frames_rejected: self.frames_rejected,
            without_separate_lines: self.without_separate_lines,
            matches: self.matches,
            settling: self.settling.clone(),
        })
    }

    /// A pipeline from the bytes of [`to_bytes`](Self::to_bytes). Bytes from anywhere may be given: everything is checked.
    ///
    /// ```
    /// use freeform_motion::{Pipeline, PipelineSettings};
    /// use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
    ///
    /// let settings = Settings { length: SequenceLength::Frames(20), ..Settings::default() };
    /// let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
    /// let frames: Vec<_> = simulator.frames().collect();
    ///
    /// let mut pipeline = Pipeline::new(PipelineSettings::default())?;
    /// for seen in &frames[..10] {
    ///     pipeline.push(seen.time, &seen.outline)?;
    /// }
    /// let mut restored = Pipeline::from_bytes(&pipeline.to_bytes()?)?;
    /// for seen in &frames[10..] {
    ///     assert_eq!(restored.push(seen.time, &seen.outline)?, pipeline.push(seen.time, &seen.outline)?);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Bytes of another version or kind, damaged ones, and ones that describe no pipeline.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let saved: SavedPipeline = FORMAT.decoded(bytes)?;
        let identifier = AdaptiveIdentifier::from_bytes(&saved.identifier)?;
        let new = Self::new(saved.settings.clone()).map_err(|_| StateError::Inconsistent { part: "settings" })?;
        saved.check(&identifier)?;
        let SavedPipeline { image_from_identifier, identifier_from_start, last, pose, .. } = saved;
        let SavedPipeline { frames, frames_rejected, without_separate_lines, matches, settling, .. } = saved;
        Ok(Self {
            identifier,
            image_from_identifier,
            identifier_from_start,
            last,
            pose,
            frames,
            frames_rejected,
            without_separate_lines,
            matches,
            settling,
            ..new
        })
    }
}

impl SavedPipeline {
    /// Whether the parts belong together.
    fn check(&self, identifier: &AdaptiveIdentifier) -> Result<(), StateError> {
        let is_begun = self.last.is_some();
        let model = self.settings.identify.model;
        // What it begins with is in coordinates of its own.
        let initial_values = self.settings.identify.initial_values.clone();
        let settings = AdaptiveSettings { initial_values, ..identifier.settings().clone() };
        let counts = [self.frames_rejected, self.frames, StateFormat::MOST_COUNTED];
        let parts = [
            ("settings of the identifier", settings == self.settings.identify),
            ("frames of the identifier", (identifier.frames() > 0) == is_begun && identifier.frames() <= self.frames),
            ("lines of the identifier", identifier.line_count() == self.last.as_ref().map(pair_count)),
            ("coordinates", self.are_coordinates_sound(is_begun)),
            ("lines", self.last.is_none_or(|last| self.is_of_settings(&last))),
            ("pose", self.pose.as_ref().is_none_or(|pose| is_begun && pose.is_of(follow_by(model)))),
            ("counts of frames", counts.is_sorted() && self.without_separate_lines <= self.frames_rejected),
            ("matches", [self.matches.ambiguous, self.matches.all, self.frames].is_sorted()),
            ("estimates of the past", self.settling.is_of(model)),
        ];
        let wrong = parts.into_iter().find(|(_, is_sound)| !is_sound);
        wrong.map_or(Ok(()), |(part, _)| Err(StateError::Inconsistent { part }))
    }

    fn are_coordinates_sound(&self, is_begun: bool) -> bool {
        let identity = Affine2::identity();
        let to_image = self.image_from_identifier.as_ref();
        to_image.is_some() == is_begun && are_coordinates(to_image.unwrap_or(&identity), &self.identifier_from_start)
    }

    /// Whether lines are those of a curve that the settings ask for, in an order of their pairs.
    fn is_of_settings(&self, last: &MatchedFrame) -> bool {
        let degree = last.decomposition.degree();
        let pairs = pair_count(last);
        let mut sorted = last.order;
        sorted[..pairs].sort_unstable();
        let is_permutation = sorted.iter().enumerate().all(|(index, &pair)| index == pair);
        degree == self.settings.fit.degree && 2 * pairs == degree.value() && is_permutation
    }
}

/// Conjugate pairs of lines of the curve, each of which gives the identifier one line.
fn pair_count(last: &MatchedFrame) -> usize {
    last.decomposition.conjugate_pairs(last.decomposition.degree().value()).count()
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::{ClosedOutline, Outline};
    use nalgebra::Point2;

    use super::*;

    #[test]
    fn an_identifier_of_other_lines_than_those_of_the_curve_is_refused() {
        let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
        let point = |angle: f64| {
            let radius = 1.0 + 0.2 * (3.0 * angle).cos();
            Point2::new(2.0 * radius * angle.cos(), radius * angle.sin())
        };
        let outline =
            ClosedOutline::new((0..100).map(|k| point(f64::from(k) * std::f64::consts::TAU / 100.0)).collect());
        pipeline.push(0.0, &Outline::Closed(outline.expect("an outline"))).expect("a frame");
        assert!(Pipeline::from_bytes(&pipeline.to_bytes().expect("memory")).is_ok());
        let (lines, count) = pipeline.last.as_ref().expect("a frame").lines();
        let mut identifier = AdaptiveIdentifier::new(pipeline.identifier.settings().clone()).expect("settings");
        identifier.step(0.0, &lines[..count - 1]).expect("a frame");
        pipeline.identifier = identifier;
        let error = Pipeline::from_bytes(&pipeline.to_bytes().expect("memory")).err();
        assert_eq!(error, Some(StateError::Inconsistent { part: "lines of the identifier" }));
    }
}
