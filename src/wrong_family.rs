//! What is said of outlines that move in ways which the motion model does not have.
use std::fmt;

use freeform_outline_filter::WrongFamily;
use freeform_riccati::MotionModel;

use crate::picture_tracing::TracedGround;

/// What the outlines do and what to try.
pub(crate) fn write_wrong_family(
    f: &mut fmt::Formatter<'_>,
    family: WrongFamily,
    motion: MotionModel,
    ground: TracedGround,
) -> fmt::Result {
    match family {
        WrongFamily::Growth => {
            write!(f, "the outlines grow or shrink, which {motion} motion does not: try --motion similarity")
        }
        WrongFamily::Shear => write!(
            f,
            "the outlines are stretched or sheared, which {motion} motion does not do: check the pixel aspect, try --rectify \
             where the camera is tilted, or --motion affine; light or shadow on one side of the object does nearly the same"
        ),
        WrongFamily::Perspective => write!(
            f,
            "the outlines change as in perspective, which {motion} motion does not do: check the lens, try --rectify where the \
             camera is tilted, or --motion projective"
        ),
        WrongFamily::RollingShutter => f.write_str(
            "the outlines are slanted by their own motion, as by a camera that reads its rows one after the other (a rolling \
             shutter): velocities may be off by some percent",
        ),
        WrongFamily::Lens => f.write_str(
            "the outlines are bent from the middle of the picture outwards, as by a lens: velocities may be off by some percent; \
             undistort the pictures with a calibration of the camera",
        ),
        WrongFamily::Shape => {
            let wider = if motion >= MotionModel::Affine { "" } else { ", --motion affine" };
            write!(
                f,
                "the outlines change their shape in ways that no {motion} motion does: the object may bend, the camera look at it \
                 from aside (--rectify{wider}), its lens distort it, or light, shadow or motion blur move the edges{}",
                against_light(ground)
            )
        }
    }
}

/// What can still be done against edges that light or shadow moves.
const fn against_light(ground: TracedGround) -> &'static str {
    match ground {
        TracedGround::Unknown => "",
        TracedGround::GreyValues => {
            "; against shadow trace by the difference from the ground (--background), or state how far edges may lie off \
             (--edge-uncertainty)"
        }
        TracedGround::Background => {
            "; the outlines are traced against a background already: state how far edges may lie off (--edge-uncertainty)"
        }
    }
}
