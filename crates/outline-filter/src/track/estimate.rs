//! What a track says of the motion.
use freeform_estimate::{MotionEstimate, MotionState, NormalisedState, is_worth};
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterKind, ParameterVector, logarithm, map_point};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Point2, SVector, Vector2};

use super::Track;
use crate::{
    belief::{StateMatrix, StateVector, scaled_inverse},
    dynamics::{
        CentredDeviations, CentredPose, Dynamics, DynamicsFilter, Summary, UnmodelledEstimate, centred_order,
        is_beyond_linear,
    },
    map::{CLOCKWISE, NullDirection},
    prediction::PoseMatrix,
    tuning::{
        null_space::{HANGS_ON, TAKES_PART, TURNS_WITH},
        statement::{ROUNDING_OF_CORRELATION, SHIFT_BY_LIGHT},
        supervisor::STEPS_KNOWN,
        turn_hypotheses::DIFFERENT,
        update::SUDDEN,
    },
    update::{EDGES, SHEAR, hold, with_hold},
};

/// What tells the turn of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnTold {
    ByOutline,
    /// The path of its centroid too, as a constant generator has it.
    ByPath,
}

/// How far the turn of a pose is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnOfPose {
    AsTheOutlineShows,
    /// Other turns explain the frames as well: how far the object has turned is not known.
    Ambiguous,
}

impl Track {
    /// What is believed of pose and motion counted from the body frame, wherever that lies, normalised; `None` where the covariance cannot be
    /// computed.
    pub(crate) fn summary_in_body_frame(&self) -> Option<Summary> {
        self.summary_by(&self.belief.marginal)
    }

    pub(super) fn summary_by(&self, marginal: &StateMatrix) -> Option<Summary> {
        let belief = &self.belief;
        let covariance = scaled_inverse(marginal, belief.parameter_count())? * self.noise.stated_variance();
        let is_finite = covariance.iter().all(|e| e.is_finite());
        is_finite.then_some(Summary { pose: belief.pose, motion: belief.motion, covariance })
    }

    /// Deviations along each axis, normalised, of what a shift of the whole outline makes of its place since the first frame, and of the velocity of
    /// its plane, as far as light from a side may displace edges: that shifts the outline besides, by as much in the picture while the object turns.
    pub(crate) fn shift_by_light(&self, unmodelled: &UnmodelledEstimate) -> [f64; 2] {
        // Of an outline that is nearly round stretch and skew are hardly told from it. Of others this is too wide where a plane is tilted.
        let moment = |numbers: [usize; 2]| numbers.into_iter().map(|l| unmodelled.moments[(l, l)]).sum::<f64>();
        let second_harmonic = moment(EDGES).max(moment(SHEAR)).max(0.0).sqrt();
        let linear = self.belief.pose.fixed_view::<2, 2>(0, 0);
        let rates = self.model().generator(&self.belief.motion[..self.belief.parameter_count()]);
        // The mean square of `C s` over the directions of s is `|C|^2 s^2 / 2`, half of it along each axis.
        let of_shift = |change: Matrix2<f64>| 0.5 * change.norm() * SHIFT_BY_LIGHT * second_harmonic;
        [of_shift(Matrix2::identity() - linear), of_shift(rates.fixed_view::<2, 2>(0, 0).into_owned())]
    }

    /// What errors of the whole outline, of sizes in image lengths for poses and motions, and of their own in every frame, make of pose and motion:
    /// deviations about the centroid, normalised. Over the `span` that the motion is known from they may change by as much as they are.
    pub(crate) fn systematic(&self, sizes: [f64; 2], span: f64) -> [CentredDeviations; 2] {
        if sizes.iter().all(|size| *size <= 0.0) {
            return [CentredDeviations::zeros(); 2];
        }
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let cells = self.map.cells();
        let mut levers = [0.0; MAX_PARAMETERS];
        for cell in cells {
            let along = model.normal_velocities(&(cell.centre - self.map.centroid().coords), &cell.normal);
            levers.iter_mut().zip(along).for_each(|(sum, v)| *sum += v * v / cells.len() as f64);
        }
        let [pose, motion] = sizes.map(|size| size / self.reference.radius).map(|size| {
            CentredDeviations::from_fn(|j, _| {
                let lever = if j < k { levers[centred_order(model)[j]].sqrt() } else { 0.0 };
                // Half of an error of one side is a shift; what an outline hardly shows may be anything.
                if lever > 0.0 { (0.5 * size / lever).min(1.0) } else { 0.0 }
            })
        });
        [pose, motion * (std::f64::consts::SQRT_2 / span)]
    }

