//! Motions that the model leaves out, carried along with the filter: how far a unit of each moves its estimates, and what a frame says of
//! them (A. S. Willsky and H. L. Jones, A generalized likelihood ratio approach to the detection and estimation of jumps in linear
//! systems, 1976).
//!
//! Pose and outline are learnt from frames that show the same errors of the model, and take them in. What is left in the residuals of a
//! frame is the displacement by a unit of the motion, less what pose and outline have taken in before. It is taken to be the same over a
//! cell: how residuals vary within one is a matter of how the outline bends.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point};
use nalgebra::{Matrix2, Matrix3, Point2, SMatrix, SVector, Vector2};

use super::pose_measurement::PoseMeasurement;
use crate::{
    belief::{Belief, OffsetInformation, STATE, StateMatrix, scaled_solution},
    map::{Cell, OutlineMap},
    measurement::Frame,
    prediction::ErrorTransition,
    tuning::family as tuning,
    vectors::vectorised,
};

/// Motions that may be left out: growth, stretch, skew, two of perspective, that of rows which are read one after the other, and three of a
/// lens.
pub(crate) const UNMODELLED: usize = 9;

pub(crate) type UnmodelledVector = SVector<f64, UNMODELLED>;
pub(crate) type UnmodelledMatrix = SMatrix<f64, UNMODELLED, UNMODELLED>;

/// How far a unit of each motion that is left out has moved the estimates.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sensitivity {
    /// Of pose and motion.
    pub(crate) state: SMatrix<f64, STATE, UNMODELLED>,
    /// Of the offset of each cell.
    offsets: Vec<UnmodelledVector>,
    /// Time since the first frame.
    elapsed: f64,
}

/// What one frame says of the motions that are left out, its pose taken to be unknown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnmodelledScore {
    /// In units of the noise.
    pub(crate) information: UnmodelledMatrix,
    /// Information times the sizes that the frame asks for.
    pub(crate) score: UnmodelledVector,
    /// Sum of the weights of points on known cells.
    pub(crate) weight: f64,
}

/// Which of them a model has.
fn has(model: MotionModel) -> [bool; UNMODELLED] {
    let (growth, shear, perspective) =
        (model != MotionModel::Rigid, model >= MotionModel::Affine, model >= MotionModel::Projective);
    // The slant of a rolling shutter is a shear.
    [growth, shear, shear, perspective, perspective, shear, perspective, perspective, perspective]
}

/// A pose and motion that displacements are taken at.
#[derive(Debug, Clone, Copy)]
struct Instant {
    pose: Matrix3<f64>,
    /// Transposed inverse of the linear part: normals of the body to those of the image, not normalised.
    of_normals: Matrix2<f64>,
    /// Of the object, in the image.
    centroid: Point2<f64>,
    generator: Matrix3<f64>,
    elapsed: f64,
    is_had: [bool; UNMODELLED],
}

impl Instant {
    /// Displacement of a cell along its normal in the body frame by a unit of each motion, and how far an error of the pose moves it.
    #[inline(always)]
    fn displacement(&self, cell: &Cell, offset: f64) -> ([f64; UNMODELLED], Point2<f64>, Vector2<f64>) {
        let p = map_point(&self.pose, &(cell.centre + offset * cell.normal));
        // A step of the image along n moves the body point by as much along the normal of the cell.
        let n = self.of_normals * cell.normal;
        let along = n.dot(&p.coords);
        // A row is seen later the further down it is; the outline has moved on meanwhile.
        let g = &self.generator;
        let velocity = Vector2::new(g.m11 * p.x + g.m12 * p.y + g.m13, g.m21 * p.x + g.m22 * p.y + g.m23);
        let square = p.coords.norm_squared();
        let mut all = [
            self.elapsed * n.dot(&(p - self.centroid)),
            n.x * p.x - n.y * p.y,
            n.x * p.y + n.y * p.x,
            p.x * along,
            p.y * along,
            p.y * (n.x * velocity.x + n.y * velocity.y),
            square * along,
            2.0 * p.x * along + square * n.x,
            2.0 * p.y * along + square * n.y,
        ];
        for (displacement, is_had) in all.iter_mut().zip(self.is_had) {
            *displacement = if is_had { 0.0 } else { *displacement };
        }
        (all, p, n)
    }
}

