//! Constants of a plane that moves in space.
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
/// By which the share of a step is multiplied that has made the sum of squares larger.
pub(crate) const LESS_SHARE: f64 = 0.25;
/// Half the length, in spacings, over which the bend of an outline at a cell is taken to go on: further off, points belong to other cells.
pub(crate) const BEND_REACHES: f64 = 2.0;
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
/// That limit for the components of the normal.
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
/// Share of the farthest depth of an outline in the first frame that the nearest must have: a camera so near to a plane, or so nearly in it, that
/// one end of an object is ten times as far as the other shows the rest of it as a line.
pub(crate) const LEAST_DEPTH: f64 = 0.1;
/// Largest squared innovation that counts, fewest of them that say something, and deviations of their mean that chance makes.
pub(crate) const LARGEST_INNOVATION: f64 = 200.0;
pub(crate) const FEWEST_INNOVATIONS: f64 = 10.0;
pub(crate) const CHANCE: f64 = 3.0;
