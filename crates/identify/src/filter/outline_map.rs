use freeform_curve_fit::Outline;
use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Point2, Projective2, SMatrix, Vector2};

use super::{
    arrow_information::{ArrowInformation, CellInformation, StateMatrix, StateVector, moved_marginal},
    contour::Contour,
    error::FilterError,
    map_update::Scratch,
    nearest_field::NearestField,
    settings::ProcessNoise,
};
use crate::{
    estimate::{MAX_PARAMETERS, MotionEstimate},
    motion_algebra::{CoordinateMatrix, Coordinates, adjoint, columns, map_point, normal_velocities},
};

/// Fewest points that a map is started from.
pub(crate) const FEWEST_POINTS: usize = 8;
/// Length of a cell in standard deviations of the noise. Shorter ones leave more offsets to be estimated, and points that come to the
/// wrong cell; longer ones a coarser outline.
const NOISE_PER_CELL: f64 = 3.0;
/// Fewest points of the first frame for each cell.
const POINTS_PER_CELL: f64 = 1.0;
/// Most cells of the first frame.
const MOST_CELLS: f64 = 800.0;
/// Weight of the first pose, in points: it only fixes the gauge, since pose and offsets can move together.
const GAUGE_WEIGHT: f64 = 10.0;
/// Information on the motion that makes the first equations solvable, per squared second: next to nothing.
const MOTION_PRIOR: f64 = 1e-10;
/// Eigenvalue of the lever arms, in squares of the RMS radius, below which a direction of the pose cannot be seen.
const DEGENERATE: f64 = 0.003;
/// Standard deviation of a displacement, in object sizes, beyond which its cause counts as unknown.
const WORTHLESS: f64 = 0.25;
/// Share of the usual information that must have come from the object's path on a motion that its outline does not show.
const SEEN_BY_PATH: f64 = 0.02;
/// Smallest standard deviation of the noise that is reckoned with, in RMS radii.
const SMALLEST_NOISE: f64 = 1e-9;
/// What straight cells leave of an outline where it bends most, in spacings: noise is not told from it below.
const CELL_ERROR: f64 = 0.03;
/// Frames that the estimate of the noise looks back on.
const NOISE_MEMORY: f64 = 200.0;

/// A stretch of the outline in the body frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) centre: Point2<f64>,
    pub(crate) normal: Vector2<f64>,
    /// Signed distance of the outline from the centre along the normal.
    pub(crate) offset: f64,
    /// The cells before and after it; its own number where none is known.
    pub(crate) neighbours: [usize; 2],
}

/// A direction of the pose that the outline does not show, in the image: rows of measurements lose `(h . direction) dual`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unseen {
    pub(crate) direction: Coordinates,
    pub(crate) dual: Coordinates,
}

/// The recursive outline map: the pose of an object, its motion, and its outline as cells along it whose signed offsets are
/// estimated together with the motion.
///
/// The body frame is the image at the first frame. Per frame: [`predict`](Self::predict), then [`update`](Self::update).
/// Work is linear in points and cells, memory constant once the whole outline has been seen. Lengths are normalised by the
/// first frame's centre and RMS radius inside, image lengths outside.
///
/// It needs a prediction that is right to a fraction of the object's features, in the first frames too; [`MotionFilter`](crate::MotionFilter)
/// provides that.
#[derive(Debug, Clone)]
pub struct OutlineMap {
    pub(crate) model: MotionModel,
    pub(crate) origin: Point2<f64>,
    pub(crate) radius: f64,
    /// Body to image.
    pub(crate) pose: Matrix3<f64>,
    pub(crate) motion: Coordinates,
    pub(crate) information: ArrowInformation,
    /// Marginal information of pose and motion.
    pub(crate) marginal: StateMatrix,
    pub(crate) cells: Vec<Cell>,
    pub(crate) field: NearestField,
    pub(crate) spacing: f64,
    pub(crate) sigma: f64,
    pub(crate) sigma_weight: f64,
    /// What bent cells alone would leave of the residuals.
    sigma_floor: f64,
    pub(crate) half_window: usize,
    /// In the body frame.
    unseen_in_body: Vec<Coordinates>,
    /// From centred coordinates of unit RMS radius to the body frame.
    body_frame: Matrix3<f64>,
    pub(crate) scratch: Scratch,
    process_noise: ProcessNoise,
    /// Seconds predicted over since the motion was last unknown.
    span: f64,
}

