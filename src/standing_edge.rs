//! What is said of straight edges that are not of an object.
use std::fmt;

use freeform_outline_filter::StandingEdge;

use crate::number::significant;

pub(crate) fn write_standing_edge(f: &mut fmt::Formatter<'_>, edge: &StandingEdge) -> fmt::Result {
    let [x1, y1, x2, y2] = [edge.from.x, edge.from.y, edge.to.x, edge.to.y].map(|x| significant(x, 4));
    let since = significant(edge.since, 4);
    write!(f, "a straight part of the outline, from ({x1}, {y1}) to ({x2}, {y2}), ")?;
    match edge.until.map(|until| significant(until, 4)) {
        Some(until) => write!(
            f,
            "was left out from {since} s to {until} s, as it did not move with the rest: poses until then are in doubt"
        ),
        None => write!(
            f,
            "does not move with the rest, as the edge of something in front of the object: it is left out from {since} s on, poses before are in \
             doubt; leave out what lies there (--margins), or give open arcs without it"
        ),
    }
}
