//! Sums of outer products of the rows of cells, in registers.
use std::borrow::Borrow;

use crate::vectors::{LANES, Lanes};

/// Rows that are written side by side before they are summed up, where that takes more than one round.
const BLOCK: usize = 16;

/// Sum of `s r r'` over so many rows r with scales s, given by their numbers; symmetric. To be called where vector instructions are at hand.
///
/// As many rows of the sum are summed up at a time as fit into registers, up to their diagonal in whole vectors; with six entries all of them at
/// once, in vectors that overlap.
#[inline(always)]
pub(crate) fn sum_of_outer_products<R: Borrow<[f64; S]>, const S: usize>(
    count: usize,
    row_with_scale: impl Fn(usize) -> (R, f64),
) -> [[f64; S]; S] {
    const { assert!(S == 6 || (S.is_multiple_of(LANES) && S <= 16)) }
    let mut sum = [[0.0; S]; S];
    if S == 6 {
        add_rows::<S, 6, 2>(count, &ByNumber(row_with_scale), 0, &mut sum);
        return sum;
    }
    if S == 4 {
        add_rows::<S, 4, 1>(count, &ByNumber(row_with_scale), 0, &mut sum);
        return sum;
    }
    let (mut rows, mut scales) = ([[0.0; S]; BLOCK], [0.0; BLOCK]);
    for start in (0..count).step_by(BLOCK) {
        let length = BLOCK.min(count - start);
        for i in 0..length {
            let (row, scale) = row_with_scale(start + i);
            (rows[i], scales[i]) = (*row.borrow(), scale);
        }
        let block = Written { rows: &rows[..length], scales: &scales[..length] };
        add_rows::<S, 4, 1>(length, &block, 0, &mut sum);
        if S > 4 {
            add_rows::<S, 4, 2>(length, &block, 4, &mut sum);
        }
        if S > 8 {
            add_rows::<S, 2, 3>(length, &block, 8, &mut sum);
            add_rows::<S, 2, 3>(length, &block, 10, &mut sum);
        }
        if S > 12 {
            add_rows::<S, 2, 4>(length, &block, 12, &mut sum);
            add_rows::<S, 2, 4>(length, &block, 14, &mut sum);
        }
    }
    // What is beyond the diagonal is in the other half.
    std::array::from_fn(|i| std::array::from_fn(|j| sum[i.max(j)][i.min(j)]))
}

/// Rows with their scales.
trait Rows<const S: usize> {
    fn get(&self, number: usize) -> (impl Borrow<[f64; S]>, f64);
}

struct ByNumber<F>(F);

impl<const S: usize, R: Borrow<[f64; S]>, F: Fn(usize) -> (R, f64)> Rows<S> for ByNumber<F> {
    #[inline(always)]
    fn get(&self, number: usize) -> (impl Borrow<[f64; S]>, f64) {
        (self.0)(number)
    }
}

struct Written<'a, const S: usize> {
    rows: &'a [[f64; S]],
    scales: &'a [f64],
}

impl<const S: usize> Rows<S> for Written<'_, S> {
    #[inline(always)]
    fn get(&self, number: usize) -> (impl Borrow<[f64; S]>, f64) {
        (&self.rows[number], self.scales[number])
    }
}

/// Adds to some rows of the sum, from one on, over the first so many vectors of each.
#[inline(always)]
fn add_rows<const S: usize, const ROWS: usize, const VECTORS: usize>(
    count: usize,
    rows: &impl Rows<S>,
    from: usize,
    sum: &mut [[f64; S]; S],
) {
    // The last vector overlaps the one before where the rows are no multiple of vectors.
    let start = |vector: usize| (LANES * vector).min(S - LANES);
    let mut sums = [[[0.0; LANES]; VECTORS]; ROWS];
    for number in 0..count {
        let (row, scale) = rows.get(number);
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
            if S == 6 {
                // All at once, and what vectors that overlap have both is the same in both.
                sum[start(vector)..][..LANES].copy_from_slice(sums);
                continue;
            }
            // Written so, the sums stay in registers.
            let before = if vector > 0 { start(vector - 1) + LANES } else { 0 };
            for lane in before - start(vector).min(before)..LANES {
                sum[start(vector) + lane] += sums[lane];
            }
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
            || sum_of_outer_products(rows.len(), |number| (&rows[number].0, rows[number].1)),
        );
        let expected = |i: usize, j: usize| rows.iter().map(|(row, scale)| scale * row[i] * row[j]).sum::<f64>();
        let entries = (0..S).flat_map(|i| (0..S).map(move |j| (i, j)));
        entries.map(|(i, j)| (found[i][j] - expected(i, j)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn sums_in_registers_are_those_entry_by_entry() {
        for count in [0, 1, 2, 16, 45] {
            let all = [difference::<4>(count), difference::<6>(count), difference::<8>(count)];
            let all = all.into_iter().chain([difference::<12>(count), difference::<16>(count)]);
            assert!(all.fold(0.0, f64::max) < 1e-13, "{count}");
        }
    }
}
