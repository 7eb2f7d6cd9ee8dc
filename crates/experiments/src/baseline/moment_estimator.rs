use freeform_curve_fit::Outline;
use freeform_estimate::MotionEstimate;
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterMatrix};
use nalgebra::{Complex, Matrix2, Matrix3, Point2, Rotation2, Vector2};

use super::{
    area_moments::AreaMoments, error::BaselineError, flow_fit::PoseObservation, outlier_removal::without_outliers,
    pose_history::PoseHistory,
};

/// Third moments that disagree by as much (1 is a turned copy, -1 one turned by half a turn more) outweigh that the axis has hardly
/// moved.
const REVERSED: f64 = -0.5;

/// Baseline: poses from the moments of the enclosed area, motion by least squares on the exact flow.
///
/// Rigid: centroid and principal axis, whose two ends are told apart by continuity, and by the third moments where these say
/// the opposite clearly. Similarity: the square root of the area as well. Affine: second moments fix the linear part up to a
/// rotation, which the third moments of the whitened area give. Points far from their
/// neighbours are taken out first; an open outline is closed by straight lines. Poses count by
/// the mean squared displacement of the area; from six frames on those that miss are weighted down (Tukey).
#[derive(Debug, Clone)]
pub struct AreaMomentEstimator {
    history: PoseHistory,
    first: Option<AreaMoments>,
    last_turn: f64,
}

impl AreaMomentEstimator {
    /// One that has seen no frame, for rigid, similarity or affine motion.
    ///
    /// # Errors
    /// Projective motion.
    pub fn new(model: MotionModel) -> Result<Self, BaselineError> {
        if model == MotionModel::Projective {
            return Err(BaselineError::UnsupportedModel { model });
        }
        Ok(Self { history: PoseHistory::new(model), first: None, last_turn: 0.0 })
    }

    /// Takes the outline seen at a time in seconds; false if it encloses no area.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<bool, BaselineError> {
        self.history.advance(time)?;
        self.history.set_coordinates(outline);
        let points: Vec<_> = without_outliers(outline).points().map(self.history.map()).collect();
        let pose = AreaMoments::of(&points)
            .and_then(|now| self.pose(&now).map(|pose| (pose, displacement_information(self.history.model, &now))));
        let Some((pose, information)) = pose else {
            self.history.rejected += 1;
            return Ok(false);
        };
        self.history.observations.push(PoseObservation { time, pose, information });
        Ok(true)
    }

    /// The map from the first area to the present one.
    fn pose(&mut self, now: &AreaMoments) -> Option<Matrix3<f64>> {
        let first = self.first.get_or_insert(*now);
        let linear = match self.history.model {
            MotionModel::Rigid | MotionModel::Similarity => {
                let mut turn = now.axis() - first.axis();
                let from_last = turn - self.last_turn;
                turn -= std::f64::consts::PI * (from_last / std::f64::consts::PI).round();
                if first.agreement(now, turn) < REVERSED {
                    turn += std::f64::consts::PI;
                }
                self.last_turn = turn;
                let scale = (now.area / first.area).sqrt();
                let scale = if self.history.model == MotionModel::Rigid { 1.0 } else { scale };
                scale * Rotation2::new(turn).into_inner()
            }
            _ => {
                let (root_first, root_now) = (root(&first.covariance), root(&now.covariance));
                let whitened_first = whitened(first, &root_first.try_inverse()?);
                let turn = whitened_first.best_turn(&whitened(now, &root_now.try_inverse()?));
                root_now * Rotation2::new(turn).into_inner() * root_first.try_inverse()?
            }
        };
        let shift = now.centroid.coords - linear * first.centroid.coords;
        let mut pose = linear.to_homogeneous();
        pose.fixed_view_mut::<2, 1>(0, 2).copy_from(&shift);
        pose.iter().all(|e| e.is_finite()).then_some(pose)
    }

    /// The motion that fits all frames so far best; `None` before the second one.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        self.history.estimate()
    }

    /// Frames that enclosed no area.
    #[must_use]
    pub fn frames_rejected(&self) -> usize {
        self.history.rejected
    }
}

/// The symmetric square root of a positive definite matrix.
fn root(matrix: &Matrix2<f64>) -> Matrix2<f64> {
    // Cayley and Hamilton: (M + d I) / sqrt(trace M + 2 d) with d the root of the determinant.
    let d = matrix.determinant().max(0.0).sqrt();
    (matrix + Matrix2::identity() * d) / (matrix.trace() + 2.0 * d).sqrt()
}

/// The third moments after a linear map, by that of the tensor of third moments.
fn whitened(moments: &AreaMoments, map: &Matrix2<f64>) -> AreaMoments {
    // x^3, x^2 y, x y^2, y^3 from the two harmonics.
    let (one, three) = (moments.first_harmonic, moments.third_harmonic);
    let tensor = [
        0.25 * (3.0 * one.re + three.re),
        0.25 * (one.im + three.im),
        0.25 * (one.re - three.re),
        0.25 * (3.0 * one.im - three.im),
    ];
    let entry = |a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>| {
        let [xxx, xxy, xyy, yyy] = tensor;
        a.x * b.x * c.x * xxx
            + (a.x * b.x * c.y + a.x * b.y * c.x + a.y * b.x * c.x) * xxy
            + (a.x * b.y * c.y + a.y * b.x * c.y + a.y * b.y * c.x) * xyy
            + a.y * b.y * c.y * yyy
    };
    let (u, v) = (map.row(0).transpose(), map.row(1).transpose());
    let (xxx, xxy, xyy, yyy) = (entry(u, u, u), entry(u, u, v), entry(u, v, v), entry(v, v, v));
    AreaMoments {
        first_harmonic: Complex::new(xxx + xyy, xxy + yyy),
        third_harmonic: Complex::new(xxx - 3.0 * xyy, 3.0 * xxy - yyy),
        ..*moments
    }
}

/// Mean squared displacement of the area by a generator, as a quadratic form: by four points with the same first and second
/// moments.
fn displacement_information(model: MotionModel, moments: &AreaMoments) -> ParameterMatrix {
    let mut information = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
    let root = root(&moments.covariance);
    let offsets =
        [root.column(0).into_owned(), root.column(1).into_owned()].map(|axis| axis * std::f64::consts::SQRT_2);
    for offset in offsets.into_iter().flat_map(|offset| [offset, -offset]) {
        let point = Point2::from(moments.centroid.coords + offset);
        for direction in [Vector2::x(), Vector2::y()] {
            let velocity = model.normal_velocities(&point, &direction);
            for (row, a) in information.iter_mut().zip(velocity) {
                row.iter_mut().zip(velocity).for_each(|(entry, b)| *entry += 0.25 * a * b);
            }
        }
    }
    information
}
