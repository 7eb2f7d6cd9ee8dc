//! What a family of motions may leave out.
use freeform_riccati::MotionModel;
use nalgebra::{SMatrix, SVector, Vector2};

use crate::{
    tuning::family as tuning,
    update::{EDGES, FOURTH_OF_EDGES, GROWTH, LENS, PERSPECTIVE, READ_OUT, SHEAR},
};

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
pub(super) const GROUPS: [(WrongFamily, Members); 6] = [
    (WrongFamily::Growth, &[GROWTH]),
    (WrongFamily::Shear, &SHEAR),
    (WrongFamily::Perspective, &PERSPECTIVE),
    (WrongFamily::RollingShutter, &[READ_OUT]),
    (WrongFamily::Lens, &OF_LENS),
    (WrongFamily::Shape, &EDGES),
];

/// What a lens does whose middle is elsewhere than where the object was first.
pub(super) const OF_LENS: [usize; 5] = [SHEAR[0], SHEAR[1], LENS[0], LENS[1], LENS[2]];

/// Groups beside a model that has growth and shear.
const GROUPS_BESIDE_SHEAR: [(WrongFamily, Members); 3] =
    [(WrongFamily::Shape, &ALL_OF_EDGES), (WrongFamily::Perspective, &PERSPECTIVE), (WrongFamily::Lens, &LENS)];

/// Both harmonics of edges that light displaces.
const ALL_OF_EDGES: [usize; 4] = [EDGES[0], EDGES[1], FOURTH_OF_EDGES[0], FOURTH_OF_EDGES[1]];

/// Motions that pictures have now and then, a little: of edges that light displaces, of pixels that are not square or a plane that is tilted, of
/// perspective, of rows that are read one after the other, and of a lens.
const OF_PICTURES: [Members; 5] = [&EDGES, &SHEAR, &PERSPECTIVE, &[READ_OUT], &[LENS[0]]];

/// The same where the model has shear.
const OF_PICTURES_BESIDE_SHEAR: [Members; 3] = [&EDGES, &PERSPECTIVE, &[LENS[0]]];

/// What may be left out by a model: motions that go together, and those that pictures have now and then.
pub(super) fn left_out_by(model: MotionModel) -> (&'static [(WrongFamily, Members)], &'static [Members]) {
    match model {
        MotionModel::Rigid | MotionModel::Similarity => (&GROUPS, &OF_PICTURES),
        MotionModel::Affine => (&GROUPS_BESIDE_SHEAR, &OF_PICTURES_BESIDE_SHEAR),
        MotionModel::Projective => (&[], &[]),
    }
}

/// What was found, with the displacement of the outlines that it explains beside what was found before it, root mean square.
pub(super) type Found = (WrongFamily, f64);

/// The name of what was found, the clearest first. A camera is blamed for what it explains. One that looks from aside stretches and skews as well
/// as it makes perspective, and what is left of either in higher orders is less than perspective is, though it may be clearer. Of a lens and of rows
/// nothing is left: where something else is there besides, beyond doubt, where rows would have to be read for longer than there is time from frame
/// to frame, or what is found of a lens is none, the outlines change in another way, which has a bit of each. `read_out` is the time in which a
/// rolling shutter would read the rows of a radius, in times from frame to frame, `off_a_lens` is in deviations.
pub(super) fn name_of(found: &[Found], read_out: f64, off_a_lens: f64) -> Option<WrongFamily> {
    let (clearest, _) = *found.first()?;
    let is_alone = found.len() == 1;
    let name = match clearest {
        WrongFamily::Growth | WrongFamily::Shear | WrongFamily::Shape => clearest,
        _ if is_tilt(found) => WrongFamily::Perspective,
        WrongFamily::Lens if is_alone && off_a_lens < tuning::SIGNIFICANT => clearest,
        WrongFamily::RollingShutter if is_alone && tuning::ROWS_OF_OBJECT * read_out <= 1.0 => clearest,
        _ => WrongFamily::Shape,
    };
    Some(name)
}

/// Whether there is perspective, and all else is stretch and skew or less than that.
fn is_tilt(found: &[Found]) -> bool {
    let perspective = found.iter().find(|(family, _)| *family == WrongFamily::Perspective);
    perspective.is_some_and(|(_, most)| {
        let explained = |(family, displacement): &Found| match family {
            WrongFamily::Perspective | WrongFamily::Shear => true,
            _ => displacement < most,
        };
        found.iter().all(explained)
    })
}

