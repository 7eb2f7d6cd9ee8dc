//! The normal equations of a frame by sums over the points of each cell, where cells are lines in the image.
//!
//! The Jacobian of a point is that of its foot on the line through its cell, `a + t b` with the coordinate t along the line. The sums of the
//! weights w, of w t and of w t^2 say what all points of a cell tell of pose and offset, and those of w r and w t r what their residuals r ask
//! for. The plain way is `accumulate`, point by point; a test compares the two.
use freeform_riccati::{MotionModel, ParameterVector};
use nalgebra::{Point2, Vector2};

use super::normal_equations::Added;
use crate::{
    belief::{Arrowhead, OffsetInformation, StateVector},
    measurement::{CellJacobians, CellLine, CellSums, Columns, Frame},
    vectors::vectorised,
};

impl Frame {
    /// Adds the points, of which the cells have the Jacobians, to what was known of the offsets and to the dense part of `work`; returns what
    /// they add to pose and motion, and leaves the right-hand sides of the offsets in the frame. `state` is the step that the residuals were
    /// taken after.
    pub(super) fn accumulate_cells(
        &mut self,
        known: &OffsetInformation,
        work: &mut Arrowhead,
        state: &StateVector,
    ) -> Added {
        self.right.resize(known.len(), 0.0);
        self.columns.sum_up();
        match work.k {
            3 => {
                self.accumulate_padded::<3, 6, 4>(known, work, state, |p, n| MotionModel::Rigid.normal_velocities(p, n))
            }
            4 => {
                let velocities = |p: &Point2<f64>, n: &Vector2<f64>| MotionModel::Similarity.normal_velocities(p, n);
                self.accumulate_padded::<4, 8, 8>(known, work, state, velocities)
            }
            6 => self
                .accumulate_padded::<6, 12, 8>(known, work, state, |p, n| MotionModel::Affine.normal_velocities(p, n)),
            _ => {
                let velocities = |p: &Point2<f64>, n: &Vector2<f64>| MotionModel::Projective.normal_velocities(p, n);
                self.accumulate_padded::<8, 16, 12>(known, work, state, velocities)
            }
        }
    }

    /// P is room for the right-hand side beside a row of the information, in whole vectors.
    fn accumulate_padded<const K: usize, const S: usize, const P: usize>(
        &mut self,
        known: &OffsetInformation,
        work: &mut Arrowhead,
        state: &StateVector,
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector + Copy,
    ) -> Added {
        let step: [f64; K] = std::array::from_fn(|i| state[i]);
        work.cells.resize_as(known);
        let (own, coupling) = work.cells.all_mut::<S>();
        let Self { right, shifts, columns, .. } = self;
        let Columns { lines, own_lines, sums, of_cells, .. } = columns;
        let CellJacobians { by_offsets: by_offsets_of_cells, rows: rows_of_cells } = of_cells;
        rows_of_cells.resize(2 * P * shifts.len(), 0.0);
        let rows = pairs_mut::<P>(rows_of_cells);
        let known = known.own().iter().zip(known.rows::<S>());
        let total = vectorised(
            #[inline(always)]
            || {
                // Rows are written first: the sums after that run in vectors.
                let of_lines = lines.iter().zip(own_lines.iter()).zip(by_offsets_of_cells.iter());
                for (rows, (((line, at), by_offset), shift)) in rows.iter_mut().zip(of_lines.zip(shifts.iter())) {
                    write_rows::<K, P>(rows, (line, *at), (by_offset * shift, &step), velocities);
                }
                let mut total = [[0.0; P]; K];
                let of_cells = rows.iter().zip(by_offsets_of_cells.iter().zip(sums.iter())).zip(known.clone());
                let added = own.iter_mut().zip(coupling.iter_mut()).zip(right.iter_mut());
                for (((rows, (by_offset, sums)), (known, known_row)), ((own, row), right)) in of_cells.zip(added) {
                    let by_foot = add_cell::<K, P>(&mut total, rows, sums);
                    *own = known + sums.moments[0] * by_offset * by_offset;
                    *right = by_offset * by_foot[K];
                    let mut with = *known_row;
                    for i in 0..K {
                        with[i] += by_offset * by_foot[i];
                    }
                    *row = with;
                }
                total
            },
        );
        // Rounded apart in its two halves.
        let information: [[f64; K]; K] =
            std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (total[i][j] + total[j][i])));
        Added::to(&mut work.dense, &information, &std::array::from_fn(|i| total[i][K]))
    }

    /// Moves the residuals of the points, of which the cells have the Jacobians, by a step of the pose and one of the offset of each cell.
    pub(super) fn move_residuals_of_cells<const K: usize>(&mut self, step: &[f64; K], by_cell: &[f64]) {
        match K {
            3 => self.move_residuals_padded::<K, 4>(step, by_cell),
            4 | 6 => self.move_residuals_padded::<K, 8>(step, by_cell),
            _ => self.move_residuals_padded::<K, 12>(step, by_cell),
        }
    }

    fn move_residuals_padded<const K: usize, const P: usize>(&mut self, step: &[f64; K], by_cell: &[f64]) {
        let Columns { moves, numbers, residuals, along, of_cells, .. } = &mut self.columns;
        let CellJacobians { by_offsets: by_offsets_of_cells, rows: rows_of_cells } = of_cells;
        moves.resize(by_offsets_of_cells.len(), [0.0; 2]);
        // What is none has not moved.
        moves[by_cell.len()..].fill([0.0; 2]);
        let (moves, rows) = (moves.as_mut_slice(), pairs_mut::<P>(rows_of_cells));
        vectorised(
            #[inline(always)]
            || {
                let of_cells = rows.iter().zip(by_offsets_of_cells.iter().zip(by_cell));
                for (moved, ([foot, further], (by_offset, by_cell))) in moves.iter_mut().zip(of_cells) {
                    let (mut at, mut slope) = (by_offset * by_cell, 0.0);
                    for i in 0..K {
                        at += foot[i] * step[i];
                        slope += further[i] * step[i];
                    }
                    *moved = [at, slope];
                }
                for (residual, (number, t)) in residuals.iter_mut().zip(numbers.iter().zip(along.iter())) {
                    let [at, slope] = moves[*number as usize];
                    *residual -= at + slope * t;
                }
            },
        );
    }
}

