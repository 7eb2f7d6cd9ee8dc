//! Steps in directions of the pose that an outline does not show: not taken, and not forgotten.
//!
//! The path of an object tells its turn even where its outline does not, but noise makes a path of its own, and by that the turn would
//! become anything. So such a step is held back until there is a path, with the gradient of the likelihood that asks for it.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterMatrix, ParameterVector, turn_rate};
use nalgebra::{Matrix2, Matrix3, Point2, Vector2};

use super::{
    arrow_information::{StateMatrix, StateVector, moved_gradient, scaled_inverse, scaled_solution},
    innovation::PoseInnovation,
    map_update::Solution,
    outline_map::OutlineMap,
    unseen_direction::Unseen,
};

/// Information that holds a direction, in units of the noise: it moves by a thousandth of it.
const HOLDING: f64 = 1e6;
/// Standard deviations by which the velocity of the centre must differ from none to be a path.
const MOVES: f64 = 6.0;
/// Standard deviation of the turn, rad, beyond which it is not linear in what is measured.
const KNOWN: f64 = 0.25;

/// What is held back.
#[derive(Debug, Clone, Default)]
pub(crate) struct Withheld {
    /// Of the log-likelihood by pose and motion, in units of the noise.
    pub(crate) gradient: StateVector,
    /// Whether nothing is, since the path gives the turn.
    pub(crate) is_given_by_path: bool,
    /// Whether something of it has been forgotten as the map grew: earlier poses are off by what nobody knows.
    pub(crate) is_forgotten: bool,
}

impl Withheld {
    /// Moves on by one step, as the information does.
    pub(crate) fn predict(&mut self, k: usize, inverse: &ParameterMatrix, product: &ParameterMatrix) {
        self.gradient = moved_gradient(&self.gradient, k, inverse, product);
    }
}

impl OutlineMap {
    /// Whether neither the outline nor its path tells the turn.
    pub(crate) fn turn_is_unknown(&self) -> bool {
        self.turn_is_unseen() && !self.withheld.is_given_by_path
    }

    /// Information by which unseen directions are held where they are predicted; `None` where they are not.
    pub(crate) fn hold(&self, unseen: &[Unseen]) -> Option<StateMatrix> {
        // What shear and growth do to a thin outline in one step is seen in the long run.
        if unseen.is_empty()
            || (self.model > MotionModel::Similarity && !self.turn_is_unseen())
            || self.withheld.is_given_by_path
        {
            return None;
        }
        let k = self.information.k;
        let span = self.remembered();
        let mut hold = StateMatrix::zeros();
        for Unseen { dual, .. } in unseen {
            for (block, information) in [(0, HOLDING), (k, HOLDING * span * span)] {
                for i in 0..k {
                    (0..k).for_each(|j| hold[(block + i, block + j)] += information * dual[i] * dual[j]);
                }
            }
        }
        Some(hold)
    }

    /// Innovation of a solution, against the prediction with what was held back before it.
    pub(crate) fn solution_innovation(
        &self,
        solution: &Solution,
        hold: Option<&StateMatrix>,
        variance: f64,
    ) -> PoseInnovation {
        let [before, after] = [&self.marginal, &solution.marginal].map(|marginal| with_hold(marginal, hold));
        self.innovation_between([&before, &after], &solution.state, variance)
    }

    fn innovation_between(
        &self,
        [before, after]: [&StateMatrix; 2],
        state: &StateVector,
        variance: f64,
    ) -> PoseInnovation {
        let step = self.withheld_step(before).map_or(*state, |withheld| state - withheld);
        self.pose_innovation([before, after], &step, variance)
    }

    /// The step that the gradient held back asks for, with this information; `None` where nothing is held back.
    fn withheld_step(&self, information: &StateMatrix) -> Option<StateVector> {
        let gradient = &self.withheld.gradient;
        let is_any = gradient.iter().any(|e| *e != 0.0);
        is_any.then(|| scaled_solution(information, gradient, self.information.k)).flatten()
    }

    /// Whether a frame that contradicts a turn held where it is predicted agrees with another.
    pub(crate) fn tells_path(&self, solution: &Solution, variance: f64) -> bool {
        let Some(released) = solution.released.filter(|_| self.turn_is_unseen()) else { return false };
        // No innovation is one that cannot be computed.
        let with_turn = self.innovation_between([&self.marginal, &solution.marginal], &released, variance);
        with_turn.squared > 0.0 && self.innovation.squared - with_turn.squared > MOVES * MOVES
    }

    /// Seconds of the past that the motion is known from.
    fn remembered(&self) -> f64 {
        let shortest = self.spans[..self.information.k].iter().copied().fold(self.span, f64::min);
        shortest.max(self.step_seconds)
    }

    /// What is held back of the motion, if anything is.
    pub(crate) fn withheld_motion(&self) -> Option<ParameterVector> {
        let k = self.information.k;
        let step = self.withheld_step(&self.marginal)?;
        let mut motion = [0.0; MAX_PARAMETERS];
        motion[..k].copy_from_slice(&step.as_slice()[k..2 * k]);
        Some(motion)
    }

