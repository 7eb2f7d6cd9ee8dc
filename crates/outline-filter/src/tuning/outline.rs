//! Constants of the outline: its map and contours, what it does not show, how it changes.

/// The map: cells along the outline, cut from points.
pub(crate) mod map {
    /// Points that must have shown the offset of a cell for the centroid and the known outline to count on it: one alone may have been measured in a
    /// wrong pose.
    pub(crate) const SEEN: f64 = 1.5;
    /// Frames, powers of two among them, after which the centroid is placed anew by what they have told of the outline. After the last its error is
    /// an eighth of that by the noise of one frame.
    pub(crate) const FRAMES_OF_CENTROID: std::ops::RangeInclusive<usize> = 4..=64;
    /// Mean square of the normals in the direction that they have least of, below which an outline is mostly straight: an ellipse four
    /// times as long as wide has 0.11, a bar ten times as long as wide that is cut at one end 0.05.
    pub(crate) const MOSTLY_STRAIGHT: f64 = 0.1;
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
    /// Points of one frame for each cell, of cells that several frames must have in common: each of them shows most of the cells then, and nearly
    /// all where its points are evenly spaced. With four times as many, of sixteen frames, it shows a quarter; poses with little noise were up to
    /// thirty deviations off.
    pub(crate) const POINTS_PER_COMMON_CELL: f64 = 1.0;
    /// Points of all frames for each cell where so few cells do not show the outline...
    pub(crate) const POINTS_PER_FINER_CELL: f64 = 4.0;
    /// ...as their normals differ by more than this from cell to cell, in rad, in the median: gears with five points a tooth have 0.3 to 0.45, and
    /// poses on them two solutions; smooth outlines of 80 points have 0.02 to 0.2, of 40 some have more.
    pub(crate) const BENT: f64 = 0.25;
    /// Most cells of the first frame, which bounds the work of a frame.
    pub(crate) const MOST_CELLS: f64 = 800.0;
    /// An outline is cut into so many cells at least, so that it has sides.
    pub(crate) const CELLS_PER_LENGTH: f64 = 12.0;
    /// Fewest cells of a map: fewer enclose nothing.
    pub(crate) const FEWEST_CELLS: usize = 3;
    /// An outline of a few points is cut into so many cells all the same where its noise allows it, so that it has sides.
    pub(crate) const FEWEST_OF_FINEST: f64 = 4.0;
    /// Places further than this many spacings from all cells are new: a cell reaches half a spacing, and its neighbour half of one more.
    pub(crate) const UNCOVERED: f64 = 1.1;
    /// A map of so many times the places that any frame has shown at once holds what is not of the object, and grows no more: an
    /// object of which less was seen at a time could not have been found again. Without this the map of an object that comes and
    /// goes at the edge of the picture would grow for ever, by poses that its few points leave in doubt.
    pub(crate) const MOST_TIMES_SEEN: usize = 8;
    /// Shortest run of new places that is taken: one alone is an outlier as often as not.
    pub(crate) const SHORTEST_RUN: usize = 2;
    /// Cells on from the one that covers the last known place of a contour, towards what is new, among which an end of the known outline is looked for:
    /// smoothing rounds a contour off over about so many beside its end.
    pub(crate) const BESIDE_END: usize = 4;
    /// Longest side of the picture of nearest cells, pixels, which are hardly larger than the cells of 400 points: to fill it was a third of the
    /// first frame with twice as many, and it stays within the first cache of a processor.
    pub(crate) const FIELD_PIXELS: f64 = 96.0;
    /// Places that are looked up before those are looked at again that have moved to a neighbour: those that have, at most 1.5 kB, stay at hand.
    pub(crate) const ASSOCIATED_AT_ONCE: usize = 64;
    /// Margin of that picture around the cells, in their extent: points of frames that are not yet aligned lie there.
    pub(crate) const FIELD_MARGIN: f64 = 0.1;
    /// Smallest pixel of that picture, in spacings: finer ones would not make the cell that a pixel names a nearer one.
    pub(crate) const FINEST_PIXEL: f64 = 0.5;
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
    /// One in so many of the points may be marked as outliers at most: a window that smooths corners away must not take half the contour for
    /// them.
    pub(crate) const MOST_MARKED: usize = 4;
    /// Points that the mean distance from one to the next is taken over: noise makes single steps longer.
    pub(crate) const STEPS_OF_CHORD: usize = 8;
    /// Fewest points of a local quadratic: three leave no residual.
    pub(crate) const FEWEST_FITTED: usize = 4;
    /// Fewest points, not outliers, of a contour that is resampled.
    pub(crate) const FEWEST_RESAMPLED: usize = 3;
    /// Most places of a resampled contour: a spacing that asks for more than a hundred times the cells of a map comes from damaged numbers.
    pub(crate) const MOST_PLACES: f64 = 1e5;
    /// Length of a tangent or chord, normalised, below which its direction is rounding.
    pub(crate) const NO_DIRECTION: f64 = 1e-12;
    /// Deviation of a normal's direction that the window is chosen for, rad: its cosine is then within 0.2 %.
    pub(crate) const NORMAL_NOISE: f64 = 0.05;
    /// As [`NORMAL_NOISE`], for the pilot regression.
    pub(crate) const PILOT_NORMAL_NOISE: f64 = 0.25;
    /// Neighbours are looked for among one of so many parts of the points, on either side, where outliers lie between; and windows reach no
    /// further.
    pub(crate) const PARTS: usize = 8;
    /// As [`PARTS`], for windows that are wider than normals usually need: over a sixth of an outline, smoothing leaves nine tenths of the
    /// height of a wave that is half of it long, and windows are narrower where they would leave less. Of nearly round outlines with noise a fifth more
    /// show their turn than with windows of a tenth.
    pub(crate) const FINE_PARTS: usize = 12;
    /// Smallest and largest half window of the local regression, in points.
    pub(crate) const HALF_WINDOWS: std::ops::RangeInclusive<usize> = 2..=30;
    /// Largest that is wider than normals usually need, in points.
    pub(crate) const LARGEST_FINE: usize = 120;
    /// Residuals of a regression that a point took part in are divided by their deviation, no less than this share of a variance.
    pub(crate) const LEAST_RESIDUAL_VARIANCE: f64 = 0.05;
    /// Sizes within these shares of a guess of their median are put in order to find it: a tenth of them, two deviations of the median of a
    /// few hundred on either side; a quarter of them where the median is not among those.
    pub(crate) const ABOUT: [[f64; 2]; 2] = [[0.88, 1.13], [0.75, 1.33]];
    /// Points whose residuals keep less of their variance than this tell nothing of the noise.
    pub(crate) const TELLING_RESIDUAL_VARIANCE: f64 = 0.1;
}

