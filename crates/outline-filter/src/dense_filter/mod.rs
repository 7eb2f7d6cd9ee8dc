//! The reference that the arrowhead filter is tested against: a Kalman filter with pose, motion and every offset in one explicit covariance
//! matrix. Slow, without shortcuts, in covariance form where the filter is in information form. docs/motion-filter.md has the equations.
mod agreement;
mod problems;

use freeform_riccati::MotionModel;
use nalgebra::{DMatrix, DVector, Matrix3};

use crate::{
    belief::{Arrowhead, StateMatrix},
    measurement::Measurement,
};
pub(crate) use problems::{Problem, random_measurements};

/// Relative difference up to which filter and reference agree.
pub(crate) const AGREES: f64 = 1e-9;

/// Mean and covariance, in units of the noise, of (pose error, motion, offsets); the mean counts from what was last believed.
#[derive(Debug, Clone)]
pub(crate) struct DenseFilter {
    /// Entries of pose and motion, 2 k.
    pub(crate) state: usize,
    pub(crate) mean: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
}

impl DenseFilter {
    /// What an information matrix of arrow shape says.
    pub(crate) fn of(information: &Arrowhead) -> Self {
        let (state, whole) = (2 * information.k, dense_information(information));
        let covariance = whole.clone().cholesky().expect("positive definite").inverse();
        Self { state, mean: DVector::zeros(whole.nrows()), covariance }
    }

    /// Moves on by one step with the transition of the error of pose and motion: `P <- F P F'`.
    pub(crate) fn predict(&mut self, transition: &DMatrix<f64>) {
        let mut whole = DMatrix::identity(self.mean.len(), self.mean.len());
        whole.view_mut((0, 0), transition.shape()).copy_from(transition);
        self.mean = &whole * &self.mean;
        self.covariance = &whole * &self.covariance * whole.transpose();
    }

    /// Adds a covariance to that of pose and motion.
    pub(crate) fn add_covariance(&mut self, added: &StateMatrix) {
        for i in 0..self.state {
            (0..self.state).for_each(|j| self.covariance[(i, j)] += added[(i, j)]);
        }
    }

    /// Adds a variance to that of every offset.
    pub(crate) fn add_shape_noise(&mut self, variance: f64) {
        (self.state..self.mean.len()).for_each(|i| self.covariance[(i, i)] += variance);
    }

    /// Takes one measurement of a known cell, by Joseph's form.
    pub(crate) fn measure(&mut self, m: &Measurement) {
        let row = self.row(m);
        let (innovation, variance) = (m.residual - row.dot(&self.mean), 1.0 / m.weight);
        let by_row = &self.covariance * &row;
        let gain = &by_row / (row.dot(&by_row) + variance);
        self.mean += &gain * innovation;
        let kept = DMatrix::identity(row.len(), row.len()) - &gain * row.transpose();
        self.covariance = &kept * &self.covariance * kept.transpose() + variance * &gain * gain.transpose();
    }

    /// Takes the first measurement of a cell that nothing is known of, which becomes the last: its offset is what the measurement makes it.
    pub(crate) fn begin_cell(&mut self, m: &Measurement) {
        let (count, s) = (self.mean.len(), m.by_offset);
        let mut by_known = DVector::zeros(count);
        (0..self.state / 2).for_each(|i| by_known[i] = -m.jacobian[i] / s);
        let offset = m.residual / s + by_known.dot(&self.mean);
        let shared = &self.covariance * &by_known;
        let own = by_known.dot(&shared) + 1.0 / (m.weight * s * s);
        self.mean = self.mean.clone().push(offset);
        self.covariance = self.covariance.clone().resize(count + 1, count + 1, 0.0);
        self.covariance.view_mut((0, count), (count, 1)).copy_from(&shared);
        self.covariance.view_mut((count, 0), (1, count)).copy_from(&shared.transpose());
        self.covariance[(count, count)] = own;
    }

