//! Hypotheses of projective motion moved on: rates and perspective about the centroid, and the velocity of the centroid.
//!
//! About its own centroid a pose is a shift of that behind a map which leaves it where it is, and the logarithm of that map has six entries, four
//! rates and two of the perspective. Affine motion is the same without the latter.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, Vector2};

use super::{
    centred::{CentredVector, by_rates, carry, centred_generator, centred_order, moved_by, parts},
    course::Course,
    hypothesis::Hypothesis,
    step::{Step, turned_along},
};
use crate::{
    map::NullDirection,
    prediction::{PoseMatrix, adjoint_matrix},
};

const MODEL: MotionModel = MotionModel::Projective;
/// Entries of a pose about the centroid before those of its shift.
const RATES: usize = MAX_PARAMETERS - 2;

/// Whether directions that the outline does not show are no directions but curves in the pose: of an ellipse under projective motion they bend with
/// the perspective, and hypotheses that are held along straight lines lead astray.
pub(crate) fn is_beyond_linear(model: MotionModel, null: &[NullDirection]) -> bool {
    model == MotionModel::Projective && !null.is_empty()
}

/// A motion about the centroid over a step.
struct Moved {
    /// What it makes of a pose, the centroid being the origin before it and after it.
    local: Matrix3<f64>,
    /// How far it carries the centroid.
    shift: Vector2<f64>,
    /// The motion after it, about the centroid then.
    motion: CentredVector,
    /// Its errors by those of the motion before.
    of_motion: PoseMatrix,
    /// Shift of the centroid by an error of the motion.
    shift_of_motion: SMatrix<f64, 2, MAX_PARAMETERS>,
}

impl<const N: usize> Hypothesis<N> {
    /// As [`predict_any`](Self::predict_any) for projective motion; whether the numbers allow it. Errors are carried to the first order of a step.
    pub(super) fn predict_in_perspective(&mut self, step: &Step<'_>) -> bool {
        debug_assert!(step.model == MODEL && Self::K == MAX_PARAMETERS);
        let (k, dt) = (MAX_PARAMETERS, step.seconds);
        let entry = |at: usize| CentredVector::from_fn(|j, _| self.mean[at * k + j]);
        let [error, motion, acceleration] = [entry(0), entry(1), entry(2)];
        let moved = match self.course {
            Course::ConstantGenerator | Course::Shaken { .. } => {
                moved_by_generator(&motion, &CentredVector::zeros(), dt)
            }
            Course::ChangingGenerator { .. } | Course::SteadyChange { turns: true } => {
                moved_by_generator(&motion, &acceleration, dt)
            }
            Course::ConstantVelocity { .. } => moved_straight(&motion, &acceleration, dt),
            Course::Accelerating { .. } | Course::SteadyChange { turns: false } => {
                moved_by_accelerations(&motion, &acceleration, dt)
            }
        };
        let Some(moved) = moved else { return false };
        let local = moved.local * without_shift(&error, 1.0) * step.local;
        let Some(off) = MODEL.motion_between(&local, 1.0) else { return false };
        let Some(transition) = self.transition_in_perspective(&moved, dt) else { return false };
        let size = self.size();
        carry(&transition, &mut self.covariance, size);
        let off = in_centred_order(&off);
        let centre = step.centre + error.fixed_rows::<2>(RATES) + moved.shift;
        self.mean.fixed_rows_mut::<RATES>(0).copy_from(&off.fixed_rows::<RATES>(0));
        self.mean.fixed_rows_mut::<2>(RATES).copy_from(&centre);
        self.mean.fixed_rows_mut::<MAX_PARAMETERS>(k).copy_from(&moved.motion);
        if self.course.is_constant_velocity() {
            let turn = moved.local.fixed_view::<2, 2>(0, 0);
            let turning = turn * acceleration.fixed_rows::<2>(RATES);
            self.mean.fixed_rows_mut::<2>(2 * k + RATES).copy_from(&turning);
        }
        self.add_change_of_accelerations(step);
        true
    }

