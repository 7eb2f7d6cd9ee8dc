//! Covariances of affine motion whose velocity turns with the object, moved on without a matrix of the transition, most of whose entries are zero.
use nalgebra::{Matrix2, Vector2};

use super::turned_chains::{Carried, RATES, carried_by};
use crate::vectors::vectorised;

/// A linear map of the plane, by columns.
type Linear = [[f64; 2]; 2];

/// How errors go on over a step of affine motion whose velocity turns with the object: of rates R, of the velocity of the centroid V, and of what
/// changes both,
///
/// - errors: `R' = T (R + dt/2 M) + dt/2 M + dt^2/2 A`, `V' = V + along W + pushed B + dt/2 push`,
/// - motion: `M' = M + dt A`, `W' = turn W + along B + push`, with `push = dt (M + dt/2 A) v` and v the mean velocity over the step,
/// - changes A of rates and B of the velocity stay.
///
/// It is what [`Hypothesis::transition`](super::hypothesis::Hypothesis::transition) says, the plain way; a test compares the two.
#[derive(Debug, Clone, Copy)]
pub(super) struct TurnedMotion {
    /// T, how the turn carries rates.
    carried: Carried,
    turn: Linear,
    along: Linear,
    pushed: Linear,
    /// The mean way over the step.
    way: [f64; 2],
    seconds: f64,
}

impl TurnedMotion {
    /// Of the linear part of the motion over a step, its integral, how far a push takes the centroid, and its velocity before and after.
    pub(super) fn new([turn, along, pushed]: [&Matrix2<f64>; 3], [v, later]: [&Vector2<f64>; 2], seconds: f64) -> Self {
        let way = 0.5 * seconds * (v + later);
        let columns = |m: &Matrix2<f64>| m.data.0;
        Self {
            carried: carried_by(turn),
            turn: columns(turn),
            along: columns(along),
            pushed: columns(pushed),
            way: [way.x, way.y],
            seconds,
        }
    }

    /// `F P F'` of a covariance, given by its columns; of pose and motion alone, or with their changes.
    pub(super) fn carry<const N: usize>(&self, p: &mut [[f64; N]; N], has_changes: bool) {
        debug_assert_eq!(N, 3 * (RATES + 2));
        let moved = *self;
        vectorised(
            #[inline(always)]
            || {
                if has_changes {
                    moved.carry_sized::<N, { 3 * K }>(p);
                } else {
                    moved.carry_sized::<N, { 2 * K }>(p);
                }
            },
        );
    }

    /// S entries are in use: those of the changes come behind those of pose and motion.
    #[inline(always)]
    fn carry_sized<const N: usize, const S: usize>(&self, p: &mut [[f64; N]; N]) {
        let mut columns = [[0.0; S]; S];
        for (column, entries) in columns.iter_mut().zip(p.iter()) {
            column.copy_from_slice(&entries[..S]);
            self.move_entries(column);
        }
        self.move_columns(&mut columns);
        for (entries, column) in p.iter_mut().zip(&columns) {
            entries[..S].copy_from_slice(column);
        }
    }

    /// `F x` of one column.
    #[inline(always)]
    fn move_entries<const S: usize>(&self, x: &mut [f64; S]) {
        let Self { carried, turn, along, pushed, way, seconds: dt } = self;
        let (half, of_change, has_changes) = (0.5 * dt, 0.5 * dt * dt, S > 2 * K);
        let before = *x;
        let (mut rates, mut motion, mut half_way) = ([0.0; RATES], [0.0; RATES], [0.0; RATES]);
        for i in 0..RATES {
            let change = if has_changes { before[2 * K + i] } else { 0.0 };
            rates[i] = half * before[K + i] + of_change * change;
            motion[i] = before[K + i] + dt * change;
            half_way[i] = before[K + i] + half * change;
        }
        for (j, carried) in carried.iter().enumerate() {
            let error = before[j] + half * before[K + j];
            for i in 0..RATES {
                rates[i] += carried[i] * error;
            }
        }
        x[..RATES].copy_from_slice(&rates);
        x[K..K + RATES].copy_from_slice(&motion);
        let velocity = [before[K + RATES], before[K + RATES + 1]];
        for i in 0..2 {
            let push = way[0] * half_way[2 * i] + way[1] * half_way[2 * i + 1];
            let mut place = before[RATES + i] + half * push;
            let mut later = push;
            for j in 0..2 {
                place += along[j][i] * velocity[j];
                later += turn[j][i] * velocity[j];
                if has_changes {
                    place += pushed[j][i] * before[2 * K + RATES + j];
                    later += along[j][i] * before[2 * K + RATES + j];
                }
            }
            (x[RATES + i], x[K + RATES + i]) = (place, later);
        }
    }

