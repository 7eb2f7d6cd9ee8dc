//! Every constant of the motion filter, once, with its reason and, where there is one, its source.
//!
//! Lengths are in RMS radii of the first outline unless a line says otherwise; "deviations" are standard deviations.

/// The map: cells along the outline, cut from points.
pub(crate) mod map {
    /// Fewest points that a map is begun with. Three cells of two points make no outline; below eight, chance makes any shape.
    pub(crate) const FEWEST_POINTS: usize = 8;
    /// Length of a cell in deviations of the noise. Shorter cells leave more offsets to be estimated, and points that come to the wrong
    /// cell; longer ones a coarser outline.
    pub(crate) const NOISE_PER_CELL: f64 = 3.0;
    /// As [`NOISE_PER_CELL`], where there are [`PLENTY_PER_CELL`] points for each cell, so that offsets are known all the same.
    pub(crate) const LEAST_NOISE_PER_CELL: f64 = 1.5;
    /// Points for each cell that are plenty.
    pub(crate) const PLENTY_PER_CELL: f64 = 4.0;
    /// Fewest points of the first frame for each cell: with fewer, cells would be seen by chance.
    pub(crate) const POINTS_PER_CELL: f64 = 1.0;
    /// Most cells of the first frame, which bounds the work of a frame.
    pub(crate) const MOST_CELLS: f64 = 800.0;
    /// An outline is cut into so many cells at least, so that it has sides.
    pub(crate) const CELLS_PER_LENGTH: f64 = 12.0;
    /// Places further than this many spacings from all cells are new: a cell reaches half a spacing, and its neighbour half of one more.
    pub(crate) const UNCOVERED: f64 = 1.1;
    /// A map of so many times the places that any frame has shown at once holds what is not of the object, and grows no more: an
    /// object of which less was seen at a time could not have been found again. Without this the map of an object that comes and
    /// goes at the edge of the picture would grow for ever, by poses that its few points leave in doubt.
    pub(crate) const MOST_TIMES_SEEN: usize = 8;
    /// Shortest run of new places that is taken: one alone is an outlier as often as not.
    pub(crate) const SHORTEST_RUN: usize = 2;
    /// Longest side of the picture of nearest cells, pixels: it stays within the second cache of a processor.
    pub(crate) const FIELD_PIXELS: f64 = 192.0;
    /// Farthest that anything on a saved map may be from the centre of the first outline, in its radii; nothing followed comes near it.
    #[cfg(feature = "serde")]
    pub(crate) const FARTHEST: f64 = 1e9;
    /// Most cells of a saved map: far more than [`MOST_TIMES_SEEN`] of [`MOST_CELLS`] make.
    #[cfg(feature = "serde")]
    pub(crate) const MOST_SAVED: usize = 1 << 20;
    /// How far the square of a saved normal may be from 1: far above rounding, far below anything that would show.
    #[cfg(feature = "serde")]
    pub(crate) const UNIT_NORMAL: f64 = 1e-6;
    /// Share of the largest square of a lever below which the outline as a whole is not seen to move: rounding makes as much.
    pub(crate) const UNSEEN_SHIFT: f64 = 1e-6;
    /// Points further than this many spacings beyond a known end belong to what is not known yet.
    pub(crate) const BEYOND_END: f64 = 0.75;
}

/// Smoothing of one contour, robust against outliers.
pub(crate) mod contour {
    /// Half window of the median that finds gross outliers, in points: up to four outliers in a row are found.
    pub(crate) const MEDIAN_HALF_WINDOW: usize = 4;
    /// A point this many median distances from the median of its neighbours is a gross outlier.
    pub(crate) const GROSS: f64 = 5.0;
    /// Half window of the pilot regression that the noise is taken from.
    pub(crate) const PILOT_HALF_WINDOW: usize = 4;
    /// Residuals beyond this many deviations leave the regression: one of 2,000 good points.
    pub(crate) const OUTLYING: f64 = 3.5;
    /// Distance of points in a row, in mean distances, up to which they are a piece of the outline rather than outliers: independent points
    /// are 3 apart once in twenty times.
    pub(crate) const OF_RUN: f64 = 3.0;
    /// Share of the points of such a row that are no further from the next: a single step over a gap is no sign of outliers.
    pub(crate) const CLOSE_OF_RUN: f64 = 0.75;
    /// Deviation of a normal's direction that the window is chosen for, rad: its cosine is then within 0.2 %.
    pub(crate) const NORMAL_NOISE: f64 = 0.05;
    /// As [`NORMAL_NOISE`], for the pilot regression.
    pub(crate) const PILOT_NORMAL_NOISE: f64 = 0.25;
    /// Neighbours are looked for among one of so many parts of the points, on either side, where outliers lie between; and windows reach no
    /// further.
    pub(crate) const PARTS: usize = 8;
    /// As [`PARTS`], for windows that are wider than normals usually need: over a tenth of an outline, smoothing leaves nine tenths of the
    /// height of a wave that is a third of it long.
    pub(crate) const FINE_PARTS: usize = 20;
    /// Smallest and largest half window of the local regression, in points.
    pub(crate) const HALF_WINDOWS: std::ops::RangeInclusive<usize> = 2..=30;
    /// Largest that is wider than normals usually need, in points.
    pub(crate) const LARGEST_FINE: usize = 120;
    /// Residuals of a regression that a point took part in are divided by their deviation, no less than this share of a variance.
    pub(crate) const LEAST_RESIDUAL_VARIANCE: f64 = 0.05;
    /// Sizes within these shares of a guess of their median are put in order to find it: a quarter of them, four deviations of the median
    /// of a few hundred on either side.
    pub(crate) const ABOUT: [f64; 2] = [0.75, 1.33];
    /// Points whose residuals keep less of their variance than this tell nothing of the noise.
    pub(crate) const TELLING_RESIDUAL_VARIANCE: f64 = 0.1;
}