    /// Time that the motion is known from, in the filter's unit; positive. It is that of as many steps as the hypotheses of dynamics remember, and
    /// without them that of a constant generator, which is shorter where only that changes.
    pub(crate) fn span_of_motion(&self, steps: Option<f64>) -> f64 {
        let memory = &self.belief.memory;
        let shortest = match steps {
            Some(steps) => memory.span.min(steps * memory.step),
            None => memory.shortest(self.belief.parameter_count()),
        };
        shortest.max(memory.step.min(memory.span)).max(f64::MIN_POSITIVE)
    }

    /// Whether the object is known to be at rest: its squared motion in its covariance is that of none, and a deviation of it moves the outline over
    /// a step by less than the noise of its points.
    pub(crate) fn is_known_to_rest(&self) -> bool {
        let k = self.belief.parameter_count();
        let Some(summary) = self.summary_in_body_frame() else { return false };
        let covariance = DMatrix::from_fn(k, k, |i, j| summary.covariance[(k + i, k + j)]);
        let over_step = PoseMatrix::from_fn(|i, j| if i < k && j < k { covariance[(i, j)] } else { 0.0 })
            * self.belief.memory.step.powi(2);
        let motion = DVector::from_fn(k, |i, _| summary.motion[i]);
        let squared = covariance.cholesky().map(|factor| motion.dot(&factor.solve(&motion)));
        squared.is_some_and(|squared| squared <= SUDDEN * k as f64)
            && self
                .farthest_displacement(&over_step)
                .is_some_and(|displacement| displacement * self.belief.scale() < self.noise.sigma)
    }

    /// What is believed, and would be if the outline were known, with null directions taken to be none, and known.
    pub(super) fn held_summaries(&self, null: &[NullDirection]) -> Option<[Summary; 2]> {
        let belief = &self.belief;
        let hold = hold(belief, &self.map, null);
        let held = |information: &StateMatrix| self.summary_by(&with_hold(information, hold.as_ref()));
        Some([held(&belief.marginal)?, held(&belief.information.with_outline_given())?])
    }

    /// Hypotheses of dynamics that begin with what is believed now. What the outline does not show is taken to be none, and known; `None` where
    /// that is not possible, as projective motion is not shown as a whole, and for numbers that do not allow it.
    pub(crate) fn begun_dynamics(&self, setting: Dynamics) -> Option<DynamicsFilter> {
        let (belief, null) = (&self.belief, self.null_directions());
        if is_beyond_linear(belief.model, &null) {
            return None;
        }
        let [summary, Summary { covariance: given_outline, .. }] = self.held_summaries(&null)?;
        let place = (self.map.centroid(), &*null);
        DynamicsFilter::begin(belief.model, setting, (&summary, &given_outline), place, belief.memory.step)
    }

    /// Hands on to hypotheses of dynamics what the outline, as it is known now, adds to the errors of poses.
    pub(crate) fn renew_common_error(&self, dynamics: &mut DynamicsFilter) {
        if let Some([summary, given_outline]) = self.held_summaries(&self.null_directions()) {
            dynamics.renew_common_error(&summary, &given_outline.covariance);
        }
    }

