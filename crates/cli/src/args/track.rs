use std::path::PathBuf;

use clap::Args;

use super::identify::{OverlayOption, TrackOptions};
use super::pictures::{PictureOptions, picture_inputs};

const TRACK_EXAMPLES: &str = "\
Examples:
  freeform track outlines.csv
  freeform track frames/ --ring dark --pixel-aspect 1.14
  ffmpeg -loglevel error -i video.mp4 -f yuv4mpegpipe -pix_fmt yuv420p - | freeform track - --background median
  camera-outlines | freeform track --motion rigid | jq .parameters.omega.value

Each line of the output is one JSON object with the fields schema, object, frame, time, phase, accepted, parameters, generator, \
velocity (of the middle of the object), reason (why the frame was not accepted, or null), ambiguity (other turns that explain \
the outlines as well, or null), unstated (the parameters, the velocity and the numbers of the pose that have no value, each with \
why: ambiguous, unobservable or unknown; generator is null where a parameter is), pose and segment. The pose has the names and \
the meaning of the columns of identify --trajectory, rigid angle, x and y, each with value, std, unit and reason; x and y are \
where the mean of the points of the first outline is now. Angles go on beyond half a turn and are counted within a segment: the \
turn between poses of different segments is not known. In a frame that was not accepted the pose is the prediction, if there is \
one. The adaptive method has no pose. The phases are acquiring, tracking and lost for the filter, start and adapt for the \
adaptive method. The last line of an object that was in none of the last 1000 frames has the phase closed; its pose is not \
known, and the object is then forgotten. It has the field warnings. Warnings of objects go to standard error when they have left \
and at the end.

A line is written and flushed as soon as its frame is complete. At the end of the input the exit status is 0, or 1 if no \
frame could be used. If the points of a frame are not an outline, its line has accepted false and the reason. A picture \
without an object gives a warning. A malformed line of CSV ends the command with status 2, after the output for all \
frames before it. Ctrl-C ends the command after the current line.";

/// Identify the motion in a stream: one line of JSON per object and frame, as soon as the frame is complete.
///
/// A frame is complete when the row after it has been read. Memory does not grow with the number of frames.
#[derive(Debug, Args)]
#[command(after_help = TRACK_EXAMPLES, after_long_help = format!("{TRACK_EXAMPLES}\n\n{}", picture_inputs("track")))]
pub(crate) struct TrackArgs {
    /// Outlines as CSV, Parquet or polygons (COCO, labelme, TrackMate), or pictures: files, a folder, a quoted pattern; '-' is
    /// standard input
    #[arg(default_value = "-", value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) options: TrackOptions,

    #[command(flatten)]
    pub(crate) drawings: OverlayOption,

    /// Print only results and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}
