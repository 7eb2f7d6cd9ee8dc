//! Constants of searches: where an object is looked for, and the map cut anew.

/// Remapping: the map cut anew from several frames.
pub(crate) mod remapping {
    /// Frames after which the map is cut anew.
    pub(crate) const OCCASIONS: [usize; 3] = [4, 16, 64];
    /// With so many points of one frame for each cell there is nothing to be gained.
    pub(crate) const PLENTY_PER_CELL: f64 = 3.5;
    /// Times that a map is cut from the same frames at most.
    pub(crate) const MOST_CUTS: usize = 4;
    /// Frames that are taken in one step by the track and its rivals while they are measured on new cells, that of the step included: no other
    /// step takes longer...
    pub(crate) const MEASURED_AT_ONCE: usize = 10;
    /// ...and as many as measuring new cells for the first time takes the time of. With more rivals each step takes so many more than there
    /// are hypotheses, so that they catch up.
    pub(crate) const FRAMES_OF_BEGINNING: usize = 2;
    /// Frames that are kept at most, twice the last occasion, for rivals to be measured on. While they are, more frames come: with four hypotheses
    /// or more, which take few more frames in a step than come, no map is cut from so many that these would be exceeded.
    pub(crate) const MOST_KEPT: usize = 2 * OCCASIONS[2];
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
    /// Squares of the noise, for each parameter that poses as found have more than a constant motion, beyond which that is not what a map is cut by.
    /// Chance explains one; of 300 recordings of constant motions none reached eight.
    pub(crate) const FOUND_ELSEWHERE: f64 = 12.0;
    /// Points that follow each other in less than this share of the mean distance lie in one place.
    pub(crate) const COMMON: f64 = 0.2;
}

/// Groupwise registration: the first frames of an outline of few points aligned together.
pub(crate) mod groupwise {
    /// Points of a frame below which a map begun with it alone is too coarse: of 20 points of a smooth outline a chord is off by a tenth of what
    /// lobes of an eighth stand out by.
    pub(crate) const SPARSE: usize = 24;
    /// Frames after which they are aligned: some hundred points.
    pub(crate) const OCCASIONS: [usize; 2] = [8, 16];
    /// Largest turn from frame to frame that is looked for, rad.
    pub(crate) const LARGEST_TURN: f64 = 0.4;
    /// Turns over all frames that are tried are so far apart, rad: an outline whose distance from its centroid changes by a quarter of itself per
    /// radian is then off by four thousandths.
    pub(crate) const STEP: f64 = 0.03;
    /// A turn that differs by more than so much over all frames is another one, rad.
    pub(crate) const ANOTHER: f64 = 0.25;
    /// Logarithm of the likelihood by which the best turn must be better than all others. Of 200 circles of 8 to 20 points the largest was 18; of
    /// smooth outlines with lobes of a tenth 96 points reach about 100.
    pub(crate) const BETTER: f64 = 40.0;
    /// Distance beyond which points count alike, in radii.
    pub(crate) const FAR: f64 = 0.25;
    /// Mean square by which a contour must differ from itself after a part of a turn not to be symmetric, in variances of its scatter. It differs by
    /// two by noise alone, and by about as much again as points are few.
    pub(crate) const SYMMETRIC: f64 = 9.0;
    /// Largest order of a symmetry that so few points show.
    pub(crate) const LARGEST_ORDER: usize = 12;
    /// Halvings of the steps that turn and path are refined by.
    pub(crate) const HALVINGS: usize = 8;
    /// Steps of a size in each rate at most: no more than leads from one turn that is tried to the next.
    pub(crate) const STEPS_OF_A_SIZE: usize = 4;
}

