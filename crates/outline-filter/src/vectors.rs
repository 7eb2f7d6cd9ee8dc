//! The widest vector instructions of the processor at hand.
use pulp::{Arch, Simd, WithSimd};

struct Vectorised<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Vectorised<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}

/// Runs loops, which the compiler turns into vector instructions of the processor at hand. The closure, and all that it calls, is to be
/// inlined always: a function by itself is made for the least of all processors.
#[inline(always)]
pub(crate) fn vectorised<R>(run: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Vectorised(run))
}

/// Numbers that are worked on side by side.
pub(crate) const LANES: usize = 4;

pub(crate) type Lanes = [f64; LANES];

/// Rows as columns of lanes.
#[inline(always)]
pub(crate) fn in_lanes<const N: usize>(rows: &[[f64; N]; LANES]) -> [Lanes; N] {
    let mut columns = [[0.0; LANES]; N];
    for (i, column) in columns.iter_mut().enumerate() {
        for lane in 0..LANES {
            column[lane] = rows[lane][i];
        }
    }
    columns
}

/// Adds products, lane by lane.
#[inline(always)]
pub(crate) fn add_product(sum: &mut Lanes, a: &Lanes, b: &Lanes) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane];
    }
}

/// Lane by lane; by nothing where the divisor is not positive.
#[inline(always)]
pub(crate) fn positive_inverse(divisor: &Lanes) -> Lanes {
    divisor.map(|d| if d > 0.0 { 1.0 / d } else { 0.0 })
}
