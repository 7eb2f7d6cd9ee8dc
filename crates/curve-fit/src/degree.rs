use crate::error::PolynomialError;

/// Largest number of coefficients of any supported degree: 45, that of an octic.
pub const MAX_COEFFICIENTS: usize = coefficient_count(8);

/// Even degree of an implicit polynomial. Closed curves need an even one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Degree {
    /// Degree 2, 6 coefficients.
    Conic,
    /// Degree 4, 15 coefficients. The degree that the paper works with.
    Quartic,
    /// Degree 6, 28 coefficients.
    Sextic,
    /// Degree 8, 45 coefficients.
    Octic,
}

impl Degree {
    /// All supported degrees, lowest first.
    pub const ALL: [Self; 4] = [Self::Conic, Self::Quartic, Self::Sextic, Self::Octic];

    /// The degree as a number: 2, 4, 6 or 8.
    #[must_use]
    pub const fn value(self) -> usize {
        match self {
            Self::Conic => 2,
            Self::Quartic => 4,
            Self::Sextic => 6,
            Self::Octic => 8,
        }
    }

    /// Number of coefficients, `(n + 1)(n + 2) / 2`.
    #[must_use]
    pub const fn coefficient_count(self) -> usize {
        coefficient_count(self.value())
    }
}

impl TryFrom<usize> for Degree {
    type Error = PolynomialError;

    fn try_from(degree: usize) -> Result<Self, PolynomialError> {
        Self::ALL.into_iter().find(|d| d.value() == degree).ok_or(PolynomialError::UnsupportedDegree { degree })
    }
}

impl std::fmt::Display for Degree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.value())
    }
}

/// Number of monomials `x^i y^j` with `i + j <= degree`.
#[must_use]
pub const fn coefficient_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}