/// Directions of the pose that an outline does not show.
pub(crate) mod null_space {
    /// Eigenvalue of the lever arms, in squares of the RMS radius, below which a direction of the pose cannot be seen.
    pub(crate) const DEGENERATE: f64 = 0.003;
    /// Times what the errors of the normals would make of the levers in a direction that is not seen: that, and some more.
    pub(crate) const EXPLAINED: f64 = 2.0;
    /// Eigenvalue of the lever arms of a turn below which its normals are taken from wider windows.
    pub(crate) const WEAKLY_SHOWN: f64 = 0.02;
    /// Eigenvalue of the lever arms of such a turn, in what errors of the normals make of it, that windows are chosen for. Over n frames errors
    /// grow as n^(1/100) beyond what is stated.
    pub(crate) const LEVER_PER_NOISE: f64 = 100.0;
    /// As that, below which the turn is held as not shown.
    pub(crate) const LEAST_LEVER_PER_NOISE: f64 = 50.0;
    /// Eigenvalue of the lever arms above which it never is: that of an ellipse whose axes differ by a seventh.
    pub(crate) const HARDLY_SHOWN: f64 = 0.01;
    /// Deviation of a normal's direction that cells are far enough apart for, rad...
    pub(crate) const CHORD_NOISE: f64 = 0.035;
    /// ...but no further than one of so many parts of all.
    pub(crate) const FEWEST_PARTS: usize = 16;
    /// Squared angle between two chords over the variance of a direction that is anywhere between theirs.
    pub(crate) const BETWEEN_CHORDS: f64 = 12.0;
    /// Variance that stands for any direction: the mean squared sine.
    pub(crate) const ANY_DIRECTION: f64 = 0.5;
    /// Points of a window over which a quadratic is fitted, for each that its middle is worth.
    pub(crate) const QUADRATIC: f64 = 2.25;
    /// Steps of Newton's method to the least of the motions that look alike; each doubles the digits.
    pub(crate) const LEAST_STEPS: usize = 3;
    /// Turn, in rad, of a unit step in a direction that counts as turning.
    pub(crate) const HOLDS_TURN: f64 = 0.3;
    /// Share of the largest part of a direction, lengths in RMS radii, from which on a parameter takes part in it.
    pub(crate) const TAKES_PART: f64 = 0.01;
    /// As that, of a velocity in a direction that turns: what is not seen of a turn may be half a circle in a frame, so that this is
    /// rounding alone.
    pub(crate) const TURNS_WITH: f64 = 1e-6;
    /// Share of the deviation of a velocity at the origin of the image that a rate which is not known may make: beyond, neither is known.
    pub(crate) const HANGS_ON: f64 = 0.5;
    /// Information that holds a direction, in units of the noise: it moves by no more than a thirty-thousandth of it, which does not add up
    /// over the frames of a recording, and leaves seven digits to the solution.
    pub(crate) const HOLDING: f64 = 1e9;
}

/// Points of a frame against the map.
pub(crate) mod measurement {
    /// Residuals up to this many deviations count in full...
    pub(crate) const FULL_WEIGHT: f64 = 3.0;
    /// ...and beyond this many not at all, with the biweight of Beaton and Tukey (1974) between.
    pub(crate) const NO_WEIGHT: f64 = 6.0;
    /// With this share of the points near the prediction, their spread need not be looked at before they are weighted.
    pub(crate) const NEAR_ENOUGH: f64 = 0.75;
    /// Deviation that the place of a point along the outline may have, in spacings.
    pub(crate) const PLACE_NOISE: f64 = 0.13;
    /// Share of all points that the mean is taken over at most: a wider mean would cut corners.
    pub(crate) const WIDEST_WINDOW: f64 = 0.04;
    /// Fewest points on either side that the direction of the contour is told from.
    pub(crate) const FEWEST_NEIGHBOURS: usize = 2;
    /// Share of the points whose cells must run the same way along the contour: most, or nothing can be said of the rest.
    pub(crate) const SURE_DIRECTION: f64 = 0.8;
    /// Points before and after one that are looked at for the side it is on, in windows.
    pub(crate) const FURTHEST_NEIGHBOUR: usize = 8;
    /// From the median of absolute values to the deviation of Gaussian noise, 1 / 0.6745.
    pub(crate) const MEDIAN_TO_DEVIATION: f64 = 1.4826;
}

