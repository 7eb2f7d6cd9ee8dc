use std::sync::Arc;

use freeform_curve_fit::Outline;
use freeform_estimate::ProcessNoise;
use freeform_riccati::{MotionModel, ParameterVector};
use nalgebra::{Affine2, Matrix3, Projective2, SVector};

use super::{
    Comparison, Outcome,
    body_frame::BodyFrame,
    first_pose::{FirstOutline, FirstPose},
    shape_change::EarlyShape,
    turn_profile::TurnProfile,
    usual_agreement::UsualAgreement,
};
use crate::{
    belief::Belief,
    dynamics::{CentredDeviations, CentredPose, FamilyTests, Summary},
    map::{NullDirections, OutlineMap, TurnEvent, TurnEvidence},
    measurement::{
        Counted, Frame, NegativeLogLikelihood, NoiseModel, Reference, ShownCorrelation, TakenOff, Tolerance, View,
        correlation_of,
    },
    prediction::{ByKind, ShapeNoise, TimeOfChange},
    tuning::{map::FEWEST_POINTS, noise as of_noise, update as tuning, usual_agreement},
    update::{
        FrameMeasurement, Gate, Linearisations, PoseMeasurement, Rejection, Sensitivity, commit, hold, left_by_offsets,
    },
};

/// One object: its outline, where it is, how it moves, and how well all of it is known.
///
/// A frame goes one way: loaded into a [`Frame`], then [`Track::update`]: solved for a proposal ([`View::solve`], which associates and linearises,
/// [`View::measure_by_columns`], until the pose settles), judged ([`Track::verdict`]), committed ([`commit`]); then the map grows by what is new.
/// Copies share the map until one of them changes it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Track {
    pub(super) reference: Reference,
    pub(super) map: Arc<OutlineMap>,
    pub(super) belief: Belief,
    pub(super) noise: NoiseModel,
    pub(super) shape: ShapeNoise,
    pub(super) early_shape: EarlyShape,
    pub(super) usual: UsualAgreement,
    /// Whether frames tell a turn that the outline hardly shows.
    pub(super) turn_profile: TurnProfile,
    /// What all poses have in error since the object was lost.
    pub(super) body_frame: BodyFrame,
    /// What the model leaves out.
    pub(super) sensitivity: Sensitivity,
    pub(super) family: FamilyTests,
    /// The pose that it was begun in.
    pub(super) first_pose: FirstPose,
    /// Frames taken.
    pub(super) frames: usize,
    /// Of these, those that had been taken when cells were added last.
    pub(super) frames_before_cells: usize,
}

impl Track {
    /// One of what an outline shows, its motion unknown. Outliers and missing arcs are allowed for. Points of masks are
    /// off by as much as the rounding to their pixels, of a size in image lengths, whatever they show; with a size of 0 it is found from the
    /// points. `None` for fewer than 8 points, or points that make no contour.
    pub(crate) fn begin(model: MotionModel, outline: &Outline, mask_pixel: f64, frame: &mut Frame) -> Option<Self> {
        if outline.point_count() < FEWEST_POINTS {
            return None;
        }
        let mut reference = Reference::of(outline);
        frame.load(outline, reference);
        reference.update_stated(frame.deviations.good());
        let contours = frame.contours(&Matrix3::identity());
        let rounding = Self::rounding_of(outline, mask_pixel, &contours, reference.radius);
        let mut track = Self::cut(model, reference, Matrix3::identity(), contours, rounding, frame)?;
        track.first_pose.outline = FirstOutline::of(outline);
        Some(track)
    }

    /// Moves on by `seconds` of the estimated motion, which may have changed meanwhile by the process noise. False, and nothing changes, where that
    /// leads to a pose that [does not show](OutlineMap::is_shown_in) the outline: it is not known where the object is.
    #[must_use]
    pub(crate) fn predict(&mut self, seconds: f64) -> bool {
        let Self { map, belief, .. } = self;
        let Some(transition) = belief.predict(seconds, |pose| map.is_shown_in(pose)) else { return false };
        self.sensitivity.predict(&transition, self.belief.parameter_count(), seconds);
        self.shape.forget_shape(&mut self.belief);
        true
    }