impl Sensitivity {
    pub(crate) fn new() -> Self {
        Self { state: SMatrix::zeros(), offsets: Vec::new(), elapsed: 0.0 }
    }

    /// Moves on by one step.
    pub(crate) fn predict(&mut self, transition: &ErrorTransition, k: usize, seconds: f64) {
        let ErrorTransition { of_pose, by_motion } = transition;
        self.elapsed += seconds;
        for mut column in self.state.column_iter_mut() {
            let before = column.clone_owned();
            for i in 0..k {
                column[i] = (0..k).map(|j| of_pose[i][j] * before[j] + by_motion[i][j] * before[k + j]).sum();
            }
        }
    }

    /// Pose and motion are forgotten, and learnt anew from what is seen some time later; the outline is kept.
    pub(crate) fn relocate(&mut self, seconds: f64, k: usize) {
        self.elapsed += seconds;
        self.state.rows_mut(0, 2 * k).fill(0.0);
    }

    /// Cells are new from those that it has on, and are measured by a frame in the pose that is believed: their offsets take in all of it.
    pub(crate) fn begin_cells(&mut self, belief: &Belief, map: &OutlineMap) {
        let Some(at) = self.instant(belief, &belief.pose, map) else {
            self.offsets.resize(map.cells().len(), UnmodelledVector::zeros());
            return;
        };
        let k = belief.parameter_count();
        for (cell, offset) in map.cells().iter().zip(&belief.offsets).skip(self.offsets.len()) {
            let (displacement, p, n) = at.displacement(cell, *offset);
            let mut displacement = UnmodelledVector::from(displacement);
            let by_pose = belief.model.normal_velocities(&p, &n);
            (0..k).for_each(|i| displacement -= self.state.row(i).transpose() * by_pose[i]);
            self.offsets.push(displacement);
        }
    }

    /// Updates by a solved frame that has not been committed yet, which stands for `repeats` frames: `frame.cells_with_frame` have the information with
    /// it, those of the belief without. `pose` and `marginal`, the information on
    /// pose and motion, are those with the frame; `measured` is what it tells of the pose by itself.
    pub(crate) fn update(
        &mut self,
        (belief, map): (&Belief, &OutlineMap),
        frame: &mut Frame,
        (pose, marginal): (&Matrix3<f64>, &StateMatrix),
        measured: &PoseMeasurement,
        repeats: f64,
    ) -> Option<UnmodelledScore> {
        match belief.parameter_count() {
            3 => self.update_sized::<3, 6>((belief, map), frame, (pose, marginal), measured, repeats),
            4 => self.update_sized::<4, 8>((belief, map), frame, (pose, marginal), measured, repeats),
            6 => self.update_sized::<6, 12>((belief, map), frame, (pose, marginal), measured, repeats),
            _ => self.update_sized::<8, 16>((belief, map), frame, (pose, marginal), measured, repeats),
        }
    }

    fn update_sized<const K: usize, const S: usize>(
        &mut self,
        (belief, map): (&Belief, &OutlineMap),
        frame: &mut Frame,
        (pose, marginal): (&Matrix3<f64>, &StateMatrix),
        measured: &PoseMeasurement,
        repeats: f64,
    ) -> Option<UnmodelledScore> {
        let at = self.instant(belief, pose, map)?;
        let [with, before] = [&frame.cells_with_frame, &belief.information.cells];
        let mut left = std::mem::take(&mut frame.values);
        left.resize(with.len() * UNMODELLED, 0.0);
        let cells = (map.cells(), belief.offsets.as_slice());
        let sums = self.sums::<K, S>(&at, cells, ([with, before], &frame.right), &mut left, repeats);
        // The estimates move as such residuals would move them.
        let right =
            SMatrix::<f64, STATE, UNMODELLED>::from_fn(|i, l| if i < S { repeats * sums.right[i][l] } else { 0.0 });
        if let Some(steps) = scaled_solution(marginal, &right, K) {
            self.move_offsets::<S>(with, &steps, &left);
            for l in 0..UNMODELLED {
                (0..S).for_each(|i| self.state[(i, l)] += steps[(i, l)]);
            }
        }
        frame.values = left;
        sums.score(measured)
    }