impl OutlineMap {
    /// A map of what one outline shows, its motion unknown. Outliers and missing arcs are allowed for.
    ///
    /// # Errors
    /// Fewer than 8 points, or points that make no contour.
    pub fn new(model: MotionModel, outline: &Outline) -> Result<Self, FilterError> {
        let found = outline.point_count();
        let too_few = FilterError::TooFewPoints { found, needed: FEWEST_POINTS };
        if found < FEWEST_POINTS {
            return Err(too_few);
        }
        let (origin, radius) = (outline.centroid(), outline.rms_radius());
        let k = model.parameter_count();
        let mut information = ArrowInformation::new(k);
        for i in 0..k {
            information.dense[i][i] = GAUGE_WEIGHT * found as f64;
            information.dense[k + i][k + i] = MOTION_PRIOR;
        }
        let mut map = Self {
            model,
            origin,
            radius,
            pose: Matrix3::identity(),
            motion: [0.0; MAX_PARAMETERS],
            marginal: information.marginal(),
            information,
            cells: Vec::new(),
            field: NearestField::default(),
            spacing: 0.0,
            sigma: 0.0,
            sigma_weight: 0.5,
            sigma_floor: SMALLEST_NOISE,
            half_window: 2,
            unseen_in_body: Vec::new(),
            body_frame: Matrix3::identity(),
            scratch: Scratch::default(),
            process_noise: ProcessNoise::default(),
            span: 0.0,
        };
        map.load(outline);
        map.choose_resolution(outline);
        if !(map.spacing > 0.0 && map.sigma.is_finite()) {
            return Err(too_few);
        }
        map.grow(outline);
        if map.cells.len() < 3 {
            return Err(too_few);
        }
        map.marginal = map.information.marginal();
        let sagitta = map.sagitta();
        map.sigma_floor = map.sigma_floor.max(0.25 * sagitta).max(CELL_ERROR * map.spacing);
        map.sigma = map.sigma.max(0.5 * sagitta).max(map.sigma_floor);
        Ok(map)
    }

    /// How far a bent outline lies from the straight cells: what is left to be noise where the points have none.
    fn sagitta(&self) -> f64 {
        let bends = self.cells.iter().map(|cell| {
            let [a, b] = cell.neighbours.map(|n| self.cells[n].centre);
            cell.normal.dot(&(nalgebra::center(&a, &b) - cell.centre)).abs()
        });
        // Over a chord of two cells: a quarter of it is left at the ends of one.
        super::contour::median(&mut bends.collect::<Vec<_>>()).unwrap_or(0.0)
    }

    /// Noise, window and spacing from the first frame.
    fn choose_resolution(&mut self, outline: &Outline) {
        let (mut variance, mut count, mut length, mut window) = (0.0, 0.0, 0.0, 2);
        for mut contour in self.contours(outline) {
            let weight = contour.len() as f64;
            let Some(sigma) = contour.noise() else { continue };
            window = contour.half_window(sigma).max(window);
            variance += weight * sigma * sigma;
            count += weight;
            length += contour.smooth_length(window);
        }
        // Exact points have no noise; the floor keeps weights finite and is far below what any number can tell.
        self.sigma = (variance / f64::max(count, 1.0)).sqrt().max(SMALLEST_NOISE);
        self.half_window = window;
        let finest = (count / POINTS_PER_CELL).clamp(4.0, MOST_CELLS);
        self.spacing = (NOISE_PER_CELL * self.sigma).max(length / finest).min(length / 12.0);
    }

    /// The pieces of the loaded outline in the body frame.
    pub(crate) fn contours<'a>(&'a self, outline: &'a Outline) -> impl Iterator<Item = Contour> + 'a {
        let inverse = self.pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let mut start = 0;
        outline.pieces().map(move |piece| {
            let range = start..start + piece.points.len();
            start = range.end;
            let points = self.scratch.points[range].iter().map(|p| map_point(&inverse, p)).collect();
            Contour::new(points, piece.closed)
        })
    }