    /// Whether its pose shows its outline.
    pub(crate) fn is_shown(&self) -> bool {
        self.map.is_shown_in(&self.belief.pose)
    }

    pub(crate) fn add_process_noise(&mut self, noise: &ProcessNoise, seconds: f64) {
        let variance = self.noise.effective_variance();
        // Variances of a motion grow with the square of the unit, and with time itself.
        let of_unit = self.reference.time_unit.powi(3);
        self.belief.add_process_noise(noise, seconds * of_unit, self.reference.radius, variance);
    }

    /// Lets the motion have changed during the last step by variances per second of its rates and of the velocity of the centroid.
    pub(crate) fn add_change(&mut self, variances: ByKind, time: TimeOfChange) {
        let variance = self.noise.effective_variance();
        self.belief.add_change((variances, time), &self.map.centroid(), variance);
    }

    /// Sets pose and motion to the combined prediction of the hypotheses of dynamics, and adds its covariance.
    pub(crate) fn expect(&mut self, expected: &Summary) {
        // By no more than is beyond doubt of the correlation, so that what is expected is never taken to be known too well: with the stated variance the
        // poses of bodies that swing in next to no noise were more than four deviations off in 15 of 668 frames.
        let variance = self.noise.effective_variance();
        self.belief.pose = expected.pose;
        self.belief.motion = expected.motion;
        self.belief.add_covariance(&(expected.covariance / variance));
    }

    /// Takes a unit of time, in seconds, before anything is known of the motion.
    pub(crate) fn set_time_unit(&mut self, seconds: f64) {
        self.reference.time_unit = seconds;
    }

    /// The pose, with the object's centroid in it.
    pub(crate) fn centred_pose(&self) -> CentredPose {
        CentredPose { pose: self.belief.pose, centroid: self.map.centroid() }
    }

    /// A pose over the noise, which its own points have told of as well, by (64a) in docs/motion-filter.md. What cells leave of an outline that shows
    /// no turn is off alike in all directions.
    fn over_noise(&self, measured: &PoseMeasurement) -> PoseMeasurement {
        let (variance, inflation) = (self.noise.stated_variance(), self.noise_over_comparable().powi(-2));
        if self.turn_is_unseen() {
            measured.over(variance * inflation, 1.0)
        } else {
            measured.over(variance, inflation)
        }
    }

    /// Variance that poses are compared by, (38) in docs/motion-filter.md.
    pub(super) fn comparable_variance(&self) -> f64 {
        self.view().comparable_noise().powi(2) * self.noise.stated_correlation()
    }

    /// Its noise over the least that poses are compared by, (38) in docs/motion-filter.md: at most 1.
    pub(crate) fn noise_over_comparable(&self) -> f64 {
        self.noise.sigma / self.view().comparable_noise()
    }

    /// What its outline does not show.
    pub(crate) fn null_directions(&self) -> NullDirections {
        self.map.null_directions(self.belief.model, &self.belief.pose)
    }

