use freeform_curve_fit::{Fit, FitError, Fitter, Normalisation, Normalise, Outline};
use freeform_decompose::{Correspondence, Decomposition, DecompositionError};
use freeform_estimate::MotionEstimate;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, IdentifyError};
use freeform_riccati::{MotionModel, moved_line};
use nalgebra::{Affine2, Matrix3, Point2, Projective2, Translation2};

use crate::{
    adaptive_progress::AdaptiveProgress,
    followed_pose::{FollowedPose, in_working},
    matched_frame::{MatchedFrame, Matches},
    pipeline_error::PipelineError,
    pipeline_settings::PipelineSettings,
    regular_map::are_coordinates,
    rejection::are_many_rejected,
    settling::Settling,
    warning::Warning,
};

/// Share of ambiguous matches that is worth a warning.
const MANY_AMBIGUOUS: f64 = 0.03;
/// Share of intervals over which the lines could not be followed that is worth a warning.
const MANY_NOT_FOLLOWED: f64 = 0.05;
/// RMS radii that the object may go from the origin of the identifier before the origin is moved to it: further out the
/// lines say little of it, as `k` and its noise grow with the distance.
const FAR: f64 = 3.0;

/// What one frame gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameResult {
    /// The fitted curve.
    pub fit: Fit,
    /// Its lines, in image coordinates.
    pub decomposition: Decomposition,
    /// How the pairs of lines were matched to the frame before; `None` in the first frame.
    pub correspondence: Option<Correspondence>,
    /// The motion as identified so far; `None` before the second frame.
    pub estimate: Option<MotionEstimate>,
    /// What the law is doing; `None` as there.
    pub progress: Option<AdaptiveProgress>,
}

/// From outlines to motion, frame by frame: fit, decompose, match, identify.
///
/// Outlines may be in any unit and anywhere: the identifier works in coordinates centred on the first outline, in which
/// the object is about of size 1, as its gains expect. In steady state a frame costs no allocation, but for hidden arcs under
/// affine motion and for projective motion.
///
/// **Projective motion.** The lines that a curve falls into are its asymptotes, and a projective map does not take asymptotes to
/// asymptotes. So every outline is brought onto the first one by iterated closest points, fitted and taken apart there; the
/// lines that the identifier follows are those, moved to the image by the same map.
#[derive(Debug, Clone)]
pub struct Pipeline {
    pub(crate) settings: PipelineSettings,
    pub(crate) fitter: Fitter,
    pub(crate) identifier: AdaptiveIdentifier,
    /// From the coordinates of the identifier to those of the image; `None` before the first good frame.
    pub(crate) image_from_identifier: Option<Affine2<f64>>,
    /// From the coordinates that the identifier had at the start to its present ones.
    pub(crate) identifier_from_start: Translation2<f64>,
    pub(crate) last: Option<MatchedFrame>,
    /// Of an object that is followed affinely or projectively.
    pub(crate) pose: Option<FollowedPose>,
    pub(crate) frames: usize,
    pub(crate) frames_rejected: usize,
    /// Frames whose curve has (nearly) coincident lines.
    pub(crate) without_separate_lines: usize,
    pub(crate) matches: Matches,
    pub(crate) settling: Settling,
}

