//! Arrowhead information matrix: dense over pose and motion, diagonal over the offsets of the cells, and a coupling.
use freeform_riccati::{MAX_PARAMETERS, ParameterMatrix};
use nalgebra::{SMatrix, SVector};

use super::OffsetInformation;
use crate::vectors::{LANES, Lanes, add_product, in_lanes, positive_inverse, vectorised};

/// Pose error and motion parameters of the largest model.
pub(crate) const STATE: usize = 2 * MAX_PARAMETERS;

/// Entries of a state up to which cells are summed over side by side.
const LARGEST_IN_LANES: usize = 8;

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
    let mut rows: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| m(i, j)));
    rows.iter_mut().for_each(|row| transform::<K, S>(row, inverse, product));
    let mut columns: [[f64; S]; S] = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
    columns.iter_mut().for_each(|column| transform::<K, S>(column, inverse, product));
    columns
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

/// Sum of `c c' / o` over the cells.
fn told_by_offsets<const S: usize>(cells: &OffsetInformation) -> [[f64; S]; S] {
    // Of more entries than that the sums of several cells side by side are too many to be near at hand.
    if S > LARGEST_IN_LANES { told_row_by_row(cells) } else { told_side_by_side(cells) }
}

/// Hands on all cells, as many at a time as there are lanes; the last of them with cells that nothing is known of.
#[inline(always)]
fn for_lanes<const S: usize>(cells: &OffsetInformation, mut add: impl FnMut(&[[f64; S]; LANES], &Lanes)) {
    let (rows, last_rows) = cells.rows::<S>().as_chunks::<LANES>();
    let (own, last_own) = cells.own().as_chunks::<LANES>();
    for (rows, own) in rows.iter().zip(own) {
        add(rows, own);
    }
    let (mut rows, mut own) = ([[0.0; S]; LANES], [0.0; LANES]);
    rows[..last_rows.len()].copy_from_slice(last_rows);
    own[..last_own.len()].copy_from_slice(last_own);
    add(&rows, &own);
}

/// As [`told_by_offsets`], one entry after the other, several cells at a time.
fn told_row_by_row<const S: usize>(cells: &OffsetInformation) -> [[f64; S]; S] {
    let lower = vectorised(
        #[inline(always)]
        || {
            let mut told = [[0.0; S]; S];
            for_lanes(cells, |rows, own| add_told_by_rows(rows, own, &mut told));
            told
        },
    );
    std::array::from_fn(|i| std::array::from_fn(|j| lower[i.max(j)][i.min(j)]))
}

/// Adds the lower half of `c c' / o` of some cells, with what fills the last vector of a row.
#[inline(always)]
fn add_told_by_rows<const S: usize>(rows: &[[f64; S]; LANES], own: &Lanes, told: &mut [[f64; S]; S]) {
    debug_assert!(S.is_multiple_of(LANES), "{S} entries");
    let inverse = positive_inverse(own);
    let blocks: [&[Lanes]; LANES] = std::array::from_fn(|cell| rows[cell].as_chunks::<LANES>().0);
    for (i, sums) in told.iter_mut().enumerate() {
        let factors: Lanes = std::array::from_fn(|cell| rows[cell][i] * inverse[cell]);
        let sums = sums.as_chunks_mut::<LANES>().0;
        for (block, sums) in sums.iter_mut().enumerate().take(i / LANES + 1) {
            let mut sum = *sums;
            for cell in 0..LANES {
                add_product(&mut sum, &[factors[cell]; LANES], &blocks[cell][block]);
            }
            *sums = sum;
        }
    }
}

/// As [`told_by_offsets`], several cells side by side.
fn told_side_by_side<const S: usize>(cells: &OffsetInformation) -> [[f64; S]; S] {
    let told = vectorised(
        #[inline(always)]
        || {
            let mut told = [[[0.0; LANES]; S]; S];
            for_lanes(cells, |rows, own| add_told(rows, own, &mut told));
            told
        },
    );
    let sum = |i: usize, j: usize| told[i.max(j)][i.min(j)].iter().sum();
    std::array::from_fn(|i| std::array::from_fn(|j| sum(i, j)))
}

/// Adds the lower half of `c c' / o` of some cells, in lanes.
#[inline(always)]
fn add_told<const S: usize>(rows: &[[f64; S]; LANES], own: &Lanes, told: &mut [[Lanes; S]; S]) {
    let (coupling, inverse) = (in_lanes(rows), positive_inverse(own));
    for i in 0..S {
        let mut factor = [0.0; LANES];
        add_product(&mut factor, &coupling[i], &inverse);
        for j in 0..=i {
            add_product(&mut told[i][j], &factor, &coupling[j]);
        }
    }
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
    fn difference<const S: usize>(cells: usize, told: fn(&OffsetInformation) -> [[f64; S]; S]) -> f64 {
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
        let found = told(&information);
        found.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn offsets_side_by_side_tell_what_they_do_one_after_the_other() {
        for cells in [0, 1, 3, 4, 5, 30] {
            let few = difference::<6>(cells, told_side_by_side).max(difference::<8>(cells, told_side_by_side));
            let many = difference::<12>(cells, told_row_by_row).max(difference::<16>(cells, told_row_by_row));
            assert!(few.max(many) < 1e-13, "{cells}: {few} {many}");
        }
    }
}