    /// Sums over the cells of a frame, and what is left of each of their displacements as far as the frame corrects it. The information on the
    /// cells is that with the frame and that before.
    fn sums<const K: usize, const S: usize>(
        &self,
        at: &Instant,
        (cells, offsets): (&[Cell], &[f64]),
        ([with, before], right): ([&OffsetInformation; 2], &[f64]),
        left: &mut [f64],
        repeats: f64,
    ) -> Sums<K, S> {
        let of_pose: [[f64; UNMODELLED]; K] = std::array::from_fn(|i| std::array::from_fn(|l| self.state[(i, l)]));
        let mut sums = Sums::<K, S>::NOTHING;
        let (coupling, coupling_before) = (with.rows::<S>(), before.rows::<S>());
        let (with, before) = (with.own(), before.own());
        vectorised(
            #[inline(always)]
            || {
                let of_cells = cells.iter().zip(offsets).zip(&self.offsets);
                let known = with.iter().zip(before).zip(coupling.iter().zip(coupling_before)).zip(right);
                let left = left.as_chunks_mut::<UNMODELLED>().0;
                for ((((cell, offset), taken_in), left), (((with, before), (coupling, coupling_before)), right)) in
                    of_cells.zip(left).zip(known)
                {
                    let own = with - before;
                    *left = [0.0; UNMODELLED];
                    if own > 0.0 {
                        let whole = at.displacement(cell, *offset).0;
                        let mut added = [0.0; K];
                        for i in 0..K {
                            added[i] = coupling[i] - coupling_before[i];
                        }
                        let of_cell =
                            OfCell { with: *with, before: *before, own, right: *right, coupling, added: &added };
                        *left = sums
                            .add(&whole, taken_in.as_slice(), &of_pose, &of_cell)
                            .map(|l| l * (repeats * own / with));
                    }
                }
            },
        );
        sums
    }

    /// Moves the offsets by what is left of the displacements, and by the steps of pose and motion.
    fn move_offsets<const S: usize>(
        &mut self,
        cells: &OffsetInformation,
        steps: &SMatrix<f64, STATE, UNMODELLED>,
        left: &[f64],
    ) {
        let (with, coupling) = (cells.own(), cells.rows::<S>());
        let by_entry: [[f64; UNMODELLED]; S] = std::array::from_fn(|i| std::array::from_fn(|l| steps[(i, l)]));
        vectorised(
            #[inline(always)]
            || {
                let of_cells = self.offsets.iter_mut().zip(left.as_chunks::<UNMODELLED>().0);
                for ((offset, left), (with, coupling)) in of_cells.zip(with.iter().zip(coupling)) {
                    if *with > 0.0 {
                        let mut along = [0.0; UNMODELLED];
                        for (i, row) in by_entry.iter().enumerate() {
                            for l in 0..UNMODELLED {
                                along[l] += coupling[i] * row[l];
                            }
                        }
                        let inverse = 1.0 / with;
                        let offset = offset.as_mut_slice();
                        for l in 0..UNMODELLED {
                            offset[l] += left[l] - along[l] * inverse;
                        }
                    }
                }
            },
        );
    }

    /// `None` where the model has all of the motions, or the pose has collapsed.
    fn instant(&self, belief: &Belief, pose: &Matrix3<f64>, map: &OutlineMap) -> Option<Instant> {
        let is_had = has(belief.model);
        let linear = pose.fixed_view::<2, 2>(0, 0).into_owned();
        if is_had.iter().all(|had| *had) || linear.determinant() <= 0.0 {
            return None;
        }
        Some(Instant {
            pose: *pose,
            of_normals: linear.try_inverse()?.transpose(),
            centroid: map_point(pose, &map.centroid()),
            generator: belief.model.generator(&belief.motion[..belief.parameter_count()]),
            elapsed: self.elapsed,
            is_had,
        })
    }
}

/// What is known of a cell with a frame and without it, and what the frame adds: the information `own`, its right-hand side, and K entries
/// of the coupling.
struct OfCell<'a, const K: usize, const S: usize> {
    with: f64,
    before: f64,
    own: f64,
    right: f64,
    coupling: &'a [f64; S],
    added: &'a [f64; K],
}