/// Global registration: the object looked for without a guess.
pub(crate) mod registration {
    /// Turns tried over the whole circle, 15 degrees apart: within reach of the local search on every outline tried.
    pub(crate) const TURNS: usize = 24;
    /// Turns that a search is begun from at least, those that few points lie nearest to the outline by: half of them, as starts on the far side of
    /// a pose do not lead to it.
    pub(crate) const SEARCHED_FROM: usize = 12;
    /// Length of an outline over its width from which on turns that stretch it are tried, too: with less, what they differ by from plain turns is
    /// within reach of the search.
    pub(crate) const STRETCHED: f64 = 1.15;
    /// Parts of these that a lost object is looked for from, one in each frame, until one says that the frame may show it: each has turns all around,
    /// which with the pose before and those of related points cost little more than half of the time in which a frame of video is to be done...
    pub(crate) const PARTS: usize = 8;
    /// ...and from one part to the next it is so many turns: after three frames no turn is further than 22.5 degrees from a start.
    pub(crate) const TO_NEXT_PART: usize = 3;
    /// While an object is lost, frames that show something else make more noise tolerated. Frames that are hopeless without that are searched from
    /// all turns once in so many; it has no factor in common with [`PARTS`], so that this happens to every part.
    pub(crate) const NOISY_SEARCHED: usize = 3;
    /// Points that the related points of an outline are found by: they need to tell a turn to some degrees.
    pub(crate) const POINTS_OF_LANDMARKS: usize = 100;
    /// Points that the search is made with.
    pub(crate) const FEW_POINTS: usize = 80;
    /// Distance beyond which points count alike in the score of a pose, in radii: they may be hidden in the map or wrong. Trimming a share of
    /// the points instead would leave out the pin of a disc, which alone tells its turn.
    pub(crate) const FARTHEST: f64 = 0.1;
    /// Most that a point beyond the known ends of an outline counts for in that score, in the root mean square of points on it: nothing says where it
    /// should lie. So a pose that leaves all of the points there which it can, and has the others on the outline, is a tie with the best
    /// ([`TIE`]), as the mean of their distances is four fifths of that root. With as much as points that are far off, or 1.5 times that of points on
    /// the outline, poses were taken that put the most points on what was known, though others put all of those there where the outline is: a square
    /// with a chamfer turned by a right angle too much.
    pub(crate) const BEYOND_END: f64 = 1.0;
    /// As that, of any other point where the outline has gaps: in the middle of one it lies nearest to what is across.
    pub(crate) const IN_GAP: f64 = 4.0;
    /// Share of the points that must not lie beyond ends: with fewer the gate would not find the outline in the frame.
    pub(crate) const FEWEST_ON_OUTLINE: f64 = 0.25;
    /// Mean distance of a point on the outline from the middle of its cell, in spacings.
    pub(crate) const FROM_CENTRE: f64 = 0.25;
    /// Deviation of the residuals that the first step of a search allows for, in radii: starts lie up to 7.5 degrees off, which is 0.13 at the
    /// RMS radius, and Tukey's weights reach 4.7 deviations.
    pub(crate) const WIDEST: f64 = 0.065;
    /// As [`WIDEST`], of a refinement, which begins with what few points have found.
    pub(crate) const WIDEST_REFINED: f64 = 0.03;
    /// By which it falls from step to step: below the noise within the steps of a search.
    pub(crate) const NARROWER: f64 = 0.5;
    /// Steps of the search for each start, at most.
    pub(crate) const SEARCH_STEPS: usize = 8;
    /// Steps after which searches that have come together are made once, and the best are chosen to go on.
    pub(crate) const FIRST_STEPS: usize = 4;
    /// As [`WIDEST`], after these.
    pub(crate) const WIDEST_FURTHER: f64 = WIDEST * NARROWER * NARROWER * NARROWER * NARROWER;
    /// Searches that go on from there, and as many of smaller turns: of a disc with a notch, which few points show, that is hardly known yet.
    pub(crate) const SEARCHED_ON: usize = 12;
    /// Score in that of the best from which on a pose cannot explain the frame nearly as well: mean distances of twice the size are squares of
    /// four times.
    pub(crate) const FAR_WORSE: f64 = 2.0;
    /// As [`FAR_WORSE`], of scores with few points, which are known to a tenth, before a pose is refined with all of them.
    pub(crate) const FAR_WORSE_BY_FEW: f64 = 3.0;
    /// If few points in the best pose found deviate by more than so many times the most noise that is tolerated, no pose explains the frame: the
    /// median of eighty is known to a seventh.
    pub(crate) const HOPELESS: f64 = 1.7;
    /// If all searches leave so many times that deviation after their first steps, only the best goes on, to confirm it: by the rest of their steps
    /// searches come nearer by less.
    pub(crate) const MARGIN_BEFORE_LAST_STEPS: f64 = 1.3;
    /// Fewest points of a frame that this is said of: a map of fewer may err by more than its noise says, and a search with all of them is soon made.
    pub(crate) const ENOUGH_POINTS: usize = 200;
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
    /// As [`SAME_POSE`], of outlines with ends that are mostly straight, found with few points: no farther than the weights of a refinement
    /// reach ([`TUKEY`] times [`WIDEST_REFINED`]). Few points hardly tell how far such an outline has gone along itself, and no refinement
    /// brings together what is farther apart.
    pub(crate) const SAME_BY_FEW: f64 = TUKEY * WIDEST_REFINED;
    /// Score in that of the best up to which poses explain a frame nearly alike, beside a mark: a tooth that is missing has a tenth of the points,
    /// which count for four times as much.
    pub(crate) const NEARLY_ALIKE: f64 = 1.5;
    /// Turns of poses that were found lie so near to multiples of a part of a circle, rad, where an outline nearly looks the same after it: few
    /// points tell a turn to a hundredth, and the farthest off of several is off by about two of that.
    pub(crate) const OFF_NEAR_SYMMETRY: f64 = 0.02;
    /// Turns that are nearer to multiples than this, rad, say nothing of which of several numbers of parts fits better: a share of that hundredth.
    pub(crate) const KNOWN_NEAR_SYMMETRY: f64 = 0.004;
    /// Centres of these turns lie no farther apart, in radii: a hundredth in the angle of the smallest turn, a quarter of a radian, is as much.
    pub(crate) const OFF_CENTRE: f64 = 0.1;
    /// Largest number of parts that is looked for: [`OFF_NEAR_SYMMETRY`] on either side is a quarter of the angle of one then. Of poses with hidden
    /// parts few teeth are reached, of outlines that are wholly symmetric
    /// ([`LARGEST_ORDER`](crate::tuning::symmetry::LARGEST_ORDER)) all that matter.
    pub(crate) const LARGEST_NEAR_SYMMETRY: usize = 40;
    /// As that, told by one turn alone, which is a multiple of one of so few parts by chance in a fifth of all cases.
    pub(crate) const LARGEST_BY_ONE_TURN: usize = 8;
    /// A score up to this many times the best is a tie.
    pub(crate) const TIE: f64 = 1.25;
    /// Tukey's constant for 95 % efficiency at Gaussian noise.
    pub(crate) const TUKEY: f64 = 4.685;
    /// Area of the outline, in times what it was, below which a step has gone astray.
    pub(crate) const SMALLEST_AREA: f64 = 1e-6;
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

/// Whether frames tell a turn that the outline hardly shows.
pub(crate) mod turn_profile {
    /// Frames that are looked back on: a turn of them all together must be told.
    pub(crate) const MEMORY: usize = 8;
    /// Share of what was found before that is kept from frame to frame.
    pub(crate) const KEPT: f64 = 1.0 - 1.0 / MEMORY as f64;
    /// Difference of squares that frames promise for the turns compared, in that which is significant: half of it may be missing.
    pub(crate) const PROMISED: f64 = 2.0;
    /// Largest turn that is compared, rad. Where frames do not promise to tell one, the deviation that is stated says how little is known.
    pub(crate) const LARGEST: f64 = super::registration::NEAR;
    /// Turn beside that expected, rad, from which on the object is looked for elsewhere: a search costs as much as fifty frames, and smaller ones are
    /// put right by the next frame.
    pub(crate) const LEAP: f64 = 0.1;
}

/// Hypotheses: turns that explain a frame alike.
pub(crate) mod turn_hypotheses {
    /// Turns that differ by less are the same, rad.
    pub(crate) const DIFFERENT_TURN: f64 = 0.15;
    /// Of turns that explain the frames alike the smallest is taken for granted if the others are so many times as large: the turn per
    /// frame is then less than two thirds of half the angle of symmetry.
    pub(crate) const SURELY_SMALLER: f64 = 2.0;
    /// Frames after which hypotheses that are surely larger turns are no longer followed: a symmetric outline will not tell them apart.
    pub(crate) const FOLLOWED: usize = 8;
    /// Deviations by which a hypothesis that is followed must explain the first frames better than the turn taken, for that to be in doubt until they
    /// decide: chance makes one of 44 better by as much.
    pub(crate) const PREFERRED: f64 = 2.0;
    /// Deviations by which the points of so many frames must be better for another of the turns that had looked the same: cells err alike in all of
    /// the first frames, so that those of a square differ by up to six.
    pub(crate) const NOT_THE_SAME: f64 = 10.0;
    /// Deviations by which poses or motions of hypotheses must differ to be in doubt.
    pub(crate) const DIFFERENT: f64 = 2.0;
}
