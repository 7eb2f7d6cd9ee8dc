//! What a frame says of the pose beyond what was predicted, and what that says of how fast the motion changes.
use nalgebra::{Point2, SMatrix};

use crate::{
    belief::{Belief, StateMatrix, StateVector},
    prediction::{ByKind, centred_change, kind_index},
    tuning::update as tuning,
};

/// Innovation of the pose in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PoseInnovation {
    /// Squared, in units of its covariance: chi-squared with one degree of freedom per parameter.
    pub(crate) squared: f64,
    /// Derivatives of the log-likelihood by the variances of the motion's change per second, in normalised units.
    pub(crate) gradient: ByKind,
    /// Fisher information of each, and of one variance for both.
    pub(crate) fisher: ByKind,
    pub(crate) fisher_of_both: f64,
    /// Degrees of freedom that the step has taken off the residuals: the trace of the gain, of no more than one for each parameter.
    pub(crate) degrees_of_freedom: f64,
}

impl Belief {
    /// From the marginal information before and after a frame and the step that it made; `centroid` is the
    /// object's in the body frame, `variance` that of the noise, with its correlation. The covariance of the pose step is `P - P+`; with `A = P^-1` of the pose alone the innovation v obeys
    /// `S^-1 v = A step` and `S^-1 = A (P - P+) A`.
    pub(crate) fn pose_innovation(
        &self,
        [before, after]: [&StateMatrix; 2],
        state: &StateVector,
        centroid: &Point2<f64>,
        variance: f64,
    ) -> PoseInnovation {
        let innovation = match self.information.k {
            3 => self.sized_innovation::<3>([before, after], state, centroid, variance),
            4 => self.sized_innovation::<4>([before, after], state, centroid, variance),
            6 => self.sized_innovation::<6>([before, after], state, centroid, variance),
            _ => self.sized_innovation::<8>([before, after], state, centroid, variance),
        };
        innovation.unwrap_or_default()
    }

    fn sized_innovation<const K: usize>(
        &self,
        marginals: [&StateMatrix; 2],
        state: &StateVector,
        centroid: &Point2<f64>,
        variance: f64,
    ) -> Option<PoseInnovation> {
        let [before, after] = marginals.map(pose_information::<K>);
        let (before, after) = (before?, after?);
        let (p, p_after) = (inverse(&before)?, inverse(&after)?);
        let step = state.fixed_rows::<K>(0).into_owned();
        let gained = p - p_after;
        // Directions that the frame does not show have no step either.
        let regular = gained + SMatrix::from_diagonal(&(p.diagonal() * tuning::REGULAR_GAIN));
        let squared = step.dot(&(inverse(&regular)? * step)) / variance;
        let weighted = before * step / variance.sqrt();
        let by_change = centred_change(self.model, &self.pose, centroid)?.fixed_view::<K, K>(0, 0).into_owned();
        // Of the pose by unit changes of the motion, over the last step.
        let by_change_before = before * by_change;
        let (slope, curvature) =
            (by_change.transpose() * weighted, by_change_before.transpose() * gained * by_change_before);
        let growth = self.memory.step.powi(3) / variance;
        let degrees_of_freedom = (gained * before).trace().clamp(0.0, K as f64);
        let mut all = PoseInnovation { squared, degrees_of_freedom, ..PoseInnovation::default() };
        let kinds = || self.model.parameter_kinds().iter().map(|kind| kind_index(*kind)).enumerate();
        for (i, of_i) in kinds() {
            all.gradient[of_i] += 0.5 * growth * (slope[i] * slope[i] - curvature[(i, i)]);
            for (j, of_j) in kinds() {
                let fisher = 0.5 * growth * growth * curvature[(i, j)] * curvature[(i, j)];
                all.fisher_of_both += fisher;
                all.fisher[of_i] += if of_i == of_j { fisher } else { 0.0 };
            }
        }
        let is_finite = all.gradient.iter().chain(&all.fisher).all(|e| e.is_finite());
        let is_told = squared >= 0.0 && is_finite && all.fisher.iter().all(|f| *f > 0.0);
        Some(if is_told { all } else { PoseInnovation { degrees_of_freedom, ..PoseInnovation::default() } })
    }
}

/// Information of the pose with the motion eliminated.
fn pose_information<const K: usize>(marginal: &StateMatrix) -> Option<SMatrix<f64, K, K>> {
    let block = |row: usize, column: usize| marginal.fixed_view::<K, K>(row, column).into_owned();
    let (pose, cross, motion) = (block(0, 0), block(0, K), block(K, K));
    Some(pose - cross * inverse(&motion)? * cross.transpose())
}

