//! Constants of a frame: its points, their noise, and what is solved and gated.

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
    /// Weight of the neighbours of a point, all together, below which they say nothing of its place: a mean over less is rounding.
    pub(crate) const LEAST_WEIGHT: f64 = 1e-3;
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

/// The lattice of pixels that points lie on.
pub(crate) mod lattice {
    /// Distance of two coordinates that are the same, in extents of the outline: they differ by the rounding of numbers.
    pub(crate) const SAME: f64 = 1e-9;
    /// Fewest coordinates that more than one point has, from which a pitch is told.
    pub(crate) const FEWEST_LINES: usize = 8;
    /// Pitches that are tried: interpolated coordinates may be the same by chance, and stand between the lines.
    pub(crate) const PITCHES_TRIED: usize = 4;
    /// Share of points at the nodes of a lattice twice as fine from which on points on its lines are those of a mask: of a side that lies along the
    /// pixels of a grey picture one point in 25 is, and of one that does not so are as few of a mask, whose contour is ragged then.
    pub(crate) const SIDES_AT_NODES: f64 = 0.25;
    /// Distance from a line within which a point is on it, in pitches: coordinates in a file may be rounded.
    pub(crate) const ON_LINE: f64 = 0.01;
    /// Share of the points that lie on lines: of points anywhere hardly more than 4 in 100 do.
    pub(crate) const NEARLY_ALL: f64 = 0.97;
    /// Reach of the local quadratics that show how ragged a contour is, in pixels: most of the steps that an edge at an angle takes from one row
    /// to the next are shorter.
    pub(crate) const RAGGED_OVER: f64 = 4.5;
    /// Share of the steps of a mask's contour that run along rows, columns or diagonals.
    pub(crate) const STRAIGHT_STEPS: f64 = 0.9;
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
    /// A frame with more than so many times the noise of most frames does not show the known outline, however well the map is bent to it.
    pub(crate) const LARGEST_RATIO: f64 = 1.8;
    /// The noise of most frames counts for a limit of no more than this, in radii: outlines of different objects differ by more. So many times the
    /// noise that is known ([`LARGEST_RATIO`]) are tolerated all the same.
    pub(crate) const LARGEST: f64 = 0.05;
    /// Spread that is remembered of a frame at most, in [`LARGEST`]: beyond, it is one that shows something else.
    pub(crate) const LARGEST_REMEMBERED: f64 = 2.0;
    /// As [`LARGEST`], while no frame has been compared with another.
    pub(crate) const LARGEST_AT_FIRST: f64 = 0.03;
    /// Frames at one place beyond which what they say of the noise is that of an object at rest.
    pub(crate) const RESTED: f64 = 4.0;
    /// Root mean square displacement from where an object was first beyond which it is seen in another place, in radii: that of the errors that are
    /// reckoned with while no frame has been compared with another.
    pub(crate) const ANOTHER_PLACE: f64 = LARGEST_AT_FIRST;
    /// Stretches that the contour is cut into to see whether its errors are correlated.
    pub(crate) const STRETCHES: usize = 24;
    /// Fewest points of a stretch whose mean tells something of correlation.
    pub(crate) const FEWEST_IN_STRETCH: usize = 3;
    /// One in so many of the points of a stretch must count, and of the stretches, for the correlation to be told: most of the contour.
    pub(crate) const ONE_IN_COUNTS: f64 = 2.0;
    /// Share of the variance of a mean that the offsets must leave for the correlation to be told. It is a half in the second frame: with less, most
    /// of what the frame shows was not known before.
    pub(crate) const LEAST_LEFT: f64 = 0.2;
    /// Frames that the correlation is averaged over.
    pub(crate) const CORRELATION_MEMORY: f64 = 50.0;
    /// Deviations of its estimate by which a correlation must be larger than none.
    pub(crate) const CORRELATION_SIGNIFICANT: f64 = 2.0;
    /// Frames from which on it is told that there is none: a correlation of a seventh would have been found.
    pub(crate) const CORRELATION_TOLD: f64 = 16.0;
    /// Deviation of a point of a mask, in pixels: measured on discs of 10 to 60 pixels in radius, smoothed by a pixel (`trace_mask`).
    pub(crate) const ROUNDED_POINT: f64 = 0.15;
    /// Length of a mask's contour that is off together, in pixels: the integral of the correlation that smoothing by a pixel leaves, 2 sqrt(pi).
    pub(crate) const ROUNDED_TOGETHER: f64 = 3.54;
    /// Scatter of the points of a mask smoothed by a pixel about their contour, in pixels: 0.07 to 0.11 for smooth shapes and polygons, where grey
    /// pictures leave 0.02 to 0.06.
    pub(crate) const RAGGED_MASK: f64 = 0.08;
    /// Least error of a point that is interpolated between pixels, in units of that of a mask: 0.03 pixels of a side. Marching squares leave 0.01
    /// to 0.03 pixels in grey pictures, by the angle of the edge.
    pub(crate) const INTERPOLATED: f64 = 0.1;
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
    /// Most that all such points of a frame speak against a pose beyond what points on the outline do, in what is significant. They come in runs,
    /// and how many there are says how long an arc was hidden: of a thousand points a hidden fifth would else rule out the true pose.
    pub(crate) const MOST_AGAINST: f64 = 0.5;
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
    /// Of these so many at once, before the sum of their squares is looked at: a fifth of them, all far off, are beyond most limits.
    pub(crate) const LOOKED_AT_ONCE: usize = 20;
    /// Points that turns are compared by; more of them would not decide more.
    pub(crate) const ENOUGH_POINTS: usize = 2000;
}

