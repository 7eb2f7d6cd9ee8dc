//! Straight edges that cut the object off and stand still while it moves, or move otherwise: sides of what is in front of it, and of the picture,
//! that nobody has declared. They are found from outlines alone, and the points along them are left out.
mod buffers;
mod cut;
mod edge;
mod evidence;
mod line;
mod places;
mod registration;
mod sighting;
mod standing_edges;

pub use edge::StandingEdge;
pub(crate) use standing_edges::StandingEdges;
