use std::fmt;

use freeform_outline_filter::{Ambiguity, Dynamics, PlaneAmbiguity, StandingEdge, WrongFamily};
use freeform_riccati::MotionModel;

use crate::{
    frame_ranges::FrameRanges,
    number::{of_time, significant},
    picture_tracing::{TracedContours, TracedGround},
    rejection::{
        FrameRejection, write_frames_rejected, write_repeated_frames, write_state_lost, write_too_many_rejected,
    },
    standing_edge::write_standing_edge,
    wrong_family::write_wrong_family,
};

/// Other angular velocities that are named at most.
const MOST_ALIASES: usize = 4;

/// What a user should know of an identified motion: a [`code`](Self::code) for programs, a message for people.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// The points of an outline jump back and forth instead of following the contour.
    PointsOutOfOrder {
        /// The first such frame.
        frame: u64,
        /// Length of the line through the points in their order, over the perimeter of their bounding box.
        perimeters: f64,
    },
    /// The outlines contain no information on these parameters (motion filter).
    NotObservable {
        /// Their names.
        parameters: Vec<&'static str>,
        /// Which contours were traced: others may show them.
        contours: TracedContours,
    },
    /// The outlines show these parameters, but they are not known well enough to be stated (motion filter).
    NotKnown {
        /// Their names.
        parameters: Vec<&'static str>,
    },
    /// The outlines contain no information on these parameters: the lines of a round outline do not turn with it (adaptive method).
    RotationNotObservable {
        /// Their names.
        parameters: Vec<&'static str>,
    },
    /// The outline does not show the rotation that is stated; the path of the object tells it, as `--dynamics generator` asks for. It is right
    /// only if the object turns with its path (motion filter).
    RotationFromPath,
    /// The object was not seen in the last frames.
    Lost {
        /// Time in seconds of the last frame in which it was followed, if a motion was found.
        last_known: Option<f64>,
    },
    /// The object was searched for in the last frames, or begun anew by them, and its motion is not known again yet: it is the last one known.
    Reacquiring {
        /// Time in seconds of the last frame that was used while the motion was known.
        last_known: f64,
    },
    /// The motion is that between two frames, and either how the pictures were traced is in doubt or other frames were rejected: no third frame tells
    /// whether both show one object.
    OfTwoFrames,
    /// The object was given up, and the filter started again with a new one.
    Restarted {
        /// Number of restarts.
        times: usize,
    },
    /// A considerable share of the frames was not used.
    FramesRejected {
        /// How many.
        rejected: usize,
        /// Out of this many.
        frames: usize,
    },
    /// Frames repeat the one before them at regular intervals, as where the rate of a video was raised.
    RepeatedFrames {
        /// One in so many does.
        every: u64,
        /// Frames per second, with the repeated ones.
        rate: f64,
    },
    /// Another turn from one frame to the next explains the outlines equally well.
    Ambiguous(Ambiguity),
    /// A second motion of a plane in space explains the outlines about as well.
    TwoPlanes(Box<PlaneAmbiguity>),
    /// The plane hardly moves, but for a turn about the camera, which all planes show alike.
    PlaneHardlyMoves {
        /// Names of what is not known for it.
        parameters: Vec<&'static str>,
    },
    /// The outlines lie further from where a constant motion of a plane puts them than their noise.
    PlaneMisfit {
        /// Mean square of their distances over what is expected.
        excess: f64,
    },
    /// The motion changed; the estimate is the motion at the end.
    MotionChanged {
        /// How it goes on at the end, where that is told.
        dynamics: Option<Dynamics>,
    },
    /// Too many frames were rejected for the others to be trusted: nothing is stated.
    TooManyRejected {
        /// Frames rejected since the object was begun with.
        rejected: usize,
        /// All of them.
        frames: usize,
    },
    /// The outlines move in ways that the motion model does not have. Standard deviations are widened by what that may do.
    WrongFamily {
        /// The ways.
        family: WrongFamily,
        /// The model.
        motion: MotionModel,
        /// How objects were told from the ground, which decides what may help.
        ground: TracedGround,
    },
    /// A straight part of the outline stood still, or moved slowly, while one rigid motion explained the rest: it is left out.
    StandingEdge(StandingEdge),
    /// A part of the outline did not move with the rest, whose motion is stated.
    PartDisagrees {
        /// Mean share of the points of a frame that lie off the known outline together with their neighbours, 0.08 to 1.
        share: f64,
    },
    /// Other angular velocities explain the outlines as well.
    Aliases {
        /// These, in rad/s, nearest to zero first.
        omega: Vec<f64>,
        /// The model: where it has no omega, these are mean angular velocities (a2 - a3) / 2.
        motion: MotionModel,
    },
    /// The method diverged, and its numbers are not finite.
    Diverged,
    /// What was known of the object cannot be had back from the file that it rested in.
    StateLost {
        /// Why.
        reason: String,
    },
    /// One of the first frames that were not used.
    FrameRejected(FrameRejection),
    /// Further frames that were not used, beyond those reported with their reasons.
    MoreFramesRejected {
        /// How many.
        count: usize,
        /// Their numbers.
        frames: FrameRanges,
    },
    /// In many frames the pairs of lines could not be matched reliably (adaptive method).
    AmbiguousCorrespondence {
        /// How many.
        ambiguous: usize,
        /// Out of this many.
        matched: usize,
    },
    /// The run is shorter than the adaptive law needs, or its parameters still drift.
    MayNotHaveSettled {
        /// Length of the run in seconds.
        seconds: f64,
    },
    /// The outline turned too far from frame to frame (adaptive method).
    LinesNotFollowed {
        /// Number of intervals between frames over which the lines were not followed.
        skipped: usize,
        /// Out of this many.
        intervals: usize,
    },
    /// The parameters of an affine motion are biased (adaptive method).
    AffineBias,
}