/// Solving for a frame, and the gate.
pub(crate) mod update {
    /// Weight of the first pose, in points: it only fixes the gauge, since pose and offsets can move together.
    pub(crate) const GAUGE_WEIGHT: f64 = 10.0;
    /// Information on the motion that makes the first equations solvable, per squared second: next to nothing.
    pub(crate) const MOTION_PRIOR: f64 = 1e-10;
    /// Most linearisations per frame. One suffices in steady state; acquisition needs three or four.
    pub(crate) const MOST_ITERATIONS: usize = 6;
    /// As that, as long as each of them moves points by more than [`FAR`] cells, and [`BEYOND_NOISE`]: an object that lies a fifth of its size from
    /// where it was expected takes ten and more.
    pub(crate) const MOST_FROM_FAR: usize = 20;
    /// Cells that points are moved by beyond which they have left their own.
    pub(crate) const FAR: f64 = 1.0;
    /// Deviations of the noise that a step is beyond by which an object moves, and no points that change cells.
    pub(crate) const BEYOND_NOISE: f64 = 4.0;
    /// A step that moves points by less than this many deviations of the noise is the last.
    pub(crate) const SETTLED: f64 = 0.03;
    /// If the last one that is taken moves them by more than so many cells, and [`BEYOND_NOISE`], the pose is on its way to another, and nothing is
    /// known of that. By less it moves to and fro where points change cells, or along a direction that few of them tell.
    pub(crate) const UNSETTLED: f64 = 2.0;
    /// Share of a variance below which what is left of it, beside others that it goes along with, is rounding.
    pub(crate) const ROUNDING_OF_VARIANCE: f64 = 1e-12;
    /// Determinant of a pose below which it has collapsed.
    pub(crate) const COLLAPSED: f64 = 1e-12;
    /// Sizes of the object from where it was first seen beyond which nothing can be told of it: numbers of sixteen digits leave a ten-millionth of
    /// its size there.
    pub(crate) const FARTHEST: f64 = 1e9;
    /// Share of the farthest depth of an outline that the nearest must have: a camera as close to a plane as that shows a part of it only. Rates of
    /// points grow with the square of their share, and variances with the fourth power, which leaves four of sixteen digits.
    pub(crate) const LEAST_DEPTH: f64 = 1e-3;
    /// Width to length of what a pose makes of a circle, below which the plane is seen from its edge: a thousandth of what pictures show.
    pub(crate) const FLATTEST: f64 = 1e-5;
    /// Residuals within this many deviations agree with the map.
    pub(crate) const AGREEING: f64 = 3.5;
    /// Residuals below this many spacings agree too: corners lie off the straight cells by as much.
    pub(crate) const BEND: f64 = 0.2;
    /// Share of the information on each parameter that is added where points that agree are compared with all: far below what shows a direction.
    pub(crate) const UNTOLD_DIRECTION: f64 = 1e-4;
    /// So many points beyond the known ends count as one in the share that agrees: they may be anything.
    pub(crate) const NEW_POINTS_PER_POINT: f64 = 3.0;
    /// Share of what is known of a cell beyond which a point says nothing of the noise: the cell follows it.
    pub(crate) const LARGEST_LEVERAGE: f64 = 0.8;
    /// One in so many of the points must tell of the noise, or that of the frame is not known: a few that happen to lie on known cells may be
    /// any.
    pub(crate) const ONE_IN_TELLS: usize = 4;
    /// Rounds in which a growth of the outline is fitted to the residuals of a frame: the weights settle to some percent.
    pub(crate) const GROWTH_ITERATIONS: usize = 4;
    /// Deviations at which a point counts for half in that fit: 95 % efficiency for normal errors (P. W. Holland and R. E. Welsch, Robust regression
    /// using iteratively reweighted least squares, 1977).
    pub(crate) const GROWTH_CAUCHY: f64 = 2.385;
    /// Share of the variances of a pose that is added to what a frame has told of it, so that it can be inverted where the frame tells nothing.
    pub(crate) const REGULAR_GAIN: f64 = 1e-9;
    /// What is added to the diagonal of an information matrix, scaled to ones, so that it can be inverted: some thousand times rounding.
    pub(crate) const REGULAR_INFORMATION: f64 = 1e-12;
    /// Fewest points beyond the known ends that make the map grow.
    pub(crate) const FEWEST_NEW_POINTS: usize = 4;
    /// Deviations of the place of the known outline in a frame that a cell must be longer than for the map to grow: nearly all poses that are off by
    /// no more put what is known into the cells that it has, and not into new ones.
    pub(crate) const DEVIATIONS_PER_CELL: f64 = 3.0;
    /// Squared innovation per parameter beyond which the motion has not gone on as it was: five deviations in every one. Chance does
    /// that once in a million frames.
    pub(crate) const SUDDEN: f64 = 25.0;
    /// Share of the smallest agreement from which a frame may show the outline where a motion that has changed has taken it: that of two lines
    /// which cross, one of them held where it was expected. A frame of a lost object with less is rejected after one linearisation.
    pub(crate) const PARTLY_THERE: f64 = 0.5;
    /// If one linearisation in a pose that was searched for leaves more than so many times the noise that is tolerated, further ones do not bring it
    /// below that.
    pub(crate) const BEYOND_DOUBT: f64 = 1.3;
}
