use std::ffi::OsStr;
use std::path::PathBuf;

use clap::builder::{EnumValueParser, PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Args, Command, ValueEnum};
use freeform_motion::curve_fit::{Degree, FitSettings};
use freeform_motion::outline_filter::{Dynamics, FilterSettings};
use freeform_motion::outline_io::OutlineUncertainty;
use freeform_motion::riccati::{CameraScale, MotionModel, ProjectiveMotion};
use freeform_motion::tracker::{Method, MethodSettings, MotionFamily};
use freeform_motion::{Rectification, TrackerSettings};

use super::law::LawOptions;
use super::pictures::{PictureOptions, picture_inputs};
use super::space::PerspectiveArgs;
use super::values::{GivenRectification, camera_scale, degree, length, motion, rectification};
use crate::failure::Failure;

const EXAMPLES: &str = "\
Examples:
  freeform identify outlines.csv
  freeform identify outlines.csv --scale 0.1 --trace trace.csv --report report.html
  freeform simulate --seconds 5 | freeform identify - --format json
  freeform identify 'frames/*.jpg' --ring dark --fps 15 --overlay drawn
  freeform identify outlines.csv --trajectory poses.csv --smooth
  freeform identify frames/ --rectify plane.txt
  freeform identify outlines.csv --motion affine --svg parameters.svg --truth 0,1,-1,0,2,0

A CSV file has a header frame,time,x,y and optional columns object, arc (open pieces of a partly hidden outline), contour (several closed contours \
of one body, as holes) and deviation (how well a point is known). The rows of an outline follow the contour. \
If the file begins with the comment lines of 'freeform simulate', the true motion in them is printed next to the result.

If a row of CSV cannot be read, its line is named on standard error, the result is that of the frames before it, and the exit status is 2. The \
result itself, also as JSON, does not say that the input was cut.";

/// Identify the motion of every object in a sequence of outlines.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", picture_inputs("identify")))]
pub(crate) struct IdentifyArgs {
    /// Outlines as CSV, Parquet or polygons (COCO, labelme, TrackMate), or pictures: files, a folder, a quoted pattern; '-' is
    /// standard input
    #[arg(required = true, value_name = "INPUT")]
    pub(crate) inputs: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) options: TrackOptions,

    /// The true parameters (OMEGA,B1,B2 or SIGMA,OMEGA,B1,B2 or A1,...,A4,B1,B2 or A1,...,B2,C1,C2), in the units of the
    /// result
    ///
    /// They are shown next to the result and in figures, and are not used in the identification.
    #[arg(long, value_name = "LIST", value_parser = motion, allow_hyphen_values = true)]
    pub(crate) truth: Option<ProjectiveMotion>,

    /// Format of the result
    #[arg(long, value_enum, default_value_t = IdentifyFormat::Table)]
    pub(crate) format: IdentifyFormat,

    /// Short for --format json
    #[arg(long, conflicts_with = "format")]
    pub(crate) json: bool,

    /// Write one row per frame with the parameters identified up to that frame
    ///
    /// With the filter v1 and v2 are the velocity of the middle of the object, point_x and point_y where that is. The column reason says why a
    /// frame was not accepted, unstated which values are empty and why, as in 'omega ambiguous; b1 ambiguous': ambiguous, unobservable or
    /// unknown.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) trace: Option<PathBuf>,

    /// Write one row per object and frame with its pose and motion, and their standard deviations
    ///
    /// The pose is relative to the first frame. Rigid: angle (rad, positive if omega is), x and y, the present position of the mean of the
    /// points of the first outline. Similarity: scale, then these. Affine: the matrix m11, m12, m21, m22, then x and y; projective also m31
    /// and m32, and the matrix has that mean for origin and m33 = 1. What the outline does not show is empty. All fields are empty if the
    /// motion is not known: in the first frame, in a frame where a lost object is found again, while it is lost, and in a frame that is not
    /// an outline. While two turns explain the outlines the angle is empty, and so is the matrix, unless they are whole turns apart and it
    /// is the same for both. In a rejected frame the fields are the prediction. The column segment is a number that is counted up from 0
    /// where poses get another reference: the object was begun anew, the second frame shows far more of it than the first, its turn is shown
    /// for the first time, another of several turns is taken, or an edge proves not to be of it. Angles go on beyond half a turn and are
    /// counted within a segment: the turn between poses of different segments is not known. v1 and v2 are the velocity of the middle of the
    /// object. The column reason says why a frame was not accepted, unstated which values are empty and why, as in --trace. point_x and
    /// point_y are where that middle is, the point of the object that v1 and v2 belong to: the centroid of what is known of its outline, or
    /// the point nearby whose motion the outline shows where it does not show that of the centroid, as the centre of a disc of which half is
    /// seen. It need not be at x, y. aliases are other angular velocities (rad/s) that explain the outlines as well, as in '-4.71; 7.85'.
    /// Not available with the adaptive method.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) trajectory: Option<PathBuf>,

    /// Estimate every row of the trajectory from all frames, also later ones
    ///
    /// A motion that was not seen to change is taken for constant: all rows have the same, also the first. Where it was, what was expected of each
    /// frame says how much the frames after it tell of those before; of a sudden change they tell nothing of what was before.
    #[arg(long, requires = "trajectory")]
    pub(crate) smooth: bool,

    /// Draw the parameters against time
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,

    /// Write a self-contained report as HTML
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) drawings: OverlayOption,

    /// Print only the result and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,

    #[command(flatten)]
    pub(crate) pictures: PictureOptions,

    #[command(flatten)]
    pub(crate) law: LawOptions,
}