    /// Brings the points of an outline into the map's own image coordinates.
    pub(crate) fn load(&mut self, outline: &Outline) {
        let (origin, scale) = (self.origin, 1.0 / self.radius);
        self.scratch.points.clear();
        for piece in outline.pieces() {
            self.scratch.points.extend(piece.points.iter().map(|p| Point2::from((p - origin) * scale)));
        }
    }

    /// Moves on by `seconds` of the estimated motion.
    pub fn predict(&mut self, seconds: f64) {
        let k = self.information.k;
        let flow = self.model.flow(&self.motion[..k], seconds).into_inner();
        let Some(inverse) = flow.try_inverse().filter(|m| m.iter().all(|e| e.is_finite())) else { return };
        let sensitivities = self.model.flow_sensitivities(&self.motion[..k], seconds);
        let by_motion = columns(self.model, sensitivities.into_iter());
        let ad_inverse = adjoint(self.model, &inverse, &flow);
        let mut product: CoordinateMatrix = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for i in 0..k {
            for j in 0..k {
                product[i][j] = (0..k).map(|m| ad_inverse[i][m] * by_motion[m][j]).sum();
            }
        }
        self.pose = flow * self.pose;
        self.information.predict(&ad_inverse, &product);
        self.marginal = moved_marginal(&self.marginal, k, &ad_inverse, &product);
        self.span += seconds;
    }

    /// Lets the motion have changed at random over `seconds`. The offsets keep what they are known to be, and their regression on
    /// pose and motion; only what they would come to know of each other is dropped.
    pub fn add_process_noise(&mut self, noise: &ProcessNoise, seconds: f64) {
        if noise.rates == 0.0 && noise.velocities == 0.0 {
            return;
        }
        self.process_noise = *noise;
        let k = self.information.k;
        let units = self.sigma * self.sigma;
        let mut added = StateMatrix::zeros();
        for (j, name) in self.model.parameter_names().iter().enumerate() {
            let per_second = match name.as_bytes()[0] {
                b'b' => noise.velocities / self.radius,
                b'c' => noise.rates * self.radius,
                _ => noise.rates,
            };
            added[(k + j, k + j)] = per_second * per_second * seconds / units;
        }
        let Some(covariance) = self.marginal.try_inverse() else { return };
        // Before (x) given after (x'): x = K x' + rest.
        let Some(after) = (covariance + added).try_inverse() else { return };
        let gain = covariance * after;
        let rest = covariance - gain * covariance;
        let mut dense = after;
        for cell in &mut self.information.cells {
            if cell.own <= 0.0 {
                continue;
            }
            let slope = StateVector::from(cell.coupling) / cell.own;
            let own = 1.0 / (1.0 / cell.own + (slope.transpose() * rest * slope).x.max(0.0));
            let coupling = gain.transpose() * slope * own;
            dense += coupling * coupling.transpose() / own;
            cell.own = own;
            cell.coupling = coupling.into();
        }
        for (i, row) in self.information.dense.iter_mut().enumerate().take(2 * k) {
            (0..2 * k).for_each(|j| row[j] = dense[(i, j)]);
        }
        self.marginal = after;
    }

    /// Puts the object into a new pose and forgets motion and pose, keeping the outline.
    pub(crate) fn relocate(&mut self, pose: Matrix3<f64>) {
        let k = self.information.k;
        self.pose = pose;
        self.information.dense = ArrowInformation::new(k).dense;
        for i in 0..k {
            self.information.dense[i][i] = MOTION_PRIOR;
            self.information.dense[k + i][k + i] = MOTION_PRIOR;
        }
        for cell in &mut self.information.cells {
            *cell = CellInformation { own: cell.own, ..CellInformation::NOTHING };
        }
        self.marginal = self.information.marginal();
        self.span = 0.0;
    }