    /// Covariance of the motion parameters in the order of the model, image units; `None` where it is beyond any number, or where the motion is known
    /// so little that rounding has left something that is no covariance.
    pub(crate) fn covariance_of(&self, summary: &Summary) -> Option<DMatrix<f64>> {
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let to_image = self.reference.to_image();
        let change = model.adjoint(&to_image, &to_image.try_inverse()?);
        let change = DMatrix::from_fn(k, k, |i, j| change[i][j] * self.reference.per_second());
        let of_motion = DMatrix::from_fn(k, k, |i, j| summary.covariance[(k + i, k + j)]);
        let covariance = &change * of_motion * change.transpose();
        // The products round apart where the image origin is far away.
        let symmetric = 0.5 * (&covariance + covariance.transpose());
        (symmetric.iter().all(|e| e.is_finite()) && is_positive(&symmetric)).then_some(symmetric)
    }

    /// Standard deviations of the motion parameters in the order of the model, image units.
    pub(crate) fn deviations_of(&self, summary: &Summary) -> Option<Vec<f64>> {
        Some(roots(&self.covariance_of(summary)?))
    }

    /// Covariance of the motion parameters as this track alone has it; `None` where it cannot be computed, or is beyond any number.
    pub(crate) fn covariance(&self) -> Option<DMatrix<f64>> {
        self.covariance_of(&self.summary_in_body_frame()?)
    }

    /// The motion as this track alone has it: see [`estimate_of`](Self::estimate_of).
    pub(crate) fn estimate(&self) -> Option<MotionEstimate> {
        self.estimate_of(&self.summary_in_body_frame()?, TurnTold::ByOutline)
    }

    /// The motion in image units, with standard deviations. A parameter whose standard deviation, over the time that it is
    /// known from, would turn the object by a quarter of a radian or move it by a quarter of its size is marked as
    /// unobservable; so is one that takes part in a motion which the outline does not show, such as the turning of a circle
    /// about its centre, unless the turn is told by the path.
    pub(crate) fn estimate_of(&self, summary: &Summary, turn: TurnTold) -> Option<MotionEstimate> {
        let covariance = self.covariance_of(summary)?;
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let to_image = self.reference.to_image();
        let from_image = to_image.try_inverse()?;
        let generator = to_image * model.generator(&summary.motion[..k]) * from_image;
        let values = model.parameters_of(&generator).map(|value| value * self.reference.per_second());
        let deviations = roots(&covariance);
        let mut estimate = MotionEstimate::new(model, &values[..k], Some(&deviations));
        let blind = match turn {
            TurnTold::ByOutline => self.blind_parameters(&summary.pose),
            TurnTold::ByPath => [false; MAX_PARAMETERS],
        };
        let reach = self.reference.radius + self.reference.origin.coords.norm();
        let memory = &self.belief.memory;
        let shortest = memory.shortest(k);
        for (j, kind) in model.parameter_kinds().iter().enumerate() {
            let (limit, span) = match kind {
                // The velocity at the origin of the image follows from that of the object and all other parameters.
                ParameterKind::Velocity => (reach, shortest),
                ParameterKind::Perspective => (1.0 / reach, memory.effective[j]),
                ParameterKind::Rate => (1.0, memory.effective[j]),
            };
            let deviation = deviations[j] * self.reference.time_unit;
            if !self.is_worth(deviation, span, limit) || blind[j] {
                estimate = estimate.with_unobservable(j);
            }
        }
        let centroid = map_point(&(to_image * summary.pose), &self.map.centroid());
        let hanging = hanging_velocities(&estimate, &centroid, &deviations);
        Some(hanging.into_iter().fold(estimate, MotionEstimate::with_unobservable))
    }

