//! Arrowhead information matrix: dense over pose and motion, diagonal over the offsets of the cells, and a coupling.
use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};
use nalgebra::{SMatrix, SVector};

use super::OffsetInformation;
use crate::vectors::vectorised;

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
        let transform = |v: &mut [f64; S]| transform::<K, S>(v, inverse, product);
        let mut rows: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| self.dense[i][j]));
        rows.iter_mut().for_each(transform);
        let mut columns: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        columns.iter_mut().for_each(transform);
        for (row, moved) in self.dense.iter_mut().zip(&columns) {
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

    /// Information of pose and motion with the offsets eliminated, `L - sum c c' / o`; unit diagonal beyond the state.
    pub(crate) fn marginal(&self) -> StateMatrix {
        let mut sum = self.dense;
        match self.k {
            3 => eliminate::<6>(&self.cells, &mut sum),
            4 => eliminate::<8>(&self.cells, &mut sum),
            6 => eliminate::<12>(&self.cells, &mut sum),
            _ => eliminate::<16>(&self.cells, &mut sum),
        }
        padded(&sum, 2 * self.k)
    }

    /// Information of pose and motion where the offsets are known; unit diagonal beyond the state.
    pub(crate) fn with_outline_given(&self) -> StateMatrix {
        padded(&self.dense, 2 * self.k)
    }
}

/// A marginal information matrix moved on by the same step.
pub(crate) fn moved_marginal(
    m: &StateMatrix,
    k: usize,
    inverse: &ParameterMatrix,
    product: &ParameterMatrix,
) -> StateMatrix {
    let mut moved = Arrowhead::new(k);
    for (i, row) in moved.dense.iter_mut().enumerate().take(2 * k) {
        (0..2 * k).for_each(|j| row[j] = m[(i, j)]);
    }
    moved.predict(inverse, product);
    padded(&moved.dense, 2 * k)
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

/// Subtracts `c c' / o` of every cell.
fn eliminate<const S: usize>(cells: &OffsetInformation, sum: &mut [[f64; STATE]; STATE]) {
    let taken = vectorised(
        #[inline(always)]
        || {
            // A sum of the size of the model fits where the processor is fastest; that of the largest one does not.
            let mut taken = [[0.0; S]; S];
            for (coupling, own) in cells.rows::<S>().iter().zip(cells.own()) {
                if *own <= 0.0 {
                    continue;
                }
                let inverse = 1.0 / own;
                for i in 0..S {
                    let factor = coupling[i] * inverse;
                    for j in 0..S {
                        taken[i][j] += factor * coupling[j];
                    }
                }
            }
            taken
        },
    );
    for (row, taken) in sum.iter_mut().zip(&taken) {
        row.iter_mut().zip(taken).for_each(|(entry, taken)| *entry -= taken);
    }
}

fn padded(sum: &[[f64; STATE]; STATE], size: usize) -> StateMatrix {
    StateMatrix::from_fn(
        |i, j| {
            if i < size && j < size { 0.5 * (sum[i][j] + sum[j][i]) } else { f64::from(u8::from(i == j)) }
        },
    )
}