/// Of each cell a row for the foot of its line, and one for what comes to it along the line: the Jacobian, and in place K what the residuals
/// were more before the step that they were taken after.
#[inline(always)]
fn pairs_mut<const P: usize>(rows: &mut [f64]) -> &mut [[[f64; P]; 2]] {
    rows.as_chunks_mut().0.as_chunks_mut().0
}

#[inline(always)]
fn write_rows<const K: usize, const P: usize>(
    [foot, further]: &mut [[f64; P]; 2],
    (line, at): (&CellLine, f64),
    (moved, step): (f64, &[f64; K]),
    velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
) {
    let [at_foot, along] = line.jacobian::<K>(at, velocities);
    let (mut at, mut slope) = (moved, 0.0);
    for i in 0..K {
        (foot[i], further[i]) = (at_foot[i], along[i]);
        at += at_foot[i] * step[i];
        slope += along[i] * step[i];
    }
    (foot[K], further[K]) = (at, slope);
}

/// Adds what the points of a cell say of the pose, with the right-hand side in column K; returns the same of the offset, for a unit of it.
#[inline(always)]
fn add_cell<const K: usize, const P: usize>(
    total: &mut [[f64; P]; K],
    [foot, further]: &[[f64; P]; 2],
    CellSums { moments: [w, wt, wtt, wr], along: wtr }: &CellSums,
) -> [f64; P] {
    let (mut by_foot, mut by_along) = ([0.0; P], [0.0; P]);
    for j in 0..P {
        let of_residuals = if j == K { 1.0 } else { 0.0 };
        by_foot[j] = w * foot[j] + wt * further[j] + wr * of_residuals;
        by_along[j] = wt * foot[j] + wtt * further[j] + wtr * of_residuals;
    }
    for i in 0..K {
        for j in 0..P {
            total[i][j] += foot[i] * by_foot[j] + further[i] * by_along[j];
        }
    }
    by_foot
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use nalgebra::{Matrix3, Point2, Vector2};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{
        measurement::{Jacobians, Pass},
        track::Track,
    };

    /// Points of an egg with three bulges, each elsewhere on it, and some anywhere.
    fn egg(rng: &mut ChaCha8Rng, count: u32) -> Outline {
        let point = |i: u32| {
            let t = std::f64::consts::TAU * (f64::from(i) + rng.random_range(0.0..1.0)) / f64::from(count);
            let r = 1.0 + 0.2 * (3.0 * t).cos() + 0.1 * t.sin() + rng.random_range(-0.01..0.01);
            let off = if i % 19 == 3 { Vector2::new(0.2, -0.1) } else { Vector2::zeros() };
            Point2::new(r * t.cos(), 0.8 * r * t.sin()) + off
        };
        Outline::closed((0..count).map(point).collect()).expect("an outline")
    }

    fn assert_near(found: impl IntoIterator<Item = f64>, expected: impl IntoIterator<Item = f64>, what: &str) {
        let (found, expected): (Vec<_>, Vec<_>) = (found.into_iter().collect(), expected.into_iter().collect());
        let size = expected.iter().fold(0.0, |size, entry| f64::max(size, entry.abs()));
        assert_eq!(found.len(), expected.len(), "{what}");
        assert!(size > 0.0, "{what}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12 * size, "{what}: {found} {expected}");
        }
    }

    fn compare<const K: usize>(model: MotionModel, count: u32) {
        let mut rng = ChaCha8Rng::seed_from_u64(u64::from(count));
        let mut frame = Frame::default();
        let track = Track::begin(model, &egg(&mut rng, 300), 0.0, &mut frame).expect("a track");
        let view = track.view();
        let mut draw = |size: f64| rng.random_range(-size..size);
        let pose = Matrix3::new(1.01, 0.02, 0.01, -0.03, 0.98, 0.02, 0.0, 0.0, 1.0);
        let state = StateVector::from_fn(|i, _| if i < K { draw(0.01) } else { 0.0 });
        let step: [f64; K] = std::array::from_fn(|_| draw(0.01));
        let shifts: Vec<f64> = (0..view.map.cells().len()).map(|_| draw(0.005)).collect();
        let by_cell: Vec<f64> = shifts.iter().map(|_| draw(0.005)).collect();
        frame.load(&egg(&mut rng, count), track.reference());
        frame.shifts = shifts;
        view.measure_by_columns(&mut frame, &pose, &[], Pass::First);
        assert_eq!(frame.columns.jacobians, Jacobians::OfCells);
        let mut plain = frame.clone();
        view.write_measurements(&mut plain, &[]);
        assert_eq!(plain.columns.jacobians, Jacobians::OfPoints);

        let known = &view.belief.information;
        let [mut work, mut expected] = [Arrowhead::new(K), Arrowhead::new(K)];
        let found = frame.accumulate_onto(known, &mut work, &state);
        let of_points = plain.accumulate_onto(known, &mut expected, &state);
        let name = |what: &str| format!("{model}, {count} points: {what}");
        let flat = |m: &[[f64; 8]; 8]| m.iter().flatten().copied().collect::<Vec<_>>();
        assert_near(flat(&found.information), flat(&of_points.information), &name("information"));
        assert_near(found.right.iter().copied(), of_points.right.iter().copied(), &name("right-hand side"));
        assert_near(work.dense.into_iter().flatten(), expected.dense.into_iter().flatten(), &name("dense"));
        assert_near(frame.right.clone(), plain.right.clone(), &name("right-hand sides of offsets"));
        assert_near(work.cells.own().to_vec(), expected.cells.own().to_vec(), &name("information on offsets"));
        let couplings = |work: &Arrowhead| work.cells.couplings().flatten().copied().collect::<Vec<_>>();
        assert_near(couplings(&work), couplings(&expected), &name("couplings"));

        frame.move_residuals_of_cells(&step, &by_cell);
        plain.move_residuals_of_points(&step, &by_cell);
        assert_near(frame.columns.residuals.clone(), plain.columns.residuals.clone(), &name("residuals"));
        let of_measurements = plain.measurements.iter().map(|m| m.residual);
        assert_near(frame.columns.residuals.clone(), of_measurements, &name("residuals of measurements"));
    }

    #[test]
    fn sums_of_cells_say_what_all_of_their_points_do_one_by_one() {
        for count in [40, 301, 1603] {
            compare::<3>(MotionModel::Rigid, count);
            compare::<4>(MotionModel::Similarity, count);
            compare::<6>(MotionModel::Affine, count);
            compare::<8>(MotionModel::Projective, count);
        }
    }
}