/// Noise of the points.
pub(crate) mod noise {
    /// Smallest deviation of the noise that is reckoned with: far below what any picture tells, and far above rounding.
    pub(crate) const SMALLEST: f64 = 1e-9;
    /// What straight cells leave of an outline where it bends most, in spacings: noise is not told from it below.
    pub(crate) const CELL_ERROR: f64 = 0.03;
    /// Share of the sagitta over a chord of two cells that is left at the ends of one.
    pub(crate) const SAGITTA_LEFT: f64 = 0.25;
    /// Frames that the running mean of the noise looks back on.
    pub(crate) const MEMORY: f64 = 200.0;
    /// Weight of the first frame's noise in that mean, in frames: it comes from one contour alone.
    pub(crate) const FIRST_WEIGHT: f64 = 0.5;
    /// Frames whose spread is looked back on to tell a bad frame.
    pub(crate) const FRAMES: usize = 9;
    /// A frame with so many times the noise of most does not show the known outline, however well the map is bent to it.
    pub(crate) const LARGEST_RATIO: f64 = 1.8;
    /// Nor does one with more than this: outlines of different objects differ by more.
    pub(crate) const LARGEST: f64 = 0.05;
    /// As [`LARGEST`], while no frame has been compared with another.
    pub(crate) const LARGEST_AT_FIRST: f64 = 0.03;
    /// Stretches that the contour is cut into to see whether its errors are correlated.
    pub(crate) const STRETCHES: usize = 24;
    /// Fewest points of a stretch whose mean tells something of correlation.
    pub(crate) const FEWEST_IN_STRETCH: usize = 3;
    /// Frames that the correlation is averaged over.
    pub(crate) const CORRELATION_MEMORY: f64 = 50.0;
    /// Deviations of its estimate by which a correlation must be larger than none.
    pub(crate) const CORRELATION_SIGNIFICANT: f64 = 2.0;
    /// Deviation of a point of a mask, in pixels: measured on discs of 10 to 60 pixels in radius, smoothed by a pixel (`trace_mask`).
    pub(crate) const ROUNDED_POINT: f64 = 0.15;
    /// Length of a mask's contour that is off together, in pixels: the integral of the correlation that smoothing by a pixel leaves, 2 sqrt(pi).
    pub(crate) const ROUNDED_TOGETHER: f64 = 3.54;
    /// Noise below this many spacings is never too much: exact points leave what the cells do not follow.
    pub(crate) const NEVER_TOO_MUCH: f64 = 0.1;
    /// Points that the assumption of the usual noise of a cell is worth.
    pub(crate) const INFLATION_PRIOR_POINTS: f64 = 8.0;
    /// Deviations of its estimate by which the variance of a cell's points must be larger than that of the noise.
    pub(crate) const INFLATION_SIGNIFICANT: f64 = 2.0;
    /// Squared residual, in units of the variance known, beyond which a point may be an outlier and counts no more than that.
    pub(crate) const INFLATION_CLIPPED: f64 = 9.0;
    /// Points of a cell that are remembered.
    pub(crate) const INFLATION_MEMORY: f64 = 400.0;
}

/// Deviations that points state of themselves.
pub(crate) mod deviations {
    /// Share of the points of a frame that are good ones, by the least deviations that are stated: no point counts for more than these.
    pub(crate) const GOOD_SHARE: f64 = 0.1;
    /// What the deviation of good points is multiplied by at least when a frame states less: one frame alone is hardly believed.
    pub(crate) const LARGEST_STEP: f64 = 0.9;
    /// What it is multiplied by at most when a frame states more: as fast as the noise is learnt, so that a first frame that states too
    /// little is not believed for ever.
    pub(crate) const LARGEST_RISE: f64 = 1.01;
    /// Deviation over that of a good point from which on it is taken for this: such a point counts for a thousandth.
    pub(crate) const LARGEST_RATIO: f64 = 30.0;
    /// Deviations over that of a typical point of its frame by which a point is still judged: an edge that was not found lies anywhere, and
    /// what it says of itself is no more than that.
    pub(crate) const WIDEST: f64 = 3.0;
}

/// Comparison of poses by their likelihoods.
pub(crate) mod likelihood {
    /// Smallest noise that poses are compared by, in spacings: without noise residuals are what straight cells leave.
    pub(crate) const CELL_ERROR: f64 = 0.1;
    /// Residuals of more deviations are no worse: they may be outliers.
    pub(crate) const LARGEST: f64 = 4.0;
    /// Square that stands for a point beyond the known ends of the outline.
    pub(crate) const UNKNOWN: f64 = 2.0;
    /// Variance of the difference of a point's squared residuals from two parts of an outline: the noise of the point is in both, that
    /// of the map is not (2 + 2 - 2 / 2).
    pub(crate) const VARIANCE: f64 = 3.0;
    /// Deviations of the difference by which one of many poses must be worse.
    pub(crate) const SIGNIFICANT: f64 = 5.0;
    /// Mean square of the residuals, in that of the best pose, from which on another is far worse at a first look, and is not measured: far
    /// beyond what any comparison asks for.
    pub(crate) const FAR_WORSE: f64 = 6.0;
    /// Points that a first look is at: the mean of their squares is known to a fifth.
    pub(crate) const ROUGHLY: usize = 100;
    /// Points that turns are compared by; more of them would not decide more.
    pub(crate) const ENOUGH_POINTS: usize = 2000;
}