    /// Directions of the pose that the cells do not show, from their lever arms about their mean.
    pub(crate) fn find_unseen_directions(&mut self, normal_noise: f64) {
        let count = self.cells.len() as f64;
        let centroid = Point2::from(self.cells.iter().map(|c| c.centre.coords / count).sum::<Vector2<f64>>());
        let spread = self.cells.iter().map(|c| (c.centre - centroid).norm_squared() / count).sum::<f64>().sqrt();
        let mut levers = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::identity();
        levers.view_mut((0, 0), (self.information.k, self.information.k)).fill(0.0);
        for cell in &self.cells {
            let p = Point2::from((cell.centre - centroid) / spread);
            let row = normal_velocities(self.model, &p, &cell.normal);
            let row = nalgebra::SVector::from(row);
            levers += row * row.transpose() / count;
        }
        let eigen = levers.symmetric_eigen();
        let threshold = DEGENERATE + 1.5 * normal_noise * normal_noise;
        let to_body = Matrix3::new(spread, 0.0, centroid.x, 0.0, spread, centroid.y, 0.0, 0.0, 1.0);
        self.unseen_in_body.clear();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value < threshold {
                let generator = self.model.generator(&vector.as_slice()[..self.information.k]);
                let Some(inverse) = to_body.try_inverse() else { continue };
                self.unseen_in_body
                    .push(crate::motion_algebra::coordinates(self.model, &(to_body * generator * inverse)));
            }
        }
        self.body_frame = to_body;
    }

    /// The same in the image, for the pose given.
    pub(crate) fn unseen_in_image(&self, pose: &Matrix3<f64>) -> Vec<Unseen> {
        if self.unseen_in_body.is_empty() {
            return Vec::new();
        }
        let k = self.information.k;
        let Some(inverse) = pose.try_inverse() else { return Vec::new() };
        let (ad, ad_inverse) = (adjoint(self.model, pose, &inverse), adjoint(self.model, &inverse, pose));
        // Duals in centred coordinates, where the directions are orthonormal.
        let to_body = self.body_frame;
        let Some(from_body) = to_body.try_inverse() else { return Vec::new() };
        let centring = adjoint(self.model, &from_body, &to_body);
        let list = self.unseen_in_body.iter().map(|u| {
            let mut direction = [0.0; MAX_PARAMETERS];
            let mut centred = [0.0; MAX_PARAMETERS];
            for i in 0..k {
                direction[i] = (0..k).map(|j| ad[i][j] * u[j]).sum();
                centred[i] = (0..k).map(|j| centring[i][j] * u[j]).sum();
            }
            let mut in_body = [0.0; MAX_PARAMETERS];
            let mut dual = [0.0; MAX_PARAMETERS];
            for j in 0..k {
                in_body[j] = (0..k).map(|i| centred[i] * centring[i][j]).sum();
            }
            for j in 0..k {
                dual[j] = (0..k).map(|i| in_body[i] * ad_inverse[i][j]).sum();
            }
            Unseen { direction, dual }
        });
        list.collect()
    }

    /// Takes a frame's estimate of the noise into the running mean.
    pub(crate) fn take_noise(&mut self, sigma: f64) {
        let weight = self.sigma_weight;
        self.sigma = (self.sigma * weight + sigma) / (weight + 1.0);
        self.sigma = self.sigma.max(self.sigma_floor);
        self.sigma_weight = (weight + 1.0).min(NOISE_MEMORY);
    }

    /// Normalised coordinates to image coordinates.
    pub(crate) fn to_image(&self) -> Matrix3<f64> {
        Matrix3::new(self.radius, 0.0, self.origin.x, 0.0, self.radius, self.origin.y, 0.0, 0.0, 1.0)
    }

    /// The map of the image that has moved the first frame's outline to where it is now.
    #[must_use]
    pub fn pose(&self) -> Projective2<f64> {
        let to_image = self.to_image();
        let inverse = to_image.try_inverse().unwrap_or_else(Matrix3::identity);
        Projective2::from_matrix_unchecked(to_image * self.pose * inverse)
    }

    /// Standard deviation of the noise on the points, image lengths.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.sigma * self.radius
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The outline as it is known now, image coordinates: one point per cell, in no particular order where the map has grown.
    pub fn outline_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        let to_image = self.to_image() * self.pose;
        self.cells.iter().map(move |cell| map_point(&to_image, &(cell.centre + cell.offset * cell.normal)))
    }

    /// Covariance of the motion parameters in the order of the model, image units; `None` where it cannot be computed.
    #[must_use]
    pub fn covariance(&self) -> Option<nalgebra::DMatrix<f64>> {
        let k = self.information.k;
        let to_image = self.to_image();
        let change = adjoint(self.model, &to_image, &to_image.try_inverse()?);
        let inverse = scaled_inverse(&self.marginal)?;
        let change = nalgebra::DMatrix::from_fn(k, k, |i, j| change[i][j]);
        let motion = nalgebra::DMatrix::from_fn(k, k, |i, j| inverse[(k + i, k + j)] * self.sigma * self.sigma);
        Some(&change * motion * change.transpose())
    }

    /// The motion in image units, with standard deviations. A parameter whose standard deviation, over the time seen so
    /// far, would turn the object by a quarter of a radian or move it by a quarter of its size is marked as unobservable; so is one
    /// that takes part in a motion which the outline does not show, such as the turning of a circle about its centre.
    #[must_use]
    pub fn estimate(&self) -> Option<MotionEstimate> {
        let covariance = self.covariance()?;
        let k = self.information.k;
        let to_image = self.to_image();
        let generator = to_image * self.model.generator(&self.motion[..k]) * to_image.try_inverse()?;
        let values = crate::motion_algebra::coordinates(self.model, &generator);
        let deviations: Vec<f64> = covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        let mut estimate = MotionEstimate::new(self.model, &values[..k], Some(&deviations));
        let blind = self.blind_parameters().unwrap_or([false; MAX_PARAMETERS]);
        let reach = self.radius + self.origin.coords.norm();
        for (j, name) in self.model.parameter_names().iter().enumerate() {
            let (limit, drift) = match name.as_bytes()[0] {
                b'b' => (reach, self.process_noise.velocities),
                b'c' => (1.0 / reach, self.process_noise.rates),
                _ => (1.0, self.process_noise.rates),
            };
            // A motion that drifts is known no longer than it takes to drift by its standard deviation.
            let span = self.span.min((deviations[j] / drift).powi(2));
            let known = deviations[j] * span <= WORTHLESS * limit;
            if !known || blind[j] {
                estimate = estimate.with_unobservable(j);
            }
        }
        Some(estimate)
    }
}