/// Directions of the pose that an outline does not show.
pub(crate) mod null_space {
    /// Standard deviation of a turn that may be any, rad: pi / sqrt(3).
    pub(crate) const ANY_TURN: f64 = 1.813_799_364_234_217_8;
    /// Eigenvalue of the lever arms, in squares of the RMS radius, below which a direction of the pose cannot be seen.
    pub(crate) const DEGENERATE: f64 = 0.003;
    /// Times what the errors of the normals would make of the levers in a direction that is not seen: that, and some more.
    pub(crate) const EXPLAINED: f64 = 2.0;
    /// Eigenvalue of the lever arms of a turn below which its normals are taken from wider windows.
    pub(crate) const WEAKLY_SHOWN: f64 = 0.02;
    /// Share of the cells that a frame may disagree with: as many points need not lie on the outline for the gate.
    pub(crate) const MISSED: f64 = 0.3;
    /// Share of the levers of a turn that the others have at most where it hangs on these: those of a wave along the outline have two fifths, the
    /// sides of a square a third.
    pub(crate) const TOLD_BY_REST: f64 = 0.1;
    /// Rounds in which the turn that the others show least is found, and those that tell most of it.
    pub(crate) const ROUNDS_OF_REST: usize = 3;
    /// Eigenvalue of the lever arms of such a turn, in what errors of the normals make of it, that windows are chosen for. Over n frames errors
    /// grow as n^(1/100) beyond what is stated.
    pub(crate) const LEVER_PER_NOISE: f64 = 100.0;
    /// As that, below which the turn is held as not shown.
    pub(crate) const LEAST_LEVER_PER_NOISE: f64 = 50.0;
    /// Eigenvalue of the lever arms above which it never is: that of an ellipse whose axes differ by a seventh.
    pub(crate) const HARDLY_SHOWN: f64 = 0.01;
    /// Mean square of the lever arms of closed contours beside each other, in squares of the RMS radius, from which on their places show the
    /// turn: a hole of half the size of a disc a seventeenth of its radius off. Light, thickness and perspective move holes by up to half as much.
    pub(crate) const SHOWN_BY_PLACES: f64 = 5e-4;
    /// Area of a contour, in that of a circle of its length, from which on it is round enough for its place to show the turn: an ellipse three
    /// times as long as wide.
    pub(crate) const ROUND: f64 = 0.6;
    /// As [`SHOWN_BY_PLACES`], in variances of the noise of a point: with less the turn of a washer was up to twice as far off as was stated,
    /// with more 1.3 times.
    pub(crate) const PLACES_PER_NOISE: f64 = 15.0;
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
    /// Share of the square of a null direction from which on its rates are most of it.
    pub(crate) const MOSTLY_RATES: f64 = 0.5;
    /// Steps of Newton's method to the least of the motions that look alike; each doubles the digits.
    pub(crate) const LEAST_STEPS: usize = 3;
    /// Share of the square of a direction that is left beside others from which on it is one of its own: of as many as there can be, mixed at will,
    /// one has as much.
    pub(crate) const BESIDE: f64 = 0.1;
    /// Cells across a direction that was not shown before, from which on new ones show it: one or two at a corner are bent, and their normals tell
    /// nothing. With four the motion of bodies that come out from behind an edge was wrong in twice as many frames, with eight in as many as with six.
    pub(crate) const FEWEST_TO_SHOW: f64 = 6.0;
    /// Turn, in rad, of a unit step in a direction that counts as turning.
    pub(crate) const HOLDS_TURN: f64 = 0.3;
    /// Share of the largest part of a direction, lengths in RMS radii, from which on a parameter takes part in it.
    pub(crate) const TAKES_PART: f64 = 0.01;
    /// As that, of a velocity in a direction that turns: what is not seen of a turn may be half a circle in a frame, so that this is
    /// rounding alone.
    pub(crate) const TURNS_WITH: f64 = 1e-6;
    /// Share of the deviation of a velocity at the origin of the image that a rate which is not known may make: beyond, neither is known.
    pub(crate) const HANGS_ON: f64 = 0.5;
    /// Squared speed of the middle in motions that are not seen, in the mean of the points, up to which the point that they leave where it is takes
    /// the place of the middle: beyond, it is no point of the outline's surroundings. The centre of a circle of which half is seen has two fifths.
    pub(crate) const MOVES_MIDDLE: f64 = 0.5;
    /// Variances of the places within an outline, in those of its cells, of a shape: a circle has a half, a comb or the letter T about one. Those of
    /// an outline that crosses itself are anything.
    pub(crate) const AREA_OVER_CELLS: std::ops::RangeInclusive<f64> = 0.1..=4.0;
    /// How far the product of a saved stretch and its inverse may be from one: far above rounding, far below anything that would show.
    #[cfg(feature = "serde")]
    pub(crate) const UNDONE: f64 = 1e-6;
    /// Information that holds a direction, in units of the noise: it moves by no more than a thirty-thousandth of it, which does not add up
    /// over the frames of a recording, and leaves seven digits to the solution.
    pub(crate) const HOLDING: f64 = 1e9;
}