    /// The same of all columns side by side.
    #[inline(always)]
    fn move_columns<const S: usize>(&self, columns: &mut [[f64; S]; S]) {
        let Self { carried, turn, along, pushed, way, seconds: dt } = self;
        let (half, of_change, has_changes) = (0.5 * dt, 0.5 * dt * dt, S > 2 * K);
        let none = [0.0; S];
        let (mut before, mut half_way) = ([none; RATES], [none; RATES]);
        for j in 0..RATES {
            let (error, motion) = (columns[j], columns[K + j]);
            let change = if has_changes { columns[2 * K + j] } else { none };
            let mut moved = none;
            for i in 0..S {
                before[j][i] = error[i] + half * motion[i];
                half_way[j][i] = motion[i] + half * change[i];
                moved[i] = half * motion[i] + of_change * change[i];
            }
            columns[j] = moved;
            if has_changes {
                let mut moved = motion;
                for i in 0..S {
                    moved[i] += dt * change[i];
                }
                columns[K + j] = moved;
            }
        }
        for j in 0..RATES {
            let mut moved = columns[j];
            for (before, carried) in before.iter().zip(carried) {
                for i in 0..S {
                    moved[i] += carried[j] * before[i];
                }
            }
            columns[j] = moved;
        }
        let velocity = [columns[K + RATES], columns[K + RATES + 1]];
        for c in 0..2 {
            let (mut place, mut later) = (columns[RATES + c], none);
            let [of_x, of_y] = [half_way[2 * c], half_way[2 * c + 1]];
            for i in 0..S {
                let push = way[0] * of_x[i] + way[1] * of_y[i];
                place[i] += half * push;
                later[i] = push;
            }
            for j in 0..2 {
                for i in 0..S {
                    place[i] += along[j][c] * velocity[j][i];
                    later[i] += turn[j][c] * velocity[j][i];
                }
                if has_changes {
                    let change = columns[2 * K + RATES + j];
                    for i in 0..S {
                        place[i] += pushed[j][c] * change[i];
                        later[i] += along[j][c] * change[i];
                    }
                }
            }
            (columns[RATES + c], columns[K + RATES + c]) = (place, later);
        }
    }
}

/// Parameters of affine motion.
const K: usize = RATES + 2;

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::{Point2, SMatrix, SVector};
    use proptest::prelude::*;

    use super::*;
    use crate::dynamics::{
        CentredPose,
        centred::{CentredVector, as_map, carried},
        course::Course,
        hypothesis::Hypothesis,
        step::Step,
    };

    proptest! {
        #[test]
        fn covariances_of_affine_motion_whose_velocity_turns_are_moved_on_as_by_matrices(
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
            ] {
                let root = SMatrix::<f64, 18, 18>::from_fn(|i, j| (7.0 * numbers[(3 * i + 5 * j) % 40]).sin());
                let mut hypothesis = Hypothesis::<18> { course, mean: SVector::zeros(), covariance: root * root.transpose() };
                let size = hypothesis.size();
                let used = |i: usize, j: usize| i < size && j < size;
                let all = hypothesis.covariance;
                hypothesis.covariance = SMatrix::from_fn(|i, j| if used(i, j) { all[(i, j)] } else { 0.0 });
                let at = CentredPose { pose: as_map(&Matrix2::identity()), centroid: Point2::origin() };
                let variance = CentredVector::zeros();
                let step = Step::new((MotionModel::Affine, dt), [&at, &at], &variance).expect("poses");
                let transition = hypothesis.transition(&step, (&turn, &along, &pushed), (&v, &later));
                let expected = carried(&transition, &hypothesis.covariance, size);
                let mut found = hypothesis.covariance;
                let motion = TurnedMotion::new([&turn, &along, &pushed], [&v, &later], dt);
                motion.carry(&mut found.data.0, course.has_accelerations());
                prop_assert!((found - expected).amax() < 1e-11 * expected.amax(), "{course:?}: {}", (found - expected).amax());
            }
        }
    }
}
