use std::path::PathBuf;

use clap::{Args, ValueEnum};
use freeform_motion::outline_io::{Channel, Contrast, Selection};

use super::values::{not_negative, positive};

/// Smallest object where none is given, in pixels.
const SMALLEST_OBJECT: u64 = 64;

/// What the help of a command that takes pictures says of them.
pub(crate) fn picture_inputs(command: &str) -> String {
    format!(
        "Pictures: PNG, JPEG, TIFF, BMP, animated GIF, uncompressed video (y4m), a folder of pictures or a quoted pattern, in \
         natural order (frame-9 before frame-10). Any other video comes through a pipe:\n  {}\nA picture that cannot be read, \
         has another size than the first, or shows no object is named in a warning and left out.",
        through_ffmpeg("video.mp4", &format!("freeform {command} -"))
    )
}

/// The command that hands on a video which is not read directly to one that reads standard input.
pub(crate) fn through_ffmpeg(video: &str, command: &str) -> String {
    format!("ffmpeg -loglevel error -i {video} -f yuv4mpegpipe -pix_fmt yuv420p - | {command}")
}

/// How outlines are found in pictures.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureOptions {
    /// Frames per second [default: what a video or animation says, else 30]
    #[arg(long, value_parser = positive)]
    pub(crate) fps: Option<f64>,

    /// The object is darker than the ground
    #[arg(long, conflicts_with = "light")]
    pub(crate) dark: bool,

    /// The object is lighter than the ground; the default without a background
    #[arg(long)]
    pub(crate) light: bool,

    /// Grey value that parts object and ground, up to 255 [default: by Otsu's method in each picture]
    #[arg(long, value_name = "LEVEL", value_parser = positive)]
    pub(crate) threshold: Option<f64>,

    /// What is looked at of a colour picture
    #[arg(long, value_enum, default_value_t = ChannelChoice::Luminance)]
    pub(crate) channel: ChannelChoice,

    /// Take what differs from a picture without objects, or from 'median', the median of the latest 25 pictures
    #[arg(long, value_name = "FILE|median", conflicts_with = "ring")]
    pub(crate) background: Option<PathBuf>,

    /// A line around the object tells it from a ground of its own colour; the outline is the line's outer edge
    #[arg(long, value_enum, conflicts_with_all = ["threshold", "dark", "light", "smoothing"])]
    pub(crate) ring: Option<RingChoice>,

    /// Widest line expected around the object, in pixels [default: a sixtieth of the picture's shorter side]
    #[arg(long, value_name = "PIXELS", value_parser = positive, requires = "ring")]
    pub(crate) ring_width: Option<f64>,

    /// Standard deviation of the smoothing in pixels [default: 1 for masks, 0.5 for others]
    #[arg(long, value_name = "PIXELS", value_parser = not_negative)]
    pub(crate) smoothing: Option<f64>,

    /// Smallest object, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = SMALLEST_OBJECT)]
    pub(crate) min_area: u64,

    /// Which objects are taken
    #[arg(long, value_enum, default_value_t = ObjectsChoice::Largest)]
    pub(crate) objects: ObjectsChoice,

    /// Height of a pixel in the length unit wanted
    #[arg(long, value_name = "LENGTH", value_parser = positive, default_value_t = 1.0)]
    pub(crate) pixel_size: f64,

    /// Width of a pixel over its height [default: what a video says, else 1]
    #[arg(long, value_name = "RATIO", value_parser = positive)]
    pub(crate) pixel_aspect: Option<f64>,

    /// y runs upwards from the lower edge of the picture; the default
    #[arg(long, overrides_with = "y_down")]
    pub(crate) y_up: bool,

    /// y runs downwards from the upper edge of the picture; a positive omega then turns anticlockwise on it
    #[arg(long)]
    pub(crate) y_down: bool,
}

impl PictureOptions {
    /// Names of the options that ask for something else than the defaults.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let options = [
            ("--fps", self.fps.is_some()),
            ("--dark", self.dark),
            ("--light", self.light),
            ("--threshold", self.threshold.is_some()),
            ("--channel", self.channel != ChannelChoice::Luminance),
            ("--background", self.background.is_some()),
            ("--ring", self.ring.is_some()),
            ("--ring-width", self.ring_width.is_some()),
            ("--smoothing", self.smoothing.is_some()),
            ("--min-area", self.min_area != SMALLEST_OBJECT),
            ("--objects", self.objects != ObjectsChoice::Largest),
            ("--pixel-size", self.pixel_size != 1.0),
            ("--pixel-aspect", self.pixel_aspect.is_some()),
            ("--y-up", self.y_up),
            ("--y-down", self.y_down),
        ];
        options.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }

    /// Whether all objects are taken, so that their names tell them apart.
    pub(crate) fn follows_all(&self) -> bool {
        self.objects == ObjectsChoice::All
    }

    /// The options as a report lists them.
    pub(crate) fn listed(&self) -> Vec<(&'static str, String)> {
        let found = match (self.ring, &self.background, self.threshold) {
            (Some(RingChoice::Dark), ..) => "by a dark ring, its outer edge".to_owned(),
            (Some(RingChoice::Light), ..) => "by a light ring, its outer edge".to_owned(),
            (_, Some(background), _) => format!("against the background {}", background.display()),
            (_, _, Some(threshold)) => format!("by the grey value {threshold}"),
            _ => "by Otsu's threshold in each picture".to_owned(),
        };
        let name = |value: Option<clap::builder::PossibleValue>| {
            value.map_or_else(String::new, |value| value.get_name().to_owned())
        };
        vec![
            ("Objects found", found),
            (
                "Objects taken",
                format!("{}, of at least {} pixels", name(self.objects.to_possible_value()), self.min_area),
            ),
            ("Channel", name(self.channel.to_possible_value())),
            ("Pixel height", self.pixel_size.to_string()),
            ("y", if self.y_down { "downwards" } else { "upwards" }.to_owned()),
        ]
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChannelChoice {
    Luminance,
    Red,
    Green,
    Blue,
    /// How far a colour is from grey
    Saturation,
}

impl ChannelChoice {
    pub(crate) const fn channel(self) -> Channel {
        match self {
            Self::Luminance => Channel::Luminance,
            Self::Red => Channel::Red,
            Self::Green => Channel::Green,
            Self::Blue => Channel::Blue,
            Self::Saturation => Channel::Saturation,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RingChoice {
    /// A line darker than what is on both sides of it
    Dark,
    /// A line lighter than what is on both sides of it
    Light,
}

impl RingChoice {
    pub(crate) const fn contrast(self) -> Contrast {
        match self {
            Self::Dark => Contrast::DarkOnLight,
            Self::Light => Contrast::LightOnDark,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ObjectsChoice {
    /// The largest of each picture
    Largest,
    /// The largest of the first picture, then the one nearest to where it is expected
    Nearest,
    /// All; each keeps its number from picture to picture
    All,
}

impl ObjectsChoice {
    pub(crate) const fn selection(self) -> Selection {
        match self {
            Self::Largest => Selection::Largest,
            Self::Nearest => Selection::Nearest,
            Self::All => Selection::All,
        }
    }
}