    /// Measures the loaded outline, and updates the track by it if the gate lets it through; otherwise nothing changes.
    pub(crate) fn update(&mut self, frame: &mut Frame, gate: &Gate, comparison: Comparison) -> Outcome {
        let (view, radius) = (self.view(), self.reference.radius);
        let null = self.map.null_directions(self.belief.model, &self.belief.pose);
        let hold = hold(&self.belief, &self.map, &null);
        let proposal = match view.solve(frame, &null, hold.as_ref(), Linearisations::UntilSettled) {
            Ok(proposal) => proposal,
            Err(iterations) => return Outcome::unsolved(FrameMeasurement::unsolved(iterations), gate),
        };
        let variance = self.comparable_variance();
        let innovation = self.innovation_of(&proposal, hold.as_ref(), variance);
        let mut likelihood = NegativeLogLikelihood::default();
        if comparison == Comparison::Asked {
            likelihood = view.negative_log_likelihood(frame, proposal.state.as_slice());
            // No more than a motion has that goes on as it was: another says nothing of the turn.
            likelihood.of_path = innovation.squared.min(tuning::SUDDEN * self.model().parameter_count() as f64);
        }
        let (measurement, limit) = view.compare(frame, &proposal, innovation.squared, radius);
        // Points that do not move show none of what they are rounded by.
        let rounding = self.noise.rounding().of_point();
        let noise = measurement.noise.map(|noise| measurement.of_good_points(noise));
        let known_noise = noise.map(|noise| (noise / radius).max(rounding));
        let by_pose = innovation.degrees_of_freedom;
        let taken = TakenOff { by_pose, left_by_offsets: left_by_offsets(&self.belief, frame) };
        let correlation = correlation_of(frame, known_noise, taken);
        let is_settled = proposal.last_step <= self.view().moved_by(tuning::UNSETTLED);
        let verdict = if is_settled { self.verdict(gate, &measurement) } else { Err(Rejection::NotFound) };
        let verdict = self.verdict_if_grown((gate, &measurement), (frame, &proposal.pose), verdict);
        let shows_outline = matches!(verdict, Ok(()) | Err(Rejection::InnovationTooLarge { .. }));
        let measured = shows_outline.then(|| PoseMeasurement::of(&self.belief, &proposal, frame));
        let (mut shift, mut doubt, mut forgotten) = (SVector::zeros(), None, NullDirections::default());
        if let Some(measured) = measured.filter(|_| verdict.is_ok()) {
            let is_asked = measurement.agreement < usual_agreement::ALL_AGREE;
            let weakest = is_asked.then(|| self.view().weakest_agreement(frame, &limit));
            self.frames += 1;
            self.look_for_unmodelled_motions(frame, (&proposal, hold.as_ref()), &measured, variance);
            commit(&proposal, frame, (&mut self.belief, &mut self.noise, &mut self.shape));
            self.belief.memory.take_frame();
            doubt = self.doubt_of_agreement(measurement.agreement, weakest, frame.points.len());
            self.record_runs(frame);
            self.look_for_change_of_shape(frame);
            self.renew_centroid();
            shift = self.common_shift(frame);
            self.learn_noise(frame, (noise.map(|noise| noise / radius), correlation), measurement.weight);
            if measurement.new_points >= tuning::FEWEST_NEW_POINTS && self.knows_place_of_new() {
                let contours = frame.contours(&self.belief.pose);
                forgotten = self.grow_along(contours, frame);
            }
        }
        let pose = measured.map(|measured| self.over_noise(&measured));
        let rounding = pose.as_ref().map_or_else(CentredDeviations::zeros, |_| self.rounding_of_pose());
        Outcome { measurement, verdict, innovation, pose, rounding, shift, forgotten, doubt, likelihood }
    }

    /// The verdict of a gate, whose limit on the noise is [`widened`](Self::widened) where outlines do what the motion model leaves out.
    pub(super) fn verdict(&self, gate: &Gate, measurement: &FrameMeasurement) -> Result<(), Rejection> {
        let verdict = gate.verdict(measurement);
        let Some(largest) = gate.largest_noise.filter(|_| matches!(verdict, Err(Rejection::NoiseTooLarge { .. })))
        else {
            return verdict;
        };
        let widened = self.widened(largest / self.reference.radius) * self.reference.radius;
        Gate { largest_noise: Some(widened.max(largest)), ..*gate }.verdict(measurement)
    }

