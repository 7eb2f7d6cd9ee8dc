use freeform_curve_fit::{Degree, MAX_COEFFICIENTS, coefficient_count};

use crate::{
    decomposition::Decomposition,
    line::Line,
    line_product::{Coefficients, expand, smallest_separation},
};

/// How far the lines of a decomposition stay apart and how much they magnify errors of the coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    degree: Degree,
    separations: [f64; 4],
    number: f64,
}

impl Condition {
    /// Smallest chordal distance `|l - l'| / sqrt((1 + |l|^2)(1 + |l'|^2))` between two lines of level m: at most 1, and
    /// the same in every orientation of the image. Infinite where m is no level.
    #[must_use]
    pub fn separation(&self, m: usize) -> f64 {
        let n = self.degree.value();
        if m == 0 || m % 2 != 0 || m > n { f64::INFINITY } else { self.separations[(n - m) / 2] }
    }

    /// Smallest separation of all levels.
    #[must_use]
    pub fn smallest_separation(&self) -> f64 {
        self.separations.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Estimated condition number: by about how much relative errors of the coefficients are magnified in the lines, in the
    /// coefficients of the levels, and in [`expand`](Decomposition::expand) through rounding. At least 1. In units of the
    /// object: a decomposition far from the origin counts the digits that its offset costs.
    ///
    /// An error of the coefficients is carried from level to level: relative to the leading form of a level it is magnified
    /// by the condition of its roots (M. Shub and S. Smale, Complexity of Bezout's theorem I, 1993; no rotation changes it),
    /// and the line product hands it on to the next level in proportion to its own size.
    #[must_use]
    pub fn number(&self) -> f64 {
        self.number
    }
}

impl Decomposition {
    /// Diagnostics: separation of the lines and condition number. Not free: about the cost of the decomposition.
    #[must_use]
    pub fn condition(&self) -> Condition {
        let mut separations = [f64::INFINITY; 4];
        let mut remainder: Coefficients = [0.0; MAX_COEFFICIENTS];
        let expansion = self.expand();
        remainder[..expansion.coefficients().len()].copy_from_slice(expansion.coefficients());
        let size = |coefficients: &[f64]| coefficients.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let whole = size(&remainder);
        let (mut error, mut number) = (whole, 1.0_f64);
        for (position, level) in self.levels().enumerate() {
            let lines = self.level(level);
            separations[position] = smallest_separation(lines).0;
            let mut product = expand(lines);
            let magnified = error / leading_size(&remainder, level) * root_condition(lines, &product);
            product.iter_mut().for_each(|a| *a *= self.coefficient(level));
            error += magnified * size(&product);
            number = number.max(magnified).max(error / whole);
            remainder.iter_mut().zip(&product).for_each(|(r, a)| *r -= a);
        }
        let number = if number.is_finite() { number } else { f64::MAX };
        Condition { degree: self.degree(), separations, number }
    }
}

/// Largest coefficient of the part of degree `level`.
fn leading_size(coefficients: &Coefficients, level: usize) -> f64 {
    let part = &coefficients[level * (level + 1) / 2..coefficient_count(level)];
    part.iter().fold(f64::MIN_POSITIVE, |m, a| m.max(a.abs()))
}

/// Condition of the worst root of the leading form of a level: `|h| (1 + |l|^2)^(m/2 - 1) / prod |l - l_j|`, |h| the norm
/// that rotations preserve (Bombieri's). At least 1.
fn root_condition(lines: &[Line], product: &Coefficients) -> f64 {
    let level = lines.len();
    let (mut norm, mut binomial) = (0.0, 1.0);
    for (j, a) in product[level * (level + 1) / 2..coefficient_count(level)].iter().enumerate() {
        norm += a * a / binomial;
        binomial *= (level - j) as f64 / (j + 1) as f64;
    }
    let worst = lines.iter().enumerate().map(|(i, line)| {
        let others = lines.iter().enumerate().filter(|&(j, _)| j != i);
        let slope = others.map(|(_, other)| (line.l - other.l).norm_sqr().sqrt()).product::<f64>();
        (1.0 + line.l.norm_sqr()).powi(level as i32 / 2 - 1) / slope
    });
    (norm.sqrt() * worst.fold(0.0, f64::max)).max(1.0)
}