    /// Propagation of errors over a step of so many seconds.
    fn transition_in_perspective(&self, moved: &Moved, dt: f64) -> Option<SMatrix<f64, N, N>> {
        let k = MAX_PARAMETERS;
        let carried = in_centred_coordinates(&adjoint_matrix(MODEL, &moved.local, &moved.local.try_inverse()?));
        let mut f = SMatrix::<f64, N, N>::identity();
        for (i, j) in (0..RATES).flat_map(|i| (0..RATES).map(move |j| (i, j))) {
            let own = f64::from(u8::from(i == j));
            f[(i, j)] = carried[(i, j)];
            f[(i, k + j)] = 0.5 * dt * (own + carried[(i, j)]);
        }
        f.fixed_view_mut::<2, MAX_PARAMETERS>(RATES, k).copy_from(&moved.shift_of_motion);
        f.fixed_view_mut::<MAX_PARAMETERS, MAX_PARAMETERS>(k, k).copy_from(&moved.of_motion);
        match self.course {
            Course::ConstantGenerator | Course::Shaken { .. } => {}
            Course::ConstantVelocity { .. } => {
                let turn = moved.local.fixed_view::<2, 2>(0, 0).into_owned();
                let less = turn - Matrix2::identity();
                f.fixed_view_mut::<2, 2>(RATES, 2 * k + RATES).copy_from(&(0.5 * dt * less));
                f.fixed_view_mut::<2, 2>(k + RATES, 2 * k + RATES).copy_from(&less);
                f.fixed_view_mut::<2, 2>(2 * k + RATES, 2 * k + RATES).copy_from(&turn);
            }
            Course::Accelerating { .. } | Course::ChangingGenerator { .. } | Course::SteadyChange { .. } => {
                for j in 0..k {
                    f[(j, 2 * k + j)] = 0.5 * dt * dt;
                    f[(k + j, 2 * k + j)] = dt;
                }
            }
        }
        Some(f)
    }
}

/// A generator that stays over a step, but for accelerations.
fn moved_by_generator(motion: &CentredVector, acceleration: &CentredVector, dt: f64) -> Option<Moved> {
    let half_way = motion + 0.5 * dt * acceleration;
    let flow = MODEL.flow(&in_order_of_model(&half_way), dt).into_inner();
    let shift = map_point(&flow, &Point2::origin()).coords;
    let (to, from) = (moved_by(-shift.x, -shift.y), moved_by(shift.x, shift.y));
    let generator = to * centred_generator(MODEL, motion.as_slice()) * from;
    let later = in_centred_order(&MODEL.parameters_of(&generator));
    let (linear, velocity) = parts(&centred_generator(MODEL, motion.as_slice()));
    // To the second order: the velocity, and half of what the rates make of it.
    let mut shift_of_motion = SMatrix::<f64, 2, MAX_PARAMETERS>::zeros();
    shift_of_motion.fixed_view_mut::<2, 2>(0, RATES).copy_from(&(Matrix2::identity() * dt + linear * (0.5 * dt * dt)));
    for (j, by_rate) in by_rates(MODEL, &(velocity * (0.5 * dt * dt))).enumerate() {
        shift_of_motion.fixed_view_mut::<2, 1>(0, j).copy_from(&by_rate);
    }
    // The motion about a centroid that is elsewhere: its derivative by that place is a commutator.
    let mut of_motion = in_centred_coordinates(&adjoint_matrix(MODEL, &to, &from));
    for (i, basis) in MODEL.basis()[4..6].iter().enumerate() {
        let by_place = in_centred_order(&MODEL.parameters_of(&(generator * basis - basis * generator)));
        of_motion += by_place * shift_of_motion.row(i);
    }
    local_of(&flow).map(|local| Moved { local, shift, motion: later + dt * acceleration, of_motion, shift_of_motion })
}

/// Constant rates and a constant velocity of a point aside of the centroid; of the velocity of the centroid, `turning` goes with the object.
fn moved_straight(motion: &CentredVector, turning: &CentredVector, dt: f64) -> Option<Moved> {
    let linear = parts(&centred_generator(MODEL, motion.as_slice())).0;
    let along = (Matrix2::identity() + linear * (0.5 * dt)) * dt;
    let local = local_of(&without_shift(motion, dt))?;
    let turn = local.fixed_view::<2, 2>(0, 0).into_owned();
    let turning = turning.fixed_rows::<2>(RATES).into_owned();
    let velocity = motion.fixed_rows::<2>(RATES).into_owned();
    let shift = velocity * dt + turned_along(&along, dt) * turning;
    let mut later = *motion;
    later.fixed_rows_mut::<2>(RATES).copy_from(&(velocity + turn * turning - turning));
    Some(Moved { local, shift, motion: later, of_motion: PoseMatrix::identity(), shift_of_motion: by_velocity(dt) })
}