/// Points that disagree in most frames.
pub(crate) mod usual_agreement {
    /// Frames that say what is usual.
    pub(crate) const FEWEST_FRAMES: usize = 2;
    /// Deviations of a share by which more points must disagree than usual. The usual share is a low one, about one deviation below the mean, and a
    /// search costs as much as fifty frames.
    pub(crate) const SIGNIFICANT: f64 = 5.0;
    /// As that, where few of the points tell the turn: four of 300 that are off by chance are searched for once or twice.
    pub(crate) const SIGNIFICANT_OF_FEW: f64 = 3.0;
    /// Frames from which on it is told whether points have come to disagree bit by bit: what few have said of the motion may be wrong by any turn.
    pub(crate) const FRAMES_OF_RISE: usize = 10;
    /// Turn that a motion which lags behind may have led away by, rad, before its points are seen to disagree: less than from one blade or tooth to the
    /// next of all but the finest.
    pub(crate) const FARTHEST_BIT_BY_BIT: f64 = 0.3;
    /// Shares by which a frame corrects what is usual where its points agree better than that, and where they agree worse: frames in which a part has
    /// been missed must not become the usual ones.
    pub(crate) const TOWARDS_BETTER: f64 = 0.2;
    pub(crate) const TOWARDS_WORSE: f64 = 0.02;
    /// Share of the points that agree from which on directions are not asked for: an end of a bar that is 50 times as long as wide has 1 % of the
    /// points.
    pub(crate) const ALL_AGREE: f64 = 0.99;
    /// Share of the usual weakest agreement below which a direction of the pose is in doubt: the ends of a bar have few points, of which chance
    /// leaves a third out.
    pub(crate) const WEAKEST: f64 = 0.6;
    /// Share of the points from which on a frame shows all of an outline: a motion that has changed leads to another tooth of a gear, or past the end
    /// of a bar, and a hole or an end are some hundredths of the points. After a frame that was not taken, one with fewer is looked for elsewhere.
    pub(crate) const ALL_OF_IT: f64 = 0.97;
    /// Deviations by which another pose must explain such a frame better: more points than usual speak for it already.
    pub(crate) const ELSEWHERE: f64 = 3.0;
    /// Distance of the outline in that pose, root mean square, in the noise of a point, below which it is no other place: points that disagree lie
    /// further off, and what the points of one frame say of the pose less, a fraction of it.
    pub(crate) const BESIDE: f64 = 1.0;
    /// Squares of the noise by which a pose further along a direction must explain a frame better, of which few points agree that tell it: four
    /// deviations of one parameter.
    pub(crate) const FURTHER_ALONG: f64 = 16.0;
    /// Mean share of the points that disagree together with both of their neighbours, from which on a part of the outline does not move with the
    /// rest. Of stands with a pendulum, drawers, pistons and flags it is 0.13 to 0.3; of outliers here and there it is the cube of their share, 0.04
    /// of a third.
    pub(crate) const SMALLEST_PART: f64 = 0.08;
    /// Frames that say so.
    pub(crate) const FRAMES_OF_PART: usize = 6;
    /// Share of a frame in that mean, at least: a part that begins to move by itself, or ceases to, is told after some tens of frames.
    pub(crate) const GAIN_OF_PART: f64 = 1.0 / 64.0;
    /// Share by which a frame does that nothing explains better, so that it is not looked into again and again.
    pub(crate) const UNEXPLAINED: f64 = 0.5;
}

