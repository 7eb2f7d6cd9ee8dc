//! Every constant of the motion filter, once, with its reason and, where there is one, its source.
//!
//! Lengths are in RMS radii of the first outline unless a line says otherwise; "deviations" are standard deviations.
//!
//! | file | modules |
//! |---|---|
//! | `frame.rs` | `measurement`, `lattice`, `noise`, `deviations`, `likelihood`, `update` (solving and the gate) |
//! | `motion.rs` | `motion_change`, `supervisor`, `batch`, `dynamics`, `steady_change`, `innovations`, `family`, `statement`, `saved_state` |
//! | `outline.rs` | `map`, `contour`, `null_space`, `usual_agreement`, `shape_change`, `shape_noise`, `redrawing`, `symmetry` |
//! | `search.rs` | `remapping`, `groupwise`, `registration`, `turn_profile`, `turn_hypotheses` |
//! | `occlusion.rs`, `plane.rs` | themselves: edges in front of the object; the plane that moves in space |
//!
//! Names such as `SIGNIFICANT` and `MEMORY` exist in several modules, with values of their own. Such a constant is always named with its module, as
//! `family::SIGNIFICANT`, or as `tuning::SIGNIFICANT` where a file imports its one module by that name; text names the module too.
mod frame;
mod motion;
pub(crate) mod occlusion;
mod outline;
pub(crate) mod plane;
mod search;

pub(crate) use frame::{deviations, lattice, likelihood, measurement, noise, update};
#[cfg(feature = "serde")]
pub(crate) use motion::saved_state;
pub(crate) use motion::{batch, dynamics, family, innovations, motion_change, statement, steady_change, supervisor};
pub(crate) use outline::{contour, map, null_space, redrawing, shape_change, shape_noise, symmetry, usual_agreement};
pub(crate) use search::{groupwise, registration, remapping, turn_hypotheses, turn_profile};