/// Squared distance of the sizes of [`OF_LENS`] from those of a lens, in deviations; chi-square of two degrees of freedom. `None` where they are
/// known without error.
///
/// A lens of strength k and middle c displaces by `k |p - c|^2 (p - c)`. But for what moves or scales the picture as a whole this is k of `|p|^2 p`,
/// -k c of what that becomes where its middle is elsewhere, and a stretch and skew of `k (cx^2 - cy^2)` and `2 k cx cy`. Light from a side makes these
/// two without the others.
pub(super) fn off_a_lens(sizes: &SVector<f64, 5>, covariance: &SMatrix<f64, 5, 5>) -> Option<f64> {
    let [stretch, skew, k, x, y] = *sizes.as_ref();
    // Times k, so that a lens may be weak and far.
    let off = Vector2::new(k * stretch - (x * x - y * y), k * skew - 2.0 * x * y);
    let by_sizes = SMatrix::<f64, 2, 5>::new(k, 0.0, stretch, -2.0 * x, 2.0 * y, 0.0, k, skew, -2.0 * y, -2.0 * x);
    let variance = by_sizes * covariance * by_sizes.transpose();
    Some(off.dot(&(variance.try_inverse()? * off)))
}

#[cfg(test)]
mod tests {
    use super::{
        WrongFamily::{Growth, Lens, Perspective, RollingShutter, Shape, Shear},
        name_of, off_a_lens,
    };
    use nalgebra::{SMatrix, SVector};

    #[test]
    fn a_camera_is_blamed_only_for_what_it_explains() {
        assert_eq!(name_of(&[], 0.0, 0.0), None);
        for alone in [Growth, Shear, Perspective, RollingShutter, Lens, Shape] {
            assert_eq!(name_of(&[(alone, 0.01)], 0.4, 4.0), Some(alone));
        }
        for camera in [RollingShutter, Lens] {
            assert_eq!(name_of(&[(camera, 0.01), (Shear, 0.001)], 0.4, 0.0), Some(Shape));
        }
        // Edges that light displaces, and a bit of each camera.
        let names = [RollingShutter, Lens].map(|camera| name_of(&[(Shape, 0.01), (camera, 0.001)], 0.4, 0.0));
        assert_eq!(names, [Some(Shape); 2]);
        // What the object does itself is named beside whatever else there is.
        let names = [Growth, Shear].map(|first| name_of(&[(first, 0.01), (Lens, 0.02)], 0.4, 9.0));
        assert_eq!(names, [Some(Growth), Some(Shear)]);
    }

    #[test]
    fn a_tilted_camera_stretches_as_well_and_leaves_less_than_its_perspective() {
        for (size, name) in [(0.009, Perspective), (0.011, Shape)] {
            let after = |other| name_of(&[(Perspective, 0.01), (Shear, 0.02), (other, size)], 0.4, 0.0);
            assert_eq!([Growth, RollingShutter, Lens].map(after), [Some(name); 3]);
            let before = |other| name_of(&[(other, size), (Perspective, 0.01)], 0.4, 0.0);
            assert_eq!([RollingShutter, Lens].map(before), [Some(name); 2]);
        }
    }

    #[test]
    fn rows_are_not_read_for_longer_than_there_is_time_between_frames() {
        let names = [0.5, 0.6].map(|read_out| name_of(&[(RollingShutter, 0.01)], read_out, 0.0));
        assert_eq!(names, [Some(RollingShutter), Some(Shape)]);
    }

    #[test]
    fn a_lens_is_told_from_a_stretch_beside_some_of_one() {
        let covariance = SMatrix::identity() * 1e-6;
        for (k, x, y) in [(0.02, 0.0, 0.0), (0.02, 0.5, -0.3), (-0.01, 2.0, 1.0)] {
            let lens = SVector::from([k * (x * x - y * y), 2.0 * k * x * y, k, -k * x, -k * y]);
            assert!(off_a_lens(&lens, &covariance).expect("errors") < 1e-9, "{k} {x} {y}");
            let stretched = lens + SVector::from([0.02, 0.0, 0.0, 0.0, 0.0]);
            assert!(off_a_lens(&stretched, &covariance).expect("errors") > 10.0, "{k} {x} {y}");
        }
        assert_eq!(name_of(&[(Lens, 0.01)], 0.0, 6.0), Some(Shape));
    }
}