/// Inverse of a positive definite matrix, scaled to unit diagonal on the way.
fn inverse<const K: usize>(matrix: &SMatrix<f64, K, K>) -> Option<SMatrix<f64, K, K>> {
    let scale: [f64; K] = std::array::from_fn(|i| {
        let entry = matrix[(i, i)];
        if entry > 0.0 { 1.0 / entry.sqrt() } else { 1.0 }
    });
    let mut scaled = SMatrix::<f64, K, K>::from_fn(|i, j| matrix[(i, j)] * scale[i] * scale[j]);
    (0..K).for_each(|i| scaled[(i, i)] += tuning::REGULAR_INFORMATION);
    let inverse = scaled.cholesky()?.inverse();
    Some(SMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    use super::*;
    use crate::{
        dense_filter::{DenseFilter, Problem, random_measurements},
        measurement::Frame,
        update::accumulate,
    };

    /// Log-likelihood, but for a constant, of an innovation.
    fn log_likelihood(covariance: &DMatrix<f64>, innovation: &DVector<f64>) -> f64 {
        let factor = covariance.clone().cholesky().expect("positive definite");
        -0.5 * (factor.l().diagonal().map(f64::ln).sum() * 2.0 + innovation.dot(&factor.solve(innovation)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn the_innovation_of_the_pose_and_its_scores_are_those_of_its_likelihood(mut problem in Problem::any()) {
            let (k, cells) = (problem.belief.parameter_count(), problem.belief.offsets.len());
            let (centroid, variance) = (Point2::new(0.3, -0.2), 0.3);
            let measurements = random_measurements(&mut problem.rng, k, 0..cells, 6 * cells + 3 * k);
            let belief = &problem.belief;
            let mut dense = DenseFilter::of(&belief.information);
            let of_pose = |dense: &DenseFilter| variance * dense.covariance.view((0, 0), (k, k)).clone_owned();
            let before = of_pose(&dense);
            measurements.iter().for_each(|m| dense.measure(m));
            let gained = &before - of_pose(&dense);
            let step = dense.mean.rows(0, k).clone_owned();
            let mut frame = Frame::of_measurements(measurements, cells);
            let mut work = belief.information.clone();
            accumulate(&mut frame, &mut work, &StateVector::zeros());
            let state = StateVector::from_fn(|i, _| if i < 2 * k { dense.mean[i] } else { 0.0 });
            let found = belief.pose_innovation([&belief.marginal, &work.marginal()], &state, &centroid, variance);

            let by_gained = gained.clone().try_inverse().expect("a frame that shows the pose");
            let squared = step.dot(&(&by_gained * &step));
            prop_assert!((found.squared / squared - 1.0).abs() < 1e-4, "{} {squared}", found.squared);
            let covariance = &before * &by_gained * &before;
            let innovation = &before * &by_gained * &step;
            let by_change = centred_change(belief.model, &belief.pose, &centroid).expect("a pose");
            let growth_of = |kind: usize| {
                let of_kind = belief.model.parameter_kinds().iter().map(|k| f64::from(u8::from(kind_index(*k) == kind)));
                let picked = DMatrix::from_diagonal(&DVector::from_iterator(k, of_kind));
                let by_change = by_change.view((0, 0), (k, k));
                by_change * picked * by_change.transpose() * belief.memory.step.powi(3)
            };
            let inverse = covariance.clone().try_inverse().expect("positive definite");
            let fisher = |growth: &DMatrix<f64>| 0.5 * (&inverse * growth * &inverse * growth).trace();
            for kind in 0..2 {
                let growth = growth_of(kind);
                let step = 1e-4 / fisher(&growth).sqrt();
                let likelihood = |size: f64| log_likelihood(&(&covariance + size * &growth), &innovation);
                let slope = (likelihood(step) - likelihood(-step)) / (2.0 * step);
                let unit = fisher(&growth).sqrt() * (1.0 + squared);
                prop_assert!((slope - found.gradient[kind]).abs() < 1e-3 * unit, "{slope} {:?}", found.gradient);
                prop_assert!((found.fisher[kind] / fisher(&growth) - 1.0).abs() < 1e-3);
            }
            let both = fisher(&(growth_of(0) + growth_of(1)));
            prop_assert!((found.fisher_of_both / both - 1.0).abs() < 1e-3);
        }
    }
}