    /// The most noise that is tolerated, normalised, with what outlines have been seen to be displaced by beside their motion, or by a change
    /// of shape. Noise and displacement are independent, so that their squares add up; all of the displacement is allowed for, since it may
    /// differ from frame to frame.
    fn widened(&self, largest: f64) -> f64 {
        let displacement = self.unmodelled_estimate().displacement_of_points();
        largest.hypot(of_noise::LARGEST_RATIO * displacement).min(of_noise::LARGEST).max(largest)
    }

    /// Updates the noise by that of good points in an accepted frame and its correlation, as far as they are told, the frame counting for a
    /// share of one of good points.
    fn learn_noise(
        &mut self,
        frame: &Frame,
        (noise, correlation): (Option<f64>, Option<ShownCorrelation>),
        share: f64,
    ) {
        if self.noise.is_seen_in_one_place() && self.displacement_from(&self.first_pose.pose) > of_noise::ANOTHER_PLACE
        {
            self.noise.see_elsewhere();
        }
        if let Some(noise) = noise {
            self.noise.update(noise, share);
        }
        if let Some(shown) = correlation {
            self.noise.update_correlation(&shown, share);
        }
        self.reference.update_stated(frame.deviations.good());
        if frame.deviations.ratios().is_some() {
            self.noise.counted = Counted::ByDeviation;
        }
    }

    /// Records the spread of a frame, used or not.
    pub(crate) fn record_spread(&mut self, measurement: &FrameMeasurement) {
        self.record_normalised_spread(measurement.of_good_points(measurement.spread) / self.reference.radius);
    }

    /// As [`record_spread`](Self::record_spread), of good points, normalised.
    pub(crate) fn record_normalised_spread(&mut self, spread: f64) {
        self.noise.record_spread(spread);
    }

    /// Adopts the noise of another track: it is the same whatever the pose.
    pub(crate) fn adopt_noise_of(&mut self, other: &Self) {
        self.noise.sigma = other.noise.sigma;
    }

    pub(crate) fn set_tolerance(&mut self, tolerance: Tolerance) {
        self.noise.tolerance = tolerance;
    }

    /// Whether a frame may have more noise where that is relaxed: once frames have been compared they say how much.
    pub(crate) fn tolerates_more_relaxed(&self) -> bool {
        self.noise.tolerated_where(Tolerance::Relaxed) > self.noise.tolerated_where(Tolerance::Known)
    }

    /// Most noise of good points that a search may tolerate, normalised; infinite where points state deviations of their own, since good points
    /// are then judged by others.
    pub(crate) fn most_noise_tolerated(&self) -> f64 {
        if self.reference.stated.is_finite() {
            return f64::INFINITY;
        }
        let of_search = [Tolerance::Known, Tolerance::Relaxed].map(|tolerance| self.noise.tolerated_where(tolerance));
        self.widened(of_search.into_iter().fold(self.largest_noise() / self.reference.radius, f64::max))
    }

    /// As [`most_noise_tolerated`](Self::most_noise_tolerated), of frames with no more noise than those that have been taken.
    pub(crate) fn usual_noise_tolerated(&self) -> f64 {
        if self.reference.stated.is_finite() {
            return f64::INFINITY;
        }
        self.widened(of_noise::LARGEST_RATIO * self.noise.sigma.max(of_noise::NEVER_TOO_MUCH * self.map.spacing()))
    }

    /// Most noise of good points in a frame that shows the outline, image lengths.
    pub(crate) fn largest_noise(&self) -> f64 {
        self.view().largest_noise(self.reference.radius)
    }

    /// Puts the object into a new pose some time later, and forgets motion and pose, keeping the outline.
    pub(crate) fn relocate(&mut self, pose: Matrix3<f64>, seconds: f64) {
        self.belief.relocate(pose);
        self.turn_profile = TurnProfile::default();
        self.sensitivity.relocate(seconds, self.belief.parameter_count());
    }

