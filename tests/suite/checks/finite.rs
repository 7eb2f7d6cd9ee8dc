//! What holds of every result.
use freeform_motion::{estimate::MotionEstimate, outline_filter::MotionFilter, riccati::MotionModel};

/// Largest difference of a covariance from its transpose, and how far an eigenvalue may be below zero, both relative to
/// the deviations: b is a velocity at the origin, which may be a million sizes away from the object.
const ROUNDING: f64 = 1e-3;

/// Variance below which products with others lose digits to underflow.
const SMALLEST_VARIANCE: f64 = 1e-200;

/// Every number of an estimate is finite and no deviation is negative.
pub(crate) fn assert_finite(estimate: &MotionEstimate) {
    assert!(estimate.values().iter().all(|v| v.is_finite()), "{estimate:?}");
    for parameter in estimate.parameters() {
        let deviation = parameter.standard_deviation.unwrap_or(0.0);
        assert!(deviation.is_finite() && deviation >= 0.0, "{parameter:?}");
    }
}

/// The covariance of the motion is finite, symmetric and has no negative eigenvalue, up to rounding.
pub(crate) fn assert_covariance(filter: &MotionFilter) {
    let Some(covariance) = filter.covariance() else { return };
    let k = covariance.nrows();
    assert!(k <= MotionModel::MAX_PARAMETERS && covariance.iter().all(|c| c.is_finite()), "{covariance:e}");
    assert!(covariance.diagonal().iter().all(|&variance| variance >= 0.0), "{covariance:e}");
    // Of variances that underflow in the unit of the image nothing can be said.
    let known: Vec<usize> = (0..k).filter(|&i| covariance[(i, i)] > SMALLEST_VARIANCE).collect();
    if known.is_empty() {
        return;
    }
    let correlation = nalgebra::DMatrix::from_fn(known.len(), known.len(), |i, j| {
        let (i, j) = (known[i], known[j]);
        covariance[(i, j)] / covariance[(i, i)].sqrt() / covariance[(j, j)].sqrt()
    });
    assert!((&correlation - correlation.transpose()).amax() <= ROUNDING, "not symmetric: {covariance:e}");
    let smallest = correlation.symmetric_eigenvalues().min();
    assert!(smallest >= -ROUNDING, "an eigenvalue of {smallest}: {covariance:e}");
}
