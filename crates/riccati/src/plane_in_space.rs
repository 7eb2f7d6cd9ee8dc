//! A plane that moves rigidly in space, seen by a perspective camera.
use nalgebra::{Matrix3, Projective2, Rotation3, SymmetricEigen, Vector3};

/// Angles in radians below which the series of the exponential are used: their next terms are then below rounding.
const SMALL_ANGLE: f64 = 1e-2;
/// Share of the size of a generator below which its symmetric part is rounding.
const ROUNDING: f64 = 1e-12;
/// Smallest cosine between normal and optical axis of a plane that could be seen.
const EDGE_ON: f64 = 1e-6;

/// Motion of a plane in space at one moment, in the coordinates of the camera: x and y as in its picture, z along the optical axis away
/// from it, in lengths of any unit. Points X of the plane have `n . X = 1` and move by `X' = w x X + v`.
///
/// With normalised image points, `X / Z` of focal length 1 about the principal point, the picture moves by the projective generator
/// `H = [w]x + v n'`, whose multiple of the identity moves nothing (equation 1 of `docs/plane-in-space.md`).
///
/// ```
/// use freeform_riccati::PlaneMotion;
/// use nalgebra::{Point2, Vector3};
///
/// // A plane that faces the camera and turns about the optical axis: positive omega turns clockwise, so w is along -z.
/// let plane = PlaneMotion { angular_velocity: Vector3::new(0.0, 0.0, -1.2), velocity: Vector3::zeros(), normal: Vector3::z() };
/// let seen = plane.flow(0.5) * Point2::new(0.3, 0.1);
/// let (sin, cos) = 0.6_f64.sin_cos();
/// assert!((seen - Point2::new(0.3 * cos + 0.1 * sin, 0.1 * cos - 0.3 * sin)).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlaneMotion {
    /// Angular velocity w in rad/s.
    pub angular_velocity: Vector3<f64>,
    /// Velocity v at the centre of the camera, lengths per second.
    pub velocity: Vector3<f64>,
    /// Normal over the distance of the plane from the camera, n, per length. Its z is 1 where lengths are in distances of the plane
    /// along the optical axis.
    pub normal: Vector3<f64>,
}

/// Motions of a plane whose pictures move by one generator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaneSolutions {
    /// The camera sees no velocity, only a turn; every plane shows that.
    Turn {
        /// Angular velocity in rad/s.
        angular_velocity: Vector3<f64>,
    },
    /// One plane: it moves along its normal, or the other solution is seen edge on.
    One(PlaneMotion),
    /// The two that are known of plane motion (Longuet-Higgins, *The visual ambiguity of a moving plane*, 1984). They part in
    /// time, as their normals change differently.
    Two([PlaneMotion; 2]),
}