    /// Means of the offsets from `first` on where pose and motion are what was last believed.
    pub(crate) fn offsets_where_state_is_zero(&self, first: usize) -> Vec<f64> {
        let state = self.covariance.view((0, 0), (self.state, self.state)).clone_owned();
        let solved = state.cholesky().expect("positive definite").solve(&self.mean.rows(0, self.state).clone_owned());
        let of_cell = |i: usize| self.mean[i] - (self.covariance.view((i, 0), (1, self.state)) * &solved)[(0, 0)];
        (self.state + first..self.mean.len()).map(of_cell).collect()
    }

    /// Largest difference of the covariance that an information matrix of arrow shape stands for, in products of deviations, over the
    /// entries that `compared` picks by row and column.
    pub(crate) fn difference(&self, information: &Arrowhead, compared: impl Fn(usize, usize) -> bool) -> f64 {
        let other = Self::of(information).covariance;
        assert_eq!(other.shape(), self.covariance.shape());
        let scaled = |(i, j): (usize, usize)| {
            let size = (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt();
            (other[(i, j)] - self.covariance[(i, j)]).abs() / size
        };
        let count = self.mean.len();
        let entries = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        entries.filter(|(i, j)| compared(*i, *j)).map(scaled).fold(0.0, f64::max)
    }

    /// As [`difference`](Self::difference), of the information on pose and motion with the offsets eliminated.
    pub(crate) fn difference_of_marginal(&self, marginal: &StateMatrix) -> f64 {
        let state = self.covariance.view((0, 0), (self.state, self.state)).clone_owned();
        let expected = state.cholesky().expect("positive definite").inverse();
        let scaled = |i: usize, j: usize| {
            (marginal[(i, j)] - expected[(i, j)]).abs() / (expected[(i, i)] * expected[(j, j)]).sqrt()
        };
        let entries = (0..self.state).flat_map(|i| (0..self.state).map(move |j| (i, j)));
        entries.map(|(i, j)| scaled(i, j)).fold(0.0, f64::max)
    }

    fn row(&self, m: &Measurement) -> DVector<f64> {
        let mut row = DVector::zeros(self.mean.len());
        (0..self.state / 2).for_each(|i| row[i] = m.jacobian[i]);
        row[self.state + m.cell] = m.by_offset;
        row
    }
}

/// All entries of an information matrix of arrow shape.
fn dense_information(information: &Arrowhead) -> DMatrix<f64> {
    let state = 2 * information.k;
    let mut whole = DMatrix::zeros(state + information.cells.len(), state + information.cells.len());
    for i in 0..state {
        (0..state).for_each(|j| whole[(i, j)] = 0.5 * (information.dense[i][j] + information.dense[j][i]));
    }
    let cells = &information.cells;
    for (number, (coupling, own)) in cells.couplings().zip(cells.own()).enumerate() {
        let at = state + number;
        whole[(at, at)] = *own;
        for i in 0..state {
            (whole[(i, at)], whole[(at, i)]) = (coupling[i], coupling[i]);
        }
    }
    whole
}

/// Transition `[[Ad, V], [0, I]]` of the errors of pose and motion, from exponentials of block matrices alone: the upper right block of
/// `expm([[A, E], [0, A]] t)` is `V expm(A t)`.
pub(crate) fn transition(model: MotionModel, motion: &[f64], seconds: f64) -> DMatrix<f64> {
    let k = model.parameter_count();
    let generator = model.generator(motion);
    let flow = (generator * seconds).exp();
    let inverse = (-generator * seconds).exp();
    let mut whole = DMatrix::identity(2 * k, 2 * k);
    for (j, basis) in model.basis().iter().enumerate() {
        let mut block = DMatrix::zeros(6, 6);
        block.view_mut((0, 0), (3, 3)).copy_from(&generator);
        block.view_mut((3, 3), (3, 3)).copy_from(&generator);
        block.view_mut((0, 3), (3, 3)).copy_from(basis);
        let derivative: Matrix3<f64> = (block * seconds).exp().fixed_view::<3, 3>(0, 3).clone_owned();
        let (moved, sensitivity) = (flow * basis * inverse, derivative * inverse);
        for i in 0..k {
            whole[(i, j)] = model.parameters_of(&moved)[i];
            whole[(i, k + j)] = model.parameters_of(&sensitivity)[i];
        }
    }
    whole
}
