//! Arrowhead information matrix: dense over pose and motion, diagonal over the offsets of the cells, and a coupling.
use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};
use nalgebra::{SMatrix, SVector};

use super::{OffsetInformation, outer_products::sum_of_outer_products};
use crate::{tuning::update::ROUNDING_OF_VARIANCE, vectors::vectorised};

/// Pose error and motion parameters of the largest model.
pub(crate) const STATE: usize = 2 * MAX_PARAMETERS;

pub(crate) type StateVector = SVector<f64, STATE>;
pub(crate) type StateMatrix = SMatrix<f64, STATE, STATE>;

/// Arrowhead information matrix over (pose error, motion, offsets) in units of the noise. The state has `2 k` entries, k the number of
/// parameters; the rest of the fixed-size arrays is zero.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Arrowhead {
    pub(crate) k: usize,
    pub(crate) dense: [[f64; STATE]; STATE],
    pub(crate) cells: OffsetInformation,
}

impl Arrowhead {
    pub(crate) fn new(k: usize) -> Self {
        Self { k, dense: [[0.0; STATE]; STATE], cells: OffsetInformation::new(2 * k) }
    }

    /// Forgets all of pose and motion; couplings stay.
    pub(crate) fn clear_dense(&mut self) {
        self.dense = [[0.0; STATE]; STATE];
    }

    /// Moves on by one step whose error transition is `[[Ad, V], [0, I]]`, given the inverse of Ad and `Ad^-1 V`:
    /// `L <- F^-T L F^-1`, coupling `<- F^-T coupling`.
    pub(crate) fn predict(&mut self, inverse: &ParameterMatrix, product: &ParameterMatrix) {
        match self.k {
            3 => self.predict_sized::<3, 6>(inverse, product),
            4 => self.predict_sized::<4, 8>(inverse, product),
            6 => self.predict_sized::<6, 12>(inverse, product),
            _ => self.predict_sized::<8, 16>(inverse, product),
        }
    }

    fn predict_sized<const K: usize, const S: usize>(&mut self, inverse: &ParameterMatrix, product: &ParameterMatrix) {
        let moved = moved_sized::<K, S>(|i, j| self.dense[i][j], inverse, product);
        for (row, moved) in self.dense.iter_mut().zip(&moved) {
            row[..S].copy_from_slice(moved);
        }
        let couplings = self.cells.all_mut::<S>().1;
        vectorised(
            #[inline(always)]
            || {
                for coupling in couplings.iter_mut() {
                    self::transform::<K, S>(coupling, inverse, product);
                }
            },
        );
    }

    /// Lets pose and motion, of which `before` is known, have changed at random by a covariance, so that `after` is known of them. Offsets keep what
    /// they are known to be, and their regression on pose and motion; what they would come to know of each other is dropped. `None` where that cannot
    /// be computed; nothing has changed then.
    pub(crate) fn add_covariance(&mut self, added: &StateMatrix, [before, after]: [&StateMatrix; 2]) -> Option<()> {
        match self.k {
            3 => self.add_covariance_sized::<6>(added, before, after),
            4 => self.add_covariance_sized::<8>(added, before, after),
            6 => self.add_covariance_sized::<12>(added, before, after),
            _ => self.add_covariance_sized::<16>(added, before, after),
        }
    }

    fn add_covariance_sized<const S: usize>(
        &mut self,
        added: &StateMatrix,
        before: &StateMatrix,
        after: &StateMatrix,
    ) -> Option<()> {
        // Before (x) given after (x'): x = gain x' + rest. Of the covariance P before and Q added, gain = P (P + Q)^-1 and rest = P - gain P.
        // Either may be larger than the other by ten digits along some direction, and nothing but rounding be left of a difference.
        let of_size = |m: &StateMatrix| SMatrix::<f64, S, S>::from_fn(|i, j| m[(i, j)]);
        let (root, known) = (square_root(of_size(added)), of_size(before));
        let inner = SMatrix::<f64, S, S>::identity() + root.transpose() * known * root;
        let rest = root * inner.cholesky()?.solve(&root.transpose());
        let gain = SMatrix::<f64, S, S>::identity() - rest * known;
        let [gain, rest] = [gain, rest].map(rows::<S>);
        let (own, couplings) = self.cells.all_mut::<S>();
        vectorised(
            #[inline(always)]
            || {
                for (own, coupling) in own.iter_mut().zip(couplings.iter_mut()) {
                    widen_cell(own, coupling, &gain, &rest);
                }
            },
        );
        let told = told_by_offsets::<S>(&self.cells);
        for (i, (row, told)) in self.dense.iter_mut().zip(&told).enumerate() {
            (0..S).for_each(|j| row[j] = after[(i, j)] + told[j]);
        }
        Some(())
    }

