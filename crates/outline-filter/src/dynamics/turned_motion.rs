//! Covariances of motion that does not accelerate, moved on without a matrix of the transition, most of whose entries are zero.
use nalgebra::{Matrix2, Vector2};

use super::{
    course::Course,
    hypothesis::Hypothesis,
    step::turned_along,
    turned_chains::{RATES, carried_by},
};
use crate::vectors::vectorised;

/// A linear map of the plane, by columns.
type Linear = [[f64; 2]; 2];

impl<const N: usize> Hypothesis<N> {
    /// Moves the covariance on over a step of so many seconds, `F P F'`, where the motion does not accelerate. Given are the linear part of the
    /// motion over the step, its integral, how far a push takes the centroid, and its velocity before and after.
    pub(super) fn carry_turned(&mut self, maps: [&Matrix2<f64>; 3], velocities: [&Vector2<f64>; 2], seconds: f64) {
        let (course, size, p) = (self.course, self.size(), &mut self.covariance.data.0);
        match (N, size) {
            (9, 6) => TurnedMotion::<1>::new(course, maps, velocities, seconds).carry::<N, 6>(p),
            (9, _) => TurnedMotion::<1>::new(course, maps, velocities, seconds).carry::<N, 9>(p),
            (12, 8) => TurnedMotion::<2>::new(course, maps, velocities, seconds).carry::<N, 8>(p),
            (12, _) => TurnedMotion::<2>::new(course, maps, velocities, seconds).carry::<N, 12>(p),
            (18, 12) => TurnedMotion::<RATES>::new(course, maps, velocities, seconds).carry::<N, 12>(p),
            (18, _) => TurnedMotion::<RATES>::new(course, maps, velocities, seconds).carry::<N, 18>(p),
            _ => unreachable!("projective motion is carried with its perspective"),
        }
    }
}

/// How errors go on over a step of motion with R rates whose velocity turns with the object, or that of a point of it stays:
///
/// - errors of rates and place: `R' = T (R + dt/2 M) + dt/2 M + dt^2/2 A`, `V' = V + along W + pushed B + dt/2 push`,
/// - of their motion: `M' = M + dt A`, `W' = turn W + along B + push`, with `push = dt (M + dt/2 A) v` and v the mean velocity over the step,
/// - changes A of rates and B of the velocity stay.
///
/// Of a point that stays its course B is the part of the velocity that turns: `V' = V + dt W + beyond B`, `W' = W + (turn - I) B`, `B' = turn B`.
///
/// It is what [`Hypothesis::transition`](super::hypothesis::Hypothesis::transition) says, the plain way; a test compares the two.
#[derive(Debug, Clone, Copy)]
struct TurnedMotion<const R: usize> {
    /// T, how the turn carries rates: by nothing where turns and growth commute.
    carried: [[f64; R]; R],
    /// What W adds to V and W.
    by_motion: [Linear; 2],
    /// What B adds to V and W.
    by_change: [Linear; 2],
    /// What B becomes, where it does not stay.
    turning: Option<Linear>,
    /// The mean way over the step, which the rates turn.
    way: [f64; 2],
    seconds: f64,
    /// For how long rates change: as long as the step where they do.
    changing: f64,
}

impl<const R: usize> TurnedMotion<R> {
    /// Parameters of the model.
    const K: usize = R + 2;

    fn new(
        course: Course,
        [turn, along, pushed]: [&Matrix2<f64>; 3],
        [v, later]: [&Vector2<f64>; 2],
        seconds: f64,
    ) -> Self {
        let columns = |m: &Matrix2<f64>| m.data.0;
        let mut carried = std::array::from_fn(|j| std::array::from_fn(|i| f64::from(u8::from(i == j))));
        if R == RATES {
            let of_turn = carried_by(turn);
            carried = std::array::from_fn(|j| std::array::from_fn(|i| of_turn[j][i]));
        }
        let (way, one) = (0.5 * seconds * (v + later), Matrix2::identity());
        let mut motion = Self {
            carried,
            by_motion: [columns(along), columns(turn)],
            by_change: [columns(pushed), columns(along)],
            turning: None,
            way: [way.x, way.y],
            seconds,
            changing: seconds,
        };
        if course.is_constant_velocity() {
            motion.by_motion = [columns(&(one * seconds)), columns(&one)];
            motion.by_change = [columns(&turned_along(along, seconds)), columns(&(turn - one))];
            (motion.turning, motion.way, motion.changing) = (Some(columns(turn)), [0.0; 2], 0.0);
        }
        motion
    }

