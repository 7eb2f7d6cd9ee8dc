//! Constants of what goes on from picture to picture, each with its reason.

/// What may be one thing in three pictures that follow each other, and how little of that chance explains.
pub(super) mod chains {
    /// Largest logarithm of the ratio of areas from one picture to the next: that of a thing that comes nearer by 7 % of its distance.
    pub(in crate::choice) const GROWTH: f64 = 0.15;

    /// What the rounding of a small outline adds to it, over its size: the area of a thing of ten pixels across is off by up to two rows of them.
    pub(in crate::choice) const GROWTH_OF_SMALL: f64 = 2.0;

    /// Largest step from one picture to the next, in sizes (roots of areas): with a larger one nearly all things of a picture could be each other.
    pub(in crate::choice) const LARGEST_STEP: f64 = 8.0;

    /// How far two steps that follow each other may differ: in sizes, as a middle is known; in steps, as a motion may turn and speed up in three
    /// pictures; and in pixels of the trial, as outlines are rounded.
    pub(in crate::choice) const BEND: [f64; 3] = [0.03, 0.25, 0.3];

    /// Steps of so many sizes need no straight way: nothing else is where the thing was.
    pub(in crate::choice) const OVERLAP: f64 = 0.5;

    /// Least way in three pictures: in sizes, and in pixels of the trial. What rests has less, by the rounding of its outline.
    pub(in crate::choice) const LEAST_WAY: [f64; 2] = [0.1, 1.5];

    /// Largest bend of a way that a common acceleration explains, in sizes: a seventh of the room that things at random fill.
    pub(in crate::choice) const LARGEST_PULL: f64 = 3.0;

    /// How far the common acceleration of a thing may vary, as shares of it: its middle is known in whole pictures, and pictures are taken unevenly.
    pub(in crate::choice) const PULL_VARIES: f64 = 0.15;

    /// So likely clutter may look as if it moved: many ways of tracing are tried on each sequence.
    pub(in crate::choice) const BY_CHANCE: f64 = 1e-4;

    /// A thing moves clearly where it moves by so many of its sizes from picture to picture: a disc then leaves most of where it was.
    pub(in crate::choice) const CLEAR: f64 = 0.75;
}

/// The score of a way of tracing: a product of shares. The values were set by hand so that what a person would choose comes first in simulated and
/// real sequences.
pub(super) mod score {
    /// What moves by more than so many pixels in all moves beyond the rounding of its outline; the share of the score that what rests keeps.
    pub(in crate::choice) const MOVES: f64 = 1.5;
    pub(in crate::choice) const AT_REST: f64 = 0.35;

    /// What covers more of the picture than this is the ground around an object; the share of the score that it keeps.
    pub(in crate::choice) const MOST_OF_PICTURE: f64 = 0.55;
    pub(in crate::choice) const GROUND: f64 = 0.05;

    /// Objects in a picture that are no clutter; and the size of the second largest, as a share of the largest, from which on more count fully.
    pub(in crate::choice) const FEW_OBJECTS: f64 = 12.0;
    pub(in crate::choice) const SECOND_COUNTS: f64 = 0.2;

    /// Area of which half of the score is left, in pixels: smaller things are mostly specks, and tell little of a motion.
    pub(in crate::choice) const SMALL: f64 = 120.0;

    /// Power of the share of pictures in which something is found: bodies come and go, so that half of the pictures keep more than half of the score.
    pub(in crate::choice) const POWER_OF_SHARE: f64 = 0.7;

    /// Share of the score lost where the border of the picture clips what is found in every picture.
    pub(in crate::choice) const LOST_BY_CLIPPING: f64 = 0.7;

    /// Holes are the same where the logarithm of the ratio of their areas is less than this, in nearly all pictures.
    pub(in crate::choice) const SAME_HOLES: f64 = 0.1;
    pub(in crate::choice) const NEARLY_ALL: f64 = 0.8;

    /// Deviations of the logarithm of the area and of affine moment invariants, over a sequence, of one body: light and tracing change them.
    pub(in crate::choice) const GROWTH: f64 = 0.12;
    pub(in crate::choice) const SHAPE: f64 = 0.2;

    /// What the area may grow by from one picture to the next: of all outlines, and by the rounding of small ones to pixels, over their size.
    pub(in crate::choice) const GROWTH_OF_STEP: [f64; 2] = [0.02, 0.3];

    /// So many times that growth, or such a change of the invariants, halves the score.
    pub(in crate::choice) const MUCH_GROWTH: f64 = 2.0;
    pub(in crate::choice) const SHAPE_OF_STEP: f64 = 0.1;

