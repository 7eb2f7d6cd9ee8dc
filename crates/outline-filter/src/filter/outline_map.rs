use freeform_curve_fit::Outline;
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, map_point};
use nalgebra::{Matrix3, Point2, Projective2, Vector2};

use super::{
    arrow_information::{ArrowInformation, StateMatrix},
    cell_scatter::Scatter,
    contour::Contour,
    error::FilterError,
    first_pose::FirstPose,
    innovation::PoseInnovation,
    map_update::{Piece, Scratch},
    misfit::Misfit,
    nearest_field::NearestField,
    noise_level::NoiseLevel,
    outline_drift::OutlineDrift,
};

/// Fewest points that a map is started from.
pub(crate) const FEWEST_POINTS: usize = 8;
/// Length of a cell in standard deviations of the noise. Shorter ones leave more offsets to be estimated, and points that come to the
/// wrong cell; longer ones a coarser outline.
const NOISE_PER_CELL: f64 = 3.0;
/// The same where there are plenty of points...
const LEAST_NOISE_PER_CELL: f64 = 1.5;
/// ...which are so many for each cell.
const PLENTY_PER_CELL: f64 = 4.0;
/// Fewest points of the first frame for each cell.
const POINTS_PER_CELL: f64 = 1.0;
/// Most cells of the first frame.
const MOST_CELLS: f64 = 800.0;
/// Weight of the first pose, in points: it only fixes the gauge, since pose and offsets can move together.
const GAUGE_WEIGHT: f64 = 10.0;
/// Information on the motion that makes the first equations solvable, per squared second: next to nothing.
pub(crate) const MOTION_PRIOR: f64 = 1e-10;
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
    /// How much its points scatter.
    pub(crate) scatter: Scatter,
    /// Of the offset in the last frame, in units of the noise; 0 where it was not seen.
    pub(crate) innovation: f64,
    /// The cells before and after it; its own number where none is known.
    pub(crate) neighbours: [usize; 2],
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
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_outline_filter::OutlineMap;
/// use freeform_riccati::MotionModel;
/// use nalgebra::{Isometry2, Point2, Vector2};
///
/// // An egg that moves so slowly that no guess of its motion is needed.
/// let seen_at = |time: f64| {
///     let pose = Isometry2::new(Vector2::new(0.02 * time, 0.0), 0.05 * time);
///     let egg = (0..300).map(|i| {
///         let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///         pose * Point2::new(0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
///     });
///     Outline::closed(egg.collect())
/// };
/// let mut map = OutlineMap::new(MotionModel::Rigid, &seen_at(0.0)?)?;
/// for frame in 1..10 {
///     map.predict(1.0 / 30.0);
///     let update = map.update(&seen_at(f64::from(frame) / 30.0)?, |update| update.agreement > 0.9);
///     assert!(update.accepted);
/// }
/// let motion = map.estimate().expect("more than one frame");
/// assert!((motion.values()[1] - 0.02).abs() < 0.002);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct OutlineMap {
    pub(crate) model: MotionModel,
    pub(crate) origin: Point2<f64>,
    pub(crate) radius: f64,
    /// Body to image.
    pub(crate) pose: Matrix3<f64>,
    pub(crate) first_pose: FirstPose,
    pub(crate) motion: ParameterVector,
    pub(crate) information: ArrowInformation,
    /// Marginal information of pose and motion.
    pub(crate) marginal: StateMatrix,
    pub(crate) cells: Vec<Cell>,
    /// Most places that a frame has shown at once.
    pub(crate) most_seen: usize,
    pub(crate) field: NearestField,
    pub(crate) spacing: f64,
    pub(crate) sigma: f64,
    pub(crate) sigma_weight: f64,
    /// What bent cells alone would leave of the residuals.
    sigma_floor: f64,
    pub(crate) half_window: usize,
    /// In the body frame.
    pub(crate) unseen_in_body: Vec<ParameterVector>,
    /// Whether something of it has been forgotten as the map grew: earlier poses are off by what nobody knows.
    pub(crate) is_forgotten: bool,
    /// Whether frames have not shown the turn, whatever the normals promise.
    pub(crate) turn_is_hidden: bool,
    /// Whether what a frame has shown for the first time shows the turn.
    pub(crate) shows_turn_at_last: bool,
    /// Whether the map was begun anew with a frame that shows the turn, and no other frame has told it since.
    pub(crate) turn_is_new: bool,
    /// From centred coordinates of unit RMS radius to the body frame.
    pub(crate) body_frame: Matrix3<f64>,
    pub(crate) scratch: Scratch,
    pub(crate) noise_level: NoiseLevel,
    pub(crate) drift: OutlineDrift,
    pub(crate) innovation: PoseInnovation,
    /// Whether the misfit of every frame is asked for.
    pub(crate) is_compared: bool,
    pub(crate) last_misfit: Misfit,
    /// Of the last prediction.
    pub(crate) step_seconds: f64,
    /// Seconds predicted over since the motion was last unknown.
    pub(crate) span: f64,
    /// Seconds of the past that each motion parameter is known from, in the body frame: the span, or, where the motion
    /// changes, what of it is not forgotten.
    pub(crate) spans: ParameterVector,
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
        let mut map = Self::without_cells(model, outline.centroid(), outline.rms_radius());
        map.load(outline);
        let contours: Vec<Contour> = map.contours().collect();
        map.cut(contours, 0.0).ok_or(too_few)?;
        Ok(map)
    }

    pub(crate) fn without_cells(model: MotionModel, origin: Point2<f64>, radius: f64) -> Self {
        let information = ArrowInformation::new(model.parameter_count());
        Self {
            model,
            origin,
            radius,
            pose: Matrix3::identity(),
            first_pose: FirstPose::default(),
            motion: [0.0; MAX_PARAMETERS],
            marginal: information.marginal(),
            information,
            cells: Vec::new(),
            most_seen: 0,
            field: NearestField::default(),
            spacing: 0.0,
            sigma: 0.0,
            sigma_weight: 0.5,
            sigma_floor: SMALLEST_NOISE,
            half_window: 2,
            unseen_in_body: Vec::new(),
            is_forgotten: false,
            turn_is_hidden: false,
            shows_turn_at_last: false,
            turn_is_new: false,
            body_frame: Matrix3::identity(),
            scratch: Scratch::default(),
            noise_level: NoiseLevel::NEW,
            drift: OutlineDrift::default(),
            innovation: PoseInnovation::default(),
            is_compared: false,
            last_misfit: Misfit::default(),
            step_seconds: 0.0,
            span: 0.0,
            spans: [0.0; MAX_PARAMETERS],
        }
    }

    /// Takes cells along contours in the body frame, and the loaded points, those of the first frame, as their first measurement. `None`
    /// where the contours do not make an outline. Their noise is no less than what is known of it.
    pub(crate) fn cut(&mut self, contours: Vec<Contour>, least_noise: f64) -> Option<()> {
        let (k, loaded) = (self.information.k, self.scratch.points.len());
        for i in 0..k {
            self.information.dense[i][i] = GAUGE_WEIGHT * loaded as f64;
            self.information.dense[k + i][k + i] = MOTION_PRIOR;
        }
        self.choose_resolution(&contours, least_noise);
        if loaded < FEWEST_POINTS || !(self.spacing > 0.0 && self.sigma.is_finite()) {
            return None;
        }
        self.grow_along(contours);
        if self.cells.len() < 3 {
            return None;
        }
        self.marginal = self.information.marginal();
        let sagitta = self.sagitta();
        self.sigma_floor = self.sigma_floor.max(0.25 * sagitta).max(CELL_ERROR * self.spacing);
        self.sigma = self.sigma.max(0.5 * sagitta).max(self.sigma_floor);
        Some(())
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

    /// Noise, window and spacing for contours.
    fn choose_resolution(&mut self, contours: &[Contour], least_noise: f64) {
        let (mut variance, mut count, mut length, mut window) = (0.0, 0.0, 0.0, 2);
        for contour in contours {
            let mut contour = contour.clone();
            let weight = contour.len() as f64;
            let Some(sigma) = contour.noise().map(|noise| noise.max(least_noise)) else { continue };
            window = contour.half_window(sigma).max(window);
            variance += weight * sigma * sigma;
            count += weight;
            length += contour.smooth_length(window);
        }
        // Exact points have no noise; the floor keeps weights finite and is far below what any number can tell.
        self.sigma = (variance / f64::max(count, 1.0)).sqrt().max(SMALLEST_NOISE);
        self.half_window = window;
        let finest = (count / POINTS_PER_CELL).clamp(4.0, MOST_CELLS);
        let plenty =
            (LEAST_NOISE_PER_CELL * self.sigma).max(PLENTY_PER_CELL * length / self.scratch.points.len() as f64);
        self.spacing = plenty.min(NOISE_PER_CELL * self.sigma).max(length / finest).min(length / 12.0);
    }

    /// The pieces of the loaded outline in the body frame.
    pub(crate) fn contours(&self) -> impl Iterator<Item = Contour> + '_ {
        let inverse = self.pose.try_inverse().unwrap_or_else(Matrix3::identity);
        self.scratch.pieces.iter().map(move |piece| {
            let points = self.scratch.points[piece.range()].iter().map(|p| map_point(&inverse, p)).collect();
            Contour::new(points, piece.closed)
        })
    }

    /// Brings the points of an outline into the map's own image coordinates. One that repeats the point before it is no second
    /// measurement.
    pub(crate) fn load(&mut self, outline: &Outline) {
        let (origin, scale) = (self.origin, 1.0 / self.radius);
        let Scratch { points, pieces, .. } = &mut self.scratch;
        points.clear();
        pieces.clear();
        for piece in outline.pieces() {
            let start = points.len();
            for p in piece.points {
                let p = Point2::from((p - origin) * scale);
                if points.len() == start || points.last() != Some(&p) {
                    points.push(p);
                }
            }
            while piece.closed && points.len() > start + 1 && points.last() == Some(&points[start]) {
                points.pop();
            }
            pieces.push(Piece { start, count: points.len() - start, closed: piece.closed });
        }
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
}