    /// S entries are in use: those of the changes come behind those of pose and motion.
    fn carry<const N: usize, const S: usize>(&self, p: &mut [[f64; N]; N]) {
        debug_assert_eq!(N, 3 * Self::K);
        let moved = *self;
        vectorised(
            #[inline(always)]
            || {
                let mut columns = [[0.0; S]; S];
                for (column, entries) in columns.iter_mut().zip(p.iter()) {
                    column.copy_from_slice(&entries[..S]);
                    moved.move_entries(column);
                }
                moved.move_columns(&mut columns);
                for (entries, column) in p.iter_mut().zip(&columns) {
                    entries[..S].copy_from_slice(column);
                }
            },
        );
    }

    /// What rates make of the mean way along an axis: the numbers of two of them, and how far each goes.
    #[inline(always)]
    fn pushing(&self, axis: usize) -> [(usize, f64); 2] {
        let [x, y] = self.way;
        match (R, axis) {
            (1, 0) => [(0, y), (0, 0.0)],
            (1, _) => [(0, -x), (0, 0.0)],
            (2, 0) => [(0, x), (1, y)],
            (2, _) => [(0, y), (1, -x)],
            _ => [(2 * axis, x), (2 * axis + 1, y)],
        }
    }

    /// `F x` of one column.
    #[inline(always)]
    fn move_entries<const S: usize>(&self, x: &mut [f64; S]) {
        let Self { carried, by_motion, by_change, turning, seconds: dt, changing, .. } = self;
        let (half, of_change, has_changes) = (0.5 * dt, 0.5 * dt * changing, S > 2 * Self::K);
        let before = *x;
        let (mut rates, mut motion, mut half_way) = ([0.0; R], [0.0; R], [0.0; R]);
        for i in 0..R {
            let change = if has_changes { before[2 * Self::K + i] } else { 0.0 };
            rates[i] = half * before[Self::K + i] + of_change * change;
            motion[i] = before[Self::K + i] + changing * change;
            half_way[i] = before[Self::K + i] + 0.5 * changing * change;
        }
        for (j, carried) in carried.iter().enumerate() {
            let error = before[j] + half * before[Self::K + j];
            for i in 0..R {
                rates[i] += carried[i] * error;
            }
        }
        x[..R].copy_from_slice(&rates);
        x[Self::K..Self::K + R].copy_from_slice(&motion);
        let velocity = [before[Self::K + R], before[Self::K + R + 1]];
        for i in 0..2 {
            let [(a, by_a), (b, by_b)] = self.pushing(i);
            let push = by_a * half_way[a] + by_b * half_way[b];
            let mut place = before[R + i] + half * push;
            let mut later = push;
            for j in 0..2 {
                place += by_motion[0][j][i] * velocity[j];
                later += by_motion[1][j][i] * velocity[j];
                if has_changes {
                    place += by_change[0][j][i] * before[2 * Self::K + R + j];
                    later += by_change[1][j][i] * before[2 * Self::K + R + j];
                }
            }
            (x[R + i], x[Self::K + R + i]) = (place, later);
        }
        if let Some(turning) = turning {
            for i in 0..2 {
                x[2 * Self::K + R + i] =
                    turning[0][i] * before[2 * Self::K + R] + turning[1][i] * before[2 * Self::K + R + 1];
            }
        }
    }