/// Shape process noise: outlines that change slowly.
pub(crate) mod shape_noise {
    /// Frames that the evidence looks back on.
    pub(crate) const MEMORY: f64 = 15.0;
    /// Deviations by which repeated innovations must be seen. A shape that does not change must not be forgotten.
    pub(crate) const SIGNIFICANT: f64 = 5.0;
    /// Share of the repeated part that the variance is corrected by in one frame.
    pub(crate) const GAIN: f64 = 0.1;
    /// Innovation of one cell, in deviations, that counts at most: one cell gone wrong must not speak for all.
    pub(crate) const CLIPPED: f64 = 6.0;
    /// Share of what is known of a cell that a frame must add for its innovation to be told.
    pub(crate) const SMALLEST_GAIN: f64 = 1e-6;
}

/// Solving for a frame, and the gate.
pub(crate) mod update {
    /// Weight of the first pose, in points: it only fixes the gauge, since pose and offsets can move together.
    pub(crate) const GAUGE_WEIGHT: f64 = 10.0;
    /// Information on the motion that makes the first equations solvable, per squared second: next to nothing.
    pub(crate) const MOTION_PRIOR: f64 = 1e-10;
    /// Most linearisations per frame. One suffices in steady state; acquisition needs three or four.
    pub(crate) const MOST_ITERATIONS: usize = 6;
    /// A step that moves points by less than this many deviations of the noise is the last.
    pub(crate) const SETTLED: f64 = 0.03;
    /// Determinant of a pose below which it has collapsed.
    pub(crate) const COLLAPSED: f64 = 1e-12;
    /// Residuals within this many deviations agree with the map.
    pub(crate) const AGREEING: f64 = 3.5;
    /// Residuals below this many spacings agree too: corners lie off the straight cells by as much.
    pub(crate) const BEND: f64 = 0.2;
    /// So many points beyond the known ends count as one in the share that agrees: they may be anything.
    pub(crate) const NEW_POINTS_PER_POINT: f64 = 3.0;
    /// Share of what is known of a cell beyond which a point says nothing of the noise: the cell follows it.
    pub(crate) const LARGEST_LEVERAGE: f64 = 0.8;
    /// Fewest points beyond the known ends that make the map grow.
    pub(crate) const FEWEST_NEW_POINTS: usize = 4;
    /// Squared innovation per parameter beyond which the motion has not gone on as it was: five deviations in every one. Chance does
    /// that once in a million frames.
    pub(crate) const SUDDEN: f64 = 25.0;
    /// Share of the smallest agreement from which a frame may show the outline where a motion that has changed has taken it: that of two lines
    /// which cross, one of them held where it was expected.
    pub(crate) const PARTLY_THERE: f64 = 0.5;
}

/// Remapping: the map cut anew from several frames.
pub(crate) mod remapping {
    /// Frames after which the map is cut anew.
    pub(crate) const OCCASIONS: [usize; 3] = [4, 16, 64];
    /// With so many points of one frame for each cell there is nothing to be gained.
    pub(crate) const PLENTY_PER_CELL: f64 = 3.5;
    /// Times that a map is cut from the same frames at most.
    pub(crate) const MOST_CUTS: usize = 4;
    /// Points of several frames beyond which more of them would not make cells finer.
    pub(crate) const PLENTY: usize = 3200;
    /// Points nearer than so many spacings are one.
    pub(crate) const COINCIDENT: f64 = 0.05;
    /// Share of the noise that the map has seen, which the points are taken to have at least: where those of many frames lie in one place
    /// they make contours of their own.
    pub(crate) const LEAST_NOISE: f64 = 0.5;
    /// Length of a map cut anew over that of the map before it, beyond which it follows errors.
    pub(crate) const LONGEST: f64 = 1.4;
    /// Cells of a map from which on its length says so: one of fewer may itself be too short, as it cuts corners.
    pub(crate) const CELLS_OF_LENGTH: usize = 64;
    /// Points that follow each other in less than this share of the mean distance lie in one place.
    pub(crate) const COMMON: f64 = 0.2;
}

