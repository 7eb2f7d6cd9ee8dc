//! The motion filter: where the outline is, how it moves, and how well that is known, frame by frame.
mod acquisition;
mod arrow_information;
mod contour;
mod error;
mod map_update;
mod motion_filter;
mod nearest_field;
mod outline_map;
mod settings;

pub use error::FilterError;
pub use map_update::MapUpdate;
pub use motion_filter::{FilterStep, MotionFilter, Phase};
pub use outline_map::OutlineMap;
pub use settings::{FilterSettings, ProcessNoise};