impl PlaneMotion {
    /// The generator `H = [w]x + v n'` of normalised image points at this moment, per second.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        self.angular_velocity.cross_matrix() + self.velocity * self.normal.transpose()
    }

    /// Rate of the normal, `n' = w x n - (n . v) n` (equation 2): a Riccati equation, per length and second.
    #[must_use]
    pub fn normal_rate(&self) -> Vector3<f64> {
        self.angular_velocity.cross(&self.normal) - self.normal * self.normal.dot(&self.velocity)
    }

    /// The map of normalised image points that the motion makes in `seconds` at constant w and v: `R + T n'` in closed form, with X
    /// going to `R X + T` (equation 3).
    #[must_use]
    pub fn flow(&self, seconds: f64) -> Projective2<f64> {
        let (turn, shift) = self.displacement(seconds);
        Projective2::from_matrix_unchecked(turn.matrix() + shift * self.normal.transpose())
    }

    /// The motion after so many seconds at constant w and v: its normal is `R n / (1 + (R n) . T)` (equation 4).
    #[must_use]
    pub fn after(&self, seconds: f64) -> Self {
        let (turn, shift) = self.displacement(seconds);
        let turned = turn * self.normal;
        Self { normal: turned / (1.0 + turned.dot(&shift)), ..*self }
    }

    /// Turn R and shift T of space in so many seconds.
    fn displacement(&self, seconds: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let axis = self.angular_velocity * seconds;
        let [by_cross, by_double] = shift_coefficients(axis.norm_squared());
        let way = self.velocity * seconds;
        let cross = axis.cross(&way);
        (Rotation3::from_scaled_axis(axis), way + by_cross * cross + by_double * axis.cross(&cross))
    }

    /// Derivatives of [`flow`](Self::flow), as the matrix `R + T n'`, by the three parts of w, the three of v, and x and y of the
    /// normal at the start (equation 6).
    #[must_use]
    pub fn flow_sensitivities(&self, seconds: f64) -> [Matrix3<f64>; Self::PARAMETERS] {
        let axis = self.angular_velocity * seconds;
        let square = axis.norm_squared();
        let [by_cross, by_double] = shift_coefficients(square);
        let [cross_slope, double_slope] = shift_slopes(square);
        let way = self.velocity * seconds;
        let (cross, normal) = (axis.cross(&way), self.normal.transpose());
        let double = axis.cross(&cross);
        let (turn, shift) = (Rotation3::from_scaled_axis(axis), way + by_cross * cross + by_double * double);
        // The shift of a way, and the turn that an added axis makes on the left: both by the same series (Barfoot 2017, equation 7.77).
        let mean_turn = |u: &Vector3<f64>| {
            let cross = axis.cross(u);
            u + by_cross * cross + by_double * axis.cross(&cross)
        };
        let unit = |i: usize| Vector3::ith(i, 1.0);
        let by_turning = |i: usize| {
            let added = unit(i) * seconds;
            let along = 2.0 * axis.dot(&added);
            let of_double = added.cross(&cross) + axis.cross(&added.cross(&way));
            let of_shift = along * (cross_slope * cross + double_slope * double)
                + by_cross * added.cross(&way)
                + by_double * of_double;
            mean_turn(&added).cross_matrix() * turn.matrix() + of_shift * normal
        };
        let by_velocity = |i: usize| mean_turn(&(unit(i) * seconds)) * normal;
        let by_normal = |i: usize| shift * unit(i).transpose();
        let [w, v] = [[0, 1, 2].map(by_turning), [0, 1, 2].map(by_velocity)];
        [w[0], w[1], w[2], v[0], v[1], v[2], by_normal(0), by_normal(1)]
    }

    /// Number of parameters of a plane in motion: w, v, and x and y of the normal at the start.
    pub const PARAMETERS: usize = 8;

    /// Names of the parameters of the motion, w and v.
    pub const NAMES: [&'static str; 6] = ["wx", "wy", "wz", "vx", "vy", "vz"];

    /// Their units; lengths are in distances of the plane along the optical axis at the start.
    pub const UNITS: [&'static str; 6] = ["rad/s", "rad/s", "rad/s", "1/s", "1/s", "1/s"];

    /// The motion with parameters in the order of [`flow_sensitivities`](Self::flow_sensitivities), z of the normal being 1.
    #[must_use]
    pub fn of_parameters([wx, wy, wz, vx, vy, vz, nx, ny]: [f64; Self::PARAMETERS]) -> Self {
        let (angular_velocity, velocity) = (Vector3::new(wx, wy, wz), Vector3::new(vx, vy, vz));
        Self { angular_velocity, velocity, normal: Vector3::new(nx, ny, 1.0) }
    }

    /// The inverse of [`of_parameters`](Self::of_parameters), where z of the normal is 1.
    #[must_use]
    pub fn parameters(&self) -> [f64; Self::PARAMETERS] {
        let (w, v, n) = (self.angular_velocity, self.velocity, self.normal);
        [w.x, w.y, w.z, v.x, v.y, v.z, n.x, n.y]
    }

    /// The motion in units of length in which z of the normal is 1: distances of the plane along the optical axis. `None` for a plane that
    /// is seen edge on along the optical axis.
    #[must_use]
    pub fn scaled_to_axis(&self) -> Option<Self> {
        let depth = self.normal.z;
        (depth.abs() > EDGE_ON * self.normal.norm()).then(|| Self {
            velocity: self.velocity * depth,
            normal: self.normal / depth,
            ..*self
        })
    }

    /// The motions of planes whose pictures move by a generator of normalised image points, a multiple of the identity being free;
    /// with normals whose z is 1 (equation 5).
    ///
    /// The symmetric part of `[w]x + v n'` has the eigenvalues `(v . n +- |v| |n|) / 2` and 0 between them, which fixes the free multiple. With
    /// `S = a a' - b b'` what is left, n is along a + b and v along a - b, or the other way round.
    #[must_use]
    pub fn of_generator(generator: &Matrix3<f64>) -> PlaneSolutions {
        let SymmetricEigen { eigenvalues, eigenvectors } =
            (0.5 * (generator + generator.transpose())).symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigenvalues[j].total_cmp(&eigenvalues[i]));
        let [most, middle, least] = order.map(|i| eigenvalues[i]);
        let vorticity =
            |m: &Matrix3<f64>| 0.5 * Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]);
        if most - least <= ROUNDING * generator.norm() {
            return PlaneSolutions::Turn { angular_velocity: vorticity(generator) };
        }
        let a = eigenvectors.column(order[0]) * (most - middle).max(0.0).sqrt();
        let b = eigenvectors.column(order[2]) * (middle - least).max(0.0).sqrt();
        let solution = |normal: Vector3<f64>, velocity: Vector3<f64>| {
            let depth = normal.z;
            (depth.abs() > EDGE_ON * normal.norm()).then(|| {
                let (normal, velocity) = (normal / depth, velocity * depth);
                let angular_velocity = vorticity(&(generator - velocity * normal.transpose()));
                Self { angular_velocity, velocity, normal }
            })
        };
        let is_one = a.norm().min(b.norm()) <= ROUNDING.sqrt() * (a.norm() + b.norm());
        match (solution(a + b, a - b), solution(a - b, a + b)) {
            (Some(first), Some(second)) if !is_one => PlaneSolutions::Two([first, second]),
            (Some(only), _) | (None, Some(only)) => PlaneSolutions::One(only),
            (None, None) => PlaneSolutions::Turn { angular_velocity: vorticity(generator) },
        }
    }
}