    /// Takes a motion for granted that a step was made by, as long as nothing else is known. Of motions that differ in null directions
    /// it is the one without them: the object is not known to turn or slide in ways that its outline does not show.
    pub(crate) fn set_motion(&mut self, motion: ParameterVector) {
        self.belief.motion = motion;
        self.map.null_directions(self.belief.model, &self.belief.pose).subtract_from(&mut self.belief.motion);
    }

    /// All that a frame is measured against.
    pub(crate) fn view(&self) -> View<'_> {
        View { map: &self.map, belief: &self.belief, noise: &self.noise }
    }

    pub(crate) fn model(&self) -> MotionModel {
        self.belief.model
    }

    /// Whether it was begun with an outline.
    pub(crate) fn is_begun_with(&self, outline: &Outline) -> bool {
        let Reference { origin, radius, .. } = Reference::of(outline);
        (self.reference.origin, self.reference.radius) == (origin, radius)
    }

    pub(crate) fn map(&self) -> &Arc<OutlineMap> {
        &self.map
    }

    pub(crate) fn noise(&self) -> &NoiseModel {
        &self.noise
    }

    pub(crate) fn belief(&self) -> &Belief {
        &self.belief
    }

    pub(crate) fn reference(&self) -> Reference {
        self.reference
    }

    /// The pose, body to image, in normalised coordinates.
    pub(crate) fn body_pose(&self) -> &Matrix3<f64> {
        &self.belief.pose
    }

    /// The pose that it was begun in, body to image, in normalised coordinates.
    pub(crate) fn first_body_pose(&self) -> &Matrix3<f64> {
        &self.first_pose.pose
    }

    /// The map of the image that has moved the first frame's outline to where it is now.
    pub(crate) fn pose(&self) -> Projective2<f64> {
        let to_image = self.reference.to_image();
        let inverse = to_image.try_inverse().unwrap_or_else(Matrix3::identity);
        Projective2::from_matrix_unchecked(to_image * self.belief.pose * inverse)
    }

    /// The pose as an affine map; `None` if it is not affine.
    pub(crate) fn affine_pose(&self) -> Option<Affine2<f64>> {
        nalgebra::try_convert(self.pose())
    }

    /// Number of cells of the map.
    pub(crate) fn cell_count(&self) -> usize {
        self.map.cells().len()
    }

    /// Deviation of the noise, normalised.
    pub(crate) fn sigma(&self) -> f64 {
        self.noise.sigma
    }

    #[cfg(test)]
    pub(crate) fn set_noise(&mut self, sigma: f64) {
        self.noise.sigma = sigma;
    }

    /// Whether neither the outline nor the frames show the turn.
    pub(crate) fn turn_is_unseen(&self) -> bool {
        self.map.turn_is_unseen(self.belief.model)
    }

    pub(crate) fn turn_evidence(&self) -> TurnEvidence {
        self.map.turn_evidence()
    }

    /// After a frame that has not shown the turn: marks it as not observable.
    pub(crate) fn hide_turn(&mut self) {
        if !self.turn_is_unseen() {
            Arc::make_mut(&mut self.map).hide_turn(self.belief.model, self.belief.known_offsets());
        }
    }

    /// Undoes [`hide_turn`](Self::hide_turn), so that it can be asked anew whether the turn is seen.
    pub(crate) fn show_turn(&mut self) {
        if self.turn_evidence().is_hidden() {
            Arc::make_mut(&mut self.map).show_turn(self.belief.model, self.belief.known_offsets());
        }
    }

    /// Records that one frame alone has shown the turn so far, or that another has.
    pub(crate) fn record_turn(&mut self, event: TurnEvent) {
        let evidence = self.turn_evidence();
        if evidence.after(event) != evidence {
            Arc::make_mut(&mut self.map).record_turn(event);
        }
    }

    /// Whether a frame may show the turn where those before it did not.
    pub(crate) fn may_show_turn(&self) -> bool {
        matches!(self.turn_evidence(), TurnEvidence::AtLast | TurnEvidence::NewAndHidden(_))
    }
}