impl Warning {
    /// Rank by importance: what makes a result worthless first, single frames last.
    pub(crate) const fn order(&self) -> u8 {
        match self {
            Self::PointsOutOfOrder { .. } | Self::Diverged | Self::StateLost { .. } => 0,
            Self::TooManyRejected { .. } | Self::Lost { .. } | Self::Reacquiring { .. } => 1,
            Self::OfTwoFrames | Self::Ambiguous(_) | Self::TwoPlanes(_) | Self::AmbiguousCorrespondence { .. } => 2,
            Self::WrongFamily { .. }
            | Self::PlaneMisfit { .. }
            | Self::AffineBias
            | Self::StandingEdge(_)
            | Self::PartDisagrees { .. } => 3,
            Self::Aliases { .. } | Self::RotationFromPath => 4,
            Self::NotObservable { .. }
            | Self::NotKnown { .. }
            | Self::PlaneHardlyMoves { .. }
            | Self::RotationNotObservable { .. } => 5,
            Self::Restarted { .. }
            | Self::FramesRejected { .. }
            | Self::RepeatedFrames { .. }
            | Self::MayNotHaveSettled { .. }
            | Self::LinesNotFollowed { .. } => 6,
            Self::MotionChanged { .. } => 7,
            Self::FrameRejected(_) | Self::MoreFramesRejected { .. } => 8,
        }
    }