impl Pipeline {
    /// A pipeline that has seen nothing yet.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: PipelineSettings) -> Result<Self, PipelineError> {
        settings.check()?;
        Ok(Self {
            fitter: Fitter::new(settings.fit)?,
            identifier: AdaptiveIdentifier::new(settings.identify.clone())?,
            image_from_identifier: None,
            identifier_from_start: Translation2::identity(),
            settings,
            last: None,
            pose: None,
            frames: 0,
            frames_rejected: 0,
            without_separate_lines: 0,
            matches: Matches::default(),
            settling: Settling::default(),
        })
    }

    /// Takes the next outline of the object, at `time` in seconds. After an error the pipeline is as if the frame had
    /// been missing, and counts it as rejected.
    ///
    /// # Errors
    /// Time that does not advance, an outline that cannot be fitted, decomposed or matched.
    pub fn push(&mut self, time: f64, outline: &Outline) -> Result<FrameResult, PipelineError> {
        self.frames += 1;
        let result = self.take(time, outline);
        self.frames_rejected += usize::from(result.is_err());
        self.without_separate_lines += usize::from(result.as_ref().is_err_and(has_no_separate_lines));
        result.map(|result| FrameResult { estimate: self.estimate(), ..result })
    }

    fn take(&mut self, time: f64, outline: &Outline) -> Result<FrameResult, PipelineError> {
        let (fit, pose) = self.fit(time, outline)?;
        let normalisation = fit.normalisation();
        let working = decomposed(&fit)?;
        let image_from_identifier = match self.image_from_identifier {
            Some(known) => known,
            None => self.start_at(normalisation)?,
        };
        let image_from_working = normalisation.image_from_working();
        let decomposition = working.moved(&image_from_working)?;
        let (there, radius) = match &pose {
            // Where the first outline was: those are the working coordinates of the first frame.
            Some(pose) if self.is_projective() => (self.decomposed_in(outline, pose)?, 1.0),
            None if self.is_projective() => (working, 1.0),
            _ => (working.moved(&(image_from_identifier.inverse() * image_from_working))?, self.settings.size),
        };
        let (matched, correspondence) = MatchedFrame::after(self.last.as_ref(), there, radius)?;
        let (mut lines, count) = matched.lines();
        if self.is_projective() {
            let image = pose.unwrap_or_else(|| nalgebra::convert(image_from_working));
            let identifier_from_there =
                nalgebra::convert::<_, Projective2<f64>>(image_from_identifier.inverse()) * image;
            for line in &mut lines[..count] {
                *line = moved_line(line, &identifier_from_there)?.0;
            }
        }
        self.identifier.step(time, &lines[..count])?;
        self.image_from_identifier = Some(image_from_identifier);
        self.last = Some(matched);
        self.remember_pose(time, outline, normalisation, pose);
        self.matches.take(correspondence.as_ref());
        let start_from_identifier = nalgebra::convert(self.identifier_from_start.inverse());
        let at_start = self.identifier.estimate().map(|estimate| estimate.in_coordinates(&start_from_identifier));
        self.settling.take(time, at_start);
        let progress = self.progress(image_from_identifier);
        self.follow(&normalisation.centre, image_from_identifier);
        Ok(FrameResult { fit, decomposition, correspondence, estimate: None, progress })
    }

    /// Fits a curve to an outline. Arcs of one that is followed affinely have no area moments to normalise them by: they are brought
    /// to the pose at which they lie on the outline of the frames before, which fills in what is hidden. Where that was
    /// never seen whole, they are fitted in its coordinates as they are. Also returns the pose, if it was looked for.
    fn fit(&mut self, time: f64, outline: &Outline) -> Result<(Fit, Option<Projective2<f64>>), FitError> {
        let arcs = match (self.settings.fit.normalise, outline) {
            (_, Outline::Closed(_)) if self.is_projective() => {
                let pose = self
                    .pose
                    .as_ref()
                    .map(|followed| followed.found(outline, &self.flow(followed.seconds_until(time))));
                return Ok((self.fitter.fit(outline)?, pose));
            }
            (Normalise::Affine, Outline::Open(arcs)) => arcs,
            _ => return Ok((self.fitter.fit(outline)?, None)),
        };
        let Some(followed) = &self.pose else {
            // The first frame: any coordinates will do that later frames are brought to.
            let first = Normalisation::similarity(outline.centroid(), outline.rms_radius());
            return Ok((self.fitter.fit_in(outline, &first.image_from_working())?, None));
        };
        let pose = followed.found(outline, &self.flow(followed.seconds_until(time)));
        let fit = match followed.completed(arcs, &pose) {
            Some(whole) => self.fitter.fit(&Outline::Closed(whole)),
            None => self.fitter.fit_in(outline, &affine_about_origin(&pose)),
        };
        Ok((fit?, Some(pose)))
    }

    /// The lines of an outline at a pose, in the coordinates that the pose takes to the image. What is hidden is filled in from the
    /// outline of the frames before.
    fn decomposed_in(&mut self, outline: &Outline, pose: &Projective2<f64>) -> Result<Decomposition, PipelineError> {
        let completed = match (&self.pose, outline) {
            (Some(followed), Outline::Open(arcs)) => followed.completed(arcs, pose).map(Outline::Closed),
            _ => None,
        };
        let there = in_working(completed.as_ref().unwrap_or(outline), pose)?;
        let fit = match there {
            Outline::Closed(_) => self.fitter.fit(&there)?,
            Outline::Open(_) => self.fitter.fit_in(&there, &Affine2::identity())?,
        };
        Ok(decomposed(&fit)?.moved(&fit.normalisation().image_from_working())?)
    }

    fn progress(&self, image_from_identifier: Affine2<f64>) -> Option<AdaptiveProgress> {
        Some(AdaptiveProgress {
            diagnostics: self.identifier.diagnostics()?,
            estimate: self.identifier.estimate()?,
            identifier_from_image: image_from_identifier.inverse(),
        })
    }

    fn is_projective(&self) -> bool {
        self.settings.identify.model == MotionModel::Projective
    }

    fn remember_pose(
        &mut self,
        time: f64,
        outline: &Outline,
        normalisation: &Normalisation,
        pose: Option<Projective2<f64>>,
    ) {
        let model = self.settings.identify.model;
        let follows = model == MotionModel::Projective || self.settings.fit.normalise == Normalise::Affine;
        match (&mut self.pose, pose) {
            _ if !follows => {}
            (Some(followed), Some(pose)) => followed.at(time, pose),
            (followed, _) => *followed = Some(FollowedPose::new(follow_by(model), time, outline, normalisation)),
        }
    }

    /// How the motion as identified so far moves the image in so many seconds; not at all before it is known.
    fn flow(&self, seconds: f64) -> Projective2<f64> {
        self.identified().map_or(Projective2::identity(), |found| found.model().flow(found.values(), seconds))
    }

    /// Sets up the identifier in coordinates centred on the first outline and, where the motion is affine, moved to its circle of
    /// inertia: the slopes of lines of a slender object swing far out.
    fn start_at(&mut self, first: &Normalisation) -> Result<Affine2<f64>, IdentifyError> {
        let unit = Normalisation { radius: first.radius / self.settings.size, ..*first };
        let map = match self.settings.identify.model {
            MotionModel::Affine | MotionModel::Projective => unit.image_from_working(),
            _ => Normalisation::similarity(unit.centre, unit.radius).image_from_working(),
        };
        let AdaptiveSettings { model, initial_values, .. } = &self.settings.identify;
        if !initial_values.is_empty() {
            let moved = MotionEstimate::new(*model, initial_values, None).in_coordinates(&map.inverse());
            let initial_values = moved.values().to_vec();
            self.identifier =
                AdaptiveIdentifier::new(AdaptiveSettings { initial_values, ..self.settings.identify.clone() })?;
        }
        Ok(map)
    }

    /// Moves the origin of the identifier to an object that went far from it.
    fn follow(&mut self, centre: &Point2<f64>, image_from_identifier: Affine2<f64>) {
        let origin = (image_from_identifier.inverse() * centre).coords;
        let moved = nalgebra::convert::<_, Affine2<f64>>(Translation2::from(origin));
        let Some(last) = self.last.as_mut().filter(|_| origin.norm() > FAR * self.settings.size) else { return };
        let (to_image, shift) =
            (image_from_identifier * moved, Translation2::from(-origin) * self.identifier_from_start);
        if !are_coordinates(&to_image, &shift) {
            return;
        }
        // Those of a projective motion are where the first outline was.
        if self.settings.identify.model != MotionModel::Projective {
            // Lines that cannot be told in the new coordinates stay in the old.
            let Ok(decomposition) = last.decomposition.moved(&moved.inverse()) else { return };
            last.decomposition = decomposition;
        }
        self.identifier.shift_origin(origin);
        self.identifier_from_start = shift;
        self.image_from_identifier = Some(to_image);
    }

    /// The motion as identified so far, in the image frame; `None` before the lines were followed from one frame to the
    /// next. Parameters of which the
    /// outlines tell nothing are marked unobservable: all of them for a circle.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        let identified = self.identified();
        if self.frames < 2 || 2 * self.without_separate_lines <= self.frames {
            return identified;
        }
        let model = self.settings.identify.model;
        let count = model.parameter_count();
        let nothing = [0.0; MotionModel::MAX_PARAMETERS];
        let estimate = identified.unwrap_or_else(|| MotionEstimate::new(model, &nothing[..count], None));
        Some((0..count).fold(estimate, MotionEstimate::with_unobservable))
    }

    /// What the identifier says, in the image frame.
    fn identified(&self) -> Option<MotionEstimate> {
        let map = self.image_from_identifier.as_ref()?;
        Some(self.identifier.estimate()?.in_coordinates(map))
    }

    /// Its settings.
    #[must_use]
    pub fn settings(&self) -> &PipelineSettings {
        &self.settings
    }

    /// The identifier, for its diagnostics. Its estimate is in its own coordinates, not in those of the image.
    #[must_use]
    pub fn identifier(&self) -> &AdaptiveIdentifier {
        &self.identifier
    }

    /// Frames taken, rejected ones included.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Frames that gave nothing.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.frames_rejected
    }

    /// What a user should know of the result.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let unobservable: Vec<_> = self.estimate().map_or(Vec::new(), |estimate| {
            estimate.parameters().filter(|p| p.value.is_none()).map(|p| p.name).collect()
        });
        if !unobservable.is_empty() {
            warnings.push(Warning::RotationNotObservable { parameters: unobservable });
        }
        let (rejected, frames) = (self.frames_rejected, self.frames);
        if are_many_rejected(rejected, frames) {
            warnings.push(Warning::FramesRejected { rejected, frames });
        }
        let intervals = self.identifier.frames().saturating_sub(1);
        let skipped = intervals - self.identifier.intervals_followed();
        if skipped as f64 > MANY_NOT_FOLLOWED * intervals as f64 {
            warnings.push(Warning::LinesNotFollowed { skipped, intervals });
        }
        let Matches { ambiguous, all: matched } = self.matches;
        if ambiguous as f64 > MANY_AMBIGUOUS * matched as f64 {
            warnings.push(Warning::AmbiguousCorrespondence { ambiguous, matched });
        }
        let settles_slowly = self.identifier.settings().law != AdaptiveLaw::FilteredLeastSquares;
        if let Some(seconds) = self.settling.unsettled()
            && settles_slowly
        {
            warnings.push(Warning::MayNotHaveSettled { seconds });
        }
        let PipelineSettings { fit, identify, .. } = &self.settings;
        let is_biased = identify.model == MotionModel::Affine && fit.normalise == Normalise::Similarity;
        if is_biased && self.identifier.intervals_followed() > 0 {
            warnings.push(Warning::AffineBias);
        }
        warnings
    }
}