/// `(1 - cos a) / a^2` and `(a - sin a) / a^3` for an angle of this square.
fn shift_coefficients(square: f64) -> [f64; 2] {
    let angle = square.sqrt();
    if angle < SMALL_ANGLE {
        let series = |[a, b, c]: [f64; 3]| a - square * (b - square * c);
        [series([1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0]), series([1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0])]
    } else {
        let half = (0.5 * angle).sin();
        [2.0 * half * half / square, (angle - angle.sin()) / (square * angle)]
    }
}

/// Derivatives of the [`shift_coefficients`] by the square of the angle.
fn shift_slopes(square: f64) -> [f64; 2] {
    let angle = square.sqrt();
    if angle < SMALL_ANGLE {
        let series = |[a, b, c]: [f64; 3]| -a + square * (b - square * c);
        [series([1.0 / 24.0, 1.0 / 360.0, 1.0 / 13440.0]), series([1.0 / 120.0, 1.0 / 2520.0, 1.0 / 120_960.0])]
    } else {
        let (sin, half) = (angle.sin(), (0.5 * angle).sin());
        let versine = 2.0 * half * half;
        [
            (0.5 * angle * sin - versine) / (square * square),
            0.5 * (angle * versine - 3.0 * (angle - sin)) / (square * square * angle),
        ]
    }
}
