use thiserror::Error;

use crate::degree::Degree;

/// Smallest extent of an outline, so that squares of its lengths are no less precise than others.
pub(crate) const SMALLEST_EXTENT: f64 = 1e-150;

/// Largest absolute coordinate accepted, so that squares never overflow.
pub(crate) const COORDINATE_LIMIT: f64 = 1e100;

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
    #[error("point {index} has the coordinate {value:e}, beyond {limit:e}", limit = COORDINATE_LIMIT)]
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
    /// The outline is so small that squares of its lengths are lost.
    #[error("the outline is too small, its points lie within {extent:e} of their middle, less than {limit:e}; use another unit of length",
            limit = SMALLEST_EXTENT)]
    TooSmall {
        /// Largest difference of a coordinate from that of the middle.
        extent: f64,
    },
    /// All points of an outline lie on one line, to rounding.
    #[error("all {count} points lie on one line")]
    Collinear {
        /// Points given.
        count: usize,
    },
    /// No arc at all.
    #[error("an open outline needs at least one arc")]
    NoArc,
    /// Standard deviations of some of the points only, or of more than there are.
    #[error("{found} standard deviation(s) for {points} points")]
    DeviationCount {
        /// Deviations given.
        found: usize,
        /// Points of the outline.
        points: usize,
    },
    /// A standard deviation that is none.
    #[error("point {index} has the standard deviation {value}, which is not a positive finite number")]
    Deviation {
        /// Position of the point in the list, counted from 0.
        index: usize,
        /// The offending number.
        value: f64,
    },
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
    /// The leading form is not positive in every direction.
    #[error("the curve is not bounded (margin {margin:.2e})")]
    NotBounded {
        /// Minimum of the leading form on the unit circle over its root mean square.
        margin: f64,
    },
    /// The map of the plane has no inverse.
    #[error("the map of the plane is singular (determinant {determinant:e})")]
    SingularMap {
        /// Determinant of its 3x3 matrix.
        determinant: f64,
    },
}

/// Why no curve could be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FitError {
    /// Fewer points than the polynomial needs.
    #[error("{found} points, a fit of degree {degree} needs at least {needed}")]
    TooFewPoints {
        /// Points of the outline.
        found: usize,
        /// Smallest number accepted.
        needed: usize,
        /// Degree asked for.
        degree: Degree,
    },
    /// The points do not determine all coefficients.
    #[error("the points determine only {rank} of {needed} coefficients (condition number {condition:.1e})")]
    RankDeficient {
        /// Numerical rank of the least-squares matrix.
        rank: usize,
        /// Number of coefficients.
        needed: usize,
        /// Estimated condition number of the least-squares matrix.
        condition: f64,
    },
    /// The outline does not tell its inside from its outside: it runs as much one way round as the other, as a line there
    /// and back or an even figure of eight does, or its normals cancel.
    #[error("the outline has no inside: its signed area is zero")]
    NoInside,
    /// Open arcs have no area moments to normalise them by.
    #[error("open arcs have no area moments: an affine-normalised fit of them needs a map to be given")]
    NoAreaMoments,
    /// The map of the working coordinates to the image has no inverse, or is not finite.
    #[error("the map that normalises the outline is singular or not finite")]
    SingularNormalisation,
    /// The leading form of the bounded fit could not be brought above its margin.
    #[error("the bounded fit did not converge in {iterations} iterations")]
    NoConvergence {
        /// Newton steps made.
        iterations: usize,
    },
}

/// Why the settings of a fit are refused.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SettingsError {
    /// The distance of the outer level sets is not a positive fraction of the size.
    #[error("level-set offset {value} is outside (0, 1]")]
    Offset {
        /// The value given, in units of the RMS radius.
        value: f64,
    },
    /// The half window of the normals is not a fraction of the length.
    #[error("normal half window {value} is outside [0, 0.25]")]
    NormalHalfWindow {
        /// The value given, a fraction of the length of the outline.
        value: f64,
    },
    /// The weight of the ridge is negative or not finite.
    #[error("ridge weight {value} is negative or not finite")]
    RidgeWeight {
        /// The value given.
        value: f64,
    },
    /// The margin of the bounded fit is not a fraction.
    #[error("boundedness margin {value} is outside (0, 0.9]")]
    Margin {
        /// The value given.
        value: f64,
    },
}