/// The family that the pose of an object is followed in where its motion is identified in another: affine at least, since that is
/// what outlines are normalised by.
pub(crate) fn follow_by(model: MotionModel) -> MotionModel {
    model.max(MotionModel::Affine)
}

/// The lines of a fitted curve in its working coordinates, where it is decomposed best.
fn decomposed(fit: &Fit) -> Result<Decomposition, PipelineError> {
    let Some(curve) = fit.bounded_working() else {
        return Err(PipelineError::NotBounded { margin: fit.diagnostics().boundedness_margin });
    };
    Ok(Decomposition::of(curve.polynomial())?)
}

/// The affine map that is nearest to a map about the origin.
fn affine_about_origin(map: &Projective2<f64>) -> Affine2<f64> {
    let m = map.matrix();
    let [x, y] = [m[(0, 2)] / m[(2, 2)], m[(1, 2)] / m[(2, 2)]];
    let by = |image: f64, row: usize, column: usize| (m[(row, column)] - image * m[(2, column)]) / m[(2, 2)];
    let matrix = Matrix3::new(by(x, 0, 0), by(x, 0, 1), x, by(y, 1, 0), by(y, 1, 1), y, 0.0, 0.0, 1.0);
    Affine2::from_matrix_unchecked(matrix)
}

/// Whether a frame was refused because its lines nearly coincide, as those of a circle do.
fn has_no_separate_lines(error: &PipelineError) -> bool {
    use DecompositionError::{CircularLeadingForm, NearDoubleLines};
    matches!(error, PipelineError::Decomposition(CircularLeadingForm { .. } | NearDoubleLines { .. }))
}
