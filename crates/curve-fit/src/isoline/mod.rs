//! Isolines, by marching squares (W. Lorensen, H. Cline, *Marching cubes*, 1987, in the plane), followed from cell to cell.
//!
//! [`of_samples`] takes the values of a picture, [`of_function`] a function that can be evaluated anywhere. Both follow the
//! lines through the cells of a grid in the same way. They differ in what only the one or the other can have:
//!
//! | | [`of_samples`] | [`of_function`] |
//! |---|---|---|
//! | inside | at or above the level | below zero, as for an [`ImplicitPolynomial`](crate::ImplicitPolynomial) |
//! | at the edge of the grid | lines are closed around it: an outline needs an area | lines end: a curve goes on beyond what is looked at |
//! | two opposite corners of a cell inside | joined, as objects are 8-connected sets of pixels | by the mean of the corners: the function tells |
//! | crossings | by linear interpolation; nothing is known between samples | refined by false position |
//! | crossings at a node | kept apart from it, so that no line touches itself | on it, where the function is zero there |
//!
//! ```
//! use freeform_curve_fit::{Rectangle, isoline};
//! use nalgebra::Point2;
//!
//! // A disc of radius 20 in a picture of 64 x 64 pixels.
//! let value = |x: usize, y: usize| 20.0 - (x as f64 - 31.5).hypot(y as f64 - 31.5);
//! let lines = isoline::of_samples([64, 64], value, 0.0);
//! assert_eq!(lines.len(), 1);
//! let area = isoline::signed_area(&lines[0]);
//! assert!((area / (400.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
//!
//! // A view of the right branch of a hyperbola, which leaves it above and below.
//! let view = Rectangle { low: Point2::new(0.0, -2.0), high: Point2::new(4.0, 2.0) };
//! let lines = isoline::of_function(|p| 1.0 + p.y * p.y - p.x * p.x, &view, 100);
//! assert_eq!(lines.len(), 1);
//! assert!(lines[0].iter().all(|p| (p.x - (1.0 + p.y * p.y).sqrt()).abs() < 1e-6));
//! ```
mod function;
mod samples;
mod walk;

pub use function::of_function;
pub(crate) use function::of_rows;
pub use samples::{Crossing, LargestLines, LineTooLong, WantedHoles, largest_of_samples, of_samples, signed_area};

/// Where a value that goes linearly from one to another passes a level, as a share of the way, at least `clearance` from
/// both ends; in the middle where the values do not tell.
fn crossing_share(from: f64, to: f64, level: f64, clearance: f64) -> f64 {
    let share = (from - level) / (from - to);
    if share.is_finite() { share.clamp(clearance, 1.0 - clearance) } else { 0.5 }
}