impl OutlineMap {
    /// Parameters that take part in a motion which the outline does not show, and which the path of the object has not shown either.
    fn blind_parameters(&self) -> Option<[bool; MAX_PARAMETERS]> {
        let mut blind = [false; MAX_PARAMETERS];
        if self.unseen_in_body.is_empty() {
            return Some(blind);
        }
        let k = self.information.k;
        let covariance = scaled_inverse(&self.marginal)?;
        let covariance = nalgebra::DMatrix::from_fn(k, k, |i, j| covariance[(k + i, k + j)]);
        let frame = self.pose * self.body_frame;
        let from_centred = adjoint(self.model, &frame, &frame.try_inverse()?);
        let from_centred = nalgebra::DMatrix::from_fn(k, k, |i, j| from_centred[i][j]);
        let to_centred = from_centred.clone().try_inverse()?;
        let information = (&to_centred * covariance * to_centred.transpose()).try_inverse()?;
        let typical = information.trace() / k as f64;
        for unseen in self.unseen_in_image(&self.pose) {
            let direction = nalgebra::DVector::from_column_slice(&unseen.direction[..k]);
            let centred = &to_centred * &direction;
            let seen = (centred.transpose() * &information * &centred)[(0, 0)] / centred.norm_squared();
            if seen < SEEN_BY_PATH * typical {
                let largest = direction.amax();
                (0..k).filter(|j| direction[*j].abs() > 0.1 * largest).for_each(|j| blind[j] = true);
            }
        }
        Some(blind)
    }
}

/// Inverse of a positive definite matrix, scaled to unit diagonal on the way.
fn scaled_inverse(matrix: &StateMatrix) -> Option<StateMatrix> {
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled = StateMatrix::from_fn(|i, j| matrix[(i, j)] * scale[i] * scale[j]);
    // Directions that nothing is known of may come out a rounding below zero.
    let inverse = (scaled + StateMatrix::identity() * 1e-14).cholesky()?.inverse();
    Some(StateMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]))
}