    /// The same of all columns side by side.
    #[inline(always)]
    fn move_columns<const S: usize>(&self, columns: &mut [[f64; S]; S]) {
        let Self { carried, by_motion, by_change, turning, seconds: dt, changing, .. } = self;
        let (half, of_change, has_changes) = (0.5 * dt, 0.5 * dt * changing, S > 2 * Self::K);
        let none = [0.0; S];
        let (mut before, mut half_way) = ([none; R], [none; R]);
        for j in 0..R {
            let (error, motion) = (columns[j], columns[Self::K + j]);
            let change = if has_changes { columns[2 * Self::K + j] } else { none };
            let mut moved = none;
            for i in 0..S {
                before[j][i] = error[i] + half * motion[i];
                half_way[j][i] = motion[i] + 0.5 * changing * change[i];
                moved[i] = half * motion[i] + of_change * change[i];
            }
            columns[j] = moved;
            if has_changes {
                let mut moved = motion;
                for i in 0..S {
                    moved[i] += changing * change[i];
                }
                columns[Self::K + j] = moved;
            }
        }
        for j in 0..R {
            let mut moved = columns[j];
            for (before, carried) in before.iter().zip(carried) {
                for i in 0..S {
                    moved[i] += carried[j] * before[i];
                }
            }
            columns[j] = moved;
        }
        let velocity = [columns[Self::K + R], columns[Self::K + R + 1]];
        for c in 0..2 {
            let (mut place, mut later) = (columns[R + c], none);
            let [(a, by_a), (b, by_b)] = self.pushing(c);
            let [of_a, of_b] = [half_way[a], half_way[b]];
            for i in 0..S {
                let push = by_a * of_a[i] + by_b * of_b[i];
                place[i] += half * push;
                later[i] = push;
            }
            for j in 0..2 {
                for i in 0..S {
                    place[i] += by_motion[0][j][c] * velocity[j][i];
                    later[i] += by_motion[1][j][c] * velocity[j][i];
                }
                if has_changes {
                    let change = columns[2 * Self::K + R + j];
                    for i in 0..S {
                        place[i] += by_change[0][j][c] * change[i];
                        later[i] += by_change[1][j][c] * change[i];
                    }
                }
            }
            (columns[R + c], columns[Self::K + R + c]) = (place, later);
        }
        if let Some(turning) = turning {
            let [x, y] = [columns[2 * Self::K + R], columns[2 * Self::K + R + 1]];
            for c in 0..2 {
                let mut turned = none;
                for i in 0..S {
                    turned[i] = turning[0][c] * x[i] + turning[1][c] * y[i];
                }
                columns[2 * Self::K + R + c] = turned;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Point2, SMatrix, SVector};
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::{
        CentredPose,
        centred::{CentredVector, as_map, carried},
        course::{Course, PointOfBody},
        step::Step,
        usual_step::Units,
    };

    proptest! {
        #[test]
        fn covariances_of_affine_motion_that_does_not_accelerate_are_moved_on_as_by_matrices(
            numbers in prop::collection::vec(-1.0_f64..1.0, 40), dt in 0.1_f64..2.0,
        ) {
            let turn = Matrix2::new(1.0 + 0.4 * numbers[0], numbers[1], numbers[2], 1.2 + 0.1 * numbers[3]);
            prop_assume!(turn.determinant() > 0.1);
            let [along, pushed] = [4, 8].map(|i| Matrix2::new(numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]));
            let [v, later] = [12, 14].map(|i| Vector2::new(numbers[i], numbers[i + 1]));
            for course in [
                Course::ConstantGenerator,
                Course::Shaken { deviations: 4.0 },
                Course::ChangingGenerator { level: 0.1 },
                Course::SteadyChange { turns: true },
                Course::straight(PointOfBody::Any),
            ] {
                let root = SMatrix::<f64, 18, 18>::from_fn(|i, j| (7.0 * numbers[(3 * i + 5 * j) % 40]).sin());
                let mut hypothesis = Hypothesis::<18> { course, mean: SVector::zeros(), covariance: root * root.transpose() };
                let size = hypothesis.size();
                let used = |i: usize, j: usize| i < size && j < size;
                let all = hypothesis.covariance;
                hypothesis.covariance = SMatrix::from_fn(|i, j| if used(i, j) { all[(i, j)] } else { 0.0 });
                let at = CentredPose { pose: as_map(&Matrix2::identity()), centroid: Point2::origin() };
                let variance = CentredVector::zeros();
                let step = Step::new((MotionModel::Affine, dt), [&at, &at], Units::of_usual_step(&variance, dt)).expect("poses");
                let transition = hypothesis.transition(&step, (&turn, &along, &pushed), (&v, &later));
                let expected = carried(&transition, &hypothesis.covariance, size);
                hypothesis.carry_turned([&turn, &along, &pushed], [&v, &later], dt);
                let found = hypothesis.covariance;
                prop_assert!((found - expected).amax() < 1e-11 * expected.amax(), "{course:?}: {}", (found - expected).amax());
            }
        }
    }
}