/// Rates and a velocity of the centroid that each change at a steady rate; no part of the velocity turns with the object.
fn moved_by_accelerations(motion: &CentredVector, acceleration: &CentredVector, dt: f64) -> Option<Moved> {
    let half_way = motion + 0.5 * dt * acceleration;
    let local = local_of(&without_shift(&half_way, dt))?;
    let shift = half_way.fixed_rows::<2>(RATES) * dt;
    let later = motion + dt * acceleration;
    Some(Moved { local, shift, motion: later, of_motion: PoseMatrix::identity(), shift_of_motion: by_velocity(dt) })
}

fn by_velocity(dt: f64) -> SMatrix<f64, 2, MAX_PARAMETERS> {
    SMatrix::from_fn(|i, j| if j == RATES + i { dt } else { 0.0 })
}

/// What a motion without its velocity makes in so many seconds.
pub(super) fn without_shift(motion: &CentredVector, seconds: f64) -> Matrix3<f64> {
    let mut rates = *motion;
    rates.fixed_rows_mut::<2>(RATES).fill(0.0);
    MODEL.flow(&in_order_of_model(&rates), seconds).into_inner()
}

/// A map with the origin taken back to where it was; `None` if it takes the origin to infinity.
pub(super) fn local_of(map: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let shift = map_point(map, &Point2::origin());
    let mut local = moved_by(-shift.x, -shift.y) * map;
    local /= local[(2, 2)];
    (local[(0, 2)], local[(1, 2)]) = (0.0, 0.0);
    local.iter().all(|entry| entry.is_finite()).then_some(local)
}

pub(super) fn in_order_of_model(centred: &CentredVector) -> ParameterVector {
    let mut parameters = [0.0; MAX_PARAMETERS];
    centred.iter().zip(centred_order(MODEL)).for_each(|(entry, j)| parameters[*j] = *entry);
    parameters
}

pub(super) fn in_centred_order(parameters: &ParameterVector) -> CentredVector {
    CentredVector::from_fn(|i, _| parameters[centred_order(MODEL)[i]])
}

