//! Constants of motion: how it changes, its hypotheses, and what is stated of it.

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
    /// How many times faster than on the mean since a frame was taken last an object may move that is found elsewhere: if its motion has changed at any time
    /// meanwhile, it was in the last twentieth once in twenty times, and an interval of 95 % reaches that.
    pub(crate) const TIMES_FASTER: f64 = 20.0;
}

/// Phases of the filter, and what of the motion is stated.
pub(crate) mod supervisor {
    /// Frames in a row that may repeat one that was stored several times: 24 pictures a second are stored as 60 with two or three times each.
    pub(crate) const MOST_REPEATED: usize = 3;
    /// A second frame shows far more of the object than the first where its outline is longer by this factor: then fewer of its points lie on that part
    /// than have to agree, which are 0.7 of them, so that the part cannot be found on it.
    pub(crate) const FAR_MORE: f64 = 1.5;
    /// Frames rejected in a row before the second one was ever found: the first was not the object.
    pub(crate) const FALSE_START: usize = 3;
    /// Starts that came to nothing, one after the other, after which frames are no longer asked whether they are the wrong one: where one
    /// frame in five is wrong, three starts in a row come to nothing once in a hundred.
    pub(crate) const MOST_FRUITLESS: usize = 3;
    /// Maps begun anew one after the other, each with a frame that seems to show the turn and is contradicted by the next ones, after which the map shows
    /// no turn for good: errors of a small disc's contour look like a shape in one frame in two. A mark that every other frame shows is missed so in one
    /// case of eight.
    pub(crate) const MOST_BEGUN_IN_VAIN: usize = 3;
    /// Frames that may be searched one after the other: two seconds of video.
    pub(crate) const MOST_SEARCHES: usize = 60;
    /// Frames after which another one may be searched: a search costs as much as 15 to 30 frames that are followed, so that searches for what
    /// never comes double the cost at most. An object that comes at last is found within two seconds of video.
    pub(crate) const FRAMES_OF_SEARCH: usize = 16;
    /// So many frames one counts as that is followed: an object that is hidden a second in three is searched for in most of the frames.
    pub(crate) const FOLLOWED_FRAME: usize = 4;
    /// A map that has taken no more frames than this may have been begun from what is not the object.
    pub(crate) const FEW_FRAMES: usize = 5;
    /// Frames of a map that a third has not confirmed.
    pub(crate) const UNCONFIRMED: usize = 2;
    /// Frames rejected in a row after which the object is given up and a new one taken: a second of video.
    pub(crate) const GIVEN_UP: usize = 30;
    /// Squared innovation of one frame beyond which a lost object has not gone on as it was.
    pub(crate) const LARGEST_INNOVATION: f64 = 80.0;
    /// Deviation of the turn, rad, with which a lost object may be found where it was expected: two of it are a quarter of a circle.
    pub(crate) const LARGEST_TURN_DEVIATION: f64 = std::f64::consts::FRAC_PI_4;
    /// Times the step before that a step must be longer than for an object to have gone unseen: less than with one missing frame, and more than in films
    /// of 24 pictures a second that are shown at 60, or of a camera that waits for light.
    pub(crate) const UNSEEN_STEPS: f64 = 1.75;
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
    /// Probability, in a usual step, that a constant motion changes to that of a certain other hypothesis: to all of them together, a change in
    /// 110,000 frames. With a hundred times as much most sequences of a thousand frames were found to show a change by chance; a real one is seen a
    /// frame or two later.
    pub(crate) const LEAVES_CONSTANT: f64 = 0.000_000_5;
    /// As that, of a motion that changes already: most of those go on to.
    pub(crate) const LEAVES_CHANGING: f64 = 0.000_15;
    /// The usual step becomes by no more than this shorter, or longer, with one that is: by so little that gaps between frames do not become usual,
    /// and that steps which differ by as much are all usual ones. Where the first steps are over gaps, some frames make up for that.
    pub(crate) const SHORTER: f64 = 0.8;
    pub(crate) const LONGER: f64 = 1.0625;
    /// Usual steps over which changes are reckoned with at most: by then a motion that changes has gone anywhere. The probability of a change is that
    /// of a step times their number, which must stay below 1.
    pub(crate) const MOST_STEPS: f64 = 100.0;
    /// How often a motion that changes becomes constant, for one change of how it changes. A body that swings looks for three or four frames at its
    /// turning points like one of a constant motion, and every frame of that speaks for it by up to sixty to one.
    pub(crate) const BECOMES_CONSTANT: f64 = 0.1;
    /// How often rates that change stay from then on, as that, for every rate of the model beyond the first, as each of them speaks for that in each of
    /// these frames: similarities have one more, affine motion three, projective motion five. So affine motion that stops must be a thousand times as
    /// probable by its frames, which are one or two more.
    pub(crate) const RATES_STAY: f64 = 0.1;
    /// How often a camera begins to shake, as that: cameras that shake do so from the start. A motion that changes again, or
    /// slowly, looks for some frames like one seen by a camera that shakes.
    pub(crate) const BEGINS_TO_SHAKE: f64 = 0.0001;
    /// Probabilities before the third frame: most things on a table or in a machine turn about a fixed point, and few accelerate. Where frames
    /// do not tell a constant velocity from a constant generator, as where an object turns slowly, chance must not leave it out.
    pub(crate) const PRIOR_OF_GENERATOR: f64 = 0.878;
    pub(crate) const PRIOR_OF_VELOCITY: f64 = 0.09;
    /// Of the velocity of any point, which most bodies that are driven have at their axle.
    pub(crate) const PRIOR_OF_VELOCITY_OF_ANY: f64 = 0.01;
    /// Of each of [`SHAKEN`], and of [`SHAKEN_STRAIGHT`].
    pub(crate) const PRIOR_OF_SHAKEN: f64 = 0.002;
    pub(crate) const PRIOR_OF_EACH_LEVEL: f64 = 0.001;
    /// How much a camera shakes, in deviations of a pose as the points of a frame tell it. The first is that of pictures whose edges are rounded: with
    /// four as the least, steady turns in them were said to change.
    pub(crate) const SHAKEN: [f64; 3] = [2.0, 4.0, 20.0];
    /// As that, of an object of which a point runs straight: edges that are drawn without grey values, or rounded otherwise, put poses off by two and more.
    /// With four, deviations were two to five times as wide where a smaller shake explains the poses.
    pub(crate) const SHAKEN_STRAIGHT: f64 = SHAKEN[0];
    /// Densities of the change of accelerations: in variances of a pose as a frame tells it, per fifth power of a usual step. The first remember some
    /// forty frames, fourteen and four, and tell poses apart by their variance hardly more than a constant motion does; the last remember none, as of
    /// bodies that are pushed. From the third on they are thirty times apart: where none fits, a constant motion explains turning points better, and
    /// between levels ten thousand times apart deviations were half of the errors.
    pub(crate) const LEVELS: [f64; 9] = [1e-8, 1e-5, 1e-2, 0.3, 1e1, 3e2, 1e4, 3e5, 1e7];
    /// Steps that a density of one remembers; others, by its sixth root as many times (the gain of a Kalman filter of a random jerk).
    pub(crate) const MEMORY: f64 = 2.0;
    /// As these, where the velocity of the centroid alone changes: of what falls while it spins, up to what a spring shakes. With the first two
    /// alone what moves to and fro without turning was taken to turn to and fro as well: the deviation of its omega was twelve times, its error nine
    /// times as large.
    pub(crate) const LEVELS_OF_VELOCITY: [f64; 5] = [1e-7, 1e-2, 1e1, 1e4, 1e7];
    /// As these, where it turns with the object. Of a body that turns by a small angle from frame to frame the others say nearly the same.
    pub(crate) const LEVELS_OF_GENERATOR: [f64; 4] = [1e-5, 1e-2, 1e1, 1e4];
    /// How far the point of an object that runs straight may be from its centroid, in RMS radii, as a deviation: noise, hidden arcs, and bodies that are
    /// not even, as with holes and marks.
    pub(crate) const OFF_CENTROID: f64 = 0.02;
    /// As that, of any point, as of the axle of a wheel of which a part is seen. What runs straight is hardly ever far off the outline.
    pub(crate) const ANY_POINT: f64 = 1.0;
    /// Turn in a step, in rad, as a deviation, that the path of an object may tell where its outline does not: larger ones are no arc any more.
    pub(crate) const LARGEST_STEP_OF_PATH: f64 = 0.5;
    /// Probability of what lies outside of an interval of 95 %.
    pub(crate) const OUTSIDE_INTERVAL: f64 = 0.05;
    /// Probability of what lies outside of an interval of three deviations: what is less improbable widens the deviations that are stated.
    pub(crate) const OUTSIDE_THREE_DEVIATIONS: f64 = 0.0027;
    /// Share of a frame in the mean of weights over the last frames. A body that swings looks, as it is fastest or turns round, for about ten frames as if
    /// its motion hardly changed.
    pub(crate) const RECENT_GAIN: f64 = 1.0 / 16.0;
    /// Steps below which a hypothesis is said to forget soon: its mean has a gain of its own, of which ten frames leave a quarter, and counts where it has
    /// explained several frames, three in a row at least.
    pub(crate) const REMEMBERED: f64 = 4.0;
    pub(crate) const FORGETFUL_GAIN: f64 = 1.0 / 8.0;
    pub(crate) const SEVERAL: f64 = 0.25;
    /// Deviations of a pose that an acceleration which begins moves the object by over the steps that its level remembers.
    pub(crate) const FIRST_ACCELERATION: f64 = 3.0;
    /// Share of the variance of an expected pose that what has changed to a hypothesis may add to it: more is kept apart until a frame has been seen. A
    /// deviation that is wider by an eighth makes what lies five deviations off a few times as probable, one that is twice as wide ten thousand times.
    pub(crate) const WIDENS: f64 = 0.25;
    /// Share of a hypothesis below which it counts for nothing.
    pub(crate) const LEAST_SHARE: f64 = 1e-6;
    /// Variance of a pose, in squares of RMS radii or rad: no less than rounding, and no more than a quarter.
    pub(crate) const LEAST_VARIANCE: f64 = 1e-18;
    pub(crate) const LARGEST_VARIANCE: f64 = 0.0625;
    /// Hypotheses begin once a step of the centroid is known better than by this, in RMS radii: two frames of few points on a fine map may have no cell
    /// in common. Where the object is since the first frame need not be known: an edge may have gone along itself before a corner came into view.
    pub(crate) const UNTOLD: f64 = 1.0;
    /// Terms of a series of powers of the turn in a step at most: that of two rounds has settled by then.
    pub(crate) const MOST_TERMS: u32 = 60;
    /// What makes a measurement of the pose solvable along what it says nothing of.
    pub(crate) const SINGULAR: f64 = 1e-9;
    /// Share of the information on a parameter, all others known, that rounding leaves where there is none with the others unknown.
    pub(crate) const ROUNDED: f64 = 1e-14;
    /// Share by which a frame corrects the variance of a pose.
    pub(crate) const VARIANCE_GAIN: f64 = 0.1;
    /// While a constant generator is more probable than this, which is that of what lies outside of an interval of 95 %, its own estimate is stated, and
    /// widened by the others; then the object is expected where all hypotheses take it...
    pub(crate) const LEADS_FROM: f64 = OUTSIDE_INTERVAL;
    /// ...until it is as probable as this.
    pub(crate) const LEADS_UNTIL: f64 = 0.9;
}