    /// Information of pose and motion with the offsets eliminated, `L - sum c c' / o`; unit diagonal beyond the state.
    pub(crate) fn marginal(&self) -> StateMatrix {
        match self.k {
            3 => self.marginal_sized::<6>(),
            4 => self.marginal_sized::<8>(),
            6 => self.marginal_sized::<12>(),
            _ => self.marginal_sized::<16>(),
        }
    }

    fn marginal_sized<const S: usize>(&self) -> StateMatrix {
        let taken = told_by_offsets::<S>(&self.cells);
        symmetric::<S>(|i, j| self.dense[i][j] - taken[i][j])
    }

    /// Information of pose and motion where the offsets are known; unit diagonal beyond the state.
    pub(crate) fn with_outline_given(&self) -> StateMatrix {
        let mut given = StateMatrix::identity();
        for i in 0..2 * self.k {
            (0..2 * self.k).for_each(|j| given[(i, j)] = 0.5 * (self.dense[i][j] + self.dense[j][i]));
        }
        given
    }
}

/// A marginal information matrix moved on by the same step.
pub(crate) fn moved_marginal(
    m: &StateMatrix,
    k: usize,
    inverse: &ParameterMatrix,
    product: &ParameterMatrix,
) -> StateMatrix {
    match k {
        3 => moved_marginal_sized::<3, 6>(m, inverse, product),
        4 => moved_marginal_sized::<4, 8>(m, inverse, product),
        6 => moved_marginal_sized::<6, 12>(m, inverse, product),
        _ => moved_marginal_sized::<8, 16>(m, inverse, product),
    }
}

fn moved_marginal_sized<const K: usize, const S: usize>(
    m: &StateMatrix,
    inverse: &ParameterMatrix,
    product: &ParameterMatrix,
) -> StateMatrix {
    let moved = moved_sized::<K, S>(|i, j| m[(i, j)], inverse, product);
    symmetric::<S>(|i, j| moved[i][j])
}

/// `F^-T m F^-1` of a symmetric matrix.
fn moved_sized<const K: usize, const S: usize>(
    m: impl Fn(usize, usize) -> f64,
    inverse: &ParameterMatrix,
    product: &ParameterMatrix,
) -> [[f64; S]; S] {
    let entries: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| m(i, j)));
    vectorised(
        #[inline(always)]
        || {
            let mut rows = entries;
            for row in &mut rows {
                transform::<K, S>(row, inverse, product);
            }
            let mut columns = [[0.0; S]; S];
            for (i, column) in columns.iter_mut().enumerate() {
                for (entry, row) in column.iter_mut().zip(&rows) {
                    *entry = row[i];
                }
                transform::<K, S>(column, inverse, product);
            }
            columns
        },
    )
}

/// `v <- F^-T v`.
#[inline(always)]
fn transform<const K: usize, const S: usize>(v: &mut [f64; S], inverse: &ParameterMatrix, product: &ParameterMatrix) {
    let mut moved = [0.0; S];
    moved[K..].copy_from_slice(&v[K..]);
    for i in 0..K {
        for j in 0..K {
            moved[j] += inverse[i][j] * v[i];
            moved[K + j] -= product[i][j] * v[i];
        }
    }
    *v = moved;
}

fn rows<const S: usize>(m: SMatrix<f64, S, S>) -> [[f64; S]; S] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}