/// Global registration: the object looked for without a guess.
pub(crate) mod registration {
    /// Turns tried over the whole circle, 15 degrees apart: within reach of the local search on every outline tried.
    pub(crate) const TURNS: usize = 24;
    /// Points that the search is made with.
    pub(crate) const FEW_POINTS: usize = 80;
    /// Distance beyond which points count alike in the score of a pose, in radii: they may be hidden in the map or wrong. Trimming a share of
    /// the points instead would leave out the pin of a disc, which alone tells its turn.
    pub(crate) const FARTHEST: f64 = 0.1;
    /// Deviation of the residuals that the first step of a search allows for, in radii: starts lie up to 7.5 degrees off, which is 0.13 at the
    /// RMS radius, and Tukey's weights reach 4.7 deviations.
    pub(crate) const WIDEST: f64 = 0.065;
    /// As [`WIDEST`], of a refinement, which begins with what few points have found.
    pub(crate) const WIDEST_REFINED: f64 = 0.03;
    /// By which it falls from step to step: below the noise within the steps of a search.
    pub(crate) const NARROWER: f64 = 0.5;
    /// Steps of the search for each start, at most.
    pub(crate) const SEARCH_STEPS: usize = 8;
    /// Steps after which searches that have come together are made once.
    pub(crate) const FIRST_STEPS: usize = 4;
    /// As [`WIDEST`], after these.
    pub(crate) const WIDEST_FURTHER: f64 = WIDEST * NARROWER * NARROWER * NARROWER * NARROWER;
    /// Distance of the matrices of poses that have come together: a fiftieth of the turn that starts are apart.
    pub(crate) const TOGETHER: f64 = 0.005;
    /// Largest step after which a pose has settled, normalised, in deviations of the noise: less than what a pose is known to, and than what
    /// the linearisations that follow settle to.
    pub(crate) const SETTLED: f64 = 0.03;
    /// Steps of the refinement of the best, at most.
    pub(crate) const REFINEMENT_STEPS: usize = 15;
    /// Poses that are refined.
    pub(crate) const REFINED: usize = 5;
    /// Poses that are handed back at most, with as many of smaller turns.
    pub(crate) const KEPT: usize = 2;
    /// Poses whose turns differ by less than this are the same, rad.
    pub(crate) const SAME_TURN: f64 = 0.15;
    /// Poses whose matrices differ by less than this are the same.
    pub(crate) const SAME_POSE: f64 = 0.5;
    /// A score up to this many times the best is a tie.
    pub(crate) const TIE: f64 = 1.25;
    /// Tukey's constant for 95 % efficiency at Gaussian noise.
    pub(crate) const TUKEY: f64 = 4.685;
    /// What makes the equations of a step solvable where the points do not.
    pub(crate) const DAMPING: f64 = 1e-6;
    /// Turns from the best that are compared with it, spread by the golden angle, to see whether a frame shows the turn.
    pub(crate) const OTHER_TURNS: usize = 32;
    /// The golden angle, rad.
    pub(crate) const GOLDEN_ANGLE: f64 = 2.399_963;
    /// Turns nearer than this to the best are no others, rad.
    pub(crate) const NEAR: f64 = 0.3;
    /// Share of other turns that a frame must explain worse than the best to show the turn...
    pub(crate) const MOST: f64 = 0.5;
    /// ...and where no frame has before.
    pub(crate) const NEARLY_ALL: f64 = 0.88;
}

/// Hypotheses: turns that explain a frame alike.
pub(crate) mod hypotheses {
    /// Turns that differ by less are the same, rad.
    pub(crate) const DIFFERENT_TURN: f64 = 0.15;
    /// Of turns that explain the frames alike the smallest is taken for granted if the others are so many times as large: the turn per
    /// frame is then less than two thirds of half the angle of symmetry.
    pub(crate) const SURELY_SMALLER: f64 = 2.0;
    /// Frames after which hypotheses that are surely larger turns are no longer followed: a symmetric outline will not tell them apart.
    pub(crate) const FOLLOWED: usize = 8;
    /// Deviations by which poses or motions of hypotheses must differ to be in doubt.
    pub(crate) const DIFFERENT: f64 = 2.0;
}

/// Changes of the motion.
pub(crate) mod motion_change {
    /// Frames that the estimate looks back on.
    pub(crate) const MEMORY: f64 = 15.0;
    /// Deviations of the likelihood's slope from which a change counts as seen. Constant motion must stay at the bound.
    pub(crate) const SIGNIFICANT: f64 = 7.0;
    /// As [`SIGNIFICANT`], for a motion that has been seen to change before.
    pub(crate) const SIGNIFICANT_AGAIN: f64 = 3.0;
    /// Squared innovation per parameter that counts at most in the running estimate: squares have long tails.
    pub(crate) const LIMIT: f64 = 4.0;
    /// Squared innovation per parameter that chance does not make...
    pub(crate) const BEYOND_CHANCE: f64 = 8.0;
    /// ...and up to which one frame counts at most so many deviations of its slope as evidence, which takes several frames that agree.
    pub(crate) const EVIDENCE: f64 = 4.0;
}

/// Phases of the filter, and what of the motion is stated.
pub(crate) mod supervisor {
    /// Frames rejected in a row before the second one was ever found: the first was not the object.
    pub(crate) const FALSE_START: usize = 3;
    /// Starts that came to nothing, one after the other, after which frames are no longer asked whether they are the wrong one: where one
    /// frame in five is wrong, three starts in a row come to nothing once in a hundred.
    pub(crate) const MOST_FRUITLESS: usize = 3;
    /// Frames that may be searched one after the other: two seconds of video.
    pub(crate) const MOST_SEARCHES: usize = 60;
    /// Frames after which another one may be searched: a search costs as much as 15 to 30 frames that are followed, so that searches for what
    /// never comes double the cost at most. An object that comes at last is found within two seconds of video.
    pub(crate) const FRAMES_OF_SEARCH: usize = 16;
    /// So many frames one counts as that is followed: an object that is hidden a second in three is searched for in most of the frames.
    pub(crate) const FOLLOWED_FRAME: usize = 4;
    /// A map that has taken no more frames than this may have been begun from what is not the object.
    pub(crate) const FEW_FRAMES: usize = 5;
    /// Frames rejected in a row after which the object is given up and a new one taken: a second of video.
    pub(crate) const GIVEN_UP: usize = 30;
    /// Squared innovation of one frame beyond which a lost object has not gone on as it was.
    pub(crate) const LARGEST_INNOVATION: f64 = 80.0;
    /// Steps over which a parameter must be known at least, however fast the motion changes.
    pub(crate) const STEPS_KNOWN: f64 = 10.0;
}