    /// So large a bend of the path within three pictures halves it, in sizes.
    pub(in crate::choice) const BEND: f64 = 0.05;

    /// Share of the score where nothing tells it, and where a part of what would is missing.
    pub(in crate::choice) const NOT_TOLD: f64 = 0.3;
    pub(in crate::choice) const HALF_TOLD: f64 = 0.5;
}

/// What there is beside a thing that may move.
pub(super) mod beside {
    /// A change is no larger than this share of the picture: light changes more of it at once.
    pub(in crate::choice) const LARGEST_CHANGE: f64 = 0.25;

    /// It is seen in one of so many pictures: specks of noise are in fewer.
    pub(in crate::choice) const CHANGES_OFTEN: usize = 4;

    /// Fewest pictures in which it is seen that are enough to say that something goes on in most of them: those of four bursts that do not overlap.
    pub(in crate::choice) const FEWEST_OF_MOST: usize = 12;

    /// What moves by less than this share of the way of another thing stands still beside it: a part of a thing goes all of its way, and the middle
    /// of what stands is off by a little of it where the other is in front.
    pub(in crate::choice) const STANDS: f64 = 0.2;
}

/// What turns in its place.
pub(super) mod turning {
    /// Directions in which an outline is looked at from its middle: a pixel at the edge of a body of eighty pixels.
    pub(in crate::choice) const DIRECTIONS: usize = 256;

    /// Parts of the angle between two of them by which a turn is told: a quarter of a pixel there.
    pub(in crate::choice) const PARTS: i32 = 4;

    /// One of so many directions at least has a point: between others the outline is taken to be straight.
    pub(in crate::choice) const ONE_IN_SEEN: usize = 4;

    /// An outline has turned where it is off by less than this share of what it is off without the turn, root mean square: points are off by some
    /// tenths of a pixel, teeth that have gone on by some pixels, and what goes over the edge of something at rest leaves all else where it is.
    pub(in crate::choice) const TURNED: f64 = 0.5;
}

/// Which of several ways is taken that do equally well.
pub(super) mod ties {
    /// Ways do equally well where what they are sorted by differs by less than this share: another sample of the same pictures changes it by as much.
    pub(in crate::choice) const TIE: f64 = 0.02;

    /// They show the same where the areas differ by less than this share: a pixel around a body of eighty.
    pub(in crate::choice) const AREA: f64 = 0.05;

    /// A contour is known clearly better where its deviation is smaller by this factor: deviations are told from edges to some tenths.
    pub(in crate::choice) const CLEARLY: f64 = 1.5;
}

/// How grey values stand for light.
pub(super) mod light {
    /// Outlines are of one body, or of bodies that are alike, where its sizes differ by less than this share, by one of what grey values may stand
    /// for: a fifth of a pixel of a small body of twenty changes them by a hundredth, and perspective by some.
    pub(in crate::choice) const ALIKE: f64 = 0.05;

    /// Pictures of a body that tell how its size changes: two bursts.
    pub(in crate::choice) const FEWEST: usize = 6;

    /// Share of the changes that are usual. Larger ones count as the largest of these: something has hidden a part of the body, or touched it.
    pub(in crate::choice) const USUAL: f64 = 0.9;

    /// Sizes that change by less than this, in pixels of the pictures tried, tell nothing: noise and the grid of pixels change them by as much.
    pub(in crate::choice) const LEAST_SPREAD: f64 = 0.02;

    /// The light is taken where it leaves less than this share of the change. Of 77 simulated sequences whose grey values are in proportion to light
    /// it left 0.69 or more, with more than 0.02 pixels to be told; of sequences blurred by some pixels, in grey values of a camera, 0.03 to 0.56.
    pub(in crate::choice) const LESS: f64 = 0.6;

    /// It speaks against the light where it leaves more than this share of the change.
    pub(in crate::choice) const MORE: f64 = 1.1;

    /// Edges tell where they are this wide at least, in pixels: in narrower ones the pixels' own square and the rim of a body are as large.
    pub(in crate::choice) const WIDE: f64 = 0.95;

    /// And where they may lie off together by more than this, in pixels: so they may by rounding and the grid of pixels.
    pub(in crate::choice) const LEAST_SYSTEMATIC: f64 = 0.015;

    /// The light is taken where that is less than this share by it: 0.03 to 0.33 in most of 58 simulated sequences of cameras, and 0.7 to 19 in 33 of
    /// drawings and of cameras whose grey values are in proportion to light.
    pub(in crate::choice) const LESS_SYSTEMATIC: f64 = 0.35;

    /// Edges are to be seen in the light in this share of the pictures in which they are seen in grey values.
    pub(in crate::choice) const SEEN_AS_WELL: f64 = 0.8;
}
