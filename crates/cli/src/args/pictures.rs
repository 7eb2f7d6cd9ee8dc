use std::path::PathBuf;

use clap::{Args, ValueEnum};
use freeform_motion::outline_io::{Channel, Contrast, Margins, Selection, TracingChoice, Transfer};

use super::values::{not_negative, positive};

/// Smallest object where none is given, in pixels.
const SMALLEST_OBJECT: u64 = 64;

/// The paragraph on pictures in the help of a command.
pub(crate) fn picture_inputs(command: &str) -> String {
    format!(
        "Pictures: PNG, JPEG, TIFF, BMP, WebP, PGM and PPM, animated GIF, uncompressed video (y4m), a folder of pictures or a quoted \
         pattern, in natural order (frame-9 before frame-10). Convert any other video through a pipe:\n  {}\nA picture that cannot be \
         read, differs in size from the first, or shows no object is left out with a warning.\n\nWithout --light, --dark, --threshold, \
         --background or --ring, the ways are tried on pictures of the sequence, and the one that tells an object from the ground best \
         is taken and printed as the options that give it again. Its score is from 0 to 1, the product of how often something is found, how \
         steady its area and shape are, how clear its edge, how smooth its path; {} is needed not to be in doubt. Of a stream 60 pictures \
         are read ahead for that; 'track' does not.",
        through_ffmpeg("video.mp4", &format!("freeform {command} -")),
        TracingChoice::CONVINCING
    )
}

/// A pipe that decodes a video with ffmpeg for a command that reads standard input.
pub(crate) fn through_ffmpeg(video: &str, command: &str) -> String {
    format!("ffmpeg -loglevel error -i {video} -f yuv4mpegpipe -pix_fmt yuv420p - | {command}")
}

/// How outlines are found in pictures.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureOptions {
    /// Frames per second [default: that of the video or animation, else 30]
    #[arg(long, value_parser = positive)]
    pub(crate) fps: Option<f64>,

    /// The object is darker than the background
    #[arg(long, conflicts_with = "light")]
    pub(crate) dark: bool,

    /// The object is lighter than the background
    #[arg(long)]
    pub(crate) light: bool,

    /// Grey value between object and background, up to 255 [default: by Otsu's method in each picture]
    #[arg(long, value_name = "LEVEL", value_parser = positive)]
    pub(crate) threshold: Option<f64>,

    /// Channel of a colour picture that is used [default: chosen with the way of tracing, else luminance]
    #[arg(long, value_enum)]
    pub(crate) channel: Option<ChannelChoice>,

    /// Find objects by their difference from a picture without objects; from 'median', the median of the latest pictures; from 'whole',
    /// the median of pictures of the whole input, without what rests in most of them and leaves or comes; or from 'surface', a smooth
    /// surface through the ground of each picture
    #[arg(long, value_name = "FILE|median|whole|surface", conflicts_with = "ring")]
    pub(crate) background: Option<PathBuf>,

    /// Pictures that '--background median' is taken of, 3 to 255: more where objects are slow [default: 25]
    #[arg(long, value_name = "PICTURES", value_parser = clap::value_parser!(u8).range(3..), requires = "background")]
    pub(crate) background_window: Option<u8>,

    /// Find the object by a line around it, if it has the colour of the background; the outline is the outer edge of the line
    #[arg(long, value_enum, conflicts_with_all = ["threshold", "dark", "light"])]
    pub(crate) ring: Option<RingChoice>,

    /// Largest expected width of that line, in pixels [default: a sixtieth of the shorter side of the picture]
    #[arg(long, value_name = "PIXELS", value_parser = positive, requires = "ring")]
    pub(crate) ring_width: Option<f64>,

    /// Standard deviation of the smoothing in pixels, against noise and speckles [default: 1 for masks and rings, 0.5 for others]
    #[arg(long, value_name = "PIXELS", value_parser = not_negative)]
    pub(crate) smoothing: Option<f64>,

    /// How grey values stand for light: it tells where edges lie that motion blurs [default: srgb where objects keep their size by it
    /// while the way of tracing is chosen, else linear]
    #[arg(long, value_enum, conflicts_with = "ring")]
    pub(crate) transfer: Option<TransferChoice>,

    /// Which contours of an object are traced [default: all where holes and marks are seen to be steady while the way of tracing is
    /// chosen, else boundary]
    #[arg(long, value_enum)]
    pub(crate) contours: Option<ContoursChoice>,

    /// Draw the ways of tracing that were tried, the highest score first: what each finds in pictures of the input
    #[arg(long, value_name = "FILE.png")]
    pub(crate) candidates: Option<PathBuf>,

    /// Area of the smallest object, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = SMALLEST_OBJECT)]
    pub(crate) min_area: u64,

    /// Pixels at the sides of the pictures that are not looked at [default: even bars, which are seen while the way of tracing is chosen]
    #[arg(long, value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = margins)]
    pub(crate) margins: Option<Margins>,

    /// Which objects are taken [default: all where several are seen while the way of tracing is chosen, else largest]
    #[arg(long, value_enum)]
    pub(crate) objects: Option<ObjectsChoice>,

    /// Height of a pixel in the unit of length of the result
    #[arg(long, value_name = "LENGTH", value_parser = positive, default_value_t = 1.0)]
    pub(crate) pixel_size: f64,

    /// Width of a pixel over its height [default: that of the video, else 1]
    #[arg(long, value_name = "RATIO", value_parser = positive)]
    pub(crate) pixel_aspect: Option<f64>,

    /// y runs upwards from the lower edge of the picture; the default
    #[arg(long, overrides_with = "y_down")]
    pub(crate) y_up: bool,

    /// y runs downwards from the upper edge of the picture; a positive omega then turns anticlockwise in the picture
    #[arg(long)]
    pub(crate) y_down: bool,
}