/// The batch estimator.
pub(crate) mod batch {
    /// Times that the outline is cut anew at most.
    pub(crate) const MOST_ROUNDS: usize = 8;
    /// Deviations by which the mean of the rounds may still change where it has settled.
    pub(crate) const SETTLED: f64 = 0.1;
}

/// Hypotheses of dynamics.
pub(crate) mod dynamics {
    /// Probability, in a step, that a constant motion changes to that of a certain other hypothesis: to all of them together, a change in 70,000 frames.
    /// With a hundred times as much most sequences of a thousand frames were found to show a change by chance; a real one is seen a frame or two later.
    pub(crate) const LEAVES_CONSTANT: f64 = 0.000_001_5;
    /// As that, of a motion that changes already: most of those go on to.
    pub(crate) const LEAVES_CHANGING: f64 = 0.000_15;
    /// How often a change is that a camera begins to shake, in one to a certain motion: cameras that do shake from the start. A motion that changes
    /// slowly looks for some frames like one seen by a camera that shakes.
    pub(crate) const BEGINS_TO_SHAKE: f64 = 0.01;
    /// Probabilities before the third frame: most things on a table or in a machine turn about a fixed point, and few accelerate.
    pub(crate) const PRIOR_OF_GENERATOR: f64 = 0.93;
    pub(crate) const PRIOR_OF_VELOCITY: f64 = 0.046;
    /// Of each of [`SHAKEN`].
    pub(crate) const PRIOR_OF_SHAKEN: f64 = 0.002;
    pub(crate) const PRIOR_OF_EACH_LEVEL: f64 = 0.001;
    /// How much a camera shakes, in deviations of a pose as the points of a frame tell it.
    pub(crate) const SHAKEN: [f64; 2] = [4.0, 20.0];
    /// Densities of the change of accelerations: in variances of a pose as a frame tells it, per fifth power of a step. They remember some forty
    /// frames, fourteen, four, and none; the last are those of bodies that are pushed. Between levels ten thousand times apart a body that swings
    /// has none that fits: deviations were half of the errors there.
    pub(crate) const LEVELS: [f64; 6] = [1e-8, 1e-5, 1e-2, 1e1, 1e4, 1e7];
    /// Steps that a density of one remembers; others, by its sixth root as many times (the gain of a Kalman filter of a random jerk).
    pub(crate) const MEMORY: f64 = 2.0;
    /// As these, where the velocity of the middle alone changes.
    pub(crate) const LEVELS_OF_VELOCITY: [f64; 2] = [1e-7, 1e-2];
    /// How far the point of an object that runs straight may be from its middle, in RMS radii, as a deviation: noise, hidden arcs, and bodies
    /// that are not quite even.
    pub(crate) const MIDDLE: f64 = 0.02;
    /// Probability that an interval of 95 % leaves out.
    pub(crate) const LEFT_OUT: f64 = 0.05;
    /// Deviations of a pose that an acceleration which begins moves the object by over the steps that its level remembers.
    pub(crate) const FIRST_ACCELERATION: f64 = 3.0;
    /// Share of a hypothesis below which it counts for nothing.
    pub(crate) const LEAST_SHARE: f64 = 1e-6;
    /// Variance of a pose, in squares of RMS radii or rad: no less than rounding, and no more than a quarter.
    pub(crate) const LEAST_VARIANCE: f64 = 1e-18;
    pub(crate) const LARGEST_VARIANCE: f64 = 0.0625;
    /// What makes a measurement of the pose solvable along what it says nothing of.
    pub(crate) const SINGULAR: f64 = 1e-9;
    /// Share by which a frame corrects the variance of a pose.
    pub(crate) const VARIANCE_GAIN: f64 = 0.1;
    /// While a constant generator is more probable than this, which is what an interval of 95 % leaves out, its own estimate is stated, and
    /// widened by the others; then the object is expected where all hypotheses take it...
    pub(crate) const LEADS_FROM: f64 = LEFT_OUT;
    /// ...until it is as probable as this.
    pub(crate) const LEADS_UNTIL: f64 = 0.9;
}

/// Series of innovations, and what they say of deviations.
pub(crate) mod innovations {
    /// Innovations, in deviations, that count at most: they may be what the gate has let through.
    pub(crate) const CLIPPED: f64 = 8.0;
    /// Blocks that the series is kept in.
    pub(crate) const BLOCKS: usize = 64;
    /// Cosines that the long-run variance is told from.
    pub(crate) const COSINES: usize = 8;
    /// Cosines that changes are slow up to.
    pub(crate) const SLOW: usize = 4;
    /// Half width of a 95 % interval of Student's distribution for eight degrees of freedom over that of a normal one, 2.306 / 1.960.
    pub(crate) const STUDENT: f64 = 1.177;
    /// Fewest frames that say something of dependence.
    pub(crate) const FEWEST_FRAMES: usize = 5;
    /// Frames that the assumption of unit variance is worth.
    pub(crate) const PRIOR_FRAMES: f64 = 8.0;
    /// Deviations of its estimate beyond which a correlation of neighbours is one.
    pub(crate) const CORRELATED: f64 = 2.5;
    /// Fewest frames that say something of that.
    pub(crate) const FEWEST_CORRELATED: usize = 10;
    /// Correlation of neighbours that is reckoned with at most.
    pub(crate) const LARGEST_CORRELATION: f64 = 0.98;
}