    /// Pose and motion with their joint covariance at a time in the unit of the track, and that of where the body frame lies, with the parameters
    /// marked that `observable` says nothing is known of.
    pub(crate) fn state_of(
        &self,
        (summary, body_frame, centroid): (&Summary, &PoseMatrix, Point2<f64>),
        time: f64,
        observable: [bool; MAX_PARAMETERS],
        turn: TurnOfPose,
    ) -> Option<MotionState> {
        let (belief, variance, k) = (&self.belief, self.noise.stated_variance(), self.belief.parameter_count());
        let covariance = DMatrix::from_fn(2 * k, 2 * k, |i, j| summary.covariance[(i, j)]);
        let per_second = self.reference.per_second();
        // Motion by the second, pose as it is.
        let in_seconds = |mut m: DMatrix<f64>| {
            m.rows_mut(k, k).scale_mut(per_second);
            m.columns_mut(k, k).scale_mut(per_second);
            m
        };
        let mut given_outline = belief.covariance_of(&belief.information.with_outline_given(), variance)?;
        if let Some(untold) = self.covariance_of_untold_turn() {
            given_outline += DMatrix::from_fn(2 * k, 2 * k, |i, j| untold[(i, j)]);
        }
        let state = NormalisedState {
            model: belief.model,
            time: time * self.reference.time_unit,
            origin: self.reference.origin,
            radius: self.reference.radius,
            pose: summary.pose,
            motion: summary.motion.map(|value| value * per_second),
            covariance: in_seconds(covariance),
            body_frame: DMatrix::from_fn(k, k, |i, j| body_frame[(i, j)]),
            covariance_given_outline: in_seconds(given_outline),
            observable,
            hidden: self.hidden_parameters(turn),
            centroid,
        };
        Some(state.into())
    }

    /// Whether another track of the same object has come to the same pose and motion: their difference, normalised, is shorter than `near`, and
    /// within [`DIFFERENT`] deviations by the joint covariance of pose and motion.
    pub(crate) fn has_met(&self, other: &Self, near: f64) -> bool {
        let (belief, k) = (&self.belief, self.belief.parameter_count());
        // The error of the pose is on the left.
        let change = belief.pose.try_inverse().and_then(|inverse| logarithm(&(other.belief.pose * inverse)));
        let Some(pose) = change.map(|change| belief.model.parameters_of(&change)) else { return false };
        let mut apart = StateVector::zeros();
        for j in 0..k {
            (apart[j], apart[k + j]) = (pose[j], other.belief.motion[j] - belief.motion[j]);
        }
        let squared = apart.dot(&(belief.marginal * apart)) / self.noise.effective_variance();
        apart.norm() < near && squared < DIFFERENT * DIFFERENT
    }

    /// The largest difference of a parameter of two motions, in standard deviations; normalised.
    pub(crate) fn in_deviations(&self, a: &ParameterVector, b: &ParameterVector) -> Option<f64> {
        let k = self.belief.parameter_count();
        let covariance = self.belief.covariance_of(&self.belief.marginal, self.noise.effective_variance())?;
        let differences = (0..k).map(|j| (a[j] - b[j]).abs() / covariance[(k + j, k + j)].sqrt());
        Some(differences.fold(0.0, f64::max))
    }

    /// Whether the standard deviation of a rate, over the time that it is known from, makes little of a displacement.
    pub(super) fn is_worth(&self, deviation: f64, span: f64, displacement: f64) -> bool {
        let memory = &self.belief.memory;
        is_worth(deviation, span.max(memory.span.min(STEPS_KNOWN * memory.step)), displacement)
    }

    /// Parameters about the centroid that take part in a motion which the outline does not show, or in a turn that is ambiguous: rates, entries of
    /// the perspective, and, where such a motion moves the centroid, coordinates of this.
    pub(super) fn hidden_parameters(&self, turn: TurnOfPose) -> [bool; MAX_PARAMETERS] {
        let (model, at) = (self.belief.model, self.centred_pose());
        let (change, kinds) = (at.about_centroid(model), model.parameter_kinds());
        let mut hidden = [false; MAX_PARAMETERS];
        if turn == TurnOfPose::Ambiguous {
            let turn = model.parameters_of(&CLOCKWISE);
            hidden.iter_mut().zip(kinds).zip(turn).for_each(|((hidden, kind), rate)| {
                *hidden = *kind == ParameterKind::Rate && rate != 0.0;
            });
        }
        let order = centred_order(model);
        let moves_centroid = self.map.hides_motion_of_centroid(model);
        for null in self.map.null_directions(model, &self.belief.pose) {
            let centred = change * SVector::<f64, MAX_PARAMETERS>::from(null.direction);
            let least = TAKES_PART * centred.amax();
            for (entry, j) in centred.iter().zip(order) {
                let may_be = match kinds.get(*j) {
                    Some(ParameterKind::Velocity) => moves_centroid,
                    Some(_) => true,
                    None => false,
                };
                hidden[*j] |= may_be && entry.abs() > least;
            }
        }
        hidden
    }

