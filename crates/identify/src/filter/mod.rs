//! The motion filter: where the outline is, how it moves, and how well that is known, frame by frame.
mod acquisition;
mod arrow_information;
mod cell_scatter;
mod contour;
mod error;
mod innovation;
mod map_estimate;
mod map_growth;
mod map_update;
mod motion_change;
mod motion_filter;
mod nearest_field;
mod noise_level;
mod outline_drift;
mod outline_map;
mod prediction;
mod reading;
mod settings;
mod state;
mod unseen_direction;

pub(crate) use contour::median;
pub use error::FilterError;
pub use map_update::MapUpdate;
pub use motion_filter::{FilterStep, MotionFilter, Phase};
pub use outline_map::OutlineMap;
pub use settings::{FilterSettings, ProcessNoise};
