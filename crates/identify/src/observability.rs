use freeform_riccati::MotionModel;

use crate::{estimate::MotionEstimate, filter::ProcessNoise};

/// Standard deviation of a displacement, in object sizes, beyond which its cause counts as unknown.
const WORTHLESS: f64 = 0.25;

/// An estimate in image units in which a parameter is marked as unobservable whose standard deviation, over the time seen, would
/// turn the object by a quarter of a radian or move it by a quarter of `reach`, the distance of its points from the image origin. A
/// motion that drifts is known no longer than it takes to drift by its standard deviation.
pub(crate) fn judged(
    model: MotionModel,
    values: &[f64],
    deviations: &[f64],
    reach: f64,
    seconds: f64,
    noise: &ProcessNoise,
) -> MotionEstimate {
    let mut estimate = MotionEstimate::new(model, values, Some(deviations));
    for (j, name) in model.parameter_names().iter().enumerate() {
        let (limit, drift) = match name.as_bytes()[0] {
            b'b' => (reach, noise.velocities),
            b'c' => (1.0 / reach, noise.rates),
            _ => (1.0, noise.rates),
        };
        let span = seconds.min((deviations[j] / drift).powi(2));
        // Not a number is not known either.
        let known = deviations[j] * span <= WORTHLESS * limit;
        if !known {
            estimate = estimate.with_unobservable(j);
        }
    }
    estimate
}