/// A motion that changes at a steady rate from the beginning.
pub(crate) mod steady_change {
    /// Probability that it does. Few frames do not tell: at the rate that moves an object by one deviation of a pose between three frames a
    /// constant generator is off by more than three of its own deviations. Of the rates alone, where the velocity changes anyway, it is no less: what
    /// is pushed or braked is more often turned by that than left alone.
    pub(crate) const PRIOR: f64 = 0.1;
    /// Sizes of the rates of change, as deviations, in deviations of a pose per square of a usual step: all are as probable as each other. Larger
    /// ones are seen in the third frame, and smaller ones not before the sixtieth.
    pub(crate) const SIZES: [f64; 6] = [4.0, 1.0, 0.25, 0.06, 0.015, 0.004];
    /// A size that all of them are small against.
    pub(crate) const ANY: f64 = 30.0;
    /// Frames after which such changes are seen, or too small to matter.
    pub(crate) const FRAMES: usize = 128;
    /// Logarithm of a Bayes factor beyond which there is no doubt.
    pub(crate) const LARGEST_LOGARITHM: f64 = 50.0;
    /// What makes their covariance regular, in the same unit, squared: far below what so many frames tell.
    pub(crate) const SINGULAR: f64 = 1e-12;
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
    /// Stretches of a series of which any one may be left out: the first frames, and those after a change of motion, are no more than a quarter of a
    /// recording that tells of a slow change.
    pub(crate) const STRETCHES: usize = 4;
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
    /// Share of a length that pictures are usually off by, where they are: pixels a hundredth too wide are two of them, and so are planes tilted by 8
    /// degrees; lenses leave 0.5 to 2 % at the border.
    pub(crate) const USUAL_ERROR: f64 = 0.005;
    /// Time in which a camera usually reads the rows that an object and its way take up, in times from frame to frame, where it reads them one after
    /// another: half of all rows in half of the time.
    pub(crate) const USUAL_READ_OUT: f64 = 0.25;
    /// Rows that an object takes up, in radii: about twice its root mean square radius, and less where it is flat. A camera has read them before
    /// the next frame.
    pub(crate) const ROWS_OF_OBJECT: f64 = 2.0;
    /// Sizes that the errors of pictures have, in usual ones, with the share of the pictures with an error that have it: an error of three times the
    /// size is three times as rare. Ten usual errors, pixels a tenth too wide or a plane tilted by 25 degrees, are as large as they come unnoticed.
    pub(crate) const SIZES: [(f64, f64); 3] = [(1.0, 0.7), (3.0, 0.23), (10.0, 0.07)];
    /// Odds against a picture that is off in one of these ways.
    pub(crate) const ODDS_AGAINST: f64 = 9.0;
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
    /// What is added to the correlations of the motions in a single frame, so that combinations it hardly tells say nothing of the scatter: those of
    /// an eigenvalue of [`TOLD_APART`] count for a tenth, those of a hundredth for nine tenths.
    pub(crate) const HARDLY_TOLD: f64 = 1e-3;
    /// Numbers that the assumption of a scatter by noise alone is worth: eleven of each of eight frames, as many frames as innovations of unit variance
    /// are assumed by.
    pub(crate) const PRIOR_SCATTER: f64 = 88.0;
    /// Share of the frames that must tell a motion for those that do not show it to speak against it: where less than half of them do, most of a
    /// series is empty, and that it is told in one stretch says when it could be seen and not when it was there.
    pub(crate) const MOST_TELL: f64 = 0.5;
    /// Share of the square of a displacement that must be left of it in a frame to say something: a hundredth of the displacement. How much pose and
    /// outline take of it is known to some percent, so that of smaller shares a size may be wrong by as much as itself. Of pixels that are 1 to 6 %
    /// too wide in 300 short or slow recordings 7 more were silently off with a tenth, and of 100 without a fault none with either.
    pub(crate) const LEFT: f64 = 1e-4;
    /// As that, in variances of the direction of the normals: errors of normals leave some of a motion along the outline, which it does not show...
    pub(crate) const LEFT_PER_NOISE: f64 = 1.0;
    /// ...but no more than this.
    pub(crate) const MOST_LEFT: f64 = 0.01;
    /// What makes the equations of the pose solvable where the outline does not, as a share of the largest entry.
    pub(crate) const SINGULAR: f64 = 1e-9;
    /// Displacement by an outline that turns unseen, over how far it is from round: two places of it that have nothing in common differ by the root
    /// of 2 of that, opposite ones by 2.
    pub(crate) const TURNED_UNSEEN: f64 = 2.0;
    /// Frames looked at: all of the first so many, and while the motion is known from fewer; else every so many. A frame that stands for
    /// several must not correct more than it has found.
    pub(crate) const ALL_OF_THE_FIRST: usize = 16;
    pub(crate) const EVERY: usize = 4;
    /// Frames that have been taken, and that the motion is known from, after which one out of [`EVERY_LATER`] is looked at: more than seventy
    /// have told by then what is left out, and what begins later is there in all frames that follow.
    pub(crate) const MANY: usize = 256;
    pub(crate) const EVERY_LATER: usize = 8;
}