/// Four numbers of pixels.
fn margins(text: &str) -> Result<Margins, String> {
    let pixels: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    match pixels.as_deref() {
        Ok([left, top, right, bottom]) => Ok(Margins { left: *left, top: *top, right: *right, bottom: *bottom }),
        _ => Err("four numbers of pixels such as 0,60,0,60".to_owned()),
    }
}

impl PictureOptions {
    /// Names of the options that differ from the defaults.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let options = [
            ("--fps", self.fps.is_some()),
            ("--dark", self.dark),
            ("--light", self.light),
            ("--threshold", self.threshold.is_some()),
            ("--channel", self.channel.is_some()),
            ("--background", self.background.is_some()),
            ("--background-window", self.background_window.is_some()),
            ("--ring", self.ring.is_some()),
            ("--ring-width", self.ring_width.is_some()),
            ("--smoothing", self.smoothing.is_some()),
            ("--transfer", self.transfer.is_some()),
            ("--contours", self.contours.is_some()),
            ("--candidates", self.candidates.is_some()),
            ("--min-area", self.min_area != SMALLEST_OBJECT),
            ("--margins", self.margins.is_some()),
            ("--objects", self.objects.is_some()),
            ("--pixel-size", self.pixel_size != 1.0),
            ("--pixel-aspect", self.pixel_aspect.is_some()),
            ("--y-up", self.y_up),
            ("--y-down", self.y_down),
        ];
        options.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }

    /// Whether several objects may be taken.
    pub(crate) fn follows_all(&self) -> bool {
        matches!(self.objects(), ObjectsChoice::All | ObjectsChoice::Moving | ObjectsChoice::Labels)
    }

    /// Which objects are taken.
    pub(crate) fn objects(&self) -> ObjectsChoice {
        self.objects.unwrap_or(ObjectsChoice::Largest)
    }

    /// The channel.
    pub(crate) fn channel(&self) -> ChannelChoice {
        self.channel.unwrap_or(ChannelChoice::Luminance)
    }

    /// How grey values stand for light.
    pub(crate) fn transfer(&self) -> TransferChoice {
        self.transfer.unwrap_or(TransferChoice::Linear)
    }

    /// Whether holes and marks are traced.
    pub(crate) fn traces_contours(&self) -> bool {
        self.contours == Some(ContoursChoice::All)
    }

    /// Whether the options say how objects are told from the ground.
    pub(crate) fn has_way(&self) -> bool {
        self.objects == Some(ObjectsChoice::Labels) || self.has_grey_way()
    }

    /// Whether they say which grey values are those of objects.
    fn has_grey_way(&self) -> bool {
        self.dark || self.light || self.threshold.is_some() || self.background.is_some() || self.ring.is_some()
    }

    /// All that is read with these options: what is named for input, and the picture without objects.
    pub(crate) fn files_read(&self, inputs: &[PathBuf]) -> Vec<PathBuf> {
        let is_file = |path: &&PathBuf| ["median", "whole", "surface"].iter().all(|word| path.as_os_str() != *word);
        inputs.iter().chain(self.background.as_ref().filter(is_file)).cloned().collect()
    }

    /// Whether pictures are compared with the ground of the whole input.
    pub(crate) fn compares_with_whole(&self) -> bool {
        self.background.as_ref().is_some_and(|path| path.as_os_str() == "whole")
    }

    /// Names of the options that say something else than that labels are objects.
    pub(crate) fn not_for_labels(&self) -> Vec<&'static str> {
        let for_greys = [
            "--dark",
            "--light",
            "--threshold",
            "--channel",
            "--background",
            "--background-window",
            "--ring",
            "--ring-width",
            "--transfer",
            "--contours",
            "--candidates",
            "--margins",
        ];
        self.given().into_iter().filter(|option| for_greys.contains(option)).collect()
    }

    /// Names and values of the options, for a report.
    pub(crate) fn listed(&self) -> Vec<(&'static str, String)> {
        let found = match (self.ring, &self.background, self.threshold) {
            (Some(RingChoice::Dark), ..) => "by a dark ring, its outer edge".to_owned(),
            (Some(RingChoice::Light), ..) => "by a light ring, its outer edge".to_owned(),
            (_, Some(background), _) if background.as_os_str() == "surface" => {
                "by the difference from a smooth surface through the ground".to_owned()
            }
            (_, Some(background), _) => format!("against the background {}", background.display()),
            (_, _, Some(threshold)) => format!("by the grey value {threshold}"),
            _ if self.objects() == ObjectsChoice::Labels => "by their labels".to_owned(),
            _ => "by Otsu's threshold in each picture".to_owned(),
        };
        let name = |value: Option<clap::builder::PossibleValue>| {
            value.map_or_else(String::new, |value| value.get_name().to_owned())
        };
        let left_out = self.margins.filter(|margins| !margins.are_none());
        let left_out = left_out.map(|Margins { left, top, right, bottom }| {
            ("Margins", format!("{left}, {top}, {right}, {bottom} pixels (left, top, right, bottom)"))
        });
        let listed = vec![
            ("Objects found", found),
            (
                "Objects taken",
                format!("{}, of at least {} pixels", name(self.objects().to_possible_value()), self.min_area),
            ),
            ("Channel", name(self.channel().to_possible_value())),
            ("Transfer function", name(self.transfer().to_possible_value())),
            ("Pixel height", self.pixel_size.to_string()),
            ("y", if self.y_down { "downwards" } else { "upwards" }.to_owned()),
        ];
        listed.into_iter().chain(left_out).collect()
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

    /// The choice of a channel.
    pub(crate) const fn of(channel: Channel) -> Self {
        match channel {
            Channel::Luminance => Self::Luminance,
            Channel::Red => Self::Red,
            Channel::Green => Self::Green,
            Channel::Blue => Self::Blue,
            Channel::Saturation => Self::Saturation,
        }
    }

    /// Its name on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TransferChoice {
    /// In proportion to it, as those of cameras that measure
    Linear,
    /// By the transfer function of sRGB, as those of most cameras and of video
    Srgb,
}

impl TransferChoice {
    pub(crate) const fn transfer(self) -> Transfer {
        match self {
            Self::Linear => Transfer::Linear,
            Self::Srgb => Transfer::Srgb,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ContoursChoice {
    /// The boundary; holes are filled
    Boundary,
    /// The boundary, and holes and marks within it
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RingChoice {
    /// A line darker than both of its sides
    Dark,
    /// A line lighter than both of its sides
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
    /// The largest object of each picture
    Largest,
    /// The largest object of the first picture, then the one nearest to its predicted place
    Nearest,
    /// All objects; each keeps its number from picture to picture
    All,
    /// Every value of label masks but 0, each by its number; the default for masks of several values
    Labels,
    /// Those of all that move: each from where it has left its place; what comes and goes is hardly ever taken
    Moving,
}

impl ObjectsChoice {
    pub(crate) const fn selection(self) -> Selection {
        match self {
            Self::Largest => Selection::Largest,
            Self::Nearest => Selection::Nearest,
            Self::All | Self::Labels => Selection::All,
            Self::Moving => Selection::Moving,
        }
    }
}
