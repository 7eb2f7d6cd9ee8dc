use freeform_decompose::Line;
use nalgebra::{Affine2, Complex};

use crate::{error::DynamicsError, flow::moved_line, motion::AffineMotion};

/// Rate `c' / c` of the coefficient c of the level-m line product in the decomposition of a monic polynomial of degree n,
/// per second: `(n - m) a1 + a3 (sum l_n - sum l_m)`, with m and n the numbers of lines given.
///
/// For the quartic this is the equation of alpha with the two conic lines as `level`, and that of beta with none (the
/// equations after 18). Lines of a real polynomial are real or in conjugate pairs, so the sums are real.
#[must_use]
pub fn level_rate(motion: &AffineMotion, leading: &[Line], level: &[Line]) -> f64 {
    let sum = |lines: &[Line]| lines.iter().map(|line| line.l.re).sum::<f64>();
    (leading.len() as f64 - level.len() as f64) * motion.a1 + motion.a3 * (sum(leading) - sum(level))
}

/// Factor `c(t) / c(0)` that the coefficient of the level-m product picks up where an affine map moves the curve, from the
/// factors that the chart divides out of its lines: `prod p_i(0) / p_i(t)` over the n lines of the leading level times
/// `prod q_i(t) / q_i(0)` over the m lines of this level. `leading` and `level` are the lines before the map.
///
/// In the paper's equation 7 the ratio of q stands upside down; its own equations after 18 agree with the one here.
///
/// # Errors
/// The map is singular, or a line left the chart.
pub fn level_factor(map: &Affine2<f64>, leading: &[Line], level: &[Line]) -> Result<f64, DynamicsError> {
    let product = |lines: &[Line]| {
        lines.iter().try_fold(Complex::new(1.0, 0.0), |product, line| Ok(product * moved_line(line, map)?.1))
    };
    Ok((product(level)? / product(leading)?).re)
}

/// The two coefficients of the decomposition of a monic quartic (equation 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlphaBeta {
    /// Coefficient of the product of the two conic lines.
    pub alpha: f64,
    /// Constant term.
    pub beta: f64,
}

impl AlphaBeta {
    /// Time derivatives of alpha and beta per second (the equations after 18).
    #[must_use]
    pub fn rate(&self, motion: &AffineMotion, quartic: &[Line; 4], conic: &[Line; 2]) -> Self {
        Self {
            alpha: level_rate(motion, quartic, conic) * self.alpha,
            beta: level_rate(motion, quartic, &[]) * self.beta,
        }
    }

    /// Alpha and beta of the curve moved by an affine map (equations 7, corrected, and 8) from the lines before the map.
    ///
    /// # Errors
    /// The map is singular, or a line left the chart.
    pub fn moved(&self, map: &Affine2<f64>, quartic: &[Line; 4], conic: &[Line; 2]) -> Result<Self, DynamicsError> {
        Ok(Self {
            alpha: level_factor(map, quartic, conic)? * self.alpha,
            beta: level_factor(map, quartic, &[])? * self.beta,
        })
    }
}
