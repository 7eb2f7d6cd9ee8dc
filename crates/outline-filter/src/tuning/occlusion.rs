//! Constants of straight edges in front of the object. Deviations are those of the places that a contour is reduced to.

/// Most places that a contour is reduced to: few enough to compare all with all in some microseconds, of a fiftieth of a body each.
pub(crate) const MOST_PLACES: usize = 128;
/// Fewest places: with fewer, a straight part of [`FEWEST_STRAIGHT`] is more than a quarter of all.
pub(crate) const FEWEST_PLACES: usize = 24;
/// Least deviation of a place, in sizes: less is what a cubic through its neighbours misses at corners.
pub(crate) const LEAST_NOISE: f64 = 1.5e-3;
/// Least deviation of a place, in spacings, as that of points on straight cells in the gate: sides between places cut corners.
pub(crate) const SPACING_NOISE: f64 = 0.1;
/// Frames that the noise is the median of.
pub(crate) const NOISES: usize = 15;
/// Places nearer than this many deviations to the contour of an earlier frame have stayed there, and agree with one that is moved onto it.
pub(crate) const AGREES: f64 = 3.5;
/// Contours are compared once those places that have not stayed have moved by so many deviations, by the median.
pub(crate) const MOVED: f64 = 6.0;
/// Share of the places that must not have stayed.
pub(crate) const MOVED_SHARE: f64 = 0.25;
/// Two contours are compared again once they lie further apart by this factor: what did not show may then.
pub(crate) const FURTHER: f64 = 1.6;
/// Contours that lie so many sizes apart are compared no more: the nearest motion between them is another one.
pub(crate) const FARTHEST: f64 = 0.35;
/// Shortest straight part, as a share of all places: more than the tooth of a gear and the end of a bar have.
pub(crate) const SHORTEST_SHARE: f64 = 0.08;
/// Fewest places of a straight part: a line leaves four of them to say that it is one.
pub(crate) const FEWEST_STRAIGHT: usize = 6;
/// Most straight parts of one contour: one place at least lies between two.
pub(crate) const MOST_STRAIGHT: usize = MOST_PLACES / (FEWEST_STRAIGHT + 1);
/// Places of a straight part scatter by this many deviations at most where it is looked for. Few scatter by less than many.
pub(crate) const SEED: f64 = 1.3;
/// As [`SEED`], of all of a straight part.
pub(crate) const STRAIGHT: f64 = 1.5;
/// A straight part goes on where places lie within so many deviations of its line.
pub(crate) const WITHIN: f64 = 3.0;
/// Most parts of one contour that are tried, the longest first: a body between two edges has two.
pub(crate) const MOST_TRIED: usize = 2;
/// Share of the places that have moved which make them one straight line: the others lie round its ends.
pub(crate) const MOST_OF_LINE: f64 = 0.8;
/// Fits of that line, each to the places nearest to the one before.
pub(crate) const FITS_OF_LINE: usize = 4;
/// Share of the rest that one rigid motion must explain: what it leaves is next to the edge, where the object comes and goes.
pub(crate) const REST_AGREES: f64 = 0.9;
/// Noise at which the rest is registered, over that of the contour, beyond which the object does not move rigidly.
pub(crate) const MOST_SCATTER: f64 = 2.2;
/// Share of the contour that must be left beside two straight parts that are judged together: a hand in front of a box at rest shows less of itself.
pub(crate) const LEAST_REST: f64 = 0.5;
/// Share of the straight part that must lie off the contour where the motion of the rest takes it: near the centre of a turn it hardly moves.
pub(crate) const PART_DISAGREES: f64 = 0.4;
/// Deviations, of noise and of the motion, that it must lie off by.
pub(crate) const OFF: f64 = 5.0;
/// Share of all places by which an edge that stands still explains more than one motion of all of them.
pub(crate) const LEAST_GAIN: f64 = 0.05;
/// The same, as a share of the straight part.
pub(crate) const GAIN_OF_PART: f64 = 0.3;
/// Pairs of frames that must say so of one line, of the last [`MOST_KEPT`]: two may show a bad frame before and after it. As many must say that an
/// edge is no longer there.
pub(crate) const PAIRS: usize = 3;
/// Most pairs that are kept, and pairs after which one that was seen is forgotten.
pub(crate) const MOST_KEPT: usize = 12;
/// Lengths of what has been seen of an edge by which it may go on at each end: the object shows more of it from frame to frame.
pub(crate) const GOES_ON: f64 = 1.0;
/// Places on either side of an edge, within what has been seen of it, that make it one that is no longer there: its corners are rounded over a few.
pub(crate) const FEWEST_ACROSS: usize = 6;
/// Deviations within which lines of several pairs are one.
pub(crate) const SAME_LINE: f64 = 5.0;
/// Sine of the angle within which they are.
pub(crate) const SAME_DIRECTION: f64 = 0.12;
/// Most edges of one object: a picture has four sides.
pub(crate) const MOST_EDGES: usize = 4;
/// Deviations of a place that the middles of an edge must have moved by across it, in the root of the sum of squares, to be moving: the middle of an
/// edge of ten places errs by a third of one.
pub(crate) const DRIFTS: f64 = 1.5;
/// Looks at contours one after the other; when they have shown nothing, fewer are looked at.
pub(crate) const ATTENTIVE: usize = 64;
/// After [`ATTENTIVE`] looks in vain, frames that pass between two pairs for each look that the first has cost.
pub(crate) const FRAMES_PER_LOOK: usize = 7;
/// Most frames between two pairs: an edge must be found while the object is behind it.
pub(crate) const LONGEST_PAUSE: usize = 60;
/// Looks that cost as much as to try one part.
pub(crate) const LOOKS_PER_PART: usize = 5;
/// Most frames between two looks at an object that hardly moves.
pub(crate) const LONGEST_WAIT: usize = 16;
/// Frames after which a contour is compared with no others: an object that has hardly moved by then drifts no more than its picture does.
pub(crate) const LONGEST_PAIR: usize = 1024;
/// Fewest points of an arc that is left beside an edge: two make a side, and tell nothing of their own noise.
pub(crate) const FEWEST_OF_ARC: usize = 3;
/// Most least-squares steps of one registration: they halve what is left, and more.
pub(crate) const REGISTRATION_STEPS: usize = 12;
/// A step by less than this share of the noise is the last.
pub(crate) const REGISTRATION_SETTLED: f64 = 0.03;
/// Information of each place that the motion is held with, of 1 where it tells all: a circle does not tell its turn.
pub(crate) const REGISTRATION_PRIOR: f64 = 1e-9;
/// Most fits of a straight part that grows: each but the last adds to it.
pub(crate) const FITS_OF_PART: usize = 8;
/// Part of the shortest straight part, one in so many, by which the next one is looked for further on: none is missed that is a little longer.
pub(crate) const SEED_STEP: usize = 4;
/// As [`SEED_STEP`], that the next one may have in common with the one before it, at their corner.
pub(crate) const SEED_OVERLAP: usize = 2;
/// Most times that the time until now may pass until the next look.
pub(crate) const MOST_WAITS: f64 = 2.0;
/// Widths of an edge within which cells of a map lie along it: it was there in other frames too.
pub(crate) const WIDTHS_OF_MAP: f64 = 2.0;
/// Fewest places that tell a rigid motion.
pub(crate) const FEWEST_REGISTERED: usize = 6;