    /// A stable name, the same in every version.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::PointsOutOfOrder { .. } => "points_out_of_order",
            Self::NotObservable { .. } => "not_observable",
            Self::NotKnown { .. } => "not_known",
            Self::RotationNotObservable { .. } => "rotation_not_observable",
            Self::RotationFromPath => "rotation_from_path",
            Self::Lost { .. } => "lost",
            Self::Reacquiring { .. } => "reacquiring",
            Self::OfTwoFrames => "of_two_frames",
            Self::Restarted { .. } => "restarted",
            Self::FramesRejected { .. } => "frames_rejected",
            Self::RepeatedFrames { .. } => "repeated_frames",
            Self::Ambiguous(_) => "ambiguous",
            Self::MotionChanged { .. } => "motion_changed",
            Self::TwoPlanes(_) => "two_planes",
            Self::PlaneHardlyMoves { .. } => "plane_hardly_moves",
            Self::PlaneMisfit { .. } => "plane_misfit",
            Self::TooManyRejected { .. } => "too_many_rejected",
            Self::WrongFamily { family: WrongFamily::Growth, .. } => "wrong_family_growth",
            Self::WrongFamily { family: WrongFamily::Shear, .. } => "wrong_family_shear",
            Self::WrongFamily { family: WrongFamily::Perspective, .. } => "wrong_family_perspective",
            Self::WrongFamily { family: WrongFamily::RollingShutter, .. } => "wrong_family_rolling_shutter",
            Self::WrongFamily { family: WrongFamily::Lens, .. } => "wrong_family_lens",
            Self::WrongFamily { family: WrongFamily::Shape, .. } => "wrong_family_shape",
            Self::StandingEdge(_) => "standing_edge",
            Self::PartDisagrees { .. } => "part_disagrees",
            Self::Aliases { .. } => "aliases",
            Self::Diverged => "diverged",
            Self::StateLost { .. } => "state_lost",
            Self::FrameRejected(_) => "frame_rejected",
            Self::MoreFramesRejected { .. } => "more_frames_rejected",
            Self::AmbiguousCorrespondence { .. } => "ambiguous_correspondence",
            Self::MayNotHaveSettled { .. } => "may_not_have_settled",
            Self::LinesNotFollowed { .. } => "lines_not_followed",
            Self::AffineBias => "affine_bias",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PointsOutOfOrder { frame, perimeters } => write_out_of_order(f, *frame, *perimeters),
            Self::NotObservable { parameters, contours } => write_not_observable(f, parameters, *contours),
            Self::NotKnown { parameters } => {
                write!(f, "not known well enough at the end to be stated: {}", parameters.join(", "))
            }
            Self::RotationNotObservable { parameters } => {
                write!(f, "rotation is not observable from these outlines; unknown: {}", parameters.join(", "))
            }
            Self::RotationFromPath => f.write_str(ROTATION_FROM_PATH),
            Self::Lost { last_known } => write_lost(f, *last_known),
            Self::Reacquiring { last_known } => write_reacquiring(f, *last_known),
            Self::OfTwoFrames => f.write_str(OF_TWO_FRAMES),
            Self::Restarted { times } => write!(f, "the object was given up and started again {times} time(s)"),
            Self::FramesRejected { rejected, frames } => write_frames_rejected(f, *rejected, *frames),
            Self::RepeatedFrames { every, rate } => write_repeated_frames(f, *every, *rate),
            Self::Ambiguous(ambiguity) => write_ambiguity(f, ambiguity),
            Self::MotionChanged { dynamics } => write_change(f, *dynamics),
            Self::TwoPlanes(ambiguity) => write_two_planes(f, ambiguity),
            Self::PlaneHardlyMoves { parameters } => {
                let unknown = parameters.join(", ");
                write!(f, "the plane hardly moves along, and a turn alone tells of no plane; unknown: {unknown}")
            }
            Self::PlaneMisfit { excess } => write_plane_misfit(f, *excess),
            Self::TooManyRejected { rejected, frames } => write_too_many_rejected(f, *rejected, *frames),
            Self::WrongFamily { family, motion, ground } => write_wrong_family(f, *family, *motion, *ground),
            Self::StandingEdge(edge) => write_standing_edge(f, edge),
            Self::PartDisagrees { share } => write_part(f, *share),
            Self::Aliases { omega, motion } => write_aliases(f, omega, *motion),
            Self::Diverged => f.write_str("the identifier diverged: its numbers are not finite"),
            Self::StateLost { reason } => write_state_lost(f, reason),
            Self::FrameRejected(rejection) => write!(f, "rejected: {rejection}"),
            Self::MoreFramesRejected { count, frames } => write!(f, "rejected: {count} more frame(s), {frames}"),
            Self::AmbiguousCorrespondence { ambiguous, matched } => write_ambiguous_lines(f, *ambiguous, *matched),
            Self::MayNotHaveSettled { seconds } => {
                write!(f, "the adaptive law may not have settled after {seconds:.1} s")
            }
            Self::LinesNotFollowed { skipped, intervals } => write_lines_not_followed(f, *skipped, *intervals),
            Self::AffineBias => f.write_str(AFFINE_BIAS),
        }
    }
}

