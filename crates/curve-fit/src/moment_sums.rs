use pulp::Simd;

use crate::monomials::monomial_index;

/// Vectors of points that are taken together: enough for the sums to be kept in registers over most of the work, few
/// enough for all their powers to stay in the nearest cache.
pub(crate) const BLOCK: usize = 16;

/// Sums of a tile next to each other: as many as there are registers for.
const COLUMNS: usize = 7;

/// The sums `x^i y^j`, `0 < i + j < POWERS`, of points that come in blocks of vectors, lane by lane. MOMENTS = POWERS (POWERS + 1) / 2.
///
/// A multiplication feeds one sum only, so that two a cycle (as many as processors can) keep them busy if neither
/// loads nor stores do more often. The sums are therefore taken in tiles of two or three powers of y and up to seven of x, which
/// stay in registers along the block: 13 products of the quartic need 9 loads and no store.
#[derive(Clone, Copy)]
pub(crate) struct MomentSums<S: Simd, const POWERS: usize, const MOMENTS: usize> {
    /// In graded order; the first one is not used.
    pub(crate) lanes: [S::f64s; MOMENTS],
}

/// The powers of a block, of x and of y: scratch memory of [`MomentSums::add`].
// Vectors that straddle a cache line cost twice.
#[repr(align(64))]
pub(crate) struct Powers<S: Simd, const POWERS: usize>([[[S::f64s; POWERS]; BLOCK]; 2]);

impl<S: Simd, const POWERS: usize> Powers<S, POWERS> {
    #[inline(always)]
    pub(crate) fn new(simd: S) -> Self {
        let zero = simd.splat_f64s(0.0);
        Self([[[zero; POWERS]; BLOCK]; 2])
    }
}

impl<S: Simd, const POWERS: usize, const MOMENTS: usize> MomentSums<S, POWERS, MOMENTS> {
    #[inline(always)]
    pub(crate) fn new(simd: S) -> Self {
        Self { lanes: [simd.splat_f64s(0.0); MOMENTS] }
    }

    /// Adds up to BLOCK vectors of points.
    #[inline(always)]
    pub(crate) fn add(&mut self, simd: S, powers: &mut Powers<S, POWERS>, xs: &[S::f64s], ys: &[S::f64s]) {
        let Powers([x_powers, y_powers]) = powers;
        let x_sums = raise(simd, xs, x_powers);
        let y_sums = raise(simd, ys, y_powers);
        let [x_powers, y_powers] = [&x_powers[..xs.len()], &y_powers[..ys.len()]];
        for k in 1..POWERS {
            self.add_to(simd, k, 0, x_sums[k]);
            self.add_to(simd, 0, k, y_sums[k]);
        }
        // The last three rows have one to three products each, too few to keep the multipliers busy by themselves.
        macro_rules! rows {
            ($($j:literal)*) => { $(
                // Constants, so that no tile is compiled that has no part in the sums.
                if const { $j + 4 < POWERS } {
                    self.add_tile::<2, $j, 1>(simd, x_powers, y_powers);
                    if const { $j + 1 + COLUMNS < POWERS } {
                        self.add_tile::<2, $j, { 1 + COLUMNS }>(simd, x_powers, y_powers);
                    }
                    if const { $j + 1 + 2 * COLUMNS < POWERS } {
                        self.add_tile::<2, $j, { 1 + 2 * COLUMNS }>(simd, x_powers, y_powers);
                    }
                } else if const { $j + 4 == POWERS } {
                    self.add_tile::<3, $j, 1>(simd, x_powers, y_powers);
                }
            )* };
        }
        rows!(1 3 5 7 9 11 13);
    }

    /// Adds `x^i y^j` for ROWS powers of y from J and up to COLUMNS powers of x from I, as far as they are within the total degree.
    #[inline(always)]
    fn add_tile<const ROWS: usize, const J: usize, const I: usize>(
        &mut self,
        simd: S,
        x_powers: &[[S::f64s; POWERS]],
        y_powers: &[[S::f64s; POWERS]],
    ) {
        let mut tile = [[simd.splat_f64s(0.0); COLUMNS]; ROWS];
        for (x_powers, y_powers) in x_powers.iter().zip(y_powers) {
            for row in 0..ROWS {
                for column in 0..COLUMNS {
                    if I + column + J + row < POWERS {
                        let sum = &mut tile[row][column];
                        *sum = simd.mul_add_e_f64s(x_powers[I + column], y_powers[J + row], *sum);
                    }
                }
            }
        }
        for (row, sums) in tile.into_iter().enumerate() {
            for (column, sum) in sums.into_iter().enumerate() {
                if I + column + J + row < POWERS {
                    self.add_to(simd, I + column, J + row, sum);
                }
            }
        }
    }

    #[inline(always)]
    fn add_to(&mut self, simd: S, i: usize, j: usize, term: S::f64s) {
        let sum = &mut self.lanes[monomial_index(i, j)];
        *sum = simd.add_f64s(*sum, term);
    }
}

/// Powers of the values from 1 on, and the sums of each.
#[inline(always)]
fn raise<S: Simd, const POWERS: usize>(
    simd: S,
    values: &[S::f64s],
    powers: &mut [[S::f64s; POWERS]; BLOCK],
) -> [S::f64s; POWERS] {
    let mut sums = [simd.splat_f64s(0.0); POWERS];
    for (value, powers) in values.iter().zip(powers) {
        let mut power = *value;
        for k in 1..POWERS {
            powers[k] = power;
            sums[k] = simd.add_f64s(sums[k], power);
            power = simd.mul_f64s(power, *value);
        }
    }
    sums
}
