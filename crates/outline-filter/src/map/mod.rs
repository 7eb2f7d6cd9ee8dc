//! The outline in the body frame: cells along it, how they follow each other, which is nearest to a point, and what they do not show.
mod association;
mod centring;
mod chains;
mod contour;
mod contour_area;
mod fixed_point;
mod growth;
mod local_fit;
mod medians;
mod nearest_field;
mod null_directions;
mod null_space;
mod outline_map;
mod plain_regression;
mod redrawing;
mod rest;
mod shown;
mod turn_evidence;

pub(crate) use chains::{CellPoint, has_common_places};
pub(crate) use contour::Contour;
pub(crate) use medians::{median, median_about};
pub(crate) use null_directions::{NullDirection, NullDirections};
pub(crate) use null_space::{CLOCKWISE, map_between};
pub(crate) use outline_map::{Cell, ContourNoise, OutlineMap, Resolution};
pub(crate) use turn_evidence::{TurnEvent, TurnEvidence};