fn write_not_observable(
    f: &mut fmt::Formatter<'_>,
    parameters: &[&'static str],
    contours: TracedContours,
) -> fmt::Result {
    let advice = match contours {
        TracedContours::AllKnown => "",
        TracedContours::BoundaryAlone => "; holes or marks within the object may show it: --contours all",
    };
    write!(f, "not observable from these outlines: {}{advice}", parameters.join(", "))
}

fn write_part(f: &mut fmt::Formatter<'_>, share: f64) -> fmt::Result {
    let percent = 100.0 * share;
    write!(
        f,
        "{percent:.0} % of the points lie off the outline side by side, in the mean of the frames: a part moves by itself or bends, two objects are \
         seen as one, or something covers it; the motion is that of the rest"
    )
}

const OF_TWO_FRAMES: &str = "its motion is that between two frames: no third frame tells whether both show one object";

const ROTATION_FROM_PATH: &str = "the outline does not show its rotation: omega is told by the path alone, and right only if the object \
                                  turns with its path";

const AFFINE_BIAS: &str =
    "the six parameters are biased, because the curve fit is not affine-equivariant: use the motion filter";

fn write_out_of_order(f: &mut fmt::Formatter<'_>, frame: u64, perimeters: f64) -> fmt::Result {
    write!(
        f,
        "frame {frame}: the points do not follow the contour: a line through them in the order of the rows is {} times \
         as long as the perimeter of their bounding box; sort the rows along the contour",
        significant(perimeters, 2)
    )
}

fn write_lost(f: &mut fmt::Formatter<'_>, last_known: Option<f64>) -> fmt::Result {
    f.write_str("the object was lost at the end")?;
    let Some(time) = last_known.map(of_time) else { return Ok(()) };
    write!(f, "; it was followed until {time} s: trajectory and trace have its last poses and motion")
}

fn write_reacquiring(f: &mut fmt::Formatter<'_>, last_known: f64) -> fmt::Result {
    let last_known = of_time(last_known);
    write!(
        f,
        "the object is searched for or begun anew at the end, and its motion is not known again yet; it was last known at {last_known} s"
    )
}

fn write_change(f: &mut fmt::Formatter<'_>, dynamics: Option<Dynamics>) -> fmt::Result {
    let is_of_middle = dynamics == Some(Dynamics::Velocity);
    let what = if is_of_middle { "b changes, as the object turns about no fixed point" } else { "the motion changed" };
    write!(f, "{what}: the values are those at the end; trajectory and trace have them over time")
}

fn write_two_planes(f: &mut fmt::Formatter<'_>, ambiguity: &PlaneAmbiguity) -> fmt::Result {
    let [first, second] = [0, 1].map(|i| significant(ambiguity.solutions[i].probability, 2));
    let parameters = ambiguity.parameters.join(", ");
    write!(
        f,
        "two motions of a plane explain the outlines, with probabilities {first} and {second}; they differ in {parameters}"
    )
}

fn write_plane_misfit(f: &mut fmt::Formatter<'_>, excess: f64) -> fmt::Result {
    write!(
        f,
        "the outlines are not where a plane of constant angular velocity and velocity would be seen (mean square {} of \
         what is expected): the motion may change, or --focal or --principal be wrong; deviations are widened",
        significant(excess, 2)
    )
}

fn write_aliases(f: &mut fmt::Formatter<'_>, omega: &[f64], motion: MotionModel) -> fmt::Result {
    let list: Vec<String> = omega.iter().take(MOST_ALIASES).map(|omega| significant(*omega, 4)).collect();
    write!(
        f,
        "the outline has a symmetry: {} may also be {} rad/s, and what depends on it differs then; the smallest turn from \
         frame to frame was taken",
        if motion.parameter_names().contains(&"omega") { "omega" } else { "the mean angular velocity (a2 - a3) / 2" },
        list.join(" or ")
    )
}

fn write_ambiguous_lines(f: &mut fmt::Formatter<'_>, ambiguous: usize, matched: usize) -> fmt::Result {
    write!(
        f,
        "lines matched ambiguously in {ambiguous} of {matched} frames: \
         the turn between frames is large or the outline nearly symmetric"
    )
}

fn write_lines_not_followed(f: &mut fmt::Formatter<'_>, skipped: usize, intervals: usize) -> fmt::Result {
    write!(
        f,
        "lines not followed over {skipped} of {intervals} intervals between frames: \
         the outline turns by more than about half a radian"
    )
}

/// Turns in degrees, positive in the direction of a positive omega.
fn write_ambiguity(f: &mut fmt::Formatter<'_>, ambiguity: &Ambiguity) -> fmt::Result {
    let as_omega = |anticlockwise: f64| -anticlockwise.to_degrees();
    let rivals: Vec<String> = ambiguity.rival_turns.iter().map(|turn| format!("{:.1}", as_omega(*turn))).collect();
    write!(
        f,
        "ambiguous: another turn explains the outlines equally well: {} instead of {:.1} degrees from one frame to the next",
        rivals.join(" or "),
        as_omega(ambiguity.turn)
    )
}