impl IdentifyArgs {
    /// The settings of a tracker with all options, for outlines that may lie off as pictures say.
    pub(crate) fn tracker_settings(&self, by_pictures: Option<OutlineUncertainty>) -> Result<TrackerSettings, Failure> {
        let mut settings = match by_pictures {
            Some(error) => self.options.tracker_settings_for(error),
            None => self.options.tracker_settings(),
        };
        match (&mut settings.method, &self.law.given()[..]) {
            (MethodSettings::Adaptive(adaptive), _) => self.law.apply(adaptive, self.options.scale)?,
            (_, []) => {}
            (_, given) => {
                let options = given.join(", ");
                return Err(Failure::unusable(format_args!("{options}: only for --method adaptive")));
            }
        }
        Ok(settings)
    }
}

/// Where the pictures go that are drawn on those of the input.
#[derive(Debug, Clone, Args)]
pub(crate) struct OverlayOption {
    /// Draw outlines and motion on every picture: a folder for PNG files, FILE.gif, or FILE.y4m (uncompressed video, which ffmpeg
    /// and others read)
    ///
    /// Yellow is the outline as it was traced, red one that was not used. Blue is the outline that the filter knows, where it takes the object
    /// to be; it lies below the yellow one and shows where this is hidden or elsewhere. With --method adaptive blue is the fitted curve, and
    /// pink crosses are its related points. Green arrows are the displacements of points of the outline in the time that is written below
    /// the object, the longest a third of the object long. There are none while the motion is not known.
    ///
    /// Drawings of an earlier run are removed from the folder. The folder is refused if it contains pictures with the names of
    /// drawings that freeform did not draw.
    #[arg(long, value_name = "DIR|FILE.gif|FILE.y4m")]
    pub(crate) overlay: Option<PathBuf>,
}

/// Options of the identification, shared by several commands.
#[derive(Debug, Clone, Args)]
pub(crate) struct TrackOptions {
    /// Family of motions to identify
    #[arg(long, value_enum, default_value_t = MotionChoice::Rigid)]
    pub(crate) motion: MotionChoice,

    #[command(flatten)]
    pub(crate) perspective: PerspectiveArgs,

    /// How the motion is identified
    #[arg(long, value_parser = MethodParser, default_value = "filter")]
    pub(crate) method: IdentifyMethod,

    /// Degree of the fitted polynomial: 2, 4, 6 or 8; not used by the filter [default: 4]
    #[arg(long, value_name = "N", value_parser = degree)]
    pub(crate) degree: Option<Degree>,

    /// Camera scale f/Z0; b is divided by it, which gives the velocity in space
    #[arg(long, value_name = "F_OVER_Z0", value_parser = camera_scale)]
    pub(crate) scale: Option<CameraScale>,

    /// Map from the picture to the plane that the objects move in: nine numbers, row by row, or a file of them
    ///
    /// For a camera that looks at a table or a floor from aside. A rigid motion in the plane then has its three parameters, in the
    /// unit of the plane. 'freeform rectify' finds the map from four points, or from a known outline.
    #[arg(long, value_name = "FILE|H11,...,H33", value_parser = rectification, allow_hyphen_values = true,
          conflicts_with = "scale")]
    pub(crate) rectify: Option<GivenRectification>,

    /// What is assumed of how the motion goes on from frame to frame; not used by the adaptive method, nor for a plane in
    /// space
    ///
    /// With 'auto', the three others are followed side by side and weighted by their probabilities. With 'generator', the path of an
    /// object tells its turn also if its outline does not, as for a disc on a turntable.
    #[arg(long, value_enum, default_value_t = DynamicsChoice::Auto)]
    pub(crate) dynamics: DynamicsChoice,

    /// How far a side of the outline may lie off in all frames, such as by a shadow, in the unit of the outlines, or of the
    /// plane with --rectify [default: 0 for CSV, of pictures what their edges tell]
    ///
    /// It widens the standard deviations. The part that comes from it is also given by itself, as std_systematic.
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) edge_uncertainty: Option<f64>,

    /// Size of a pixel of the two-valued masks that the outlines come from, in the unit of the outlines
    /// [default: of pictures that are masks the size of their pixels, unless --edge-uncertainty is given; else found from the points]
    ///
    /// The rounding of an outline to pixels stays the same while the object moves by less than a pixel. It widens the standard
    /// deviations, the less the farther the object has moved.
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) mask_pixel: Option<f64>,
}

