//! Least squares on the exact flow of a motion, over the poses of frames.
use freeform_estimate::{MotionEstimate, invert_information};
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterMatrix};
use nalgebra::{DMatrix, DVector, Matrix3};

/// Most steps of Gauss and Newton.
const STEPS: usize = 40;
/// A step that changes the sum of squares by less than this share of it is the last.
const CONVERGED: f64 = 1e-18;
/// Frames from which on those that do not fit are weighted down: fewer do not tell which they are.
const ROBUST_FROM: usize = 6;
/// Frames that miss by so many times the median have no weight.
const CUT_OFF: f64 = 5.0;

/// The pose of one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseObservation {
    /// Seconds.
    pub(super) time: f64,
    /// What has moved the first outline to where it is in this frame.
    pub(super) pose: Matrix3<f64>,
    /// How well the pose is known: information of its error, a generator on the left, up to a factor common to all
    /// frames.
    pub(super) information: ParameterMatrix,
}

/// The constant motion theta, and the pose H at the first time, that minimise `sum xi' I xi` with `exp(xi) flow(theta, t) H` the poses
/// observed. `None` for fewer than two frames, or numbers that overflow. `normalisation` maps the image to the coordinates of
/// the poses; the estimate is in the image.
pub(super) fn fit_flow(
    model: MotionModel,
    observations: &[PoseObservation],
    normalisation: &Matrix3<f64>,
) -> Option<MotionEstimate> {
    let (first, k) = (observations.first()?, model.parameter_count());
    if observations.len() < 2 {
        return None;
    }
    let mut fit = FlowFit { model, first: first.time, theta: typical_motion(model, observations)?, pose: first.pose };
    let mut weights = vec![1.0; observations.len()];
    let mut equations = fit.equations(observations, &weights)?;
    for _ in 0..STEPS {
        if observations.len() >= ROBUST_FROM {
            reweight(&mut weights, &equations.distances);
            equations = fit.equations(observations, &weights)?;
        }
        let step = invert_information(&equations.information).covariance * &equations.gradient;
        fit.move_by(&step)?;
        equations = fit.equations(observations, &weights)?;
        if step.dot(&equations.gradient).abs() <= CONVERGED * equations.sum_of_squares {
            break;
        }
    }
    let inverse = invert_information(&equations.information);
    // From the coordinates of the poses to those of the image.
    let back = model.adjoint(&normalisation.try_inverse()?, normalisation);
    let back = DMatrix::from_fn(k, k, |i, j| back[i][j]);
    let values = &back * DVector::from_row_slice(&fit.theta[..k]);
    let freedom = weights.iter().sum::<f64>() * k as f64 - inverse.rank as f64;
    let deviations = (freedom > 0.5).then(|| {
        let variance = equations.sum_of_squares / freedom;
        let covariance = &back * inverse.covariance.view((k, k), (k, k)) * back.transpose() * variance;
        covariance.diagonal().map(|v| v.max(0.0).sqrt())
    });
    let deviations = deviations.as_ref().map(nalgebra::Matrix::as_slice);
    let finite = values.iter().chain(deviations.unwrap_or_default()).all(|v| v.is_finite());
    let estimate = finite.then(|| MotionEstimate::new(model, values.as_slice(), deviations))?;
    let unknown = (0..k).filter(|i| (0..k).any(|j| !inverse.observable[k + j] && back[(*i, j)].abs() > 1e-9));
    Some(unknown.fold(estimate, MotionEstimate::with_unobservable))
}

/// A motion and the pose at the first time.
struct FlowFit {
    model: MotionModel,
    first: f64,
    theta: [f64; MAX_PARAMETERS],
    pose: Matrix3<f64>,
}

/// Normal equations over the first pose, then the motion.
struct Equations {
    information: DMatrix<f64>,
    gradient: DVector<f64>,
    /// Weighted.
    sum_of_squares: f64,
    /// Of every observed pose from the one of the motion, in units of the information.
    distances: Vec<f64>,
}

impl FlowFit {
    fn equations(&self, observations: &[PoseObservation], weights: &[f64]) -> Option<Equations> {
        let (model, k) = (self.model, self.model.parameter_count());
        let mut information = DMatrix::zeros(2 * k, 2 * k);
        let mut gradient = DVector::zeros(2 * k);
        let (mut sum_of_squares, mut distances) = (0.0, Vec::with_capacity(observations.len()));
        for (observation, weight) in observations.iter().zip(weights) {
            let seconds = observation.time - self.first;
            let flow = model.flow(&self.theta[..k], seconds).into_inner();
            let inverse = flow.try_inverse()?;
            let missing = observation.pose * self.pose.try_inverse()? * inverse - Matrix3::identity();
            let xi = model.parameters_of(&missing);
            let by_pose = model.adjoint(&flow, &inverse);
            let by_motion = model.parameter_columns(model.flow_sensitivities(&self.theta[..k], seconds).into_iter());
            let derivative = DMatrix::from_fn(k, 2 * k, |i, j| if j < k { by_pose[i][j] } else { by_motion[i][j - k] });
            let metric = DMatrix::from_fn(k, k, |i, j| observation.information[i][j]);
            let xi = DVector::from_row_slice(&xi[..k]);
            let weighted = metric * &xi;
            let square = xi.dot(&weighted).max(0.0);
            let by_metric = DMatrix::from_fn(k, k, |i, j| weight * observation.information[i][j]) * &derivative;
            information += derivative.transpose() * by_metric;
            gradient += derivative.transpose() * weighted * *weight;
            sum_of_squares += weight * square;
            distances.push(square.sqrt());
        }
        let finite = information.iter().chain(&gradient).all(|e| e.is_finite());
        finite.then_some(Equations { information, gradient, sum_of_squares, distances })
    }