/// A matrix U with `U U' = m`, of a covariance of any rank: its Cholesky factor with pivots.
fn square_root<const S: usize>(m: SMatrix<f64, S, S>) -> SMatrix<f64, S, S> {
    let (variances, mut left, mut root) = (m.diagonal(), m, SMatrix::<f64, S, S>::zeros());
    for number in 0..S {
        let share = |i: usize| if variances[i] > 0.0 { left[(i, i)] / variances[i] } else { 0.0 };
        let (pivot, most) = (0..S).map(|i| (i, share(i))).fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        if most <= ROUNDING_OF_VARIANCE {
            break;
        }
        let column = left.column(pivot) / left[(pivot, pivot)].sqrt();
        left -= column * column.transpose();
        root.set_column(number, &column);
    }
    root
}

/// What is known of an offset after its regression on pose and motion has been carried over to what they are now: they were `gain` times that, but
/// for `rest`, the covariance of what is not known of it.
#[inline(always)]
fn widen_cell<const S: usize>(own: &mut f64, coupling: &mut [f64; S], gain: &[[f64; S]; S], rest: &[[f64; S]; S]) {
    let known = *own;
    if known.is_nan() || known <= 0.0 {
        return;
    }
    let slope = coupling.map(|entry| entry / known);
    let (mut moved, mut unknown) = ([0.0; S], [0.0; S]);
    for i in 0..S {
        for j in 0..S {
            moved[j] += gain[i][j] * slope[i];
            unknown[j] += rest[i][j] * slope[i];
        }
    }
    let mut variance = 0.0;
    for j in 0..S {
        variance += unknown[j] * slope[j];
    }
    *own = 1.0 / (1.0 / known + f64::max(variance, 0.0));
    *coupling = moved.map(|entry| entry * *own);
}

/// Sum of `c c' / o` over the cells; nothing is told of those that nothing is known of.
fn told_by_offsets<const S: usize>(cells: &OffsetInformation) -> [[f64; S]; S] {
    let count = cells.len();
    let (rows, own) = (&cells.rows::<S>()[..count], &cells.own()[..count]);
    vectorised(
        #[inline(always)]
        || {
            sum_of_outer_products(
                count,
                #[inline(always)]
                |number| (&rows[number], if own[number] > 0.0 { 1.0 / own[number] } else { 0.0 }),
            )
        },
    )
}

/// The symmetric part of the entries of a state; unit diagonal beyond them.
fn symmetric<const S: usize>(entry: impl Fn(usize, usize) -> f64) -> StateMatrix {
    let mut whole = StateMatrix::identity();
    for i in 0..S {
        whole[(i, i)] = entry(i, i);
        for j in 0..i {
            let mean = 0.5 * (entry(i, j) + entry(j, i));
            (whole[(i, j)], whole[(j, i)]) = (mean, mean);
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// How far a sum is from its definition, one cell after the other.
    fn difference<const S: usize>(cells: usize) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut information = OffsetInformation::new(S);
        information.resize(cells);
        let mut expected = [[0.0; S]; S];
        for (number, (own, coupling)) in information.iter_mut().enumerate() {
            // Nothing is told of cells that nothing is known of.
            if number % 5 != 2 {
                *own = rng.random_range(0.5..2.0);
                coupling.iter_mut().for_each(|entry| *entry = rng.random_range(-1.0..1.0));
                for (i, row) in expected.iter_mut().enumerate() {
                    row.iter_mut().enumerate().for_each(|(j, sum)| *sum += coupling[i] * coupling[j] / *own);
                }
            }
        }
        let found = told_by_offsets::<S>(&information);
        found.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn offsets_in_registers_tell_what_they_do_one_after_the_other() {
        for cells in [0, 1, 3, 4, 5, 30] {
            let few = difference::<6>(cells).max(difference::<8>(cells));
            let many = difference::<12>(cells).max(difference::<16>(cells));
            assert!(few.max(many) < 1e-13, "{cells}: {few} {many}");
        }
    }
}
