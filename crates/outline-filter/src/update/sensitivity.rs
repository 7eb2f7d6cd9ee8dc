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
    belief::{Belief, STATE, StateMatrix, scaled_solution},
    map::{Cell, OutlineMap},
    measurement::Frame,
    prediction::ErrorTransition,
    tuning::family as tuning,
};

/// Motions that may be left out: growth, stretch, skew, two of perspective, that of rows which are read one after the other, and three of a
/// lens.
pub(crate) const LEFT_OUT: usize = 9;

pub(crate) type LeftOutVector = SVector<f64, LEFT_OUT>;
pub(crate) type LeftOutMatrix = SMatrix<f64, LEFT_OUT, LEFT_OUT>;

/// How far a unit of each motion that is left out has moved the estimates.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sensitivity {
    /// Of pose and motion.
    pub(crate) state: SMatrix<f64, STATE, LEFT_OUT>,
    /// Of the offset of each cell.
    offsets: Vec<LeftOutVector>,
    /// Time since the first frame.
    elapsed: f64,
}

/// What one frame says of the motions that are left out, its pose taken to be unknown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeftOutScore {
    /// In units of the noise.
    pub(crate) information: LeftOutMatrix,
    /// Information times the sizes that the frame asks for.
    pub(crate) score: LeftOutVector,
    /// Sum of the weights of points on known cells.
    pub(crate) weight: f64,
}

/// Which of them a model has.
fn has(model: MotionModel) -> [bool; LEFT_OUT] {
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
    middle: Point2<f64>,
    generator: Matrix3<f64>,
    elapsed: f64,
    is_had: [bool; LEFT_OUT],
}

impl Instant {
    /// Displacement of a cell along its normal in the body frame by a unit of each motion, and how far an error of the pose moves it.
    fn displacement(&self, cell: &Cell, offset: f64) -> (LeftOutVector, Point2<f64>, Vector2<f64>) {
        let p = map_point(&self.pose, &(cell.centre + offset * cell.normal));
        // A step of the image along n moves the body point by as much along the normal of the cell.
        let n = self.of_normals * cell.normal;
        let along = n.dot(&p.coords);
        // A row is seen later the further down it is; the outline has moved on meanwhile.
        let velocity = self.generator * p.to_homogeneous();
        let square = p.coords.norm_squared();
        let mut all = LeftOutVector::from([
            self.elapsed * n.dot(&(p - self.middle)),
            n.x * p.x - n.y * p.y,
            n.x * p.y + n.y * p.x,
            p.x * along,
            p.y * along,
            p.y * (n.x * velocity.x + n.y * velocity.y),
            square * along,
            2.0 * p.x * along + square * n.x,
            2.0 * p.y * along + square * n.y,
        ]);
        all.iter_mut().zip(self.is_had).filter(|(_, had)| *had).for_each(|(d, _)| *d = 0.0);
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
            self.offsets.resize(map.cells().len(), LeftOutVector::zeros());
            return;
        };
        let k = belief.parameter_count();
        for (cell, offset) in map.cells().iter().zip(&belief.offsets).skip(self.offsets.len()) {
            let (mut displacement, p, n) = at.displacement(cell, *offset);
            let by_pose = belief.model.normal_velocities(&p, &n);
            (0..k).for_each(|i| displacement -= self.state.row(i).transpose() * by_pose[i]);
            self.offsets.push(displacement);
        }
    }

    /// Takes a solved frame that has not been committed yet, which stands for `repeats` frames: `frame.cells` have the information with
    /// it, those of the belief without. `pose` and `marginal`, the information on
    /// pose and motion, are those with the frame; `measured` is what it tells of the pose by itself.
    pub(crate) fn take(
        &mut self,
        (belief, map): (&Belief, &OutlineMap),
        frame: &mut Frame,
        (pose, marginal): (&Matrix3<f64>, &StateMatrix),
        measured: &PoseMeasurement,
        repeats: f64,
    ) -> Option<LeftOutScore> {
        let at = self.instant(belief, pose, map)?;
        let k = belief.parameter_count();
        let mut sums = Sums::NOTHING;
        let mut right = SMatrix::<f64, STATE, LEFT_OUT>::zeros();
        let mut left = std::mem::take(&mut frame.values);
        left.clear();
        for (number, cell) in map.cells().iter().enumerate() {
            let (with, before) = (&frame.cells[number], &belief.information.cells[number]);
            let own = with.own - before.own;
            if own <= 0.0 {
                left.extend([0.0; LEFT_OUT]);
                continue;
            }
            let mut added = [0.0; MAX_PARAMETERS];
            (0..k).for_each(|i| added[i] = with.coupling[i] - before.coupling[i]);
            let (whole, ..) = at.displacement(cell, belief.offsets[number]);
            let mut of_cell = whole - self.offsets[number];
            (0..k).for_each(|i| of_cell -= self.state.row(i).transpose() * (added[i] / own));
            if before.own > 0.0 {
                let share = before.own / with.own;
                sums.add(&of_cell, (&added, own, frame.right[number]), (share, k));
                sums.whole += share * own * whole.component_mul(&whole);
            }
            for i in 0..2 * k {
                let direct = if i < k { added[i] } else { 0.0 };
                let factor = repeats * (direct - with.coupling[i] * own / with.own);
                (0..LEFT_OUT).for_each(|l| right[(i, l)] += factor * of_cell[l]);
            }
            left.extend((of_cell * (repeats * own / with.own)).iter());
        }
        // The estimates move as such residuals would move them.
        for l in 0..LEFT_OUT {
            let Some(step) = scaled_solution(marginal, &right.column(l).into_owned(), k) else { continue };
            for ((offset, left), with) in self.offsets.iter_mut().zip(left.chunks(LEFT_OUT)).zip(&frame.cells) {
                if with.own > 0.0 {
                    let along: f64 = (0..2 * k).map(|i| with.coupling[i] * step[i]).sum();
                    offset[l] += left[l] - along / with.own;
                }
            }
            (0..2 * k).for_each(|i| self.state[(i, l)] += step[i]);
        }
        frame.values = left;
        sums.score(measured, k)
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
            middle: map_point(pose, &map.middle()),
            generator: belief.model.generator(&belief.motion[..belief.parameter_count()]),
            elapsed: self.elapsed,
            is_had,
        })
    }
}

