//! What a family of motions may leave out.
use freeform_riccati::MotionModel;

use crate::update::{EDGES, GROWTH, LENS, PERSPECTIVE, READ_OUT, SHEAR};

/// What outlines do that their family of motions does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrongFamily {
    /// They grow or shrink.
    Growth,
    /// They are stretched or sheared: an affine motion, or a camera that looks from aside, or pixels that are not square.
    Shear,
    /// They change as in perspective.
    Perspective,
    /// They are slanted by their own motion, as rows of a picture are that are read one after the other.
    RollingShutter,
    /// They are bent from the middle of the picture outwards, as a lens does.
    Lens,
    /// They change their shape in other ways: bending, edges that light or shadow moves.
    Shape,
}

/// Some of the motions, by their numbers.
pub(super) type Members = &'static [usize];

/// Motions that go together, by their numbers: a lens whose middle is not known stretches and skews too.
pub(super) const GROUPS: [(WrongFamily, Members); 5] = [
    (WrongFamily::Growth, &[GROWTH]),
    (WrongFamily::Shear, &SHEAR),
    (WrongFamily::Perspective, &PERSPECTIVE),
    (WrongFamily::RollingShutter, &[READ_OUT]),
    (WrongFamily::Lens, &[SHEAR[0], SHEAR[1], LENS[0], LENS[1], LENS[2]]),
];

/// Groups beside a model that has growth and shear, whose numbers edges have.
const GROUPS_BESIDE_SHEAR: [(WrongFamily, Members); 3] =
    [(WrongFamily::Shape, &EDGES), (WrongFamily::Perspective, &PERSPECTIVE), (WrongFamily::Lens, &LENS)];

/// Motions that pictures of a camera have now and then, a little: of pixels that are not square or a plane that is tilted, of perspective, of rows
/// that are read one after the other, and of a lens.
const OF_CAMERA: [Members; 4] = [&SHEAR, &PERSPECTIVE, &[READ_OUT], &[LENS[0]]];

/// The same where the model has shear: edges that light displaces, perspective, a lens.
const OF_CAMERA_BESIDE_SHEAR: [Members; 3] = [&[EDGES[0], EDGES[1]], &PERSPECTIVE, &[LENS[0]]];

/// What may be left out by a model: motions that go together, and those that pictures have now and then.
pub(super) fn left_out_by(model: MotionModel) -> (&'static [(WrongFamily, Members)], &'static [Members]) {
    match model {
        MotionModel::Rigid | MotionModel::Similarity => (&GROUPS, &OF_CAMERA),
        MotionModel::Affine => (&GROUPS_BESIDE_SHEAR, &OF_CAMERA_BESIDE_SHEAR),
        MotionModel::Projective => (&[], &[]),
    }
}
