use nalgebra::Complex;
use thiserror::Error;

/// Why the roots of a binary form could not be given.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum RootError {
    /// Only the even degrees 2 to 8 are supported.
    #[error("{count} coefficients are not those of a binary form of degree 2, 4, 6 or 8")]
    UnsupportedDegree {
        /// Coefficients given, one more than the degree.
        count: usize,
    },
    /// The coefficient of the highest power is zero, or so small relative to another one that their ratio overflows.
    #[error("the leading coefficient {leading:e} is zero beside the largest one, {largest:e}")]
    VanishingLeadingCoefficient {
        /// Coefficient of the highest power of z.
        leading: f64,
        /// Largest absolute coefficient.
        largest: f64,
    },
    /// A coefficient is NaN or infinite.
    #[error("coefficient {index} is not finite")]
    NotFinite {
        /// Position in the list, counted from 0.
        index: usize,
    },
    /// Neither the iteration nor the eigenvalues of the companion matrix gave roots.
    #[error(
        "the roots of a form of degree {degree} did not converge in {iterations} iterations (residual {residual:e})"
    )]
    NoConvergence {
        /// Degree of the form.
        degree: usize,
        /// Iterations made.
        iterations: usize,
        /// Largest absolute value left of the scaled form at the points reached.
        residual: f64,
    },
}

/// Why a polynomial has no decomposition into line products that could be trusted, or why one could not be moved or
/// put together.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum DecompositionError {
    /// The coefficient of `x^level` (in the quartic: `a40` at level 4, alpha at level 2) is zero or next to it. It
    /// depends on the orientation unless the whole part of that degree is missing.
    #[error("the coefficient of x^{level} vanishes at level {level} (relative size {relative:e})")]
    VanishingLeadingCoefficient {
        /// Degree of the line product.
        level: usize,
        /// Size of the coefficient relative to the part of that degree, or to what it was computed from.
        relative: f64,
    },
    /// Two lines of a level have almost the same direction; their intercepts k are unbounded there.
    #[error("two lines at level {level} nearly share l = {l} (separation {separation:e})")]
    NearDoubleLines {
        /// Degree of the line product.
        level: usize,
        /// Chordal distance of the two l, between 0 and 1.
        separation: f64,
        /// One of the two.
        l: Complex<f64>,
    },
    /// The part of highest degree has a factor `(x^2 + y^2)^2`, or nearly: `l = +-j` twice. Such a curve shows neither
    /// separate lines nor its rotation.
    #[error("the leading form at level {level} is circular, l = +-j twice (separation {separation:e})")]
    CircularLeadingForm {
        /// Degree of the line product.
        level: usize,
        /// Chordal distance of the two l, between 0 and 1.
        separation: f64,
    },
    /// Rounding alone would leave next to nothing of the lines: the curve is close to one of the cases above at some level,
    /// or its coordinates are far from centred and scaled.
    #[error("the decomposition is ill-conditioned (condition number about {condition:e})")]
    IllConditioned {
        /// Estimated condition number.
        condition: f64,
    },
    /// No roots could be found.
    #[error("no lines at level {level}")]
    Roots {
        /// Degree of the line product.
        level: usize,
        /// What went wrong.
        source: RootError,
    },
    /// A line or a coefficient of the level overflows.
    #[error("a number at level {level} is not finite")]
    NotFinite {
        /// Degree of the line product.
        level: usize,
    },
    /// The map of the plane has no inverse.
    #[error("the map of the plane is singular (determinant {determinant:e})")]
    SingularMap {
        /// Determinant of its linear part.
        determinant: f64,
    },
    /// The map turns a real line of the level parallel to the x axis, where `x + l y + k` cannot describe it.
    #[error("a line at level {level} is turned parallel to the x axis (relative coefficient of x {relative:e})")]
    LineLeavesChart {
        /// Degree of the line product.
        level: usize,
        /// Coefficient of x relative to what it was computed from.
        relative: f64,
    },
    /// The number of lines or coefficients is not that of the degree.
    #[error(
        "{lines} lines and {coefficients} coefficients, degree {degree} has {lines_needed} and {coefficients_needed}"
    )]
    WrongCount {
        /// Degree of the polynomial.
        degree: usize,
        /// Lines given.
        lines: usize,
        /// Lines of a decomposition of this degree.
        lines_needed: usize,
        /// Coefficients given.
        coefficients: usize,
        /// Coefficients of a decomposition of this degree.
        coefficients_needed: usize,
    },
    /// Lines 2i and 2i + 1 of a level are neither complex conjugates nor both real.
    #[error("lines {index} and {} at level {level} are neither conjugate nor both real", index + 1)]
    NotConjugate {
        /// Degree of the line product.
        level: usize,
        /// Position of the first of the two within the level.
        index: usize,
    },
}

/// Why the conjugate pairs of two frames could not be matched.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CorrespondenceError {
    /// The two frames do not have the same number of conjugate pairs at the level.
    #[error("level {level} has {earlier} conjugate pair(s) in the earlier frame and {later} in the later one")]
    PairCountDiffers {
        /// Degree of the line product.
        level: usize,
        /// Pairs in the earlier frame.
        earlier: usize,
        /// Pairs in the later frame.
        later: usize,
    },
    /// Neither frame has a conjugate pair at the level.
    #[error("no conjugate pair at level {level}")]
    NoConjugatePair {
        /// Degree of the line product.
        level: usize,
    },
    /// The size of the object is not a positive finite number.
    #[error("the size of the object, {size}, is not positive and finite")]
    ObjectSize {
        /// The size given.
        size: f64,
    },
    /// A cost of matching overflows.
    #[error("the distance between the pairs at level {level} is not finite")]
    NotFinite {
        /// Degree of the line product.
        level: usize,
    },
}