/// Outlines that have changed since their map became known.
pub(crate) mod shape_change {
    /// Fewest cells that are compared.
    pub(crate) const FEWEST_CELLS: usize = 16;
    /// Least share of the map that must have been known early.
    pub(crate) const LEAST_SHARE: f64 = 0.5;
    /// Deviations of the noise of a point by which the outline must have changed to matter: errors of outlines that are slow in time are
    /// learnt as part of the outline, so that they change it by up to three or four times what is left as noise.
    pub(crate) const LEAST: f64 = 5.0;
    /// Frames in which one is compared.
    pub(crate) const EVERY: usize = 4;
    /// Frames over which a change is forgotten: what has been explains the estimate as long as that remembers it.
    pub(crate) const MEMORY: f64 = 100.0;
    /// Deviations of the offsets by which they must have changed: those of Gaussian noise change by one.
    pub(crate) const SIGNIFICANT: f64 = 3.0;
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

/// Symmetry of outlines.
pub(crate) mod symmetry {
    /// Frames after which the outline is asked again whether it is symmetric: soon after its map has been cut anew, in a frame without that to do, and
    /// later on, when frames in wrong poses have made all teeth alike.
    pub(crate) const ASKED_AGAIN: [usize; 4] = [20, 40, 70, 200];
    /// Largest order that is looked for.
    pub(crate) const LARGEST_ORDER: usize = 72;
    /// Mean square of the innovations of a turned outline, in those of the outline as it is, up to which it is symmetric within its
    /// noise: noise and straight cells make as much of one, and a tooth that is missing much more.
    pub(crate) const AS_GOOD: f64 = 1.5;
    /// As [`AS_GOOD`], up to which a turn may be as good about another centre than the middle of what has been seen: of a gear of 20 teeth of which some
    /// have been seen twice as often as others, half a circle leaves 1.6, of one of 23 teeth its only turn 2.
    pub(crate) const NEARLY_AS_GOOD: f64 = 4.0;
    /// Such a centre lies no farther from that middle, in RMS radii: where a third of a round outline has never been seen, the middle of the rest is 0.4
    /// from its centre.
    pub(crate) const OFF_MIDDLE: f64 = 0.5;
    /// As [`AS_GOOD`], that half of a turn of a symmetry must exceed.
    pub(crate) const HALF_IS_WORSE: f64 = 2.0;
    /// Times of these limits from which on a first look is enough to say that a turn is beyond them: its mean square is known to a fifth.
    pub(crate) const FAR_WORSE: f64 = 2.0;
    /// Share of the angle of symmetry that a turn between frames may lie off a multiple of it for the turns to be the same.
    pub(crate) const OFF_MULTIPLE: f64 = 0.2;
    /// Turns on either side of none that are tried of a symmetric outline.
    pub(crate) const TRIED: usize = 2;
    /// Turns that differ by less than this share of the angle of symmetry are the same.
    pub(crate) const SAME: f64 = 0.25;
    /// Share of the angle of symmetry up to which a search may turn an object beside what was expected: by half of it and more it may have turned the
    /// other way round.
    pub(crate) const NEARBY: f64 = 0.125;
}
