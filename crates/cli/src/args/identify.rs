use std::ffi::OsStr;
use std::path::PathBuf;

use clap::builder::{EnumValueParser, PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Args, Command, ValueEnum};
use freeform_motion::TrackerSettings;
use freeform_motion::curve_fit::{Degree, FitSettings};
use freeform_motion::riccati::{AffineMotion, CameraScale, MotionModel};
use freeform_motion::tracker::{Method, MethodSettings};

use super::pictures::{PictureOptions, picture_inputs};
use super::values::{camera_scale, degree, motion};

const EXAMPLES: &str = "\
Examples:
  freeform identify outlines.csv
  freeform identify outlines.csv --scale 0.1 --trace trace.csv --report report.html
  freeform simulate --seconds 5 | freeform identify - --format json
  freeform identify 'frames/*.jpg' --ring dark --fps 15 --overlay drawn
  freeform identify outlines.csv --trajectory poses.csv --smooth
  freeform identify outlines.csv --motion affine --svg parameters.svg --truth 0,1,-1,0,2,0

INPUT has a header frame,time,x,y and optional columns object and arc. Rows of one outline follow each other along the \
contour. Where it begins with the comment lines of 'freeform simulate', the truth in them is shown beside \
the result.";

/// Identify the motion of every object in a sequence of outlines.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("identify")))]
pub(crate) struct IdentifyArgs {
    /// Outlines as CSV, or pictures: files, a folder, a quoted pattern; '-' is standard input
    #[arg(required = true, value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) options: TrackOptions,

    /// The true parameters (OMEGA,B1,B2 or SIGMA,OMEGA,B1,B2 or A1,...,A4,B1,B2), as they should be printed
    ///
    /// Shown beside the result and in figures; takes no part in the identification.
    #[arg(long, value_name = "LIST", value_parser = motion, allow_hyphen_values = true)]
    pub(crate) truth: Option<AffineMotion>,

    /// How the result is printed
    #[arg(long, value_enum, default_value_t = IdentifyFormat::Table)]
    pub(crate) format: IdentifyFormat,

    /// The same as --format json
    #[arg(long, conflicts_with = "format")]
    pub(crate) json: bool,

    /// Write one row per frame with the parameters as identified so far
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) trace: Option<PathBuf>,

    /// Write one row per object and frame with its pose and motion, and their standard deviations
    ///
    /// The pose is told since the first frame: rigid, angle (rad, positive where omega is), x and y, where the middle of the
    /// points of the first outline is now; similarity, scale before them; affine, the matrix m11, m12, m21, m22, x and y. Empty
    /// where the motion is not known: in the first frame, in one that the object was found again in, while it is lost, and in a
    /// frame that is no outline; in frames rejected while it is followed, where it is predicted to be. Not with the adaptive method.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) trajectory: Option<PathBuf>,

    /// Let all frames, also later ones, take part in every row of the trajectory
    #[arg(long, requires = "trajectory")]
    pub(crate) smooth: bool,

    /// Draw the parameters against time
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    /// Write a self-contained report
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,

    /// Draw outline, fitted curve, related points and motion on every picture: a folder for PNG files, or FILE.gif
    ///
    /// Drawings of an earlier run are removed from the folder; a folder with pictures of the same names that freeform has not
    /// drawn is refused.
    #[arg(long, value_name = "DIR|FILE.gif")]
    pub(crate) overlay: Option<PathBuf>,

    /// Say nothing but errors beside the result
    #[arg(long, short)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}

const TRACK_EXAMPLES: &str = "\
Examples:
  freeform track outlines.csv
  freeform track frames/ --ring dark --pixel-aspect 1.14
  ffmpeg -loglevel error -i video.mp4 -f yuv4mpegpipe -pix_fmt yuv420p - | freeform track - --background median
  camera-outlines | freeform track --motion rigid | jq .parameters.omega.value

Each line of the output is one JSON object with the fields object, frame, time, phase, accepted, parameters, \
generator and reason (why the frame was not accepted, else null). Phases of the filter: acquiring, \
tracking, lost; of the adaptive method: start, adapt.

A line is written and flushed as soon as its frame is complete. At the end of the input the command ends with status 0, \
or 1 if no frame could be used. A frame that is no outline gives a line with accepted false and its reason, and a picture \
without an object a warning; a line of CSV that does not follow the format ends the command with status 2 after all lines \
before it. Ctrl-C ends it after the line being written.";

