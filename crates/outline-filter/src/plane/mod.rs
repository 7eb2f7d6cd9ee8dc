//! A plane that moves in space before a perspective camera.
//!
//! Angular velocity, velocity and normal are constants, and so are the offsets of the outline. So frames add up: what each of them
//! says is measured against the place that the motion puts the outline in, and the first frames are measured again where another
//! motion puts it. `docs/plane-in-space.md` has the equations.
mod information;
mod plane_filter;
mod scenery;
mod search;
mod solution;
mod statement;

pub use plane_filter::PlaneFilter;
pub use statement::{PlaneAmbiguity, PlaneSolution, PlaneUnknown};