/// What is stated at all.
pub(crate) mod statement {
    /// How far below none the variance of a combination of parameters may be, in their variances: what rounding leaves where hardly anything is
    /// known.
    pub(crate) const ROUNDING_OF_CORRELATION: f64 = 1e-3;
    /// Standard deviation of what a motion changes by in a step, as a share of how fast the outline moves, where nothing has shown yet that it is
    /// steady. What falls, swings or slows down changes by a tenth to a third of its speed at 30 frames a second, machines by less. It is that of
    /// a step, however short: how fast frames come is chosen by how fast what they show changes.
    pub(crate) const CHANGE_IN_A_STEP: f64 = 0.2;
    /// Standard deviation of a side of a mask, in pixels: that of rounding, 1 / sqrt(12), where the side lies along the rows or columns. Sides
    /// that lie across them are off by less.
    pub(crate) const ROUNDING: f64 = 0.289;
    /// Tangent of the angle to the rows or columns within which points of a side are rounded together: by less than a pixel over ten.
    pub(crate) const ALONG_PIXELS: f64 = 0.1;
    /// Share of the frames rejected beyond which what the others say is no motion of the object.
    pub(crate) const MOST_REJECTED: f64 = 0.4;
    /// As that, where the path of a constant generator tells the turn, and the outline does not: that of a disc that turned by more than half a radian from
    /// frame to frame was thousands of deviations off, with three frames in ten rejected.
    pub(crate) const MOST_REJECTED_OF_PATH: f64 = 0.1;
    /// Fewest frames rejected that say so.
    pub(crate) const FEWEST_REJECTED: usize = 5;
    /// Fewest frames rejected, no fewer than taken, that say so: one by itself may be wrong, and where frames are wrong by chance two of the
    /// first four hardly are.
    pub(crate) const FEWEST_AGAINST: usize = 2;
    /// Shift of an outline by light from a side, over the second harmonic of what it displaces edges by: of `max(0, cos t)` that is 1/2 over 2 / 3 pi.
    pub(crate) const SHIFT_BY_LIGHT: f64 = 2.36;
    /// A variance of so many times the square of a distance has intervals of 95 % of that half width: 1 / 1.96^2.
    pub(crate) const REACH: f64 = 0.26;
}

/// States that are read from bytes.
#[cfg(feature = "serde")]
pub(crate) mod saved_state {
    /// How far probabilities may sum to something else than 1, by rounding.
    pub(crate) const SUM_OFF: f64 = 1e-6;
}