/// Tests of what a family of motions leaves out.
pub(crate) mod family {
    /// Frames that say something.
    pub(crate) const FEWEST_FRAMES: usize = 6;
    /// Deviations beyond which a motion that is left out is there. A warning that is always there is none.
    pub(crate) const SIGNIFICANT: f64 = 5.0;
    /// Deviations beyond which it may be there: what it makes of the estimates is reckoned with.
    pub(crate) const DOUBTFUL: f64 = 2.5;
    /// Squared deviations that a motion more must explain to be preferred: those that chance explains once in a thousand times.
    pub(crate) const PER_MOTION: f64 = 10.8;
    /// Share of the noise of a point that a displacement must have to matter.
    pub(crate) const MATTERS: f64 = 0.03;
    /// Displacement, in squares of the noise, that noise itself makes where the outline bends, by frames that are told by straight cells.
    pub(crate) const OF_NOISE: f64 = 3.0;
    /// Frames after which a map is known well enough to be compared with: its cells were cut along the first ones, noise and all.
    pub(crate) const MAP_KNOWN: usize = 4;
    /// Mean square, in variances, of a change of shape that has no direction.
    pub(crate) const SHAPE_CHANGES: f64 = 4.0;
    /// Eigenvalue of the correlations of motions that are left out below which a combination of them is not told.
    pub(crate) const TOLD_APART: f64 = 1e-4;
    /// Share of the square of a displacement that must be left of it in a frame to say something: a tenth of the displacement.
    pub(crate) const LEFT: f64 = 0.01;
    /// What makes the equations of the pose solvable where the outline does not, as a share of the largest entry.
    pub(crate) const SINGULAR: f64 = 1e-9;
    /// Frames looked at: all of the first so many, and while the motion is known from fewer; else every so many. A frame that stands for
    /// several must not correct more than it has found.
    pub(crate) const ALL_OF_THE_FIRST: usize = 16;
    pub(crate) const EVERY: usize = 4;
}

/// Symmetry of outlines.
pub(crate) mod symmetry {
    /// Largest order that is looked for.
    pub(crate) const LARGEST_ORDER: usize = 72;
    /// Mean square of the innovations of a turned outline, in those of the outline as it is, up to which it is symmetric within its
    /// noise: noise and straight cells make as much of one, and a tooth that is missing much more.
    pub(crate) const AS_GOOD: f64 = 1.5;
    /// As [`AS_GOOD`], that half of a turn of a symmetry must exceed.
    pub(crate) const HALF_IS_WORSE: f64 = 2.0;
    /// Share of the angle of symmetry that a turn between frames may lie off a multiple of it for the turns to be the same.
    pub(crate) const OFF_MULTIPLE: f64 = 0.2;
    /// Turns on either side of none that are tried of a symmetric outline.
    pub(crate) const TRIED: usize = 2;
    /// Turns that differ by less than this share of the angle of symmetry are the same.
    pub(crate) const SAME: f64 = 0.25;
}

/// What is stated at all.
pub(crate) mod statement {
    /// Standard deviation of a side of a mask, in pixels: that of rounding, 1 / sqrt(12), where the side lies along the rows or columns. Sides
    /// that lie across them are off by less.
    pub(crate) const ROUNDING: f64 = 0.289;
    /// Tangent of the angle to the rows or columns within which points of a side are rounded together: by less than a pixel over ten.
    pub(crate) const ALONG_PIXELS: f64 = 0.1;
    /// Share of the frames rejected beyond which what the others say is no motion of the object.
    pub(crate) const MOST_REJECTED: f64 = 0.4;
    /// Fewest frames rejected that say so.
    pub(crate) const FEWEST_REJECTED: usize = 5;
    /// Fewest frames rejected, no fewer than taken, that say so: one by itself may be wrong, and where frames are wrong by chance two of the
    /// first four hardly are.
    pub(crate) const FEWEST_AGAINST: usize = 2;
    /// Share of a squared distance that a variance has of which an interval of 95 % reaches so far, 1 / 1.96^2.
    pub(crate) const REACH: f64 = 0.26;
}

/// States that are read from bytes.
#[cfg(feature = "serde")]
pub(crate) mod saved_state {
    /// How far probabilities may sum to something else than 1, by rounding.
    pub(crate) const SUM_OFF: f64 = 1e-6;
}

/// The map drawn anew where many frames have shown the outline.
pub(crate) mod redrawing {
    /// Deviation of a normal's direction that its neighbours are chosen for, rad: a fifth of that of the first frames, so that what it takes
    /// from the weakest directions of a projective pose is below a hundredth.
    pub(crate) const NORMAL_NOISE: f64 = 0.01;
    /// Neighbours on either side that a curvature comes from.
    pub(crate) const NEIGHBOURS_OF_CURVATURE: usize = 3;
    /// Most neighbours on either side: more would cut corners.
    pub(crate) const MOST_NEIGHBOURS: usize = 6;
}