/// Sums over the cells of a frame, the offsets eliminated.
struct Sums<const K: usize, const S: usize> {
    information: [[f64; UNMODELLED]; UNMODELLED],
    score: [f64; UNMODELLED],
    /// Squares of the displacements with what pose and outline have taken in.
    whole: [f64; UNMODELLED],
    /// With the pose.
    with_pose: [[f64; UNMODELLED]; K],
    weight: f64,
    /// What pose and motion are moved by.
    right: [[f64; UNMODELLED]; S],
}

impl<const K: usize, const S: usize> Sums<K, S> {
    const NOTHING: Self = Self {
        information: [[0.0; UNMODELLED]; UNMODELLED],
        score: [0.0; UNMODELLED],
        whole: [0.0; UNMODELLED],
        with_pose: [[0.0; UNMODELLED]; K],
        weight: 0.0,
        right: [[0.0; UNMODELLED]; S],
    };

    /// Adds a cell that is displaced by `whole`, of which its offset and the pose have taken some in; returns what is left.
    #[inline(always)]
    fn add(
        &mut self,
        whole: &[f64; UNMODELLED],
        taken_in: &[f64],
        of_pose: &[[f64; UNMODELLED]; K],
        cell: &OfCell<'_, K, S>,
    ) -> [f64; UNMODELLED] {
        let OfCell { with, before, own, right, coupling, added } = *cell;
        let mut left = [0.0; UNMODELLED];
        for l in 0..UNMODELLED {
            left[l] = whole[l] - taken_in[l];
        }
        let inverse = 1.0 / own;
        for (i, row) in of_pose.iter().enumerate() {
            let factor = added[i] * inverse;
            for l in 0..UNMODELLED {
                left[l] -= factor * row[l];
            }
        }
        let by_known = own / with;
        for (i, row) in self.right.iter_mut().enumerate() {
            let direct = if i < K { added[i] } else { 0.0 };
            let factor = direct - coupling[i] * by_known;
            for l in 0..UNMODELLED {
                row[l] += factor * left[l];
            }
        }
        if before > 0.0 {
            // Only what was known before can be compared with.
            let share = before / with;
            let shared = left.map(|left| share * left);
            for (m, row) in self.information.iter_mut().enumerate() {
                let of_own = shared[m] * own;
                for l in 0..UNMODELLED {
                    row[l] += of_own * left[l];
                }
            }
            for (i, row) in self.with_pose.iter_mut().enumerate() {
                for l in 0..UNMODELLED {
                    row[l] += shared[l] * added[i];
                }
            }
            for l in 0..UNMODELLED {
                self.score[l] += shared[l] * right;
                self.whole[l] += share * own * whole[l] * whole[l];
            }
            self.weight += own;
        }
        left
    }

    /// The pose eliminated.
    fn score(&self, pose: &PoseMeasurement) -> Option<UnmodelledScore> {
        let known = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
            if i < K && j < K { pose.information[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        let jitter = (0..K).map(|i| known[(i, i)]).fold(0.0, f64::max) * tuning::SINGULAR;
        let with_pose =
            SMatrix::<f64, MAX_PARAMETERS, UNMODELLED>::from_fn(|i, l| if i < K { self.with_pose[i][l] } else { 0.0 });
        let explained = (known + SMatrix::identity() * jitter).cholesky()?.solve(&with_pose);
        let mut information = UnmodelledMatrix::from_fn(|a, b| {
            self.information[a.max(b)][a.min(b)] - with_pose.column(a).dot(&explained.column(b))
        });
        let mut score = UnmodelledVector::from(self.score) - explained.transpose() * pose.pulled;
        // What has been taken in is known to some percent.
        for l in 0..UNMODELLED {
            if information[(l, l)] > tuning::LEFT * self.whole[l] {
                continue;
            }
            information.row_mut(l).fill(0.0);
            information.column_mut(l).fill(0.0);
            score[l] = 0.0;
        }
        let found = UnmodelledScore { information, score, weight: self.weight };
        (self.weight > 0.0 && information.iter().chain(&score).all(|e| e.is_finite())).then_some(found)
    }
}

#[cfg(feature = "serde")]
impl Sensitivity {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_valid(&self, cells: usize) -> bool {
        let numbers = self.state.iter().chain(self.offsets.iter().flatten()).chain([&self.elapsed]);
        self.offsets.len() == cells && numbers.into_iter().all(|number| number.is_finite())
    }
}