/// A change of parameters in the order of the model as one of them in centred order.
fn in_centred_coordinates(change: &PoseMatrix) -> PoseMatrix {
    let order = centred_order(MODEL);
    PoseMatrix::from_fn(|i, j| change[(order[i], order[j])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{CentredPose, course::PointOfBody, usual_step::Units};

    type State = nalgebra::SVector<f64, 24>;

    const COURSES: [Course; 9] = [
        Course::ConstantGenerator,
        Course::straight(PointOfBody::NearCentroid),
        Course::straight(PointOfBody::Any),
        Course::ConstantVelocity { of: PointOfBody::Any, deviations: 2.0 },
        Course::Accelerating { level: 1e-1, rates: true },
        Course::Accelerating { level: 1e1, rates: false },
        Course::ChangingGenerator { level: 1e1 },
        Course::SteadyChange { turns: true },
        Course::SteadyChange { turns: false },
    ];

    fn pose(parameters: [f64; 8]) -> CentredPose {
        CentredPose { pose: MODEL.flow(&parameters, 1.0).into_inner(), centroid: Point2::new(0.1, -0.3) }
    }

    fn poses() -> [CentredPose; 2] {
        [[0.1, 0.3, -0.4, 0.05, 0.2, -0.1, 0.04, -0.03], [0.12, 0.35, -0.43, 0.02, 0.25, -0.08, 0.05, -0.01]].map(pose)
    }

    /// What a hypothesis has for the object: where a point of the body is in the image.
    fn place(mean: &State, reference: &CentredPose, point: &Point2<f64>) -> Point2<f64> {
        let centre = reference.centre() + mean.fixed_rows::<2>(RATES);
        let error = CentredVector::from_fn(|j, _| mean[j]);
        let local = without_shift(&error, 1.0) * reference.local(MODEL);
        map_point(&(moved_by(centre.x, centre.y) * local), &(point - reference.centroid.coords))
    }

    fn begun(course: Course) -> Hypothesis<24> {
        let size = if course.has_more_than_motion() { 24 } else { 16 };
        let mut mean = State::from_fn(|i, _| if i < size { 0.3 * (1.0 + 2.3 * i as f64).sin() } else { 0.0 });
        (0..8).for_each(|i| mean[i] *= 0.1);
        if course.is_constant_velocity() {
            mean.fixed_rows_mut::<6>(16).fill(0.0);
        }
        Hypothesis { course, mean, covariance: SMatrix::zeros() }
    }

    #[test]
    fn a_constant_generator_of_projective_motion_moves_the_points_of_a_body_as_its_flow_does() {
        let [from, to] = poses();
        let variance = CentredVector::repeat(1.0);
        let step = Step::new((MODEL, 0.4), [&from, &to], Units::of_usual_step(&variance, 0.4)).expect("poses");
        let mut hypothesis = begun(Course::ConstantGenerator);
        let before = hypothesis.mean;
        let centre = from.centre() + before.fixed_rows::<2>(RATES);
        let motion = CentredVector::from_fn(|j, _| before[8 + j]);
        let flow = MODEL.flow(&in_order_of_model(&motion), 0.4).into_inner();
        let flow = moved_by(centre.x, centre.y) * flow * moved_by(-centre.x, -centre.y);
        assert!(hypothesis.predict(&step));
        for point in [Point2::new(0.7, 0.2), Point2::new(-0.4, 0.9), Point2::new(0.1, -0.3)] {
            let expected = map_point(&flow, &place(&before, &from, &point));
            let found = place(&hypothesis.mean, &to, &point);
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
        // And goes on as it was: half of the step twice is the step.
        let half = Step::new((MODEL, 0.2), [&from, &from], Units::of_usual_step(&variance, 0.2)).expect("poses");
        let rest = Step::new((MODEL, 0.2), [&from, &to], Units::of_usual_step(&variance, 0.2)).expect("poses");
        let mut twice = begun(Course::ConstantGenerator);
        assert!(twice.predict(&half) && twice.predict(&rest));
        assert!((twice.mean - hypothesis.mean).amax() < 1e-12);
    }

    /// Errors as the covariance carries them, and by finite differences.
    #[test]
    fn errors_of_projective_motion_are_carried_as_the_motion_is() {
        let [from, _] = poses();
        let variance = CentredVector::zeros();
        let dt = 0.005;
        let step = Step::new((MODEL, dt), [&from, &from], Units::of_usual_step(&variance, dt)).expect("poses");
        for course in COURSES {
            let mut begun = begun(course);
            begun.mean.fixed_rows_mut::<8>(0).fill(0.0);
            if course.is_constant_velocity() {
                // How the rates turn what is small of the velocity is left out.
                begun.mean.fixed_rows_mut::<2>(22).fill(0.0);
            }
            let size = begun.size();
            let moved = |mean: State| {
                let mut hypothesis = Hypothesis::<24> { mean, ..begun.clone() };
                assert!(hypothesis.predict(&step));
                hypothesis.mean
            };
            let without_acceleration = |j: usize| course.is_constant_velocity() && (16..22).contains(&j);
            for j in (0..size).filter(|j| !without_acceleration(*j)) {
                let unit = State::from_fn(|i, _| f64::from(u8::from(i == j)));
                let difference = (moved(begun.mean + 1e-5 * unit) - moved(begun.mean - 1e-5 * unit)) / 2e-5;
                let mut carried = Hypothesis::<24> { covariance: unit * unit.transpose(), ..begun.clone() };
                assert!(carried.predict(&step));
                let column = carried.covariance.column(j) / carried.covariance[(j, j)].sqrt();
                // A pose that is off is turned with its error, which a first order leaves out.
                let tolerance = if j < RATES { 0.5 * dt } else { dt * dt };
                assert!((difference - column).amax() < tolerance, "{course:?} {j}: {difference} {column}");
            }
        }
    }

    #[test]
    fn without_perspective_projective_motion_is_moved_on_as_affine_motion() {
        let poses =
            [[0.1, 0.3, -0.4, 0.05, 0.2, -0.1, 0.0, 0.0], [0.12, 0.35, -0.43, 0.02, 0.25, -0.08, 0.0, 0.0]].map(pose);
        let variance = CentredVector::zeros();
        let short = |entries: &State| -> nalgebra::SVector<f64, 18> {
            let affine = [0, 1, 2, 3, 6, 7];
            nalgebra::SVector::from_fn(|i, _| entries[8 * (i / 6) + affine[i % 6]])
        };
        for course in COURSES {
            let mut hypothesis = begun(course);
            (0..3).for_each(|at| hypothesis.mean.fixed_rows_mut::<2>(8 * at + 4).fill(0.0));
            let mut affine = Hypothesis::<18> { course, mean: short(&hypothesis.mean), covariance: SMatrix::zeros() };
            let dt = 0.02;
            let of = |model| {
                Step::new((model, dt), [&poses[0], &poses[1]], Units::of_usual_step(&variance, dt)).expect("poses")
            };
            assert!(hypothesis.predict(&of(MODEL)) && affine.predict(&of(MotionModel::Affine)));
            let apart = (short(&hypothesis.mean) - affine.mean).amax();
            assert!(apart < dt * dt * 0.1, "{course:?}: {apart}");
        }
    }
}
