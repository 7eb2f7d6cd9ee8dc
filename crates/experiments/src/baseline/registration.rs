use freeform_curve_fit::Outline;
use freeform_estimate::{MotionEstimate, invert_information};
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterMatrix, map_point, pull_back};
use nalgebra::{DMatrix, DVector, Matrix3, Point2};

use super::{
    error::BaselineError,
    flow_fit::{PoseObservation, median, tukey_weight},
    pose_history::PoseHistory,
    reference::Reference,
};

/// From the median of the absolute values to the standard deviation of Gaussian noise.
const MEDIAN_TO_SIGMA: f64 = 1.4826;
/// Most iterations of one registration.
const ITERATIONS: usize = 30;
/// Tukey's constant: 95 % efficiency on Gaussian noise.
const TUKEY: f64 = 4.685;
/// A step of this many standard deviations, squared, is the last.
const CONVERGED: f64 = 1e-4;
/// Smallest scale of the residuals, in units of the outline: below, rounding decides.
const ROUNDING: f64 = 1e-13;
/// A frame whose residuals are so many times those of the other frames shows something else.
const TOO_FAR: f64 = 4.0;
/// Smallest share of the points of a frame that must be matched.
const SMALLEST_SHARE: f64 = 0.3;
/// Frames rejected in a row while none was taken yet: the first was not the object.
const FALSE_START: usize = 3;

/// Baseline: every frame registered to the first by iterated closest points, motion by least squares on the exact flow.
///
/// Residuals are distances from the points of a frame to the lines through the nearest points of the first frame, in the image;
/// they have Tukey weights on the scale of their median, and points whose nearest is the end of an open arc are left out.
/// A registration starts from the pose of the last frame taken. A frame with residuals four times those of the others is
/// rejected; three such frames after the first one alone, and the first was wrong. Any motion model.
#[derive(Debug, Clone)]
pub struct RegistrationEstimator {
    history: PoseHistory,
    reference: Option<Reference>,
    /// Scale of the residuals of every frame taken.
    scales: Vec<f64>,
    rejected_in_a_row: usize,
}

/// Information of an unknown pose.
const NOTHING: ParameterMatrix = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];

/// One frame brought onto the first.
struct Registration {
    pose: Matrix3<f64>,
    /// In units of the noise of this frame.
    information: ParameterMatrix,
    /// Standard deviation of the residuals, from their median.
    scale: f64,
    /// Share of the points that were matched.
    share: f64,
}

impl RegistrationEstimator {
    /// One that has seen no frame.
    #[must_use]
    pub fn new(model: MotionModel) -> Self {
        Self { history: PoseHistory::new(model), reference: None, scales: Vec::new(), rejected_in_a_row: 0 }
    }

    /// Takes the outline seen at a time in seconds; false if it does not show the outline of the first frame.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<bool, BaselineError> {
        self.history.advance(time)?;
        self.history.set_coordinates(outline);
        let points: Vec<_> = outline.points().map(self.history.map()).collect();
        let (Some(reference), Some(last)) = (&self.reference, self.history.observations.last()) else {
            self.start(time, outline, &points);
            return Ok(true);
        };
        let usual = median(self.scales.clone());
        let registration = register(reference, self.history.model, &points, last.pose);
        match registration.filter(|r| r.scale <= TOO_FAR * usual && r.share >= SMALLEST_SHARE) {
            Some(Registration { pose, information, scale, .. }) => {
                self.history.observations.push(PoseObservation { time, pose, information });
                self.scales.push(scale);
                self.rejected_in_a_row = 0;
                Ok(true)
            }
            None => {
                self.history.rejected += 1;
                self.rejected_in_a_row += 1;
                if self.history.observations.len() == 1 && self.rejected_in_a_row >= FALSE_START {
                    self.history.restart();
                    self.history.set_coordinates(outline);
                    let points: Vec<_> = outline.points().map(self.history.map()).collect();
                    self.start(time, outline, &points);
                }
                Ok(false)
            }
        }
    }

    /// Takes the outline as the first.
    fn start(&mut self, time: f64, outline: &Outline, points: &[Point2<f64>]) {
        let reference = Reference::new(outline, self.history.map());
        // Registered to itself: what its lines make of its points is then the same error in all poses, and no motion.
        let own = register(&reference, self.history.model, points, Matrix3::identity());
        let (pose, information, scale) =
            own.map_or((Matrix3::identity(), NOTHING, ROUNDING), |own| (own.pose, own.information, own.scale));
        self.scales = vec![scale];
        self.history.observations.push(PoseObservation { time, pose, information });
        self.reference = Some(reference);
        self.rejected_in_a_row = 0;
    }

    /// The motion that fits all frames so far best; `None` before the second one.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        self.history.estimate()
    }

    /// Frames that did not fit.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.history.rejected
    }
}

/// Iterated closest points from a pose.
fn register(
    reference: &Reference,
    model: MotionModel,
    points: &[Point2<f64>],
    start: Matrix3<f64>,
) -> Option<Registration> {
    let k = model.parameter_count();
    let mut pose = start;
    for iteration in 1..=ITERATIONS {
        let Equations { information, gradient, scale, share } = equations(reference, model, points, &pose);
        let matrix = DMatrix::from_fn(k, k, |i, j| information[i][j]);
        let gradient = DVector::from_row_slice(&gradient[..k]);
        if !matrix.iter().chain(&gradient).all(|e| e.is_finite()) {
            return None;
        }
        let step = invert_information(&matrix).covariance * &gradient;
        pose = model.flow(step.as_slice(), 1.0).into_inner() * pose;
        if step.dot(&gradient) <= CONVERGED * scale * scale || iteration == ITERATIONS {
            let information = information.map(|row| row.map(|entry| entry / (scale * scale)));
            return Some(Registration { pose, information, scale, share });
        }
    }
    None
}

/// Weighted normal equations for a generator on the left of the pose.
struct Equations {
    information: ParameterMatrix,
    gradient: [f64; MAX_PARAMETERS],
    scale: f64,
    share: f64,
}

fn equations(reference: &Reference, model: MotionModel, points: &[Point2<f64>], pose: &Matrix3<f64>) -> Equations {
    let inverse = pose.try_inverse().unwrap_or_else(|| Matrix3::repeat(f64::NAN));
    // The distance of every point to the line of its nearest, and how fast each generator changes it.
    let matched: Vec<_> = points
        .iter()
        .filter_map(|q| {
            let body = map_point(&inverse, q);
            let place = reference.nearest(&body).filter(|place| !place.is_end)?;
            let normal = pull_back(&inverse, q, &body, &place.normal);
            let stretch = normal.norm();
            let (normal, distance) = (normal / stretch, place.normal.dot(&(body - place.point)) / stretch);
            // At the foot on the line: the point itself would have its noise multiplied with the residual.
            let velocity = model.normal_velocities(&(q - distance * normal), &normal);
            distance.is_finite().then_some((distance, velocity))
        })
        .collect();
    let scale = MEDIAN_TO_SIGMA * median(matched.iter().map(|(distance, _)| distance.abs()).collect());
    let scale = scale.max(ROUNDING);
    let mut information = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
    let mut gradient = [0.0; MAX_PARAMETERS];
    for (distance, velocity) in &matched {
        let weight = tukey_weight(distance / (TUKEY * scale));
        for ((row, g), a) in information.iter_mut().zip(&mut gradient).zip(velocity) {
            row.iter_mut().zip(velocity).for_each(|(entry, b)| *entry += weight * a * b);
            *g += weight * a * distance;
        }
    }
    Equations { information, gradient, scale, share: matched.len() as f64 / points.len() as f64 }
}
