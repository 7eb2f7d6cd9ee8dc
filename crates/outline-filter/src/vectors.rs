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