/// Identify as a stream: one line of JSON per object and frame as soon as the frame is complete.
///
/// A frame is complete when the row after it has been read. Memory does not grow with the number of frames.
#[derive(Debug, Args)]
#[command(after_help = TRACK_EXAMPLES, after_long_help = format!("{TRACK_EXAMPLES}\n\n{}", picture_inputs("track")))]
pub(crate) struct TrackArgs {
    /// Outlines as CSV, or pictures: files, a folder, a quoted pattern; '-' is standard input
    #[arg(default_value = "-", value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) options: TrackOptions,

    /// Draw outline, fitted curve, related points and motion on every picture: a folder for PNG files, or FILE.gif
    ///
    /// Drawings of an earlier run are removed from the folder; a folder with pictures of the same names that freeform has not
    /// drawn is refused.
    #[arg(long, value_name = "DIR|FILE.gif")]
    pub(crate) overlay: Option<PathBuf>,

    /// Say nothing but errors
    #[arg(long, short)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,
}

/// What is identified and how.
#[derive(Debug, Clone, Args)]
pub(crate) struct TrackOptions {
    /// Family of motions
    #[arg(long, value_enum, default_value_t = MotionChoice::Rigid)]
    pub(crate) motion: MotionChoice,

    /// How the motion is identified
    #[arg(long, value_parser = MethodParser, default_value = "filter")]
    pub(crate) method: IdentifyMethod,

    /// Degree of the fitted polynomial: 2, 4, 6 or 8; the filter fits none [default: 4]
    #[arg(long, value_name = "N", value_parser = degree)]
    pub(crate) degree: Option<Degree>,

    /// Camera scale f/Z0: b is divided by it, so that it is the velocity in space
    #[arg(long, value_name = "F_OVER_Z0", value_parser = camera_scale)]
    pub(crate) scale: Option<CameraScale>,
}

impl TrackOptions {
    /// What they ask of a tracker.
    pub(crate) fn tracker_settings(&self) -> TrackerSettings {
        let settings = TrackerSettings::new(self.method.into(), self.motion.model());
        let method = match (settings.method, self.degree) {
            (MethodSettings::Adaptive(mut settings), Some(degree)) => {
                settings.fit.degree = degree;
                MethodSettings::Adaptive(settings)
            }
            (method, _) => method,
        };
        TrackerSettings { method, scale: self.scale }
    }

    /// Degree of the curve that is drawn where the method fits none.
    pub(crate) fn degree_drawn(&self) -> Degree {
        self.degree.unwrap_or(FitSettings::default().degree)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MotionChoice {
    /// omega, b1, b2
    Rigid,
    /// sigma, omega, b1, b2
    Similarity,
    /// a1, a2, a3, a4, b1, b2
    Affine,
}

impl MotionChoice {
    pub(crate) const fn model(self) -> MotionModel {
        match self {
            Self::Rigid => MotionModel::Rigid,
            Self::Similarity => MotionModel::Similarity,
            Self::Affine => MotionModel::Affine,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum IdentifyMethod {
    /// Outline, pose and motion estimated together, with standard deviations
    Filter,
    /// The paper's adaptive identifier on the lines of the fitted curve
    Adaptive,
}

impl From<IdentifyMethod> for Method {
    fn from(method: IdentifyMethod) -> Self {
        match method {
            IdentifyMethod::Filter => Self::Filter,
            IdentifyMethod::Adaptive => Self::Adaptive,
        }
    }
}

/// Reads a method, and says of the one that was retired what takes its place.
#[derive(Debug, Clone)]
struct MethodParser;

impl TypedValueParser for MethodParser {
    type Value = IdentifyMethod;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<IdentifyMethod, clap::Error> {
        if value == "curve" {
            let text = "--method curve: the whole-curve filter was retired; take --method filter (the default), which \
                        is nearer to the bound in every setting\n";
            return Err(clap::Error::raw(ErrorKind::InvalidValue, text));
        }
        EnumValueParser::new().parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(IdentifyMethod::value_variants().iter().filter_map(ValueEnum::to_possible_value)))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum IdentifyFormat {
    /// For reading
    Table,
    /// One JSON object, schema freeform.identify/1
    Json,
    /// One row per object and parameter
    Csv,
}
