//! Sums of outer products of the rows of cells, in registers.
use std::borrow::Borrow;

use crate::vectors::{LANES, Lanes};

/// Sum of `s r r'` over rows r with scales s, symmetric. To be called where vector instructions are at hand.
///
/// As many rows of the sum are summed up at a time as fit into registers, up to their diagonal in whole vectors; with six entries all of them at
/// once, in vectors that overlap.
#[inline(always)]
pub(crate) fn sum_of_outer_products<const S: usize>(
    rows: impl Iterator<Item = (impl Borrow<[f64; S]>, f64)> + Clone,
) -> [[f64; S]; S] {
    const { assert!(S == 6 || (S.is_multiple_of(LANES) && S <= 16)) }
    let mut sum = [[0.0; S]; S];
    if S == 6 {
        add_rows::<S, 6, 2>(rows, 0, &mut sum);
        return sum;
    }
    add_rows::<S, LANES, 1>(rows.clone(), 0, &mut sum);
    if S > 4 {
        add_rows::<S, LANES, 2>(rows.clone(), 4, &mut sum);
    }
    if S > 8 {
        add_rows::<S, LANES, 3>(rows.clone(), 8, &mut sum);
    }
    if S > 12 {
        add_rows::<S, LANES, 4>(rows, 12, &mut sum);
    }
    for i in 0..S {
        for j in 0..i {
            sum[j][i] = sum[i][j];
        }
    }
    sum
}

/// Some rows of the sum, from one on, over the first so many vectors of each.
#[inline(always)]
fn add_rows<const S: usize, const ROWS: usize, const VECTORS: usize>(
    rows: impl Iterator<Item = (impl Borrow<[f64; S]>, f64)>,
    from: usize,
    sum: &mut [[f64; S]; S],
) {
    // The last vector overlaps the one before where the rows are no multiple of vectors.
    let start = |vector: usize| (LANES * vector).min(S - LANES);
    let mut sums = [[[0.0; LANES]; VECTORS]; ROWS];
    for (row, scale) in rows {
        let row: &[f64; S] = row.borrow();
        let mut scaled = [[0.0; LANES]; VECTORS];
        for (vector, scaled) in scaled.iter_mut().enumerate() {
            for lane in 0..LANES {
                scaled[lane] = row[start(vector) + lane] * scale;
            }
        }
        for i in 0..ROWS {
            let factor = row[from + i];
            for vector in 0..VECTORS {
                add_multiple(&mut sums[i][vector], factor, &scaled[vector]);
            }
        }
    }
    for (sums, sum) in sums.iter().zip(&mut sum[from..]) {
        for (vector, sums) in sums.iter().enumerate() {
            sum[start(vector)..][..LANES].copy_from_slice(sums);
        }
    }
}

#[inline(always)]
fn add_multiple(sum: &mut Lanes, factor: f64, by: &Lanes) {
    for lane in 0..LANES {
        sum[lane] += factor * by[lane];
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::vectors::vectorised;

    fn difference<const S: usize>(count: usize) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut draw = || rng.random_range(-1.0..1.0);
        let rows: Vec<([f64; S], f64)> = (0..count).map(|_| (std::array::from_fn(|_| draw()), draw())).collect();
        let found = vectorised(
            #[inline(always)]
            || sum_of_outer_products(rows.iter().map(|(row, scale)| (row, *scale))),
        );
        let expected = |i: usize, j: usize| rows.iter().map(|(row, scale)| scale * row[i] * row[j]).sum::<f64>();
        let entries = (0..S).flat_map(|i| (0..S).map(move |j| (i, j)));
        entries.map(|(i, j)| (found[i][j] - expected(i, j)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn sums_in_registers_are_those_entry_by_entry() {
        for count in [0, 1, 2, 30] {
            let all = [difference::<4>(count), difference::<6>(count), difference::<8>(count)];
            let all = all.into_iter().chain([difference::<12>(count), difference::<16>(count)]);
            assert!(all.fold(0.0, f64::max) < 1e-13, "{count}");
        }
    }
}