/// A plane that moves in space.
pub(crate) mod plane {
    /// Fewest frames that a motion is looked for in: two show a generator, a third how it changes.
    pub(crate) const FEWEST_FRAMES: usize = 3;
    /// Numbers of frames on which motions are looked for from many starts: with half as many again each time.
    pub(crate) const OCCASIONS: [usize; 11] = [4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128];
    /// Number of frames from which on the outline is drawn anew when motions are looked for.
    pub(crate) const FEWEST_TO_REDRAW: usize = 12;
    /// Number of frames from which on a motion that is known, and has no rival, is not looked for again.
    pub(crate) const FEWEST_TO_DECIDE: usize = 24;
    /// Frames that are kept to be linearised anew. From then on half of them are no more than their sums: half a minute of film, after
    /// which a motion that can be told at all is known well.
    pub(crate) const MOST_KEPT: usize = 512;
    /// Poses that a search is made with.
    pub(crate) const MOST_POSES: usize = 40;
    /// Steps to the pose of one frame, and the step in deviations of the noise that ends them.
    pub(crate) const MOST_POSE_STEPS: usize = 4;
    pub(crate) const POSE_SETTLED: f64 = 0.03;
    /// Tangents of the tilts that a search starts from, and starts around each.
    pub(crate) const STARTING_TILTS: [f64; 3] = [0.0, 0.5, 1.2];
    pub(crate) const STARTS_PER_RING: u32 = 6;
    /// Share of the time over which the generator of a start is taken: the generator changes with the normal.
    pub(crate) const EARLY: f64 = 0.34;
    /// Damping of Levenberg and Marquardt: Marquardt's factors.
    pub(crate) const FIRST_DAMPING: f64 = 1e-3;
    pub(crate) const LESS_DAMPING: f64 = 0.1;
    pub(crate) const MORE_DAMPING: f64 = 10.0;
    pub(crate) const MOST_DAMPING: f64 = 1e8;
    pub(crate) const MOST_SEARCH_STEPS: usize = 60;
    /// A fall of the sum of squares that ends a search: a hundredth of a deviation.
    pub(crate) const FALLEN_ENOUGH: f64 = 1e-4;
    /// Motions that differ by no more than this, in normal or in rad and distances over the whole time, were found twice.
    pub(crate) const ALIKE: f64 = 0.02;
    /// Motions of a search that are followed further: sums of squares no more than this above the least, and so many of them.
    pub(crate) const FAR_FROM_BEST: f64 = 100.0;
    pub(crate) const MOST_SOLUTIONS: usize = 3;
    /// Linearisations of all frames at most, the step in deviations that ends them, the rise of the sum of squares that is no chance of
    /// points that change their cells, and the least share of a step that is tried.
    pub(crate) const MOST_STEPS: usize = 8;
    pub(crate) const SETTLED: f64 = 0.02;
    pub(crate) const WORSE: f64 = 3.0;
    pub(crate) const LEAST_SHARE: f64 = 1e-2;
    /// Frames are linearised anew when the parameters have moved by this many deviations: what is of second order is then a few hundredths.
    pub(crate) const STALE: f64 = 0.3;
    /// Solutions nearer to each other than this many deviations are one.
    pub(crate) const SAME: f64 = 0.5;
    /// Square of a residual, in deviations of the noise, beyond which a point is an outlier.
    pub(crate) const LARGEST_SQUARE: f64 = 25.0;
    /// A second solution whose sum of squares is so much larger is ruled out for good: odds of one to three million.
    pub(crate) const RULED_OUT: f64 = 30.0;
    /// As [`RULED_OUT`], for one that is not stated any more: one to four hundred.
    pub(crate) const DECIDED: f64 = 12.0;
    /// Parameters of two solutions differ if they are this many deviations apart.
    pub(crate) const DIFFERENT: f64 = 0.5;
    /// Deviation over the whole time, rad or distances of the plane, beyond which a parameter is not known: as `estimate::is_worth`.
    pub(crate) const LARGEST_DEVIATION: f64 = 0.25;
    /// The same of the normal.
    pub(crate) const LARGEST_DEVIATION_OF_NORMAL: f64 = 0.25;
    /// A plane that has moved by less, in its distance, hardly moves.
    pub(crate) const HARDLY_MOVED: f64 = 0.02;
    /// Squared velocity in units of its covariance from which on the plane moves beyond doubt. A velocity and a normal are five degrees of
    /// freedom that can follow noise: chance makes 30 of them once in 80,000, and less where both are chosen among several minima.
    pub(crate) const MOVES: f64 = 50.0;
    /// Known beforehand, as deviations: turns over the whole time in rad, ways in distances, and the normal. So weak that they bound only
    /// what no frame tells of.
    pub(crate) const LARGEST_MOTION: f64 = 100.0;
    pub(crate) const LARGEST_NORMAL: f64 = 10.0;
    /// Largest squared innovation that counts, fewest of them that say something, and deviations of their mean that chance makes.
    pub(crate) const LARGEST_INNOVATION: f64 = 200.0;
    pub(crate) const FEWEST_INNOVATIONS: f64 = 10.0;
    pub(crate) const CHANCE: f64 = 3.0;
}