    /// Parameters, in image units, that take part in a motion which the outline does not show. The velocity at the origin of the image is
    /// one of them wherever the centre of a turn that is not seen is not there.
    pub(crate) fn blind_parameters(&self, pose: &Matrix3<f64>) -> [bool; MAX_PARAMETERS] {
        let mut blind = [false; MAX_PARAMETERS];
        let (model, radius) = (self.belief.model, self.reference.radius);
        let to_image = self.reference.to_image();
        let Some(inverse) = to_image.try_inverse() else { return blind };
        let about_centroid = CentredPose { pose: *pose, centroid: self.map.centroid() }.about_centroid(model);
        for null in self.map.null_directions(model, pose) {
            let generator = to_image * model.generator(&null.direction[..model.parameter_count()]) * inverse;
            let direction = model.parameters_of(&generator);
            // Over the largest part about the centroid: about an origin far away the velocity there would be that, beside which a turn is little.
            let largest = (about_centroid * SVector::<f64, MAX_PARAMETERS>::from(null.direction)).amax();
            // In units of the object, so that lengths and angles compare.
            let sizes = direction.iter().zip(model.parameter_kinds()).map(|(entry, kind)| match kind {
                ParameterKind::Rate => entry.abs(),
                ParameterKind::Velocity => entry.abs() / radius,
                ParameterKind::Perspective => entry.abs() * radius,
            });
            let turns = self.turn_is_unseen();
            for ((blind, size), kind) in blind.iter_mut().zip(sizes).zip(model.parameter_kinds()) {
                let takes_all = *kind == ParameterKind::Velocity || model > MotionModel::Similarity;
                let least = if turns && takes_all { TURNS_WITH } else { TAKES_PART };
                *blind |= size > least * largest;
            }
        }
        blind
    }
}

/// Velocities at the origin of the image that hang on a rate which is not known, by how far that moves the centroid of the object.
fn hanging_velocities(estimate: &MotionEstimate, centroid: &Point2<f64>, deviations: &[f64]) -> Vec<usize> {
    let model = estimate.model();
    let (k, kinds) = (model.parameter_count(), model.parameter_kinds());
    let mut carried = Vector2::<f64>::zeros();
    let rates = estimate.parameters().enumerate().filter(|(j, _)| kinds[*j] == ParameterKind::Rate);
    for (j, _) in rates.filter(|(_, parameter)| parameter.value.is_none()) {
        let by_rate = model.basis()[j].fixed_view::<2, 2>(0, 0) * centroid.coords * deviations[j];
        carried = carried.zip_map(&by_rate, |a, b| a.max(b.abs()));
    }
    let velocities = (0..k).filter(|j| kinds[*j] == ParameterKind::Velocity).zip(&carried);
    velocities.filter(|(j, carried)| **carried > HANGS_ON * deviations[*j]).map(|(j, _)| j).collect()
}

/// Whether no combination of what a matrix is the covariance of has a negative variance, beyond rounding, in units of its variances.
fn is_positive(covariance: &DMatrix<f64>) -> bool {
    let roots = roots(covariance);
    let scaled = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        let rounding = if i == j { ROUNDING_OF_CORRELATION } else { 0.0 };
        // What has no variance has no covariance either.
        let scale = roots[i] * roots[j];
        rounding + if scale > 0.0 { covariance[(i, j)] / scale } else { 0.0 }
    });
    covariance.diagonal().iter().all(|variance| *variance >= 0.0) && scaled.cholesky().is_some()
}

/// Standard deviations of a covariance.
fn roots(covariance: &DMatrix<f64>) -> Vec<f64> {
    covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_has_left_a_negative_variance_is_no_covariance() {
        let with_variance = |variance: f64| DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, variance]);
        assert!([1.0, 1e-20, 0.0].iter().all(|variance| is_positive(&with_variance(*variance))));
        assert!([-1e-20, -1.0].iter().all(|variance| !is_positive(&with_variance(*variance))));
    }
}