    /// Keeps the gradient by what was held, and lets it go if the path gives the turn.
    pub(crate) fn withhold(&mut self, unseen: &[Unseen], hold: Option<&StateMatrix>, state: &StateVector) {
        if unseen.is_empty() {
            self.withheld.gradient = StateVector::zeros();
            self.withheld.is_given_by_path = false;
            return;
        }
        self.withheld.gradient = hold.map_or_else(StateVector::zeros, |hold| hold * state);
        self.follow_path(unseen, hold);
    }

    /// Forgets all that is known of pose and motion in directions that were not seen: another place of the middle of a turn makes something
    /// known of it that is not.
    pub(crate) fn forget(&mut self, unseen: &[Unseen]) {
        let k = self.information.k;
        let units = self.effective_variance();
        for Unseen { direction, .. } in unseen {
            let rate = if self.step_seconds > 0.0 { 1.0 / self.step_seconds } else { 0.0 };
            let unknown = StateMatrix::from_fn(|i, j| {
                let (block, row, column) = (i / k, i % k, j % k);
                if i >= 2 * k || j / k != block {
                    return 0.0;
                }
                let size = if block == 0 { 1.0 } else { rate };
                size * size * direction[row] * direction[column] / units
            });
            self.add_covariance(&unknown);
        }
        self.withheld.is_forgotten = true;
    }

    /// Lets go of a turn that the outline does not show once the path gives it: where the object's centre moves beyond doubt, the turn since
    /// the beginning is known well enough for steps to be small, and it is less than half a circle per step, since of a faster turn the
    /// path shows another. Takes what was held back if so.
    fn follow_path(&mut self, unseen: &[Unseen], hold: Option<&StateMatrix>) {
        let was_given = std::mem::take(&mut self.withheld.is_given_by_path);
        if !self.turn_is_unseen() || !self.moves(unseen, hold).unwrap_or(false) {
            return;
        }
        let k = self.information.k;
        let Some(covariance) = scaled_inverse(&self.marginal, k) else { return };
        let step = covariance * self.withheld.gradient;
        let motion: Vec<f64> = (0..k).map(|i| self.motion[i] + step[k + i]).collect();
        let turn = turn_rate(&self.model.generator(&motion)) * self.step_seconds;
        let is_known = |unseen: &Unseen| {
            let dual = StateVector::from_fn(|i, _| if (k..2 * k).contains(&i) { unseen.dual[i - k] } else { 0.0 });
            let variance = dual.dot(&(covariance * dual)) * self.effective_variance();
            variance.sqrt() * self.remembered() < KNOWN
        };
        if turn.abs() >= std::f64::consts::PI || !unseen.iter().all(is_known) {
            return;
        }
        self.withheld.is_given_by_path = true;
        if was_given {
            return;
        }
        self.withheld.gradient = StateVector::zeros();
        self.motion[..k].copy_from_slice(&motion);
        self.pose = self.model.flow(&step.as_slice()[..k], 1.0).into_inner() * self.pose;
        for (cell, information) in self.cells.iter_mut().zip(&self.information.cells).filter(|(_, i)| i.own > 0.0) {
            cell.offset -= StateVector::from(information.coupling).dot(&step) / information.own;
        }
    }

    /// Whether the point that a turn which is not seen would leave where it is, moves beyond doubt.
    fn moves(&self, unseen: &[Unseen], hold: Option<&StateMatrix>) -> Option<bool> {
        let k = self.information.k;
        let centre = unseen.iter().find_map(|unseen| still_point(&self.model.generator(&unseen.direction[..k])))?;
        let generator = self.model.generator(&self.motion[..k]);
        let velocity = (generator * centre.to_homogeneous()).xy();
        // By the parameters of the motion.
        let covariance = scaled_inverse(&with_hold(&self.marginal, hold), k)? * self.effective_variance();
        let mut by_motion = [Vector2::zeros(); MAX_PARAMETERS];
        for (j, column) in by_motion.iter_mut().enumerate().take(k) {
            let mut unit = [0.0; MAX_PARAMETERS];
            unit[j] = 1.0;
            *column = (self.model.generator(&unit[..k]) * centre.to_homogeneous()).xy();
        }
        let mut of_velocity = Matrix2::zeros();
        for i in 0..k {
            for j in 0..k {
                of_velocity += covariance[(k + i, k + j)] * by_motion[i] * by_motion[j].transpose();
            }
        }
        let squared = velocity.dot(&(of_velocity.try_inverse()? * velocity));
        Some(squared > MOVES * MOVES)
    }
}

/// Information with that of a hold, where there is one.
pub(crate) fn with_hold(information: &StateMatrix, hold: Option<&StateMatrix>) -> StateMatrix {
    hold.map_or(*information, |hold| information + hold)
}

/// The point that an affine generator does not move; `None` where there is none.
fn still_point(generator: &Matrix3<f64>) -> Option<Point2<f64>> {
    let turn = generator.fixed_view::<2, 2>(0, 0).into_owned();
    let point = turn.try_inverse()? * -generator.fixed_view::<2, 1>(0, 2);
    Some(Point2::from(point)).filter(|p| p.iter().all(|e| e.is_finite()))
}
