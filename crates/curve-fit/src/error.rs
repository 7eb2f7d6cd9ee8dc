use thiserror::Error;

/// Why a list of points is not an outline.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum OutlineError {
    /// Fewer points than the smallest outline of this kind has.
    #[error("{found} point(s), at least {needed} are needed")]
    TooFewPoints {
        /// Points given.
        found: usize,
        /// Smallest number accepted.
        needed: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("point {index} has a coordinate that is not finite")]
    NotFinite {
        /// Position of the point in the list, counted from 0.
        index: usize,
    },
    /// A coordinate is so large that its square would overflow.
    #[error("point {index} has the coordinate {value:e}, beyond {limit:e}", limit = crate::outline::COORDINATE_LIMIT)]
    TooLarge {
        /// Position of the point in the list, counted from 0.
        index: usize,
        /// The offending coordinate.
        value: f64,
    },
    /// All points are equal.
    #[error("all {count} points are equal")]
    Coincident {
        /// Points given.
        count: usize,
    },
    /// All points of a closed outline lie on one line.
    #[error("all {count} points lie on one line")]
    Collinear {
        /// Points given.
        count: usize,
    },
    /// No arc at all.
    #[error("an open outline needs at least one arc")]
    NoArc,
}

/// Why a polynomial could not be made or moved.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PolynomialError {
    /// Only the even degrees 2, 4, 6 and 8 describe closed curves here.
    #[error("degree {degree} is not one of 2, 4, 6, 8")]
    UnsupportedDegree {
        /// The degree asked for.
        degree: usize,
    },
    /// The coefficient list does not have the length that the degree asks for.
    #[error("{found} coefficients, degree {degree} has {needed}")]
    WrongCoefficientCount {
        /// Degree of the polynomial.
        degree: usize,
        /// Coefficients given.
        found: usize,
        /// Coefficients of a polynomial of this degree.
        needed: usize,
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient {index} is not finite")]
    NotFinite {
        /// Position in the graded order, counted from 0.
        index: usize,
    },
    /// The map of the plane has no inverse.
    #[error("the map of the plane is singular (determinant {determinant:e})")]
    SingularMap {
        /// Determinant of its 3x3 matrix.
        determinant: f64,
    },
}