impl TrackOptions {
    /// The settings of a tracker with these options.
    pub(crate) fn tracker_settings(&self) -> TrackerSettings {
        if let Some(camera) = self.perspective.camera().filter(|_| self.motion == MotionChoice::Plane) {
            return TrackerSettings::of_plane(camera);
        }
        let settings = TrackerSettings::new(self.method.into(), self.motion.model());
        let method = match (settings.method, self.degree) {
            (MethodSettings::Adaptive(mut settings), Some(degree)) => {
                settings.fit.degree = degree;
                MethodSettings::Adaptive(settings)
            }
            (MethodSettings::Filter(settings), _) => MethodSettings::Filter(FilterSettings {
                dynamics: self.dynamics.into(),
                edge_uncertainty: self.edge_uncertainty.unwrap_or(0.0),
                mask_pixel: self.mask_pixel.unwrap_or(0.0),
                ..settings
            }),
            (method, _) => method,
        };
        TrackerSettings { method, scale: self.scale, rectification: self.rectification() }
    }

    /// The map to the plane that the objects move in.
    pub(crate) fn rectification(&self) -> Option<Rectification> {
        self.rectify.as_ref().map(|given| given.map)
    }

    /// Whether they say how the camera looks at the plane that the objects move in.
    pub(crate) fn allows_for_tilt(&self) -> bool {
        self.rectify.is_some() || self.motion == MotionChoice::Plane
    }

    /// All that is read with these options: that of `pictures`, and the file of that map, where it is one.
    pub(crate) fn files_read(&self, pictures: &PictureOptions, inputs: &[PathBuf]) -> Vec<PathBuf> {
        let of_map = self.rectify.as_ref().and_then(|given| given.file.clone());
        pictures.files_read(inputs).into_iter().chain(of_map).collect()
    }

    /// Settings of the tracker for outlines whose edges are as uncertain as pictures say, in the unit of the pictures. Options that are given
    /// go before it, and so does another plane, whose unit is another.
    pub(crate) fn tracker_settings_for(&self, by_pictures: OutlineUncertainty) -> TrackerSettings {
        let mut options = self.clone();
        if self.edge_uncertainty.is_none() && self.mask_pixel.is_none() && self.rectify.is_none() {
            match by_pictures {
                OutlineUncertainty::Edges(length) => options.edge_uncertainty = Some(length),
                OutlineUncertainty::MaskPixel(length) => options.mask_pixel = Some(length),
            }
        }
        options.tracker_settings()
    }

    /// Refuses options that cannot be combined with the motion.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let is_plane = self.motion == MotionChoice::Plane;
        self.perspective.check(is_plane)?;
        let others = [
            ("--method adaptive", self.method == IdentifyMethod::Adaptive),
            ("--scale", self.scale.is_some()),
            ("--rectify", self.rectify.is_some()),
            ("--edge-uncertainty", self.edge_uncertainty.is_some()),
            ("--mask-pixel", self.mask_pixel.is_some()),
        ];
        match others.into_iter().find(|(_, is_given)| is_plane && *is_given) {
            Some((option, _)) => {
                Err(Failure::unusable(format_args!("{option} cannot be combined with --motion plane")))
            }
            None => Ok(()),
        }
    }

    /// Degree of the curve that is drawn if the method fits none.
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
    /// a1, a2, a3, a4, b1, b2, c1, c2
    Projective,
    /// wx, wy, wz, vx, vy, vz: a plane that moves in space, before a camera given by --focal and --principal
    Plane,
}

impl MotionChoice {
    /// The family of motions that is identified.
    pub(crate) const fn family(self) -> MotionFamily {
        match self {
            Self::Plane => MotionFamily::Plane,
            _ => MotionFamily::Picture(self.model()),
        }
    }

    /// The motion model of the picture.
    pub(crate) const fn model(self) -> MotionModel {
        match self {
            Self::Rigid => MotionModel::Rigid,
            Self::Similarity => MotionModel::Similarity,
            Self::Affine => MotionModel::Affine,
            Self::Projective | Self::Plane => MotionModel::Projective,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DynamicsChoice {
    /// The three below side by side
    Auto,
    /// Constant generator: the velocity of the middle turns with the object
    Generator,
    /// Constant angular velocity, and a constant velocity of the middle
    Velocity,
    /// Nearly constant accelerations
    Accelerating,
}

impl From<DynamicsChoice> for Dynamics {
    fn from(choice: DynamicsChoice) -> Self {
        match choice {
            DynamicsChoice::Auto => Self::Auto,
            DynamicsChoice::Generator => Self::Generator,
            DynamicsChoice::Velocity => Self::Velocity,
            DynamicsChoice::Accelerating => Self::Accelerating,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum IdentifyMethod {
    /// The motion filter: outline, pose and motion estimated together, with standard deviations
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

/// Reads a method. For the method that was removed, the error names its replacement.
#[derive(Debug, Clone)]
struct MethodParser;

impl TypedValueParser for MethodParser {
    type Value = IdentifyMethod;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<IdentifyMethod, clap::Error> {
        if value == "curve" {
            let text = "--method curve: the whole-curve filter was removed; use --method filter (the default), which \
                        is more accurate in every setting\n";
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
    /// One JSON object, schema freeform.identify/2
    Json,
    /// One row per object and parameter
    Csv,
}