/// Sums over the cells of a frame, the offsets eliminated.
struct Sums {
    information: LeftOutMatrix,
    score: LeftOutVector,
    /// Squares of the displacements with what pose and outline have taken in.
    whole: LeftOutVector,
    /// With the pose.
    with_pose: SMatrix<f64, MAX_PARAMETERS, LEFT_OUT>,
    weight: f64,
}

impl Sums {
    const NOTHING: Self = Self {
        information: LeftOutMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; LEFT_OUT]; LEFT_OUT])),
        score: LeftOutVector::from_array_storage(nalgebra::ArrayStorage([[0.0; LEFT_OUT]; 1])),
        whole: LeftOutVector::from_array_storage(nalgebra::ArrayStorage([[0.0; LEFT_OUT]; 1])),
        with_pose: SMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; MAX_PARAMETERS]; LEFT_OUT])),
        weight: 0.0,
    };

    /// Adds a cell of which a `share` of the information was known before, with the coupling, the information and the right-hand side that
    /// the frame adds.
    fn add(
        &mut self,
        left: &LeftOutVector,
        (coupling, own, right): (&[f64; MAX_PARAMETERS], f64, f64),
        (share, k): (f64, usize),
    ) {
        for l in 0..LEFT_OUT {
            let factor = share * left[l];
            let of_own = factor * own;
            (0..=l).for_each(|m| self.information[(l, m)] += of_own * left[m]);
            (0..k).for_each(|i| self.with_pose[(i, l)] += factor * coupling[i]);
            self.score[l] += factor * right;
        }
        self.weight += own;
    }

    /// The pose eliminated.
    fn score(&self, pose: &PoseMeasurement, k: usize) -> Option<LeftOutScore> {
        let known = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
            if i < k && j < k { pose.information[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        let jitter = (0..k).map(|i| known[(i, i)]).fold(0.0, f64::max) * tuning::SINGULAR;
        let explained = (known + SMatrix::identity() * jitter).cholesky()?.solve(&self.with_pose);
        let mut information = LeftOutMatrix::from_fn(|a, b| {
            self.information[(a.max(b), a.min(b))] - self.with_pose.column(a).dot(&explained.column(b))
        });
        let mut score = self.score - explained.transpose() * pose.pulled;
        // What has been taken in is known to some percent.
        for l in 0..LEFT_OUT {
            if information[(l, l)] > tuning::LEFT * self.whole[l] {
                continue;
            }
            information.row_mut(l).fill(0.0);
            information.column_mut(l).fill(0.0);
            score[l] = 0.0;
        }
        let found = LeftOutScore { information, score, weight: self.weight };
        (self.weight > 0.0 && information.iter().chain(&score).all(|e| e.is_finite())).then_some(found)
    }
}

#[cfg(feature = "serde")]
impl Sensitivity {
    /// Whether it is that of a map with so many cells, and all its numbers can be worked with.
    pub(crate) fn is_sound(&self, cells: usize) -> bool {
        let numbers = self.state.iter().chain(self.offsets.iter().flatten()).chain([&self.elapsed]);
        self.offsets.len() == cells && numbers.into_iter().all(|number| number.is_finite())
    }
}