    fn move_by(&mut self, step: &DVector<f64>) -> Option<()> {
        let k = self.model.parameter_count();
        let (pose, motion) = step.as_slice().split_at(k);
        self.pose = self.model.flow(pose, 1.0).into_inner() * self.pose;
        self.theta.iter_mut().zip(motion).for_each(|(theta, change)| *theta += change);
        self.theta.iter().chain(self.pose.iter()).all(|e| e.is_finite()).then_some(())
    }
}

/// Tukey's weights of the distances, on the scale of their median.
fn reweight(weights: &mut [f64], distances: &[f64]) {
    let cut_off = CUT_OFF * median(distances.to_vec()).max(f64::MIN_POSITIVE);
    for (weight, distance) in weights.iter_mut().zip(distances) {
        *weight = tukey_weight(distance / cut_off);
    }
}

/// `(1 - x^2)^2` up to x = 1, then 0 (Beaton and Tukey 1974).
pub(super) fn tukey_weight(x: f64) -> f64 {
    let rest = 1.0 - x * x;
    if x.abs() < 1.0 { rest * rest } else { 0.0 }
}

/// The upper median; 0 of nothing.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Median of the motions between each frame and the next, parameter by parameter.
fn typical_motion(model: MotionModel, observations: &[PoseObservation]) -> Option<[f64; MAX_PARAMETERS]> {
    let motions: Vec<_> = observations
        .windows(2)
        .filter_map(|pair| {
            let change = pair[1].pose * pair[0].pose.try_inverse()?;
            motion_of(model, &change).map(|theta| theta.map(|t| t / (pair[1].time - pair[0].time)))
        })
        .collect();
    let typical = std::array::from_fn(|j| median(motions.iter().map(|theta| theta[j]).collect()));
    (!motions.is_empty()).then_some(typical)
}

/// The generator, in coordinates of the model, whose flow of one second is the map.
fn motion_of(model: MotionModel, map: &Matrix3<f64>) -> Option<[f64; MAX_PARAMETERS]> {
    let k = model.parameter_count();
    let mut theta = [0.0; MAX_PARAMETERS];
    for _ in 0..STEPS {
        let flow = model.flow(&theta[..k], 1.0).into_inner();
        let missing = model.parameters_of(&(map * flow.try_inverse()? - Matrix3::identity()));
        let by_motion = model.parameter_columns(model.flow_sensitivities(&theta[..k], 1.0).into_iter());
        let matrix = DMatrix::from_fn(k, k, |i, j| by_motion[i][j]);
        let step = matrix.lu().solve(&DVector::from_row_slice(&missing[..k]))?;
        theta.iter_mut().zip(&step).for_each(|(theta, change)| *theta += change);
        if step.amax() < 1e-12 {
            break;
        }
    }
    theta.iter().all(|t| t.is_finite()).then_some(theta)
}

#[cfg(test)]
mod tests {
    use super::*;

    const THETA: [f64; 6] = [0.05, 1.2, -1.7, -0.08, -0.3, 0.4];

    fn observations(model: MotionModel, theta: &[f64], count: u32) -> Vec<PoseObservation> {
        let mut information = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        (0..MAX_PARAMETERS).for_each(|i| information[i][i] = 1.0 + i as f64);
        let pose = |time| model.flow(theta, time).into_inner();
        (0..count)
            .map(|k| f64::from(k) / 4.0)
            .map(|time| PoseObservation { time, pose: pose(time), information })
            .collect()
    }

    #[test]
    fn poses_without_error_give_the_motion_for_every_model() {
        for model in MotionModel::ALL {
            let theta: Vec<f64> = THETA.iter().chain(&[0.1, -0.05]).copied().take(model.parameter_count()).collect();
            let theta = if model == MotionModel::Similarity { vec![0.1, 1.2, -0.3, 0.4] } else { theta };
            let estimate = fit_flow(model, &observations(model, &theta, 9), &Matrix3::identity()).expect("nine poses");
            for (found, truth) in estimate.values().iter().zip(&theta) {
                assert!((found - truth).abs() < 1e-9, "{model}: {found} for {truth}");
            }
        }
    }

    #[test]
    fn a_pose_that_does_not_belong_to_the_others_takes_no_part() {
        let mut poses = observations(MotionModel::Affine, &THETA, 12);
        poses[5].pose = Matrix3::new(0.3, -2.0, 5.0, 1.0, 0.1, -3.0, 0.0, 0.0, 1.0);
        let estimate = fit_flow(MotionModel::Affine, &poses, &Matrix3::identity()).expect("twelve poses");
        for (found, truth) in estimate.values().iter().zip(&THETA) {
            assert!((found - truth).abs() < 1e-6, "{found} for {truth}");
        }
    }

    #[test]
    fn one_pose_makes_no_motion() {
        assert!(
            fit_flow(MotionModel::Rigid, &observations(MotionModel::Rigid, &[0.0; 3], 1), &Matrix3::identity())
                .is_none()
        );
    }
}
